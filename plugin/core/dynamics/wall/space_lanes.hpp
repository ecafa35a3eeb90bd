#pragma once
// Contact points in space, side by side. The spin of a body is taken along its principal axes and multiplied by the radii of gyration
// rho about them, W = rho R^T w: then it too goes with the mass m. Along each row e of a point, the normal n (from body 1 to body 2) and
// two tangents, the relative velocity is
//
//     u_e = e.(v2 - v1) + a2.W2 - a1.W1        a = R^T (r x e) / rho
//
// The arms r of the tangents lead to the place of the friction (contact/friction_points.hpp), that of the normal to the point itself.
#include "dynamics/wall/plane_lanes.hpp"

namespace masonry::wall {

struct alignas(alignment) Lanes3 {
	Lanes x, y, z;
	MASONRY_INLINE Vector3 lane(int i) const { return {x[i], y[i], z[i]}; }
	MASONRY_INLINE void operator+=(const Lanes3& o)
	{
		x += o.x;
		y += o.y;
		z += o.z;
	}
	MASONRY_INLINE void operator-=(const Lanes3& o)
	{
		x -= o.x;
		y -= o.y;
		z -= o.z;
	}
};
MASONRY_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
MASONRY_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
MASONRY_INLINE Lanes3 operator*(const Lanes& f, const Lanes3& a) { return {f * a.x, f * a.y, f * a.z}; }
MASONRY_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
MASONRY_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b)
{
	return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
MASONRY_INLINE Lanes3 select(const Mask& mask, const Lanes3& a, const Lanes3& b)
{
	return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

inline void setLane(Lanes3& to, int lane, const Vector3& value)
{
	to.x[lane] = value.x();
	to.y[lane] = value.y();
	to.z[lane] = value.z();
}

MASONRY_INLINE double component(const Lanes2& tangent, int k, int lane) { return k == 0 ? tangent.x[lane] : tangent.y[lane]; }
MASONRY_INLINE void setComponent(Lanes2& tangent, int k, int lane, double value)
{
	if (k == 0)
		tangent.x[lane] = value;
	else // (k == 0 ? x : y)[lane] is a copy to GCC 16
		tangent.y[lane] = value;
}

// The pose is (axes and position in three rows, then 1/rho).
template <>
struct BodyPacks<Space> {
	static constexpr int poses = 4;

	static Vector3 gyration(const Vector3& inertia, double mass) { return (inertia / mass).cwiseSqrt(); }
	static void place(const Pose& at, const Vector3& rho, Lanes* pose)
	{
		const Matrix3 axes = at.orientation.toRotationMatrix();
		for (int i = 0; i < 3; ++i)
			pose[i] = Lanes {axes(i, 0), axes(i, 1), axes(i, 2), at.position[i]};
		const Vector3 perRho = rho.cwiseInverse();
		pose[3] = Lanes {perRho[0], perRho[1], perRho[2], 1};
	}
	static Vector3 position(const Lanes* pose) { return {pose[0][3], pose[1][3], pose[2][3]}; }
	static void setVelocity(const Space::Velocity& v, const Lanes* pose, const Vector3&, double perMass, Lanes* to)
	{
		const Lanes spin = (v[3] * pose[0] + v[4] * pose[1] + v[5] * pose[2]) / pose[3]; // R^T w rho
		to[0] = Lanes {v[0], v[1], v[2], perMass};
		to[1] = Lanes {spin[0], spin[1], spin[2], perMass};
	}
	static Space::Velocity inGlobal(const Lanes* v, const Lanes* pose, const Vector3&)
	{
		const Lanes w = v[1] * pose[3];
		Space::Velocity result;
		for (int i = 0; i < 3; ++i) {
			result[i] = v[0][i];
			result[3 + i] = pose[i][0] * w[0] + pose[i][1] * w[1] + pose[i][2] * w[2];
		}
		return result;
	}
	static std::array<Lanes, 2> ofForce(const Space::Velocity& force, double factor, const Lanes* pose, const Vector3&)
	{
		const Lanes moment = force[3] * pose[0] + force[4] * pose[1] + force[5] * pose[2]; // R^T times it
		const Lanes spin = factor * moment * pose[3];
		return {factor * Lanes {force[0], force[1], force[2], 0}, Lanes {spin[0], spin[1], spin[2], 0}};
	}
};

// Velocities of bodies: packs (v, 1/m) and (W, 1/m) of each in, one lane a body out.
template <>
struct alignas(alignment) Bodies<Space> {
	Lanes3 v, w;
	Lanes m;

	MASONRY_INLINE Bodies(const Lanes* from, const int* body)
	{
		gather<2>(from, body, v.x, v.y, v.z, m);
		gather<2>(from + 1, body, w.x, w.y, w.z, m);
	}
	// Back to where they came from; those that are not free stay.
	MASONRY_INLINE void store(Lanes* to, const int* body, unsigned free) const
	{
		scatter<2>(v.x, v.y, v.z, m, to, body, free);
		scatter<2>(w.x, w.y, w.z, m, to + 1, body, free);
	}
};

// A row of a point takes the velocities of both bodies along an axis, and their spins by its arms.
struct alignas(alignment) Row {
	Lanes3 axis, arm1, arm2;
	MASONRY_INLINE Lanes rate(const Bodies<Space>& v1, const Bodies<Space>& v2) const
	{
		return dot(axis, v2.v - v1.v) + dot(arm2, v2.w) - dot(arm1, v1.w);
	}
};

template <>
struct alignas(alignment) PointLanes<Space> {
	using Tangent = Lanes2;
	Row normal, tangent[2];
	Lanes gap;          // m; far away in lanes without a point
	Lanes massN, massT; // 1 / (J M^-1 J^T), kg; of the tangents along that in which the point gives most
};

// The geometry of points (contact/point_geometry.hpp); edges that cross are looked at one by one.
template <>
struct alignas(alignment) FeatureLanes<Space> {
	Mask vertexOn1, present, crossing;
	Lanes3 vertex, normal, tangent; // of the face: outward normal, first tangent
	Lanes faceDistance;
	Lanes3 arm;       // from body 2 to the point, global axes
	Lanes foundGap;   // when the features were looked up
	Lanes2 found;     // where along them
	Lanes fromCorner; // m, of a vertex then from the nearest corner of the face: the larger component along its tangents
	Lanes3 grip;      // from the point to where its friction acts, in its tangent plane, global axes
	Lanes3 gripAt;    // the same in the axes of the body that has the vertex: a face that turns on its bed takes it along

	std::array<double, 6> saved(int lane) const
	{
		return {foundGap[lane], found.x[lane], found.y[lane], gripAt.x[lane], gripAt.y[lane], gripAt.z[lane]};
	}
	void setSaved(const std::array<double, 6>& f, int lane)
	{
		foundGap[lane] = f[0], found.x[lane] = f[1], found.y[lane] = f[2];
		gripAt.x[lane] = f[3], gripAt.y[lane] = f[4], gripAt.z[lane] = f[5];
	}
};

MASONRY_INLINE Lanes normalRate(const Bodies<Space>& v1, const Bodies<Space>& v2, const PointLanes<Space>& p)
{
	return p.normal.rate(v1, v2);
}
MASONRY_INLINE Lanes2 slipRate(const Bodies<Space>& v1, const Bodies<Space>& v2, const PointLanes<Space>& p)
{
	return {p.tangent[0].rate(v1, v2), p.tangent[1].rate(v1, v2)};
}

// Impulses into velocities.
MASONRY_INLINE void pushNormal(Bodies<Space>& v1, Bodies<Space>& v2, const PointLanes<Space>& p, const Lanes& dn)
{
	const Lanes d1 = v1.m * dn, d2 = v2.m * dn;
	v1.v -= d1 * p.normal.axis;
	v1.w -= d1 * p.normal.arm1;
	v2.v += d2 * p.normal.axis;
	v2.w += d2 * p.normal.arm2;
}
// 1 / (J M^-1 J^T) along the normal of bodies with these 1/m.
MASONRY_INLINE Lanes normalMass(const PointLanes<Space>& p, const Lanes& m1, const Lanes& m2)
{
	return all(1) / (m1 + m2 + m1 * dot(p.normal.arm1, p.normal.arm1) + m2 * dot(p.normal.arm2, p.normal.arm2));
}
// Impulses into momenta.
MASONRY_INLINE void add(Bodies<Space>& f1, Bodies<Space>& f2, const PointLanes<Space>& p, const Lanes& qn, const Lanes2& qt)
{
	const Lanes3 f = qn * p.normal.axis + qt.x * p.tangent[0].axis + qt.y * p.tangent[1].axis;
	f1.v -= f;
	f1.w -= qn * p.normal.arm1 + qt.x * p.tangent[0].arm1 + qt.y * p.tangent[1].arm1;
	f2.v += f;
	f2.w += qn * p.normal.arm2 + qt.x * p.tangent[0].arm2 + qt.y * p.tangent[1].arm2;
}

// Coulomb: within the disc of radius `bound`.
MASONRY_INLINE Lanes2 clip(const Lanes2& tangential, const Lanes& bound)
{
	const Lanes square = dot(tangential, tangential);
	const Mask outside = square > bound * bound;
	return select(outside, bound / select(outside, root(square), all(1)), all(1)) * tangential;
}
// On the rim but for round-off.
MASONRY_INLINE Mask slides(const Lanes2& tangential, const Lanes& bound)
{
	constexpr double offRim = 1e-12;
	return dot(tangential, tangential) >= all(1 - offRim) * bound * bound;
}
inline Vector3 normal(const PointLanes<Space>& p, int lane) { return p.normal.axis.lane(lane); }
// Along a row (0 normal, then tangential) what one lane's point takes of a body's pack (0 velocity, 1 spin).
MASONRY_INLINE Vector3 partOf(const PointLanes<Space>& p, int row, int lane, int body, int pack)
{
	const Row& r = row == 0 ? p.normal : p.tangent[row - 1];
	return (pack == 0 ? r.axis : body == 1 ? r.arm1 : r.arm2).lane(lane);
}

// Sets the frame of one lane's point. Its position is from the centre of body 2.
MASONRY_INLINE void takeFrame(const PointLanes<Space>& p, const FeatureLanes<Space>& f, int lane, const Space::Spin&,
                              ContactFrame<Space>& frame)
{
	frame.position = f.arm.lane(lane);
	frame.axes.row(0) = p.normal.axis.lane(lane);
	frame.axes.row(1) = p.tangent[0].axis.lane(lane);
	frame.axes.row(2) = p.tangent[1].axis.lane(lane);
	frame.grip = f.grip.lane(lane);
	frame.gap = p.gap[lane];
}

} // namespace masonry::wall
