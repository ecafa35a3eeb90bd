#include "dynamics/localised/localised_step.hpp"
#include "dynamics/localised/grip.hpp"
#include "dynamics/model/external_force.hpp"
#include "tolerances.hpp"

namespace masonry::localised {

namespace {

// A corner does without its second normal while its reaction is well inside the friction cone of the first: the motion is the same, and a
// block that rocks about a corner above a corner carries one row. Where the reaction is not known, it has both.
template <class K>
void dropIdle(FoundPoints<K>& found, const ContactPair<K>& before, const RigidBody<K>& body1, const RigidBody<K>& body2, double samePlace)
{
	constexpr double inside = 0.8; // of the friction limit
	const auto frameOf = [&](const Feature& feature) {
		return masonry::frameOf(feature, *body1.shape, body1.pose, *body2.shape, body2.pose);
	};
	const auto isIdle = [&](int place) {
		const ContactFrame<K> frame = frameOf(found.features[place]);
		typename K::Vector reaction = K::Vector::Zero();
		for (const ContactPoint<K>& point : before.points)
			if (const auto old = frameOf(point.feature); (old.position - frame.position).norm() <= samePlace)
				reaction += old.axes.transpose() * point.force;
		const typename ContactRows<K>::Rows p = frame.axes * reaction;
		return p[0] > 0 && p.template tail<K::rows - 1>().norm() <= inside * before.friction * p[0];
	};
	for (int i = found.size() - 1; i >= found.places; --i)
		if (isIdle(found.cornerOf(i)))
			found.dropSecondNormal(i);
}

} // namespace

// Bodies that turn or pass each other too far for one step share it out among several.
template <class K>
StepReport LocalisedStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	s.impacts.clear();
	const Energies before(s);
	step.begin(s, settings, dt);
	for (int parts = partsOf(s, dt); parts > 0 && !report.diverged; parts = parts > 1 ? partsOf(s, step.left()) : 0)
		advancePart(s, step.beginPart(s, parts));
	balance(s, before);
	return report;
}

// Tells of energy that the step has made or lost over what the forces, the base, friction and impacts account for, where it is more than a
// share of what is at stake in the step, and of what lifts all blocks by the smallest half size.
template <class K>
void LocalisedStep<K>::balance(const RigidSystem<K>& s, const Energies& before)
{
	const Energies now(s);
	const double friction = now.friction - before.friction, impact = now.impact - before.impact, base = now.base - before.base;
	const double made = now.kinetic - before.kinetic - step.work - base + friction + impact;
	const double atStake = before.kinetic + std::abs(step.work) + std::abs(base) + std::abs(friction) + std::abs(impact);
	errors = {std::max(0., made), std::max(0., -made), before.kinetic,
	          (freeMass(s) * step.scales.acceleration + externalForce(s)) * step.scales.length};
	if (std::abs(made) > tolerance::localised::madeShare * atStake + tolerance::localised::madeLift * errors.lift)
		report.created += made;
}

// How many parts what is left of a step needs: small turns, for the passes over the spins to converge, and ways shorter than a block, for
// contacts to be those that the part begins with.
template <class K>
int LocalisedStep<K>::partsOf(const RigidSystem<K>& s, double left) const
{
	double parts = 1;
	for (const RigidBody<K>& body : s.bodies)
		if (!body.prescribed)
			parts = std::max(parts, left * body.velocity.template tail<K::spins>().norm() / tolerance::partTurn);
	for (const ContactPair<K>& pair : s.pairs) {
		const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
		const double way = left * (body2.velocity - body1.velocity).template head<K::dimension>().norm();
		parts = std::max(parts, way / (tolerance::localised::partWay * std::min(body1.shape->thickness(), body2.shape->thickness())));
	}
	return int(std::ceil(std::min(parts, tolerance::localised::maxParts)));
}

// The stages of a step. All but the first repeat for each part of the step that ends with an event.
template <class K>
void LocalisedStep<K>::advancePart(RigidSystem<K>& s, double part)
{
	findContacts(s);
	takeJumps(s);
	for (double left = part; left > 0;) {
		double h = untilKink(s, left, part);
		const StepReport before = report;
		Event event = tryStep(s, h);
		if (const double rest = untilRelease(s); rest > 0) {
			report = before;
			h = std::min(h, rest);
			event = tryStep(s, h);
		}
		if (event.kind == Event::none || event.at > 0) {
			step.accept(s);
			left = event.kind == Event::none && h == left ? 0 : left - step.trial().h;
		}
		if (!s.isFinite()) {
			report.diverged = true;
			return;
		}
		if (event.kind == Event::closing) {
			if (!land(s, event.point)) // the point parts and would be back at once: it stays
				s.pairs[event.point.pair].points[event.point.point].closed = true;
		} else if (event.kind == Event::stop) {
			s.pairs[event.point.pair].points[event.point.point].sliding = false;
		} else if (event.kind == Event::change) {
			findContacts(s, s.pairs[event.point.pair], true);
			land(s);
		}
		if (event.kind == Event::none && left == 0)
			break;
		takeJumps(s);
		s.startAnew();
	}
}

