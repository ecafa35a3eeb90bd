#pragma once
// Scenes of rigid blocks for the tests: blocks on a base, stepped, with the peaks and impacts of a rocking block.
#include "dynamics/localised/localised_step.hpp"
#include <cmath>
#include <limits>
#include <vector>

namespace rig {

using namespace masonry;
using namespace masonry::localised;

constexpr double g = 9.81, density = 2000;

// A base whose top face is at height 0, and its gravity.
template <class K>
RigidSystem<K> emptyScene(double halfLength = 5, double halfHeight = 5)
{
	constexpr int up = K::dimension - 1;
	RigidSystem<K> s;
	s.gravity[up] = -g;
	RigidBody<K> base;
	typename K::Vector half = K::Vector::Constant(halfLength);
	half[up] = halfHeight;
	base.setBox(half);
	base.pose.position[up] = -halfHeight;
	base.origin = base.pose.position;
	base.prescribed = true;
	s.bodies.push_back(base);
	return s;
}

inline int addBlock(RigidSystem<Plane>& s, double b, double a, const Vector2& center, double angle = 0, double mass = 0)
{
	RigidBody<Plane> block;
	block.setBox({b, a});
	block.mass = mass > 0 ? mass : density * 4 * a * b;
	block.inertia[0] = block.mass * (a * a + b * b) / 3;
	block.pose.position = center;
	block.pose.setAngle(angle);
	block.force << 0, -block.mass * g, 0;
	s.bodies.push_back(block);
	return int(s.bodies.size()) - 1;
}

// The hull of these points, turned about a pivot.
inline int addPolygon(RigidSystem<Plane>& s, const std::vector<Vector2>& points, double angle = 0, const Vector2& pivot = {0, 0},
                      double mass = 0)
{
	RigidBody<Plane> block;
	Vector2 centre;
	const ConvexPolygon shape = ConvexPolygon::hull(points, &centre);
	block.mass = mass > 0 ? mass : density * shape.area();
	block.inertia[0] = block.mass * shape.gyrationSquared();
	block.pose.setAngle(angle);
	block.pose.position = pivot + block.pose.rotate(centre - pivot);
	block.force << block.mass * s.gravity, 0;
	block.shape = std::make_shared<const Solid<ConvexPolygon>>(shape);
	s.bodies.push_back(block);
	return int(s.bodies.size()) - 1;
}

template <class K>
void addPair(RigidSystem<K>& s, int body1, int body2, double restitution, double friction = noSlip)
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

// A block on the base, turned about one of its edges.
inline RigidSystem<Plane> rockingBlock(double b, double a, double angle, double restitution, double friction = noSlip)
{
	auto s = emptyScene<Plane>();
	addBlock(s, b, a, onEdge(b, a, angle, {angle > 0 ? -b : b, 0}), angle);
	addPair(s, 0, 1, restitution, friction);
	return s;
}

// Equal blocks, one upon the other; bodies 1.. upwards.
inline RigidSystem<Plane> stack(int n, double b, double a, double restitution, double friction = noSlip)
{
	auto s = emptyScene<Plane>();
	for (int k = 0; k < n; ++k) {
		addBlock(s, b, a, {0, (2 * k + 1) * a});
		addPair(s, k, k + 1, restitution, friction);
	}
	return s;
}

template <class K>
double potentialEnergy(const RigidSystem<K>& s)
{
	double sum = 0;
	for (const auto& body : s.bodies)
		if (!body.prescribed)
			sum -= body.mass * s.gravity.dot(body.pose.position);
	return sum;
}

template <class K>
double energy(const RigidSystem<K>& s)
{
	return s.kineticEnergy() + potentialEnergy(s);
}

// Constant through a run.
template <class K>
double balance(const RigidSystem<K>& s)
{
	return energy(s) + s.frictDissip + s.impactDissip - s.baseWork;
}

// What takes a block from its base onto its corner.
inline double overturningEnergy(const RigidBody<Plane>& block)
{
	return block.mass * g * (block.shape->radius() - block.shape->halfSize().y());
}

// The drive moves the base along x, or along `direction`.
template <class K>
void moveBase(RigidSystem<K>& s, BaseDrive& drive, const typename K::Vector& direction = K::Vector::Unit(0))
{
	s.drives.push_back({{{&drive, direction}}});
	s.bodies[0].drive = 0;
}

// Motion in pieces: velocity jumps at the start of a piece, then acceleration(x) = constant + slope x + amplitude sin(frequency x),
// x the time since.
class ScheduledMotion : public BaseDrive {
public:
	struct Piece {
		double start, jump {0}, constant {0}, slope {0}, amplitude {0}, frequency {1};
	};

