#pragma once
// Walls for the tests: running bond with half blocks at the ends, touching head joints, on a base that may shake.
#include "core/dynamics/localised/space_rig.hpp"
#include "dynamics/model/neighbours.hpp"
#include "dynamics/wall/wall_step.hpp"

namespace rig {

// Shaken until `end`, then held.
struct Stopped : Harmonic {
	double end;

	Stopped(double amplitude, double hertz, double begin, double end) : Harmonic(amplitude, hertz, begin), end(end) {}
	double displacement(double t) const override { return Harmonic::displacement(std::min(t, end)); }
	double velocity(double t) const override { return t < end ? Harmonic::velocity(t) : 0; }
};

// 0.5 m deep.
inline int addBlock(RigidSystem<Plane>& s, const Vector2& half, const Vector2& center, double angle = 0)
{
	return addBlock(s, half.x(), half.y(), center, angle, density * 4 * half.x() * half.y() * 0.5);
}

inline int addBlock(RigidSystem<Space>& s, const Vector3& half, const Vector3& center,
                    const Quaternion& orientation = Quaternion::Identity())
{
	return addBox(s, half, {center, orientation});
}

// Energies, places and velocities, to compare bit by bit.
inline std::vector<double> numbersOf(const RigidSystem<Plane>& s)
{
	std::vector<double> numbers {s.baseWork, s.frictDissip, s.impactDissip};
	for (const auto& body : s.bodies)
		for (double value :
		     {body.pose.position.x(), body.pose.position.y(), body.pose.angle, body.velocity[0], body.velocity[1], body.velocity[2]})
			numbers.push_back(value);
	return numbers;
}

// Of a block 0.5 m deep.
inline Vector2 sizeOf(const RigidSystem<Plane>&, double x, double z) { return {x, z}; }
inline Vector3 sizeOf(const RigidSystem<Space>&, double x, double z) { return {x, 0.25, z}; }
inline Vector2 placeOf(const RigidSystem<Plane>&, double x, double z) { return {x, z}; }
inline Vector3 placeOf(const RigidSystem<Space>&, double x, double z) { return {x, 0, z}; }

template <class K>
struct SceneOf {
	static constexpr int up = K::dimension - 1;
	RigidSystem<K> system = emptyScene<K>(50, 1);
	Neighbours<K> near;
	wall::WallStep<K> step;
	std::vector<RigidBody<K>> start;

	explicit SceneOf(double friction = 0.7, double restitution = NAN)
	    : near(0.05, [=](ContactPair<K>& pair) {
		      pair.friction = friction;
		      pair.restitution = restitution;
	      })
	{
	}
	SceneOf(const SceneOf&) = delete;

	// In space 0.5 m deep.
	void addWall(int courses, int perLevel, double left = 0, double length = 1, double height = 0.5)
	{
		for (int c = 0; c < courses; ++c) {
			const double y = 0.5 * height + height * c;
			if (c % 2 == 1) {
				addBlock(system, sizeOf(system, 0.25 * length, 0.5 * height), placeOf(system, left + 0.25 * length, y));
				addBlock(system, sizeOf(system, 0.25 * length, 0.5 * height), placeOf(system, left + (perLevel - 0.25) * length, y));
			}
			for (int i = 0; i < perLevel - c % 2; ++i)
				addBlock(system, sizeOf(system, 0.5 * length, 0.5 * height), placeOf(system, left + (i + 0.5 + 0.5 * (c % 2)) * length, y));
		}
	}

	void drive(BaseDrive& motion, const typename K::Vector& direction = K::Vector::Unit(0)) { moveBase(system, motion, direction); }

	void advance(double h)
	{
		if (start.empty())
			start = system.bodies;
		near.update(system);
		step.advance(system, h);
		step.showPoints(system);
	}
	void run(double time, double h)
	{
		for (long k = 0; k < std::lround(time / h); ++k)
			advance(h);
	}

	// Returns the kinetic and potential energy in the middle of the last step, J.
	double energy() const { return rig::energy(system) + step.potentialShift(); }

	// Of a block, relative to the base, since the start.
	typename K::Vector shift(size_t block) const
	{
		const auto moved = [&](size_t b) { return typename K::Vector(system.bodies[b].pose.position - start[b].pose.position); };
		return moved(block) - moved(0);
	}
	double deepest() const // m, of a block in another now
	{
		double most = 0;
		for (const auto& pair : system.pairs)
			for (int i = 0; i < pair.size(); ++i)
				most = std::max(most, -pair.points[i].gap);
		return most;
	}
	double drift() const
	{
		double most = 0;
		for (size_t b = 1; b < system.bodies.size(); ++b)
			most = std::max(most, shift(b).template head<up>().norm());
		return most;
	}
	double sink() const
	{
		double most = 0;
		for (size_t b = 1; b < system.bodies.size(); ++b)
			most = std::max(most, -shift(b)[up]);
		return most;
	}
};

using Scene = SceneOf<Plane>;
using SpaceScene = SceneOf<Space>;

} // namespace rig
