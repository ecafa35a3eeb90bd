#pragma once
// Sweeps over the points: each takes the impulse that its law asks for while the others keep theirs. In the plane one after the other
// (block Gauss-Seidel), in space all at once (damped block Jacobi): where the laws have several solutions, as for points that share an edge
// and cannot slip, sweeps one after the other give the load to the first point, and a scene that is its own mirror image would turn.
#include "dynamics/rigid/contact_state.hpp"

namespace masonry::rigid {

// One pass of Gauss-Seidel. A point that obeys its law is left alone, so that a pass that returns `tolerance` or less has
// changed nothing, and what it returns is the residual.
template <class K>
double sweepInTurn(ContactState<K>& s, double tolerance)
{
	double worst = 0;
	for (int i = 0; i < s.nPoints; ++i) {
		const auto u = s.relativeVelocity(s.rows[i]);
		const double miss = s.violation(i, u);
		worst = std::max(worst, miss);
		if (miss <= tolerance)
			continue;
		const auto next = s.impulseAlone(i, u);
		s.push(i, next - s.rows[i].impulse);
		s.rows[i].impulse = next;
	}
	return worst;
}

// The same of Jacobi. Each point goes a part of the way, by the number of points that push one of its bodies in this pass: so the pass
// converges wherever impulses minimise the energy. A part of the way between two impulses in a friction cone is in the cone.
template <class K>
double sweepAtOnce(ContactState<K>& s, double tolerance)
{
	double worst = 0;
	std::fill(s.pushes.begin(), s.pushes.end(), 0);
	for (int i = 0; i < s.nPoints; ++i) {
		const auto u = s.relativeVelocity(s.rows[i]);
		const double miss = s.violation(i, u);
		worst = std::max(worst, miss);
		s.points[i].change.setZero();
		if (miss <= tolerance)
			continue;
		s.points[i].change = s.impulseAlone(i, u) - s.rows[i].impulse;
		for (const int body : {s.rows[i].body1, s.rows[i].body2})
			if (body >= 0)
				++s.pushes[body];
	}
	for (int i = 0; i < s.nPoints; ++i) {
		if (s.points[i].change.isZero(0))
			continue;
		int pushes = 1;
		for (const int body : {s.rows[i].body1, s.rows[i].body2})
			if (body >= 0)
				pushes = std::max(pushes, s.pushes[body]);
		s.points[i].change /= pushes;
		s.push(i, s.points[i].change);
		s.rows[i].impulse += s.points[i].change;
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
	row.impulse = s.points[0].alone.impulse(s.relativeVelocity(row), row.friction);
	s.push(0, row.impulse);
	return s.violation(0, s.relativeVelocity(row));
}

// Sweeps until solved, up to `limit`; not `patient`: or until the rate of convergence tells that `limit` will not do.
template <class K>
double sweep(ContactState<K>& s, double tolerance, int limit, bool patient, SolveReport& report)
{
	constexpr int look = 4; // sweeps between two looks at the rate
	double last = std::numeric_limits<double>::infinity();
	for (int k = 1;; ++k) {
		const double miss = K::dimension == 2 ? sweepInTurn(s, tolerance) : sweepAtOnce(s, tolerance);
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

} // namespace masonry::rigid
