#include "dynamics/localised/smooth_step.hpp"
#include "dynamics/localised/grip.hpp"
#include "laws/contact_limits.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::localised {

namespace {

template <class K>
typename K::Velocity prescribedVelocity(const RigidSystem<K>& s, const RigidBody<K>& body, double t)
{
	typename K::Velocity v = body.velocity;
	if (body.drive >= 0)
		v.template head<K::dimension>() = s.drives[body.drive].velocity(t);
	return v;
}

// At the time t of a step, `passed` after its start, where the body was at `start`.
template <class K>
typename K::Pose prescribedPose(const RigidSystem<K>& s, const RigidBody<K>& body, const typename K::Pose& start, double passed, double t)
{
	typename K::Pose pose = start;
	if (!body.velocity.isZero(0))
		K::advance(pose, body.velocity, passed);
	if (body.drive >= 0)
		pose.position = s.driven(body, t);
	return pose;
}

template <class K>
InverseMass<K> inverseMass(const RigidBody<K>& body, const typename K::Pose& pose)
{
	return {1 / body.mass, K::inverseInertia(body.inertia, pose)};
}

// Whether velocities have come out otherwise than the middle was predicted with, by more than gravity gives in the step: a sliding block
// has jammed, or had in the last step.
template <class K>
bool surprises(const RigidSystem<K>& s, const Trial<K>& trial, const std::vector<FreeBody<K>>& solved, const Scales& scales)
{
	const double enough = scales.stepSpeed(trial.h) * scales.stepSpeed(trial.h), square = scales.length * scales.length;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		if (trial.bodies[b].unknown < 0)
			continue;
		const typename K::Velocity miss = 0.5 * (s.bodies[b].velocity + solved[trial.bodies[b].unknown].velocity) - trial.bodies[b].mean;
		if (miss.template head<K::dimension>().squaredNorm() + square * miss.template tail<K::spins>().squaredNorm() > enough)
			return true;
	}
	return false;
}

// As far as is known: after events forces may not be.
template <class K>
bool carriesAtRest(const RigidSystem<K>& s, PointRef ref)
{
	const ContactPoint<K>& point = s.pairs[ref.pair].points[ref.point];
	return point.closed && !point.sliding && (point.force[0] > 0 || s.isFresh());
}

// Whether prescribed bodies that free ones touch move against each other in a step.
template <class K>
bool basesPart(const RigidSystem<K>& s, double dt)
{
	const auto mean = [&](const RigidBody<K>& body) {
		typename K::Velocity v = body.velocity;
		if (body.drive >= 0)
			v.template head<K::dimension>() = s.drives[body.drive].meanVelocity(s.time, dt);
		return v;
	};
	const RigidBody<K>* first = nullptr;
	for (const ContactPair<K>& pair : s.pairs) {
		const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
		if (body1.prescribed == body2.prescribed)
			continue;
		const RigidBody<K>& base = body1.prescribed ? body1 : body2;
		if (!touches(pair) || &base == first)
			continue;
		if (!first)
			first = &base;
		if (base.drive != first->drive || base.drive < 0) // one drive moves all its bodies alike
			if (mean(base) != mean(*first))
				return true;
	}
	return false;
}

} // namespace

template <class K>
void SmoothStep<K>::begin(const RigidSystem<K>& s, const Settings& settings, double dt)
{
	allowed = settings.tolerance;
	full = dt;
	end = s.time;
	stepEnd = s.time + dt;
	passed = work = 0;
	starts.resize(s.bodies.size());
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed)
			starts[b] = s.bodies[b].pose;
}

template <class K>
double SmoothStep<K>::beginPart(const RigidSystem<K>& s, int parts)
{
	whole = parts == 1 && passed == 0 ? full : left() / parts;
	end = parts == 1 ? stepEnd : s.time + whole;
	solver.forget();
	shifts.reserve(s.bodies.size()); // a step that closes gaps may be the first to
	scales = Scales(s);
	partBases = basesPart(s, whole);
	mass = freeMass(s);
	weight = mass * scales.acceleration * scales.length;
	return whole;
}

// Parts of a step add up to its end but for round-off, which would depend on the events in it.
template <class K>
double SmoothStep<K>::timeAfter(const RigidSystem<K>& s, double h) const
{
	const double t = s.time + h;
	return std::abs(t - end) <= tolerance::instant * whole ? end : t;
}

