#pragma once
// Contact points in the plane, side by side. With n from body 1 to body 2, t = n turned by 90 degrees and V = (v, rho w), the relative
// velocity at a point is
//
//     u_n = n.(v2 - v1) + a2n W2 - a1n W1        a_n = (r x n)/rho,  a_t = (r x t)/rho = (r.n)/rho
//     u_t = t.(v2 - v1) + a2t W2 - a1t W1
#include "contact/kinematics.hpp"
#include "simd/lanes.hpp"
#include <array>
#include <cmath>

namespace masonry::wall {

// Numbers side by side by their own names; contact points add overloads to some functions.
using simd::alignment;
using simd::all;
using simd::allLanes;
using simd::any;
using simd::Array;
using simd::bitsOf;
using simd::copyLane;
using simd::gather;
using simd::LaneArray;
using simd::Lanes;
using simd::larger;
using simd::largest;
using simd::length;
using simd::Mask;
using simd::maskOf;
using simd::noMass;
using simd::root;
using simd::scatter;
using simd::select;
using simd::size;
using simd::smaller;
using simd::transpose;
using simd::width;

// Side by side: vectors of a plane, or along two tangents.
struct alignas(alignment) Lanes2 {
	Lanes x, y;
};
MASONRY_INLINE Lanes2 operator+(const Lanes2& a, const Lanes2& b) { return {a.x + b.x, a.y + b.y}; }
MASONRY_INLINE Lanes2 operator-(const Lanes2& a, const Lanes2& b) { return {a.x - b.x, a.y - b.y}; }
MASONRY_INLINE Lanes2 operator*(const Lanes& f, const Lanes2& a) { return {f * a.x, f * a.y}; }
MASONRY_INLINE Lanes2 operator*(const Lanes2& a, const Lanes& f) { return f * a; }
MASONRY_INLINE Lanes2 operator*(double f, const Lanes2& a) { return all(f) * a; }
MASONRY_INLINE Lanes2& operator*=(Lanes2& a, const Lanes& f) { return a = f * a; }
MASONRY_INLINE Lanes dot(const Lanes2& a, const Lanes2& b) { return a.x * b.x + a.y * b.y; }
MASONRY_INLINE Lanes size(const Lanes2& a) { return larger(size(a.x), size(a.y)); } // to report and compare only: saves the root
MASONRY_INLINE Lanes length(const Lanes2& a) { return root(dot(a, a)); }
MASONRY_INLINE Lanes2 select(const Mask& mask, const Lanes2& a, const Lanes2& b)
{
	return {select(mask, a.x, b.x), select(mask, a.y, b.y)};
}
template <class K>
struct BodyPacks;
template <class K>
struct Bodies;
template <class K>
struct PointLanes;
template <class K>
struct FeatureLanes;

// How the pose, the velocity and forces of a body are packed; rho: radius of gyration. The pose is (position, cosine, sine).
template <>
struct BodyPacks<Plane> {
	static constexpr int poses = 1; // packs of a pose

	static Plane::Spin gyration(const Plane::Inertia& inertia, double mass) { return Plane::Spin(std::sqrt(inertia[0] * (1 / mass))); }
	static void place(const PlanePose& at, const Plane::Spin&, Lanes* pose)
	{
		*pose = Lanes {at.position.x(), at.position.y(), at.cosine, at.sine};
	}
	static Vector2 position(const Lanes* pose) { return {pose[0][0], pose[0][1]}; }
	static void setVelocity(const Plane::Velocity& v, const Lanes*, const Plane::Spin& rho, double perMass, Lanes* to)
	{
		*to = Lanes {v[0], v[1], rho[0] * v[2], perMass};
	}
	static Plane::Velocity inGlobal(const Lanes* v, const Lanes*, const Plane::Spin& rho) { return {v[0][0], v[0][1], v[0][2] / rho[0]}; }
	// A force and its moment times a factor.
	static std::array<Lanes, 1> ofForce(const Plane::Velocity& force, double factor, const Lanes*, const Plane::Spin& rho)
	{
		return {factor * Lanes {force[0], force[1], force[2] / rho[0], 0}};
	}
};

// Velocities of bodies: packs of `from` in, one lane a body out.
template <>
struct alignas(alignment) Bodies<Plane> {
	Lanes x, y, w, m;

