#pragma once
// Block Gauss-Seidel: each point takes the impulse that its law asks for while the others keep theirs.
#include "laws/contact_state.hpp"

namespace masonry {

// One pass over the points. A point that obeys its law is left alone, so that a pass that returns `tolerance` or less has
// changed nothing, and what it returns is the residual.
template <class K>
double sweep(ContactState<K>& s, double tolerance)
{
	double worst = 0;
	for (int i = 0; i < s.nPoints; ++i) {
		const auto u = s.relativeVelocity(s.rows[i]);
		const double miss = s.violation(i, u);
		worst = std::max(worst, miss);
		if (miss <= tolerance)
			continue;
		const OnePoint<K::rows>& alone = s.points[i].alone;
		const auto next = alone.impulse(u - alone.G * s.rows[i].impulse, s.rows[i].law);
		s.push(i, next - s.rows[i].impulse);
		s.rows[i].impulse = next;
	}
	return worst;
}

// A point alone needs no sweeps.
template <class K>
double solveAlone(ContactState<K>& s)
{
	for (int b = 0; b < s.nBodies; ++b)
		s.bodies[b].velocity = s.bodies[b].free;
	ContactRows<K>& row = s.rows[0];
	row.impulse.setZero(); // a compliant row's velocity depends on it
	row.impulse = s.points[0].alone.impulse(s.relativeVelocity(row), row.law);
	s.push(0, row.impulse);
	return s.violation(0, s.relativeVelocity(row));
}

// Sweeps until solved, up to `limit`; not `patient`: or until the rate of convergence tells that `limit` will not do.
template <class K>
double gaussSeidel(ContactState<K>& s, double tolerance, int limit, bool patient, SolveReport& report)
{
	constexpr int look = 4; // sweeps between two looks at the rate
	double last = std::numeric_limits<double>::infinity();
	for (int k = 1;; ++k) {
		const double miss = sweep(s, tolerance);
		++report.sweeps;
		if (miss <= tolerance || k == limit)
			return miss;
		if (k % look)
			continue;
		if (!patient && std::log(miss / tolerance) * look > (limit - k) * std::log(last / miss))
			return miss;
		last = miss;
	}
}

} // namespace masonry
