#pragma once
// Place of the core's plane or space in the scene, and of a body in it. No physics here.

#include "block_shape.hpp"
#include "dynamics/model/rigid_system.hpp"
#include "sentence.hpp"
#include <core/Body.hpp>

namespace yade {

using masonry::Plane;
using masonry::Space;

/// A body moves, or is pushed, out of the plane of a planar scene.
struct LeavesPlane : std::runtime_error {
	using std::runtime_error::runtime_error;
};

/// Sine of an angle, or share of a length, a force or a speed, by which a planar scene may miss its plane: what rounding leaves of
/// a yawed scene. Larger: a real push out of the plane is lost.
constexpr Real outOfPlane = 1e-9;

inline bool isSame(const masonry::PlanePose& a, const masonry::PlanePose& b) { return a.position == b.position && a.angle == b.angle; }
inline bool isSame(const masonry::Pose& a, const masonry::Pose& b)
{
	return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// Motion of a body's State, as it was written last.
struct Motion {
	Vector3r pos, vel, angVel;
	Quaternionr ori;

	bool isPlaceOf(const State& state) const { return pos == state.pos && ori.coeffs() == state.ori.coeffs(); }
	/// Nobody has touched the body since.
	bool isOf(const State& state) const { return isPlaceOf(state) && vel == state.vel && angVel == state.angVel; }
};

template <class K>
struct Coordinates;
template <class K>
struct Seat;

template <>
struct Coordinates<Plane> {
	Vector3r along, up, normal; // angles count from along to up, about the normal

	explicit Coordinates(const Vector3r& horizontal) : along(horizontal), up(Vector3r::UnitZ()), normal(horizontal.cross(up)) {}

	masonry::Vector2 in(const Vector3r& v) const { return {along.dot(v), up.dot(v)}; }
	/// Throws LeavesPlane.
	masonry::Vector2 gravity(const Vector3r& g) const
	{
		if (std::abs(normal.dot(g)) > outOfPlane * g.norm())
			throw LeavesPlane("gravity points out of the plane");
		return in(g);
	}
	/// Direction of a motion, a unit vector. Throws LeavesPlane.
	masonry::Vector2 direction(const Vector3r& d) const
	{
		if (std::abs(normal.dot(d)) > outOfPlane)
			throw LeavesPlane("a motion points out of the plane");
		return in(d);
	}
	Vector3r out(const masonry::Vector2& v) const { return v.x() * along + v.y() * up; }
	/// Load on block `id`. Throws LeavesPlane.
	Plane::Velocity load(const Vector3r& force, const Vector3r& torque, int id) const
	{
		if (leaves(force, torque))
			throw LeavesPlane(sentence("a force or torque acts on block ", id, " out of the plane"));
		return in(force, torque);
	}
	/// Velocity of block `id`. Throws LeavesPlane.
	Plane::Velocity velocity(const State& state, int id) const
	{
		if (leaves(state.vel, state.angVel))
			throw LeavesPlane(sentence("block ", id, " moves out of the plane"));
		return in(state.vel, state.angVel);
	}

private:
	bool leaves(const Vector3r& linear, const Vector3r& angular) const
	{
		const auto share = [](Real square, const Vector3r& of) { return square > outOfPlane * outOfPlane * of.squaredNorm(); };
		const Real across = normal.dot(linear);
		return share(across * across, linear) || share(angular.cross(normal).squaredNorm(), angular);
	}
	Plane::Velocity in(const Vector3r& linear, const Vector3r& angular) const
	{
		Plane::Velocity result;
		result << in(linear), normal.dot(angular);
		return result;
	}
};

template <>
struct Coordinates<Space> {
	explicit Coordinates(const Vector3r&) {}

	const Vector3r& in(const Vector3r& v) const { return v; }
	const Vector3r& gravity(const Vector3r& g) const { return g; }
	const Vector3r& direction(const Vector3r& d) const { return d; }
	const Vector3r& out(const Vector3r& v) const { return v; }
	Space::Velocity load(const Vector3r& force, const Vector3r& torque, int) const
	{
		Space::Velocity result;
		result << force, torque;
		return result;
	}
};

/// A box in the plane: which of its axes lies across, which upright, how deep it is, how it stands at angle zero.
template <>
struct Seat<Plane> {
	int across = 0, upright = 0, lengthwise = 0;
	Real depth = 0; // along the normal
	Quaternionr reference = Quaternionr::Identity();

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(across, upright, lengthwise, depth, reference.coeffs());
	}

	Seat() = default;
	Seat(const Coordinates<Plane>& c, const State& state)
	{
		const Matrix3r axes = state.ori.toRotationMatrix();
		(c.normal.transpose() * axes).cwiseAbs().maxCoeff(&across);
		lengthwise = (across + 1) % 3;
		upright = (across + 2) % 3;
		if (std::abs(c.along.dot(axes.col(lengthwise))) < std::abs(c.along.dot(axes.col(upright))))
			std::swap(lengthwise, upright);
		Matrix3r standing;
		standing.col(across) = std::copysign(1, c.normal.dot(axes.col(across))) * c.normal;
		standing.col(lengthwise) = std::copysign(1, c.along.dot(axes.col(lengthwise))) * c.along;
		standing.col(upright) = standing.col((upright + 1) % 3).cross(standing.col((upright + 2) % 3));
		reference = Quaternionr(standing);
		depth = c.normal.dot(state.pos);
	}

	masonry::Solid<masonry::ConvexPolygon> shape(const Coordinates<Plane>& c, const BlockShape& of) const
	{
		if (of.isBox())
			return masonry::ConvexPolygon::box({of.extents()[lengthwise], of.extents()[upright]});
		const Vector3r along = reference.conjugate() * c.along, up = reference.conjugate() * c.up;
		if (!of.isUnion())
			return of.solid()->part(0).section(along, up);
		vector<masonry::ConvexPolygon> parts;
		for (int part = 0; part < of.solid()->size(); ++part) {
			masonry::Vector2 centre;
			const masonry::ConvexPolygon section = of.solid()->part(part).section(along, up, &centre);
			parts.push_back(section.moved(centre));
		}
		return masonry::Solid<masonry::ConvexPolygon>(std::move(parts));
	}
	Plane::Inertia inertia(const Vector3r& principal) const { return Plane::Inertia(principal[across]); }

	/// Angles within half a turn. Throws LeavesPlane.
	void read(const Coordinates<Plane>& c, const State& state, Real size, int id, masonry::RigidBody<Plane>& body) const
	{
		const Quaternionr turn = state.ori * reference.conjugate();
		const Real about = turn.vec().dot(c.normal);
		const Vector3r astray = turn.vec() - about * c.normal;
		if (std::abs(c.normal.dot(state.pos) - depth) > outOfPlane * size || astray.norm() > outOfPlane)
			throw LeavesPlane(sentence("block ", id, " has been moved out of the plane"));
		body.velocity = c.velocity(state, id);
		body.pose.position = c.in(state.pos);
		body.pose.setAngle(2 * (turn.w() < 0 ? std::atan2(-about, -turn.w()) : std::atan2(about, turn.w())));
	}
	/// To all at once: read back while it is still being written, a number keeps the processor waiting.
	template <class... To>
	void tell(const Coordinates<Plane>& c, const masonry::RigidBody<Plane>& body, To&... to) const
	{
		// Half the angle, within a quarter turn, from its cosine and sine.
		const auto& pose = body.pose;
		const Real w = pose.cosine >= 0 ? std::sqrt((1 + pose.cosine) / 2) : std::abs(pose.sine) / std::sqrt(2 * (1 - pose.cosine));
		const Real s = pose.cosine >= 0 ? pose.sine / (2 * w) : std::copysign(std::sqrt((1 - pose.cosine) / 2), pose.sine);
		Quaternionr turn;
		turn.w() = w;
		turn.vec() = s * c.normal;
		const Vector3r pos = c.out(pose.position) + depth * c.normal, vel = c.out(body.velocity.head<2>()),
		               angVel = body.velocity[2] * c.normal;
		const Quaternionr ori = turn * reference;
		((to.pos = pos, to.vel = vel, to.angVel = angVel, to.ori = ori), ...);
	}
	Vector3r spin(const Coordinates<Plane>& c, const masonry::RigidBody<Plane>& body) const
	{
		return body.inertia[0] * body.velocity[2] * c.normal;
	}
};

template <>
struct Seat<Space> {
	static constexpr Real depth = 0;