template <class K>
void SmoothStep<K>::predict(const RigidSystem<K>& s, double h, bool again)
{
	last.bodies.resize(s.bodies.size());
	solver.bodies.clear();
	const double after = timeAfter(s, h);
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const RigidBody<K>& body = s.bodies[b];
		auto& next = last.bodies[b];
		if (body.prescribed) {
			next.unknown = -1;
			next.middle = prescribedPose(s, body, starts[b], passed + h / 2, s.time + h / 2);
			next.end = prescribedPose(s, body, starts[b], after == stepEnd ? full : passed + h, after);
			next.velocity = prescribedVelocity(s, body, after);
			if (steadyOf && body.drive >= 0) {
				constexpr int dimension = K::dimension;
				const typename K::Vector v = body.velocity.template head<dimension>(),
				                         dv = h * s.drives[body.drive].acceleration(*steadyOf);
				next.middle.position = body.pose.position + h / 2 * (v + dv / 4);
				next.end.position = body.pose.position + h * (v + dv / 2);
				next.velocity.template head<dimension>() = v + dv;
			}
			next.mean = 0.5 * (body.velocity + next.velocity);
			continue;
		}
		next.unknown = int(solver.bodies.size());
		if (!again) {
			const typename K::Velocity change = h * body.increment;
			next.mean = body.velocity + 0.5 * change;
			if constexpr (K::spins == 3) {
				next.velocity = body.velocity + change;
				next.end = body.pose;
				K::advance(next.end, next.mean, h);
				next.momentum = K::angularMomentum(body.inertia, next.end, next.velocity.template tail<3>());
			}
		}
		next.middle = body.pose;
		K::advanceOnce(next.middle, next.mean, h / 2);

		FreeBody<K> unknown;
		unknown.inverseMass = inverseMass(body, next.middle);
		unknown.free = body.velocity + h * (unknown.inverseMass * body.force);
		if constexpr (K::spins == 3) {
			const Quaternion half = next.middle.orientation * body.pose.orientation.conjugate();
			const Vector3 spin = body.velocity.template tail<3>(), momentum = K::angularMomentum(body.inertia, body.pose, spin);
			const Vector3 back = half.conjugate() * next.momentum - next.momentum;
			unknown.free.template tail<3>() =
			    half * spin - spin + unknown.inverseMass.angular * (momentum + h * body.force.template tail<3>() + back);
		}
		solver.bodies.push_back(unknown);
	}
}

// Returns what the spins gain over the work on them, of all bodies, J.
template <class K>
double SmoothStep<K>::finish(const RigidSystem<K>& s, double h)
{
	double gain = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const RigidBody<K>& body = s.bodies[b];
		auto& next = last.bodies[b];
		if (body.prescribed)
			continue;
		const FreeBody<K>& solved = solver.bodies[next.unknown];
		next.velocity = solved.velocity;
		next.mean = 0.5 * (body.velocity + next.velocity);
		next.end = body.pose;
		K::advance(next.end, next.mean, h);
		if constexpr (K::spins == 3) {
			const Vector3 spin = body.velocity.template tail<3>(), mean = next.mean.template tail<3>();
			const Vector3 before = K::angularMomentum(body.inertia, body.pose, spin);
			const Vector3 contact = K::angularMomentum(body.inertia, next.middle, (solved.velocity - solved.free).template tail<3>());
			next.momentum = before + h * body.force.template tail<3>() + contact;
			next.velocity.template tail<3>() = K::inverseInertia(body.inertia, next.end) * next.momentum;
			gain +=
			    std::abs(0.5 * (next.velocity.template tail<3>().dot(next.momentum) - spin.dot(before)) - mean.dot(next.momentum - before));
		}
	}
	return gain;
}

template <class K>
void SmoothStep<K>::findFrames(const RigidSystem<K>& s)
{
	first.resize(s.pairs.size());
	last.frames.clear();
	for (size_t c = 0; c < s.pairs.size(); ++c) {
		const ContactPair<K>& pair = s.pairs[c];
		first[c] = int(last.frames.size());
		for (int i = 0; i < pair.size(); ++i)
			last.frames.push_back(frameOf(pair.points[i], s.bodies[pair.body1], last.bodies[pair.body1].end, s.bodies[pair.body2],
			                              last.bodies[pair.body2].end));
	}
}

