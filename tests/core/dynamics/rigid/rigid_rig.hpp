#pragma once
// Scenes of rigid blocks for the tests: blocks on a base, stepped, with the peaks and impacts of a rocking block.
#include "dynamics/rigid/rigid_step.hpp"
#include <cmath>
#include <vector>

namespace rig {

using namespace masonry;
using namespace masonry::rigid;

constexpr double g = 9.81, density = 2000;

// A base whose top face is at height 0, and its gravity.
template <class K> RigidSystem<K> emptyScene(double friction = noSlip)
{
	(void)friction;
	RigidSystem<K> s;
	s.gravity[K::dimension - 1] = -g;
	RigidBody<K> base;
	base.halfSize.setConstant(5.);
	base.pose.position[K::dimension - 1] = -5;
	base.origin = base.pose.position;
	base.prescribed = true;
	s.bodies.push_back(base);
	return s;
}

inline int addBlock(RigidSystem<Plane>& s, double b, double a, const Vector2& center, double angle = 0, double mass = 0)
{
	RigidBody<Plane> block;
	block.halfSize << b, a;
	block.mass = mass > 0 ? mass : density * 4 * a * b;
	block.inertia[0] = block.mass * (a * a + b * b) / 3;
	block.pose.position = center;
	block.pose.setAngle(angle);
	block.force << 0, -block.mass * g, 0;
	s.bodies.push_back(block);
	return int(s.bodies.size()) - 1;
}

template <class K> void addPair(RigidSystem<K>& s, int body1, int body2, double restitution, double friction = noSlip)
{
	ContactPair<K> pair;
	pair.body1 = body1;
	pair.body2 = body2;
	pair.restitution = restitution;
	pair.friction = friction;
	s.pairs.push_back(pair);
}

// Centre of a block that stands on its edge at `pivot`, turned by angle (counter-clockwise; it stands on its left edge if positive).
inline Vector2 onEdge(double b, double a, double angle, const Vector2& pivot)
{
	PlanePose pose;
	pose.setAngle(angle);
	return pivot - pose.rotate(Vector2(angle > 0 ? -b : b, -a));
}

// Peaks of |angle| between impacts, each from the step in which the spin changes sign: cubic through angle and spin at both ends.
struct Peaks {
	std::vector<double> found;
	double              angle { NAN }, spin { 0 }, time { 0 };

	void take(double t, double newAngle, double newSpin)
	{
		if (!std::isnan(angle) && spin * newSpin < 0 && newAngle * spin > 0) {
			const double h = t - time, share = spin / (spin - newSpin);
			const double u = share, d = newAngle - angle;
			found.push_back((1 - u) * (1 - u) * (1 + 2 * u) * angle + u * u * (3 - 2 * u) * newAngle + h * u * (1 - u) * ((1 - u) * spin - u * newSpin));
			(void)d;
		}
		angle = newAngle;
		spin = newSpin;
		time = t;
	}
};

} // namespace rig