template <class K>
void LocalisedStep<K>::findContacts(RigidSystem<K>& s)
{
	for (ContactPair<K>& pair : s.pairs)
		findContacts(s, pair, false);
	s.moved = false;
}

// Points of a pair, as features. One that was there before keeps its state, and so does one that another feature of the same place takes
// over from. Others are closed where they touch; those found within a step may be about to strike, and are open.
template <class K>
void LocalisedStep<K>::findContacts(RigidSystem<K>& s, ContactPair<K>& pair, bool within)
{
	const double touching = settings.merged * step.scales.length, samePlace = 2 * tolerance::contact::vertexReach * step.scales.length;
	const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	FoundPoints<K> found = findRows(s, pair, tolerance::restSpeed * step.scales.speed, pair.memory);
	dropIdle(found, pair, body1, body2, samePlace);
	pair.face1 = found.face1;
	pair.face2 = found.face2;
	const bool same = sameFeatures(pair, found);
	if (same && !s.moved)
		return;
	const ContactPair<K> before = pair;
	pair.points.resize(found.size());
	for (int i = 0; i < found.size(); ++i) {
		ContactPoint<K>& point = pair.points[i];
		if (!same)
			point = {};
		point.feature = found.features[i];
		locate(point, body1, body2);
		if (same)
			continue;
		point.closed = point.gap <= touching && !within;
		takeStates(before, found, samePlace, point);
	}
}

// A trial that ends with the first event, or without one after h. Where blocks would penetrate each other unseen, it is halved until they
// do not, and their features are searched again at its end.
template <class K>
Event LocalisedStep<K>::tryStep(RigidSystem<K>& s, double h)
{
	constexpr int maxHalvings = 12;
	Event event = tryUpTo(s, h);
	if (report.events >= settings.mostEvents)
		return event;
	int unseen = -1;
	for (int k = 0; k < maxHalvings; ++k) {
		const int pair = unseenPenetration(s, step);
		if (pair < 0)
			break;
		unseen = pair;
		event = tryUpTo(s, step.trial().h / 2);
	}
	if (unseen >= 0 && event.kind == Event::none) {
		++report.events;
		return {Event::change, {unseen, -1}, step.trial().h};
	}
	if (!isContact(s, step, event))
		event.kind = Event::change;
	return event;
}

template <class K>
Event LocalisedStep<K>::tryUpTo(RigidSystem<K>& s, double h)
{
	const bool localised = report.events < settings.mostEvents;
	const double rest = tolerance::restSpeed * step.scales.speed;
	step.anticipated.clear();
	step.stopsInside = !localised;
	Event event;
	size_t known;
	do { // until no point closes that the trial did not know of
		known = step.anticipated.size();
		step.attempt(s, h);
		event = findEvent(s, step, localised ? rest : std::numeric_limits<double>::infinity());
	} while (step.anticipated.size() > known);
	++report.substeps;
	if (event.kind != Event::none) {
		event = localise(s, step, event);
		++report.events;
	} else if (!localised) {
		report.unlocalised += int(step.anticipated.size());
	}
	const SolveReport& solved = step.trial().solved;
	report.sweeps += solved.sweeps;
	report.factorisations += solved.factorisations;
	note(solved.residual, solved.converged);
	step.addJammed(s, report.jammed);
	return event;
}

template <class K>
void LocalisedStep<K>::note(double residual, bool solved)
{
	report.residual = std::max(report.residual, residual);
	report.converged &= solved;
}

// Impulses that miss their laws by what counts as rest will do.
template <class K>
void LocalisedStep<K>::note(const RockingImpactResult& impact)
{
	note(impact.residual, impact.solved || impact.residual <= tolerance::restSpeed * step.scales.speed);
}

// Points that touch and approach each other land, with `now`, which an event has brought to touch; false: there are none.
template <class K>
bool LocalisedStep<K>::land(RigidSystem<K>& s, PointRef now)
{
	touchingPoints(s, settings.merged, now, closing);
	if (closing.empty())
		return false;
	const size_t known = s.impacts.size();
	placeFriction(s);
	placeFriction(s, closing);
	note(impacts.land(s, settings, closing));
	impacts.addJammed(report.jammed);
	answerImpacts(s, known);
	return true;
}

