#pragma once
// Scenes of boxes in space for the tests, and what a run must hold to.
#include "core/dynamics/localised/rigid_rig.hpp"
#include <utility>

namespace rig {

using System = RigidSystem<Space>;

inline int addBox(System& s, const Vector3& half, const Pose& pose)
{
	RigidBody<Space> box;
	const Vector3 squares = half.cwiseAbs2();
	box.setBox(half);
	box.mass = density * 8 * half.prod();
	box.inertia = box.mass / 3 * (squares.sum() * Vector3::Ones() - squares);
	box.pose = pose;
	box.force[2] = -box.mass * g;
	s.bodies.push_back(box);
	return int(s.bodies.size()) - 1;
}

inline Quaternion turn(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis.normalized())); }

// With its own point `local` at `place`.
inline Pose placed(const Quaternion& orientation, const Vector3& local, const Vector3& place)
{
	Pose pose;
	pose.orientation = orientation;
	pose.position = place - orientation * local;
	return pose;
}

inline System oneBox(const Vector3& half, const Pose& pose, double restitution, double friction = noSlip)
{
	System s = emptyScene<Space>();
	addBox(s, half, pose);
	addPair(s, 0, 1, restitution, friction);
	return s;
}

// The box as a block of the plane, of half width b: turned by angle > 0 about its edge, with the mass and the moment of inertia of the box.
inline RigidSystem<Plane> inPlane(const RigidBody<Space>& box, double b, double angle, double restitution)
{
	const double a = box.shape->halfSize().z();
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, onEdge(b, a, angle, {-b, 0}), angle, box.mass);
	s.bodies[1].inertia[0] = box.inertia.x();
	addPair(s, 0, 1, restitution);
	return s;
}

inline double energyOf(const System& s)
{
	double sum = s.kineticEnergy();
	for (const auto& body : s.bodies)
		if (!body.prescribed)
			sum += body.mass * g * body.pose.position.z();
	return sum;
}

inline double overturning(const RigidBody<Space>& body) { return body.mass * g * (body.shape->radius() - body.shape->halfSize().z()); }

inline Matrix3 axesOf(const System& s, int body = 1) { return s.bodies[body].pose.orientation.toRotationMatrix(); }

// What a run must hold to at every step.
struct Watch {
	double rise {0}, depth {0}, impactGain {0}, residual {0};
	long events {0}, unlocalised {0}, unsolved {0};
	bool diverged {false};
	double last;

	explicit Watch(const System& s) : last(energyOf(s) - s.baseWork) {}
	void take(const System& s, const StepReport& report)
	{
		const double now = energyOf(s) - s.baseWork;
		rise = std::max(rise, now - last);
		last = now;
		for (const auto& pair : s.pairs)
			for (int i = 0; i < pair.size(); ++i)
				depth = std::max(depth, -pair.points[i].gap);
		for (const Impact& impact : s.impacts)
			impactGain = std::max(impactGain, -impact.energyLost);
		residual = std::max(residual, report.residual);
		events += report.events;
		unlocalised += report.unlocalised;
		unsolved += !report.converged;
		diverged |= report.diverged;
	}
};

// One velocity jump of the base at the start.
struct Jump : BaseDrive {
	double speed;
	bool taken {false};
	explicit Jump(double v) : speed(v) {}
	double displacement(double t) const override { return taken ? speed * t : 0; }
	double velocity(double) const override { return taken ? speed : 0; }
	double nextKink(double, double) const override { return std::numeric_limits<double>::infinity(); }
	double jumpAt(double) override { return std::exchange(taken, true) ? 0 : speed; }
	double respond(int, double) override { return 0; }
};

} // namespace rig
