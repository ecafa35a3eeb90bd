// Gaps of loaded points, and penetrations, that a step has left: taken off its end.
#include "dynamics/localised/smooth_step.hpp"
#include "laws/contact_limits.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::localised {

// Movements that close the gaps of loaded points and take penetrations off, both up to `most` (m), and all that arose in the step. Sweeps
// over the points, each moved back along its normal row (least motion, weighted by mass); the gaps follow linearly. Returns the work
// against the forces on the bodies, J.
template <class K>
double SmoothStep<K>::findShifts(const RigidSystem<K>& s, double most)
{
	const double enough = tolerance::localised::gap * scales.length;
	double largest = 0;
	misses.clear();
	for (size_t r = 0; r < last.rows.size(); ++r) {
		const ContactPoint<K>& point = s.pairs[last.rows[r].pair].points[last.rows[r].point];
		const double gap = frame(last.rows[r].pair, last.rows[r].point).gap;
		const bool loaded = solver.points[r].impulse[0] > 0;
		const double sunk = stray.empty() ? 0. : 0.5 * last.h * stray[r][0];
		const double meant = point.closed ? point.gap + sunk : std::min(gap, 0.);
		const double kept = meant - std::clamp(meant, -most, most);
		const bool givesWay = last.solved.jammed && isAtLimit(solver.points[r]);
		misses.push_back(givesWay ? 0 : gap - (loaded ? kept : std::min(kept, 0.)));
		if (loaded || misses.back() < 0)
			largest = std::max(largest, std::abs(misses.back()));
	}
	shifts.clear();
	if (!(largest > enough))
		return 0;
	shifts.assign(solver.bodies.size(), K::Velocity::Zero());
	const int maxSweeps = last.rows.size() == 1 ? 1 : 20;
	for (int sweep = 0; sweep < maxSweeps && largest > enough; ++sweep) {
		largest = 0;
		for (size_t r = 0; r < last.rows.size(); ++r) {
			const ContactRows<K>& rows = solver.points[r];
			double miss = misses[r], softness = 0;
			typename K::Velocity move1 = K::Velocity::Zero(), move2 = K::Velocity::Zero();
			if (rows.body1 >= 0) {
				move1 = solver.bodies[rows.body1].inverseMass * rows.J1.row(0).transpose();
				softness += rows.J1.row(0).dot(move1);
				miss += rows.J1.row(0).dot(shifts[rows.body1]);
			}
			if (rows.body2 >= 0) {
				move2 = solver.bodies[rows.body2].inverseMass * rows.J2.row(0).transpose();
				softness += rows.J2.row(0).dot(move2);
				miss += rows.J2.row(0).dot(shifts[rows.body2]);
			}
			if (!(rows.impulse[0] > 0) && miss >= 0)
				continue;
			largest = std::max(largest, std::abs(miss));
			if (rows.body1 >= 0)
				shifts[rows.body1] -= miss / softness * move1;
			if (rows.body2 >= 0)
				shifts[rows.body2] -= miss / softness * move2;
		}
	}
	double work = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (last.bodies[b].unknown >= 0)
			work -= s.bodies[b].force.dot(shifts[last.bodies[b].unknown]);
	return work;
}

// Closes gaps and penetrations: at once where that costs no more energy than the contacts have lost in the step, else little by little.
template <class K>
void SmoothStep<K>::project(const RigidSystem<K>& s, double lost)
{
	if (last.solved.jammed || findShifts(s, std::numeric_limits<double>::infinity()) > lost)
		findShifts(s, tolerance::localised::closingSpeed * scales.speed * last.h);
	if (shifts.empty())
		return;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (last.bodies[b].unknown >= 0)
			K::advance(last.bodies[b].end, shifts[last.bodies[b].unknown], 1.);
	findFrames(s);
}

template void SmoothStep<Plane>::project(const RigidSystem<Plane>&, double);
template void SmoothStep<Space>::project(const RigidSystem<Space>&, double);

} // namespace masonry::localised