// Resonant pulses act right after the impact that releases them.
template <class K>
void LocalisedStep<K>::answerImpacts(RigidSystem<K>& s, size_t known)
{
	for (size_t k = known; k < s.impacts.size(); ++k)
		for (size_t d = 0; d < s.drives.size(); ++d)
			if (const auto jump = s.drives[d].respond(s.impacts[k].block, s.time); !jump.isZero(0)) {
				placeFriction(s);
				note(impacts.pulse(s, settings, int(d), jump));
				impacts.addJammed(report.jammed);
			}
}

// An impact at the same instant comes before the pulse.
template <class K>
void LocalisedStep<K>::takeJumps(RigidSystem<K>& s)
{
	for (size_t d = 0; d < s.drives.size(); ++d)
		if (const auto jump = s.drives[d].jumpAt(s.time); !jump.isZero(0)) {
			land(s);
			placeFriction(s);
			note(impacts.pulse(s, settings, int(d), jump));
			impacts.addJammed(report.jammed);
		}
}

template <class K>
double LocalisedStep<K>::untilKink(const RigidSystem<K>& s, double left, double dt) const
{
	const double tiny = tolerance::instant * dt;
	double first = s.time + left;
	for (const Drive<K>& drive : s.drives)
		first = std::min(first, drive.nextKink(s.time + tiny, s.time + left - tiny));
	return first < s.time + left ? first - s.time : left;
}

// How long the step may be in which what rests goes on to rest, s, if in the trial it begins to move because the acceleration of a base
// varies; infinity, if it turns out not to do so inside it; 0, if there was nothing to look for and the trial is as it was. The laws of a
// step act on its mean. What rests until the acceleration passes what it bears, and moves from then on, needs a step for each: otherwise
// the impulse that it bears for the rest of the step is lost, an error of first order.
//
// Only jumps are looked for where blocks turn already: their own motion releases contacts all the time.
//
// One looks where points are released in the trial, or would be if their forces went on to the acceleration at its end as they have changed
// since the last step. The instant is then found with the accelerations of the instants themselves, between two bends.
template <class K>
double LocalisedStep<K>::untilRelease(RigidSystem<K>& s)
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const auto isFree = [](const RigidBody<K>& body) { return !body.prescribed; };
	if (std::count_if(s.bodies.begin(), s.bodies.end(), isFree) > tolerance::localised::maxReleased)
		return 0;
	const double h = step.trial().h, end = s.time + h - tolerance::instant * h;
	const double least = tolerance::localised::release * step.scales.acceleration,
	             jump = tolerance::localised::jump * step.scales.acceleration;
	const auto turns = [&](const RigidBody<K>& body) {
		return !body.prescribed &&
		       body.velocity.template tail<K::spins>().norm() * step.scales.length > tolerance::restSpeed * step.scales.speed;
	};
	const auto varies = [&](double enough) {
		return std::any_of(s.drives.begin(), s.drives.end(),
		                   [&](const Drive<K>& drive) { return (drive.acceleration(end) - drive.acceleration(s.time)).norm() > enough; });
	};
	if (!varies(std::any_of(s.bodies.begin(), s.bodies.end(), turns) ? jump : least))
		return 0;
	double further = 0; // the change of the acceleration from the mean to the end, relative to that between the means
	for (const Drive<K>& drive : s.drives) {
		const typename K::Vector last = drive.acceleration(end), mean = (drive.velocity(s.time + h) - drive.velocity(s.time)) / h,
		                         before = (drive.velocity(s.time) - drive.velocity(s.time - h)) / h, change = mean - before;
		if (change.squaredNorm() > 0)
			further = std::max(further, (last - mean).dot(change) / change.squaredNorm());
	}
	if (!step.isReleased(s, 0) && !step.isReleased(s, further))
		return 0;
	if (step.wouldMove(s, h, s.time))
		return infinity;
	for (double rests = s.time; rests < end;) {
		double moves = end;
		for (const Drive<K>& drive : s.drives)
			moves = std::min(moves, drive.nextBend(rests, end));
		if (!step.wouldMove(s, h, moves)) {
			rests = moves;
			continue;
		}
		while (moves - rests > tolerance::localised::release * h) {
			const double middle = (rests + moves) / 2;
			(step.wouldMove(s, h, middle) ? moves : rests) = middle;
		}
		return moves - s.time > tolerance::localised::release * h ? moves - s.time : infinity;
	}
	return infinity;
}

template class LocalisedStep<Plane>;
template class LocalisedStep<Space>;

} // namespace masonry::localised
