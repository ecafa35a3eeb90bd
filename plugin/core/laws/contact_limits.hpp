#pragma once
// Impulses where no motion obeys the laws of contact_problem.hpp because bodies with prescribed motion approach each other through free
// ones: jaws that close on a block, a block that wedges between them. There such a body presses with a limited normal impulse, `most` of
// its rows, and goes into the block if that is not enough:
//
//     0 <= p_n <= most,   u_n >= 0 where p_n < most,   u_n <= 0 where p_n > 0
//
// The penetration takes the energy most |u_n|. All other laws stay; a row without slip and with a limit has the friction coefficient 1.
// Method: Gauss-Seidel with the projection of each point, p <- P(p - r u), since all impulses are bounded.
#include "laws/contact_state.hpp"
#include <algorithm>
#include <cmath>

namespace masonry {

template <class K>
typename ContactRows<K>::Rows projectLimited(typename ContactRows<K>::Rows y, const ContactRows<K>& row)
{
	if (std::isinf(row.most))
		return project(row.law, y);
	y[0] = std::min(y[0], row.most);
	return project(PointLaw(std::min(row.law.friction, 1.)), y);
}

// Whether the point presses with all that it may.
template <class K>
bool isAtLimit(const ContactRows<K>& row)
{
	constexpr double nearly = 0.9; // of two jaws one holds what the other presses, but for the inertia of the blocks between them
	return row.impulse[0] > 0 && row.impulse[0] >= nearly * row.most;
}

// An impulse this many times the limit, and what stops all bodies at once, only grows while a solution is sought. Where round-off ends the
// search, that is no solution.
constexpr double absurd = 1e3;

template <class K>
bool pressAbsurdly(const ContactState<K>& s)
{
	const auto exceeds = [&](double momentum) {
		return std::any_of(s.rows, s.rows + s.nPoints,
		                   [=](const ContactRows<K>& row) { return row.impulse[0] > absurd * (row.most + momentum); });
	};
	if (!exceeds(0))
		return false;
	double mass = 0, speed = 0;
	for (int b = 0; b < s.nBodies; ++b)
		mass += 1 / s.bodies[b].inverseMass.linear;
	for (int i = 0; i < s.nPoints; ++i) {
		const ContactRows<K>& row = s.rows[i];
		typename ContactRows<K>::Rows u = row.offset;
		if (row.body1 >= 0)
			u += row.J1 * s.bodies[row.body1].free;
		if (row.body2 >= 0)
			u += row.J2 * s.bodies[row.body2].free;
		speed = std::max(speed, u.norm());
	}
	return exceeds(mass * speed);
}

// Impulses with limits, from those given, in the place of those of the state, which miss the laws without limits by report.residual. False:
// they are no better, since no limit is reached or the laws are missed by more; then impulses and velocities are worthless.
template <class K>
bool solveLimited(ContactState<K>& s, const std::vector<typename ContactRows<K>::Rows>& given, double tolerance, int sweeps,
                  SolveReport& report)
{
	double share = 1; // of the impulses that the search has ended with: they grow in proportion, and balance each other but for the weights
	for (int i = 0; i < s.nPoints; ++i)
		if (s.rows[i].impulse[0] > s.rows[i].most)
			share = std::min(share, s.rows[i].most / s.rows[i].impulse[0]);
	const bool areTooLarge = share < 1;
	for (int i = 0; i < s.nPoints; ++i) {
		const typename ContactRows<K>::Rows start = areTooLarge ? given[i] + share * s.rows[i].impulse : given[i];
		s.rows[i].impulse = projectLimited(start, s.rows[i]);
	}
	s.applyImpulses();
	double worst = std::numeric_limits<double>::infinity();
	for (int k = 0; k < sweeps && worst > tolerance; ++k) {
		worst = 0;
		for (int i = 0; i < s.nPoints; ++i) {
			ContactRows<K>& row = s.rows[i];
			const double trace = s.points[i].alone.trace;
			const auto next = projectLimited<K>(row.impulse - s.relativeVelocity(row) / trace, row);
			worst = std::max(worst, (next - row.impulse).norm() * trace);
			s.push(i, next - row.impulse);
			row.impulse = next;
		}
		++report.sweeps;
	}
	report.jammed = std::any_of(s.rows, s.rows + s.nPoints, isAtLimit<K>);
	const bool isBetter = areTooLarge || (report.jammed && worst < report.residual);
	if (isBetter)
		report.residual = worst;
	report.jammed &= isBetter;
	return isBetter;
}

} // namespace masonry
