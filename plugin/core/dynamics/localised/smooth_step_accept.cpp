// The trial becomes the system's state: energies, bodies, points.
#include "dynamics/localised/smooth_step.hpp"
#include "tolerances.hpp"

namespace masonry::localised {

template <class K>
void SmoothStep<K>::accept(RigidSystem<K>& s)
{
	const double lost = book(s);
	bookTies(s);
	project(s, lost);
	partings.clear();
	for (size_t r = 0; last.h < whole && r < last.rows.size(); ++r)
		partings.push_back(localised::relativeVelocity(s, last.rows[r])[0]);
	takeBodies(s);
	takeTies(s);
	if (takePoints(s))
		s.startAnew();
}

// Energies of the step. Returns what the contacts have lost, J: not as a difference of what has been lost since the start.
template <class K>
double SmoothStep<K>::book(RigidSystem<K>& s) const
{
	double impact = 0, friction = 0;
	for (size_t r = 0; r < last.rows.size(); ++r) {
		const ContactRows<K>& rows = solver.points[r];
		const PointRef ref = last.rows[r];
		const auto& next1 = last.bodies[s.pairs[ref.pair].body1];
		const auto& next2 = last.bodies[s.pairs[ref.pair].body2];
		const auto mean1 = (rows.J1 * next1.mean).eval(), mean2 = (rows.J2 * next2.mean).eval(), slip = (mean1 + mean2).eval();
		impact -= rows.impulse[0] * slip[0];
		friction -= rows.impulse.template tail<K::rows - 1>().dot(slip.template tail<K::rows - 1>());
		if (next1.unknown < 0)
			s.baseWork -= rows.impulse.dot(mean1);
		if (next2.unknown < 0)
			s.baseWork -= rows.impulse.dot(mean2);
	}
	s.impactDissip += impact;
	s.frictDissip += friction;
	return impact + friction;
}

template <class K>
void SmoothStep<K>::takeBodies(RigidSystem<K>& s)
{
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		RigidBody<K>& body = s.bodies[b];
		const auto& next = last.bodies[b];
		if (!body.prescribed)
			work += body.force.template head<K::dimension>().dot(next.end.position - body.pose.position) +
			        last.h * body.force.template tail<K::spins>().dot(next.mean.template tail<K::spins>());
		if (!body.prescribed && !isShort())
			body.increment = (next.velocity - body.velocity) / last.h;
		body.pose = next.end;
		body.velocity = next.velocity;
	}
	s.time = timeAfter(s, last.h);
	passed += last.h;
	s.setFresh(unsteady || (isShort() && s.isFresh()));
}

// Writes what points carry and whether they are in touch. Returns whether some have landed.
template <class K>
bool SmoothStep<K>::takePoints(RigidSystem<K>& s) const
{
	const double still = tolerance::localised::parting * scales.stepSpeed(last.h);
	size_t row = 0;
	bool landed = false;
	for (size_t c = 0; c < s.pairs.size(); ++c)
		for (int i = 0; i < s.pairs[c].size(); ++i) {
			ContactPoint<K>& point = s.pairs[c].points[i];
			point.frame = last.frames[first[c] + i];
			point.gap = point.frame.gap;
			const auto before = point.force;
			point.force.setZero();
			const bool acted = row < last.rows.size() && last.rows[row].pair == int(c) && last.rows[row].point == i;
			if (!acted)
				continue;
			const auto& rows = solver.points[row++];
			const auto u = relativeVelocity(s, int(c), i);
			const bool wasOpen = !point.closed;
			point.closed = rows.impulse[0] > 0 || u[0] <= still;
			landed |= wasOpen && point.closed;
			// A loaded point has velocity errors of either sign, and parts where it parts ever faster.
			const bool lostByError =
			    last.h < whole &&
			    (u[0] <= partings[row - 1] || (isShort() && std::abs(u[0]) <= tolerance::localised::stray * scales.stepSpeed(whole)));
			if (lostByError && !wasOpen && before[0] > 0 && !(rows.impulse[0] > 0)) {
				point.closed = true;
				point.force = before;
				continue;
			}
			if (!point.closed)
				continue;
			point.force = rows.impulse / last.h;
			point.sliding = u.template tail<K::rows - 1>().norm() > still && rows.slides();
		}
	return landed;
}

template void SmoothStep<Plane>::accept(RigidSystem<Plane>&);
template void SmoothStep<Space>::accept(RigidSystem<Space>&);

} // namespace masonry::localised