	template <class Archive>
	void serialize(Archive&)
	{
	}

	Seat() = default;
	Seat(const Coordinates<Space>&, const State&) {}

	masonry::Solid<masonry::ConvexPolyhedron> shape(const Coordinates<Space>&, const BlockShape& of) const
	{
		return of.isBox() ? masonry::ConvexPolyhedron::box(of.extents()) : *of.solid();
	}
	const Vector3r& inertia(const Vector3r& principal) const { return principal; }
	void read(const Coordinates<Space>&, const State& state, Real, int, masonry::RigidBody<Space>& body) const
	{
		body.pose = {state.pos, state.ori};
		body.velocity << state.vel, state.angVel;
	}
	template <class... To>
	void tell(const Coordinates<Space>&, const masonry::RigidBody<Space>& body, To&... to) const
	{
		((to.pos = body.pose.position, to.vel = body.velocity.head<3>(), to.angVel = body.velocity.tail<3>(),
		  to.ori = body.pose.orientation),
		 ...);
	}
	Vector3r spin(const Coordinates<Space>&, const masonry::RigidBody<Space>& body) const
	{
		return Space::angularMomentum(body.inertia, body.pose, body.velocity.tail<3>());
	}
};

// --- depth of points: those of the plane lie in the middle of the blocks ---

inline Vector3r pointInScene(const Coordinates<Plane>& c, const masonry::Vector2& p, Real depth) { return c.out(p) + depth * c.normal; }
inline Vector3r pointInScene(const Coordinates<Space>&, const Vector3r& p, Real) { return p; }

} // namespace yade