// By the impulses of the pass.
template <class K>
void SmoothStep<K>::moveFriction(RigidSystem<K>& s) const
{
	if constexpr (K::dimension == 3) {
		size_t row = 0;
		placeFriction(s, [&](int c, int i) {
			const bool acted = row < last.rows.size() && last.rows[row] == PointRef {c, i};
			return acted ? solver.points[row++].impulse[0] : 0.;
		});
	}
}

template <class K>
void SmoothStep<K>::attempt(RigidSystem<K>& s, double h, bool again)
{
	// After an event the change of velocity in the last step, which can have been of any length, tells nothing: a second pass takes that
	// of the first.
	constexpr int maxPasses = 5;
	guesses.clear();
	if (again)
		for (const ContactRows<K>& rows : solver.points)
			guesses.push_back(h / last.h * rows.impulse);
	last.h = h;
	stray.clear();
	unsteady = false;
	breaking.clear();
	const bool fresh = s.isFresh();
	placeFriction(s);
	if (!fresh)
		dampStray(s, h);
	for (int pass = 0; pass < maxPasses; ++pass) {
		predict(s, h, pass > 0);
		assemble(s, h);
		solver.guessed = fresh && pass == 0;
		do
			last.solved = solver.solve(allowed * scales.stepSpeed(h), allowed * scales.stepSpeed(whole));
		while (holdTies(s, h));
		const bool surprised = pass == 0 && surprises(s, last, solver.bodies, scales);
		const double gain = finish(s, h);
		const bool first = pass == 0 && fresh;
		if (first) {
			moveFriction(s);
			findFrames(s);
			findStray(s);
		}
		const bool gives =
		    strayWork() > tolerance::localised::strayEnergy * weight; // then they stay: in the next step they have the other sign
		if (gives) {
			stray.clear();
			unsteady = true;
		}
		if (!first && !surprised && !gives && gain <= tolerance::localised::spinEnergy * weight)
			break;
		guesses.clear();
		for (const ContactRows<K>& rows : solver.points)
			guesses.push_back(rows.impulse);
	}
	findFrames(s);
}

template <class K>
bool SmoothStep<K>::wouldMove(RigidSystem<K>& s, double h, double of)
{
	steadyOf = of;
	attempt(s, h);
	steadyOf.reset();
	const double still = tolerance::localised::parting * scales.stepSpeed(h);
	for (const PointRef ref : last.rows)
		if (carriesAtRest(s, ref) && relativeVelocity(s, ref.pair, ref.point).norm() > still)
			return true;
	return false;
}

template <class K>
bool SmoothStep<K>::isReleased(const RigidSystem<K>& s, double further) const
{
	for (size_t r = 0; r < last.rows.size(); ++r) {
		if (!carriesAtRest(s, last.rows[r]))
			continue;
		const ContactPoint<K>& point = s.pairs[last.rows[r].pair].points[last.rows[r].point];
		if (point.force.isZero(0)) // there is no last step to tell
			return true;
		ContactRows<K> rows = solver.points[r];
		rows.impulse += further * (rows.impulse - last.h * point.force);
		if (!(rows.impulse[0] > 0) || (rows.law.friction > 0 && rows.slides()))
			return true;
	}
	return false;
}

template <class K>
void SmoothStep<K>::addJammed(const RigidSystem<K>& s, std::vector<int>& bodies) const
{
	for (size_t r = 0; last.solved.jammed && r < last.rows.size(); ++r)
		if (isAtLimit(solver.points[r])) {
			const ContactPair<K>& pair = s.pairs[last.rows[r].pair];
			bodies.insert(bodies.end(), {pair.body1, pair.body2});
		}
}

template <class K>
Eigen::Matrix<double, K::rows, 1> SmoothStep<K>::relativeVelocity(const RigidSystem<K>& s, int pair, int point) const
{
	const auto& next1 = last.bodies[s.pairs[pair].body1];
	const auto& next2 = last.bodies[s.pairs[pair].body2];
	return masonry::relativeVelocity(last.frames[first[pair] + point], next1.end.position, next1.velocity, next2.end.position,
	                                 next2.velocity);
}

template class SmoothStep<Plane>;
template class SmoothStep<Space>;

} // namespace masonry::localised