	MASONRY_INLINE Bodies(const Lanes* from, const int* body) { gather<1>(from, body, x, y, w, m); }
	// Back to where they came from; those that are not free stay.
	MASONRY_INLINE void store(Lanes* to, const int* body, unsigned free) const { scatter<1>(x, y, w, m, to, body, free); }
};

template <>
struct alignas(alignment) PointLanes<Plane> {
	using Tangent = Lanes;
	Lanes nx, ny, a1n, a1t, a2n, a2t;
	Lanes gap;          // m; far away in lanes without a point
	Lanes massN, massT; // 1 / (J M^-1 J^T), kg
};

// The geometry of points (contact/point_geometry.hpp).
template <>
struct alignas(alignment) FeatureLanes<Plane> {
	Mask vertexOn1, present;
	Lanes2 vertex, normal;
	Lanes faceDistance;         // m, of the face from the centre
	Lanes faceBegin, faceEnd;   // m, along the face
	Lanes foundGap, foundShift; // of the vertex over and along the face when they were looked up

	std::array<double, 2> saved(int lane) const { return {foundGap[lane], foundShift[lane]}; }
	void setSaved(const std::array<double, 2>& f, int lane) { foundGap[lane] = f[0], foundShift[lane] = f[1]; }
};

MASONRY_INLINE double component(const Lanes& tangent, int, int lane) { return tangent[lane]; }
MASONRY_INLINE void setComponent(Lanes& tangent, int, int lane, double value) { tangent[lane] = value; }
MASONRY_INLINE Lanes dot(const Lanes& a, const Lanes& b) { return a * b; }

MASONRY_INLINE Lanes normalRate(const Bodies<Plane>& v1, const Bodies<Plane>& v2, const PointLanes<Plane>& p)
{
	return p.nx * (v2.x - v1.x) + p.ny * (v2.y - v1.y) + p.a2n * v2.w - p.a1n * v1.w;
}
MASONRY_INLINE Lanes slipRate(const Bodies<Plane>& v1, const Bodies<Plane>& v2, const PointLanes<Plane>& p)
{
	return p.nx * (v2.y - v1.y) - p.ny * (v2.x - v1.x) + p.a2t * v2.w - p.a1t * v1.w;
}

// Impulses into velocities.
MASONRY_INLINE void pushNormal(Bodies<Plane>& v1, Bodies<Plane>& v2, const PointLanes<Plane>& p, const Lanes& dn)
{
	v1.x -= v1.m * p.nx * dn;
	v1.y -= v1.m * p.ny * dn;
	v1.w -= v1.m * p.a1n * dn;
	v2.x += v2.m * p.nx * dn;
	v2.y += v2.m * p.ny * dn;
	v2.w += v2.m * p.a2n * dn;
}
// 1 / (J M^-1 J^T) along the normal of bodies with these 1/m.
MASONRY_INLINE Lanes normalMass(const PointLanes<Plane>& p, const Lanes& m1, const Lanes& m2)
{
	return all(1) / (m1 + m2 + m1 * p.a1n * p.a1n + m2 * p.a2n * p.a2n);
}
// Impulses into momenta.
MASONRY_INLINE void add(Bodies<Plane>& f1, Bodies<Plane>& f2, const PointLanes<Plane>& p, const Lanes& qn, const Lanes& qt)
{
	const Lanes fx = p.nx * qn - p.ny * qt, fy = p.ny * qn + p.nx * qt;
	f1.x -= fx;
	f1.y -= fy;
	f1.w -= p.a1n * qn + p.a1t * qt;
	f2.x += fx;
	f2.y += fy;
	f2.w += p.a2n * qn + p.a2t * qt;
}

// Coulomb: within the bound.
MASONRY_INLINE Lanes clip(const Lanes& tangential, const Lanes& bound) { return larger(smaller(tangential, bound), -bound); }
MASONRY_INLINE Mask slides(const Lanes& tangential, const Lanes& bound) { return size(tangential) >= bound; }
inline Vector2 normal(const PointLanes<Plane>& p, int lane) { return {p.nx[lane], p.ny[lane]}; }
// Along a row (0 normal, 1 tangential) what one lane's point takes of a body's pack.
MASONRY_INLINE Vector3 partOf(const PointLanes<Plane>& p, int row, int lane, int body, int)
{
	const double n[3] = {p.nx[lane], p.ny[lane], (body == 1 ? p.a1n : p.a2n)[lane]};
	return row == 0 ? Vector3(n[0], n[1], n[2]) : Vector3(-n[1], n[0], (body == 1 ? p.a1t : p.a2t)[lane]);
}

// Sets the frame of one lane's point. Its position is from the centre of body 2, whose radius of gyration is rho.
MASONRY_INLINE void takeFrame(const PointLanes<Plane>& p, const FeatureLanes<Plane>&, int lane, const Plane::Spin& rho,
                              ContactFrame<Plane>& frame)
{
	const double nx = p.nx[lane], ny = p.ny[lane], along = rho[0] * p.a2t[lane], across = -rho[0] * p.a2n[lane];
	frame.position = {along * nx - across * ny, along * ny + across * nx};
	frame.axes << nx, ny, -ny, nx;
	frame.gap = p.gap[lane];
}

} // namespace masonry::wall
