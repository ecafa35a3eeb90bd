#pragma once
// Centre after centre of the proximal Newton method: from impulses close to the solution, or through other states.
#include "laws/contact_root.hpp"

namespace masonry {

template <class K>
class ContactNewton : public ContactRoot<K> {
	using Root = ContactRoot<K>;
	using Root::s, Root::points, Root::softness, Root::factored, Root::begin, Root::findRoot, Root::takeNext, Root::factorIsKept,
	    Root::keepFactor;
	using typename Root::Rows;

public:
	using Root::Root;

	// With a small R at once, for impulses that are close to the solution: from the states in the kept factor, else from
	// those of the impulses. That factor is of another problem with the same points; as only increments enter, this slows
	// convergence but does not move the solution. False: too far.
	bool resume(double tolerance, SolveReport& report)
	{
		constexpr int maxCentres = 6, maxSteps = 10;
		constexpr double slow = 0.1; // ratio of residuals from centre to centre that calls for a new factor
		const bool known = factorIsKept();
		begin(tolerance);
		factored = known;
		softness = tolerance::contactProblem::resumedSoftness;
		if (!factored) {
			for (int i = 0; i < s.nPoints; ++i)
				points[i].rate = projectionRate<Rows>(s.rows[i].law, onCone(s.rows[i].impulse));
		}
		for (int k = 0; k < maxCentres; ++k) {
			if (!findRoot(true, maxSteps, report))
				return false;
			takeNext();
			const double present = report.residual;
			report.residual = s.residual();
			if (report.residual <= tolerance) {
				keepFactor();
				return true;
			}
			if (report.residual > slow * present)
				factored = false;
		}
		return false;
	}

	// Centre after centre. R falls while roots are found, so that the centres converge faster than linearly; where one is not it grows, and
	// falls in smaller steps from there on, until roots come easily again. As the load on springs of stiffness 1/R, a centre moves the
	// forces by what the points still move, over R: forces that have far to go need a small R, and a path of many changes of state small
	// steps.
	double converge(double target, SolveReport& report)
	{
		constexpr int maxCentres = 40, maxSteps = 30, easy = 3;  // factorisations
		constexpr double growth = 10, most = 1, steepest = 1e-2; // of the softness
		double fall = steepest;
		begin(target);
		softness = tolerance::contactProblem::softness;
		double present = s.residual();
		bool found = false;
		for (int k = 0; k < maxCentres && softness <= most; ++k) {
			const int before = report.factorisations;
			found = findRoot(found, maxSteps, report);
			const bool easily = found && report.factorisations - before <= easy;
			for (int i = 0; i < s.nPoints; ++i)
				std::swap(s.rows[i].impulse, points[i].next);
			s.applyImpulses();
			const double next = found ? goOn(s.residual()) : s.residual();
			s.keepBest(next);
			if (next <= target)
				return next;
			if (!found && next > present) {
				for (int i = 0; i < s.nPoints; ++i)
					s.rows[i].impulse = points[i].next;
				s.applyImpulses();
			} else {
				present = next;
			}
			if (easily)
				fall = std::max(steepest, fall * fall);
			softness = found ? std::max(tolerance::contactProblem::minSoftness, fall * softness) : growth * softness;
			if (!found)
				fall = std::sqrt(fall);
			factored = false;
		}
		return present;
	}

private:
	// From the new centre, with the old one in `next`, on by its last move, ever farther while the residual hardly grows: where no point
	// changes its state, centre after centre moves by the same u/R. Returns the residual.
	double goOn(double present)
	{
		constexpr double slack = 1e-2, most = 1e6;
		for (int i = 0; i < s.nPoints; ++i) {
			points[i].move = s.rows[i].impulse - points[i].next;
			points[i].next = s.rows[i].impulse;
		}
		const auto residualAt = [&](double moves) {
			for (int i = 0; i < s.nPoints; ++i)
				s.rows[i].impulse = moves > 0 ? project<Rows>(s.rows[i].law, points[i].next + moves * points[i].move) : points[i].next;
			s.applyImpulses();
			return s.residual();
		};
		double reached = 0;
		for (double moves = 1; moves <= most; moves *= 2) {
			const double next = residualAt(moves);
			if (!(next <= (1 + slack) * present))
				break;
			present = next;
			reached = moves;
		}
		return residualAt(reached);
	}

	// An impulse that has reached the cone but for round-off, moved beyond it.
	static Rows onCone(Rows impulse)
	{
		impulse.template tail<K::rows - 1>() *= 1 + tolerance::contactProblem::onCone;
		return impulse;
	}
};

} // namespace masonry
