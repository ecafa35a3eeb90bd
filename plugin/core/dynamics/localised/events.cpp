#include "dynamics/localised/events.hpp"
#include "dynamics/model/scales.hpp"
#include "tolerances.hpp"

namespace masonry::localised {

namespace {

struct Crossing {
	double at, speed;
};

// A gap with the value g0 and rate r0 at the start and g1 < 0 after h falls through zero here (parabola through the three).
Crossing downCrossing(double g0, double r0, double g1, double h)
{
	const double c = (g1 - g0 - r0 * h) / (h * h);
	const double root = std::sqrt(std::max(0., r0 * r0 - 4 * c * g0));
	const double t = c < 0 ? (r0 + root) / (-2 * c) : 2 * g0 / (root - r0);
	return {std::isfinite(t) ? std::clamp(t, 0., h) : 0., root};
}

// Gap of an open point that counts as closed: zero, or the penetration that it parted with.
template <class K>
double zeroOf(const RigidSystem<K>& s, PointRef ref)
{
	return std::min(s.pairs[ref.pair].points[ref.point].gap, 0.);
}

template <class K>
struct Relative {
	double gap, rate;
	Eigen::Matrix<double, K::rows - 1, 1> slip;
};

template <class K>
Relative<K> atStart(const RigidSystem<K>& s, PointRef ref)
{
	const auto u = relativeVelocity(s, ref);
	return {s.pairs[ref.pair].points[ref.point].gap, u[0], u.template tail<K::rows - 1>()};
}

template <class K>
Relative<K> atEnd(const RigidSystem<K>& s, const SmoothStep<K>& step, PointRef ref)
{
	const auto u = step.relativeVelocity(s, ref.pair, ref.point);
	return {step.frame(ref.pair, ref.point).gap, u[0], u.template tail<K::rows - 1>()};
}

// Slip speed at the end of the trial along the direction of slip at its start.
template <class K>
double slipOn(const RigidSystem<K>& s, const SmoothStep<K>& step, PointRef ref)
{
	return atStart(s, ref).slip.normalized().dot(atEnd(s, step, ref).slip);
}

// The features that a pair has at the end of the trial.
template <class K>
FoundPoints<K> featuresAtEnd(const RigidSystem<K>& s, const SmoothStep<K>& step, const ContactPair<K>& pair)
{
	typename K::Memory memory = pair.memory;
	return findRows(s, pair, step.trial().bodies[pair.body1].end, step.trial().bodies[pair.body2].end, memory);
}

// No point of either body goes farther than this relative to the other one in the trial.
template <class K>
double relativeTravel(const RigidSystem<K>& s, const SmoothStep<K>& step, const ContactPair<K>& pair)
{
	const RigidBody<K>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const auto &end1 = step.trial().bodies[pair.body1], &end2 = step.trial().bodies[pair.body2];
	const typename K::Velocity difference = end2.mean - end1.mean;
	const typename K::Spin spin1 = end1.mean.template tail<K::spins>();
	const typename K::Vector apart = body2.pose.position - body1.pose.position;
	return step.trial().h * ((difference.template head<K::dimension>() - K::cross(spin1, apart)).norm() +
	                         difference.template tail<K::spins>().norm() * (body1.prescribed ? body2 : body1).shape->radius());
}

} // namespace

template <class K>
Event findEvent(const RigidSystem<K>& s, SmoothStep<K>& step, double slow)
{
	Event first;
	const double h = step.trial().h, tiny = tolerance::localised::gap * step.scales.length,
	             still = tolerance::localised::parting * step.scales.stepSpeed(h);
	const auto consider = [&](Event::Kind kind, PointRef ref, double at) {
		if (first.kind == Event::none || at < first.at)
			first = {kind, ref, at};
	};
	for (int c = 0; c < int(s.pairs.size()); ++c)
		for (int i = 0; i < s.pairs[c].size(); ++i) {
			const ContactPoint<K>& point = s.pairs[c].points[i];
			const PointRef ref {c, i};
			if (!point.closed) {
				const double zero = zeroOf(s, ref), gap = step.frame(c, i).gap - zero;
				if (gap >= -tiny || contains(step.anticipated, ref))
					continue;
				const Crossing crossing = downCrossing(point.gap - zero, atStart(s, ref).rate, gap, h);
				if (crossing.speed < slow)
					step.anticipated.push_back(ref);
				else
					consider(Event::closing, ref, crossing.at);
			} else if (point.sliding && !step.stopsInside) {
				const double before = atStart(s, ref).slip.norm(), after = slipOn(s, step, ref);
				if (after < -still && before > step.slowSlip())
					consider(Event::stop, ref, h * before / (before - after));
			}
		}
	return first;
}

template <class K>
Event localise(RigidSystem<K>& s, SmoothStep<K>& step, Event event)
{
	const double tiny = tolerance::localised::gap * step.scales.length,
	             still = tolerance::localised::parting * step.scales.stepSpeed(step.trial().h);
	double early = 0, late = step.trial().h; // the event lies between
	const double instant = tolerance::instant * late;
	constexpr int most = 40;
	// The normal of two edges changes its sign where they become parallel, and with it the gap, however far apart they are. Such a trial
	// ends behind the jump, where the search for features no longer finds them.
	const bool jumps = event.kind == Event::closing && s.pairs[event.point.pair].points[event.point.point].gap > 0 &&
	                   -atEnd(s, step, event.point).gap > relativeTravel(s, step, s.pairs[event.point.pair]);
	for (int k = 0; k < most; ++k) {
		const double h = event.at;
		if (h <= instant && !jumps) { // it is now
			event.at = 0;
			return event;
		}
		step.attempt(s, h, true);
		if (event.kind == Event::closing) {
			const auto end = atEnd(s, step, event.point);
			const double gap = end.gap - zeroOf(s, event.point);
			if (std::abs(gap) <= tiny)
				break;
			(gap > 0 ? early : late) = h;
			event.at = h - gap / end.rate; // Newton
			if (!(end.rate < 0) || !(event.at > early && event.at < late))
				event.at = 0.5 * (early + late);
		} else {
			const double before = atStart(s, event.point).slip.norm(), after = slipOn(s, step, event.point);
			if (std::abs(after) <= still)
				break;
			(after > 0 ? early : late) = h;
			event.at = after > 0 ? h * before / (before - after) : 0.5 * (early + h); // secant; past the stop the slip tells nothing
			if (!(event.at > early && event.at < late))
				event.at = 0.5 * (early + late);
		}
		if (late - early <= tolerance::instant * instant)
			break;
	}
	if (jumps && atEnd(s, step, event.point).gap > tiny)
		step.attempt(s, late, true);
	event.at = step.trial().h;
	return event;
}

template <class K>
bool isContact(const RigidSystem<K>& s, const SmoothStep<K>& step, const Event& event)
{
	if (event.kind != Event::closing)
		return true;
	if (std::abs(atEnd(s, step, event.point).gap - zeroOf(s, event.point)) > tolerance::contact::unseen * step.scales.length)
		return false; // it has jumped (localise)
	const ContactPair<K>& pair = s.pairs[event.point.pair];
	const auto found = featuresAtEnd(s, step, pair);
	const auto isKnown = [&pair](const auto& feature) {
		return std::any_of(pair.points.begin(), pair.points.end(), [&](const auto& point) { return point.feature == feature; });
	};
	const auto& closing = pair.points[event.point.point].feature;
	for (int i = found.places; i < found.size(); ++i) { // a corner meets a corner, with both normals
		const auto &first = found.features[found.cornerOf(i)], &second = found.features[i];
		if ((closing == first && !isKnown(second)) || (closing == second && !isKnown(first)))
			return false;
	}
	return found.has(closing);
}

template <class K>
int unseenPenetration(const RigidSystem<K>& s, const SmoothStep<K>& step)
{
	const double bound = tolerance::contact::unseen * step.scales.length;
	for (int c = 0; c < int(s.pairs.size()); ++c) {
		const ContactPair<K>& pair = s.pairs[c];
		if (relativeTravel(s, step, pair) < bound)
			continue;
		double deepest = 0;
		for (int i = 0; i < pair.size(); ++i)
			deepest = std::min(deepest, step.frame(c, i).gap);
		const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
		const auto &end1 = step.trial().bodies[pair.body1].end, &end2 = step.trial().bodies[pair.body2].end;
		const auto found = featuresAtEnd(s, step, pair);
		for (const Feature& feature : found.features)
			if (frameOf(feature, *body1.shape, end1, *body2.shape, end2).gap < deepest - bound)
				return c;
	}
	return -1;
}

template <class K>
void touchingPoints(const RigidSystem<K>& s, double merged, PointRef now, std::vector<PointRef>& out)
{
	out.clear();
	const double touching = merged * scale::length(s);
	for (int c = 0; c < int(s.pairs.size()); ++c)
		for (int i = 0; i < s.pairs[c].size(); ++i) {
			const ContactPoint<K>& point = s.pairs[c].points[i];
			const PointRef ref {c, i};
			if (!point.closed && (point.gap <= touching || ref == now) && atStart(s, ref).rate < 0)
				out.push_back(ref);
		}
}

template Event findEvent(const RigidSystem<Plane>&, SmoothStep<Plane>&, double);
template Event findEvent(const RigidSystem<Space>&, SmoothStep<Space>&, double);
template Event localise(RigidSystem<Plane>&, SmoothStep<Plane>&, Event);
template Event localise(RigidSystem<Space>&, SmoothStep<Space>&, Event);
template bool isContact(const RigidSystem<Plane>&, const SmoothStep<Plane>&, const Event&);
template bool isContact(const RigidSystem<Space>&, const SmoothStep<Space>&, const Event&);
template int unseenPenetration(const RigidSystem<Plane>&, const SmoothStep<Plane>&);
template int unseenPenetration(const RigidSystem<Space>&, const SmoothStep<Space>&);
template void touchingPoints(const RigidSystem<Plane>&, double, PointRef, std::vector<PointRef>&);
template void touchingPoints(const RigidSystem<Space>&, double, PointRef, std::vector<PointRef>&);

} // namespace masonry::localised
