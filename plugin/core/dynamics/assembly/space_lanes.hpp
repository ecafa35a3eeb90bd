#pragma once
// Contact points in space, side by side. The spin of a body is taken along its principal axes and multiplied by the radii of gyration
// rho about them, W = rho R^T w: then it too goes with the mass m. Along each row e of a point, the normal n (from body 1 to body 2) and
// two tangents, the relative velocity is
//
//     u_e = e.(v2 - v1) + a2.W2 - a1.W1        a = R^T (r x e) / rho
#include "dynamics/assembly/plane_lanes.hpp"

namespace masonry::rigid::assembly {

template <class L>
struct alignas(alignment) Three {
	L x, y, z;
	MASONRY_INLINE Vector3 lane(int i) const { return {x[i], y[i], z[i]}; }
	MASONRY_INLINE void operator+=(const Three<L>& o)
	{
		x += o.x;
		y += o.y;
		z += o.z;
	}
	MASONRY_INLINE void operator-=(const Three<L>& o)
	{
		x -= o.x;
		y -= o.y;
		z -= o.z;
	}
};
template <class L>
MASONRY_INLINE Three<L> operator+(const Three<L>& a, const Three<L>& b)
{
	return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class L>
MASONRY_INLINE Three<L> operator-(const Three<L>& a, const Three<L>& b)
{
	return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class L>
MASONRY_INLINE Three<L> operator*(const L& f, const Three<L>& a)
{
	return {f * a.x, f * a.y, f * a.z};
}
template <class L>
MASONRY_INLINE L dot(const Three<L>& a, const Three<L>& b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class L>
MASONRY_INLINE Three<L> cross(const Three<L>& a, const Three<L>& b)
{
	return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class L>
MASONRY_INLINE Three<L> select(const MaskOf<L>& mask, const Three<L>& a, const Three<L>& b)
{
	return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

using Lanes3 = Three<Lanes>;

// Along the two tangents.
template <class L>
struct alignas(alignment) Two {
	L x, y;
};
using Lanes2 = Two<Lanes>;
template <class L>
MASONRY_INLINE Two<L> operator+(const Two<L>& a, const Two<L>& b)
{
	return {a.x + b.x, a.y + b.y};
}
template <class L>
MASONRY_INLINE Two<L> operator-(const Two<L>& a, const Two<L>& b)
{
	return {a.x - b.x, a.y - b.y};
}
template <class L>
MASONRY_INLINE Two<L> operator*(const L& f, const Two<L>& a)
{
	return {f * a.x, f * a.y};
}
template <class L>
MASONRY_INLINE Two<L> operator*(const Two<L>& a, const L& f)
{
	return f * a;
}
template <class L>
MASONRY_INLINE Two<L> operator*(double f, const Two<L>& a)
{
	return all<L>(f) * a;
}
template <class L>
MASONRY_INLINE Two<L>& operator*=(Two<L>& a, const L& f)
{
	return a = f * a;
}
template <class L>
MASONRY_INLINE L dot(const Two<L>& a, const Two<L>& b)
{
	return a.x * b.x + a.y * b.y;
}
template <class L>
MASONRY_INLINE L size(const Two<L>& a)
{
	return larger(size(a.x), size(a.y));
} // to report and compare only: saves the root
template <class L>
MASONRY_INLINE L length(const Two<L>& a)
{
	return root(dot(a, a));
}
template <class L>
MASONRY_INLINE Two<L> select(const MaskOf<L>& mask, const Two<L>& a, const Two<L>& b)
{
	return {select(mask, a.x, b.x), select(mask, a.y, b.y)};
}
template <class L>
MASONRY_INLINE double component(const Two<L>& tangent, int k, int lane)
{
	return k == 0 ? tangent.x[lane] : tangent.y[lane];
}
template <class L>
MASONRY_INLINE void setComponent(Two<L>& tangent, int k, int lane, double value)
{
	if (k == 0)
		tangent.x[lane] = value;
	else // (k == 0 ? x : y)[lane] is a copy to GCC 16
		tangent.y[lane] = value;
}

// Velocities of bodies: packs (v, 1/m) and (W, 1/m) of each in, one lane a body out.
template <class L>
struct alignas(alignment) Bodies<Space, L> {
	Three<L> v, w;
	L m;

	MASONRY_INLINE Bodies(const PackOf<L>* from, const PlaceOf<L>* body)
	{
		gather<2>(from, body, v.x, v.y, v.z, m);
		gather<2>(from + 1, body, w.x, w.y, w.z, m);
	}
	// Back to where they came from; those that are not free stay.
	MASONRY_INLINE void store(PackOf<L>* to, const PlaceOf<L>* body, unsigned free) const
	{
		scatter<2>(v.x, v.y, v.z, m, to, body, free);
		scatter<2>(w.x, w.y, w.z, m, to + 1, body, free);
	}
};

// Of one row of a point.
template <class L>
struct alignas(alignment) Row {
	Three<L> axis, arm1, arm2;
	MASONRY_INLINE L rate(const Bodies<Space, L>& v1, const Bodies<Space, L>& v2) const
	{
		return dot(axis, v2.v - v1.v) + dot(arm2, v2.w) - dot(arm1, v1.w);
	}
};

template <class L>
struct alignas(alignment) PointLanes<Space, L> {
	using Number = L;
	using Tangent = Two<L>;
	Row<L> normal, tangent[2];
	L gap;          // m; far away in lanes without a point
	L massN, massT; // 1 / (J M^-1 J^T), kg; of the tangents along that in which the point gives most
	L pn;           // impulse of a step, N s
	Two<L> pt;
	L steady; // filtered pn
};

// What a point is made of: vertex and face in the axes of their bodies; or two edges that cross, which are looked at one by one.
template <>
struct alignas(alignment) FeatureLanes<Space> {
	Mask vertexOn1, present, crossing;
	Lanes3 vertex, normal, tangent; // of the face: outward normal, first tangent
	Lanes faceDistance;
	Lanes3 arm;     // from body 2 to the point, global axes
	Lanes foundGap; // when the features were looked up
	Lanes2 found;   // where along them

	std::array<double, 3> foundAt(int lane) const { return {foundGap[lane], found.x[lane], found.y[lane]}; }
	void setFound(const std::array<double, 3>& f, int lane) { foundGap[lane] = f[0], found.x[lane] = f[1], found.y[lane] = f[2]; }
};

template <class L>
MASONRY_INLINE L normalRate(const Bodies<Space, L>& v1, const Bodies<Space, L>& v2, const PointLanes<Space, L>& p)
{
	return p.normal.rate(v1, v2);
}
template <class L>
MASONRY_INLINE Two<L> slipRate(const Bodies<Space, L>& v1, const Bodies<Space, L>& v2, const PointLanes<Space, L>& p)
{
	return {p.tangent[0].rate(v1, v2), p.tangent[1].rate(v1, v2)};
}

// Impulses into velocities.
template <class L>
MASONRY_INLINE void pushNormal(Bodies<Space, L>& v1, Bodies<Space, L>& v2, const PointLanes<Space, L>& p, const L& dn)
{
	const L d1 = v1.m * dn, d2 = v2.m * dn;
	v1.v -= d1 * p.normal.axis;
	v1.w -= d1 * p.normal.arm1;
	v2.v += d2 * p.normal.axis;
	v2.w += d2 * p.normal.arm2;
}
// 1 / (J M^-1 J^T) along the normal of bodies with these 1/m.
template <class L>
MASONRY_INLINE L normalMass(const PointLanes<Space, L>& p, const L& m1, const L& m2)
{
	return all<L>(1) / (m1 + m2 + m1 * dot(p.normal.arm1, p.normal.arm1) + m2 * dot(p.normal.arm2, p.normal.arm2));
}
// Impulses into momenta.
template <class L>
MASONRY_INLINE void add(Bodies<Space, L>& f1, Bodies<Space, L>& f2, const PointLanes<Space, L>& p, const L& qn, const Two<L>& qt)
{
	const Three<L> f = qn * p.normal.axis + qt.x * p.tangent[0].axis + qt.y * p.tangent[1].axis;
	f1.v -= f;
	f1.w -= qn * p.normal.arm1 + qt.x * p.tangent[0].arm1 + qt.y * p.tangent[1].arm1;
	f2.v += f;
	f2.w += qn * p.normal.arm2 + qt.x * p.tangent[0].arm2 + qt.y * p.tangent[1].arm2;
}

// Coulomb: within the disc of radius `bound`.
template <class L>
MASONRY_INLINE Two<L> clip(const Two<L>& tangential, const L& bound)
{
	const L square = dot(tangential, tangential);
	const MaskOf<L> outside = square > bound * bound;
	return select(outside, bound / select(outside, root(square), all<L>(1)), all<L>(1)) * tangential;
}
// On the rim but for round-off.
template <class L>
MASONRY_INLINE MaskOf<L> slides(const Two<L>& tangential, const L& bound)
{
	constexpr double offRim = std::is_same_v<L, Lanes> ? 1e-12 : 1e-6;
	return dot(tangential, tangential) >= all<L>(1 - offRim) * bound * bound;
}
inline Vector3 normal(const PointLanes<Space>& p, int lane) { return p.normal.axis.lane(lane); }
// Along a row (0 normal, then tangential) what one lane's point takes of a body's pack (0 velocity, 1 spin).
MASONRY_INLINE Vector3 partOf(const PointLanes<Space>& p, int row, int lane, int body, int pack)
{
	const Row<Lanes>& r = row == 0 ? p.normal : p.tangent[row - 1];
	return (pack == 0 ? r.axis : body == 1 ? r.arm1 : r.arm2).lane(lane);
}

// Of one lane's point; its position from the centre of body 2.
MASONRY_INLINE void takeFrame(const PointLanes<Space>& p, const FeatureLanes<Space>& f, int lane, const Space::Spin&,
                              ContactFrame<Space>& frame)
{
	frame.position = f.arm.lane(lane);
	frame.axes.row(0) = p.normal.axis.lane(lane);
	frame.axes.row(1) = p.tangent[0].axis.lane(lane);
	frame.axes.row(2) = p.tangent[1].axis.lane(lane);
	frame.gap = p.gap[lane];
}

} // namespace masonry::rigid::assembly
