#pragma once
// Walls for the tests: running bond with half blocks at the ends, touching head joints, on a base that may shake.
#include "dynamics/rigid/neighbours.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <cmath>

namespace rig {

using namespace masonry;
using namespace masonry::rigid;

constexpr double g = 9.81, density = 2000;

// Acceleration amplitude * sin(2 pi f (t - begin)), from rest.
struct Harmonic : BaseDrive {
	double amplitude, frequency, begin;

	Harmonic(double amplitude, double hertz, double begin) : amplitude(amplitude), frequency(2 * M_PI * hertz), begin(begin) {}
	double since(double t) const { return std::max(0., t - begin); }
	double displacement(double t) const override { return amplitude / frequency * (since(t) - std::sin(frequency * since(t)) / frequency); }
	double velocity(double t) const override { return amplitude / frequency * (1 - std::cos(frequency * since(t))); }
	double acceleration(double t) const override { return amplitude * std::sin(frequency * since(t)); }
	double nextKink(double after, double until) const override { return after < begin && begin <= until ? begin : INFINITY; }
	double jumpAt(double) override { return 0; }
	double respond(int, double) override { return 0; }
};

inline int addBlock(RigidSystem<Plane>& s, const Vector2& half, const Vector2& center, double angle = 0)
{
	RigidBody<Plane> block;
	block.halfSize = half;
	block.mass = density * 4 * half.x() * half.y() * 0.5;
	block.inertia[0] = block.mass * half.squaredNorm() / 3;
	block.pose.position = center;
	block.pose.setAngle(angle);
	block.force << 0, -block.mass * g, 0;
	s.bodies.push_back(block);
	return int(s.bodies.size()) - 1;
}

struct Scene {
	RigidSystem<Plane> system;
	Neighbours<Plane> near;
	WallStep<Plane> step;
	std::vector<RigidBody<Plane>> start;

	explicit Scene(double friction = 0.7, double restitution = NAN)
	    : near(0.05, [=](ContactPair<Plane>& pair) {
		      pair.friction = friction;
		      pair.restitution = restitution;
	      })
	{
		system.gravity << 0, -g;
		RigidBody<Plane> base;
		base.halfSize << 50, 1;
		base.pose.position << 0, -1;
		base.origin = base.pose.position;
		base.prescribed = true;
		system.bodies.push_back(base);
	}
	Scene(const Scene&) = delete;

	// Blocks 1.0 x 0.5 m.
	void addWall(int courses, int perCourse)
	{
		for (int c = 0; c < courses; ++c) {
			const double y = 0.25 + 0.5 * c;
			if (c % 2 == 1) {
				addBlock(system, {0.25, 0.25}, {0.25, y});
				addBlock(system, {0.25, 0.25}, {perCourse - 0.25, y});
			}
			for (int i = 0; i < perCourse - c % 2; ++i)
				addBlock(system, {0.5, 0.25}, {i + 0.5 + 0.5 * (c % 2), y});
		}
	}

	void drive(BaseDrive& motion)
	{
		system.drives = {&motion};
		system.driveDirections = {Vector2(1, 0)};
		system.bodies[0].drive = 0;
	}

	void advance(double h)
	{
		if (start.empty())
			start = system.bodies;
		near.update(system);
		step.advance(system, h);
	}
	void run(double time, double h)
	{
		for (long k = 0; k < std::lround(time / h); ++k)
			advance(h);
	}

	// Of a block, relative to the base, since the start.
	Vector2 shift(size_t block) const
	{
		const auto moved = [&](size_t b) { return Vector2(system.bodies[b].pose.position - start[b].pose.position); };
		return moved(block) - moved(0);
	}
	double drift() const
	{
		double most = 0;
		for (size_t b = 1; b < system.bodies.size(); ++b)
			most = std::max(most, std::abs(shift(b).x()));
		return most;
	}
	double sink() const
	{
		double most = 0;
		for (size_t b = 1; b < system.bodies.size(); ++b)
			most = std::max(most, -shift(b).y());
		return most;
	}
};

} // namespace rig