	void append(Piece piece)
	{
		const double u = displacement(piece.start), v = velocityAt(piece.start, pieces.size());
		pieces.push_back({piece, u, v + piece.jump});
	}

	double displacement(double t) const override
	{
		const auto [p, x] = at(t, pieces.size());
		if (!p)
			return 0;
		const auto& q = p->law;
		return p->displacement + x * (p->velocity + x * (q.constant / 2 + x * q.slope / 6)) +
		       q.amplitude / q.frequency * (x - std::sin(q.frequency * x) / q.frequency);
	}
	double velocity(double t) const override { return velocityAt(t, taken); }
	double nextKink(double after, double until) const override
	{
		for (const auto& piece : pieces)
			if (piece.law.start > after)
				return piece.law.start <= until ? piece.law.start : infinity;
		return infinity;
	}
	double jumpAt(double t) override
	{
		double jump = 0;
		for (; taken < pieces.size() && pieces[taken].law.start <= t + roundOff; ++taken)
			jump += pieces[taken].law.jump;
		return jump;
	}
	double respond(int, double) override { return 0; }

private:
	static constexpr double infinity = std::numeric_limits<double>::infinity();
	static constexpr double roundOff = 1e-12; // s

	struct Placed {
		Piece law;
		double displacement, velocity; // at its start, after the jump
	};

	// The piece that holds at t, of the first `count`, and the time since its start.
	std::pair<const Placed*, double> at(double t, size_t count) const
	{
		const Placed* found = nullptr;
		for (size_t k = 0; k < count && pieces[k].law.start <= t + roundOff; ++k)
			found = &pieces[k];
		return {found, found ? t - found->law.start : 0};
	}
	double velocityAt(double t, size_t count) const
	{
		const auto [p, x] = at(t, count);
		if (!p)
			return 0;
		const auto& q = p->law;
		return p->velocity + x * (q.constant + x * q.slope / 2) + q.amplitude / q.frequency * (1 - std::cos(q.frequency * x));
	}

	std::vector<Placed> pieces;
	size_t taken {0}; // pieces whose jump has been
};

// Acceleration amplitude * sin(2 pi f (t - begin)), from rest, asked in any order of time unless `inOrder`.
struct Harmonic : BaseDrive {
	double amplitude, frequency, begin; // m/s^2, rad/s, s
	bool inOrder;

	Harmonic(double amplitude, double hertz, double begin, bool inOrder = false)
	    : amplitude(amplitude), frequency(2 * M_PI * hertz), begin(begin), inOrder(inOrder)
	{
	}
	double since(double t) const { return std::max(0., t - begin); }
	double displacement(double t) const override { return amplitude / frequency * (since(t) - std::sin(frequency * since(t)) / frequency); }
	double velocity(double t) const override { return amplitude / frequency * (1 - std::cos(frequency * since(t))); }
	double nextKink(double after, double until) const override { return after < begin && begin <= until ? begin : INFINITY; }
	double jumpAt(double) override { return 0; }
	double respond(int, double) override { return 0; }
	bool ordered() const override { return inOrder; }
};

// The paper's train: +I at once, then -2I, +2I ... each right after an impact of a block.
class ResonantTrain : public BaseDrive {
public:
	explicit ResonantTrain(double impulse) : impulse(impulse) {}

	double displacement(double t) const override { return moved + speed * (t - since); }
	double velocity(double) const override { return speed; }
	double nextKink(double, double) const override { return std::numeric_limits<double>::infinity(); }
	double jumpAt(double t) override { return speed == 0 ? jump(impulse, t) : 0; }
	double respond(int, double t) override { return jump(-2 * speed, t); }

private:
	double jump(double size, double t)
	{
		moved = displacement(t);
		since = t;
		speed += size;
		return size;
	}
	double impulse, speed {0}, moved {0}, since {0};
};

// Peaks of |angle| between impacts, each from the step in which the spin changes sign: cubic through angle and spin at both ends.
struct Peaks {
	std::vector<double> found;
	double angle {NAN}, spin {0}, time {0};

	void take(double t, double newAngle, double newSpin)
	{
		if (!std::isnan(angle) && spin * newSpin < 0 && newAngle * spin > 0) {
			const double h = t - time, u = spin / (spin - newSpin);
			found.push_back((1 - u) * (1 - u) * (1 + 2 * u) * angle + u * u * (3 - 2 * u) * newAngle +
			                h * u * (1 - u) * ((1 - u) * spin - u * newSpin));
		}
		angle = newAngle;
		spin = newSpin;
		time = t;
	}
};

} // namespace rig
