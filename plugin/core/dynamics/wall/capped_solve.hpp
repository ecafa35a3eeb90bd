#pragma once
// A solve of the contact laws, of a step or of an instant, in which no joint makes energy by its row. A joint's gain is the work of its
// couple and of the impulses at its points, on the mean of the relative velocities before and after (JointWork); what friction and impacts
// take at other joints does not pay for it. Joints without a row land plastically, and yet gain where their blocks moved apart before the
// impact pressed them together again: the rows at these blocks share that gain. Row and points of a step and of the instant after it are
// one impact, whose last part gives back a little of what the first has taken: the balance is that of both.
//
// The row with the largest gain is left out, and the rest is solved again, until no joint makes energy: a joint without its row lands with
// its natural restitution. Then these rows come back with the largest spins that make no energy. While no other contact opens, closes or
// begins to slide, impulses are linear in the spin x, 0 at the natural one and 1 at that which made energy, and the gain is
//
//     G(x) = G0 + (G1 - G0) x - D x (1 - x),        D = (c1 - c0)(e.w1 - e.w0)/2
//
// where c are the couples. Each trial takes the root of this and replaces one of the two ends. If the last trial makes energy anywhere, the
// last one that has made none holds.
#include "dynamics/wall/admm_solver.hpp"
#include "dynamics/wall/energy_ledger.hpp"
#include "dynamics/wall/few_blocks.hpp"
#include <cmath>

namespace masonry::wall {

struct CappedStatus : SolverStatus { // iterations and factorisations of all solves
	double lost {0};                 // energy of an instant, J
};

template <class K>
class CappedSolve {
public:
	// As AdmmSolver::solve; the rows of the results whose targets were not reached are `capped`.
	CappedStatus solve(const RigidSystem<K>& system, const AdmmProblem<K>& problem, const AdmmSettings& settings, AdmmSolver<K>& solver,
	                   const EnergyLedger<K>& ledger, AdmmResults<K>& results);

private:
	// Looks at the work of all rows after a solve with those that are held. Returns the one that makes most energy, or nullptr.
	SpinRow<K>* takeWork(const RigidSystem<K>& system, const AdmmProblem<K>& problem, double residual, const AdmmResults<K>& results);

	// Sums what joints without a row gain beside each row, J, by the work of each pair.
	std::vector<double> gainsBeside(const RigidSystem<K>& system, const std::vector<JointWork>& works) const;

	// Gives capped rows the targets of the next trial. False: all of them have found theirs.
	bool moveTargets(int trials);

	// The result of a solve for one row.
	struct Trial {
		bool held {false}, makesEnergy {false};
		double rate {0}, couple {0}; // rad/s, N m s
		JointWork work;

		// The share x of the way to a trial that makes energy, at which the joint loses `loss`, J.
		double shareUpTo(const Trial& above, double loss) const
		{
			const double curved = std::max(0., (above.couple - couple) * (above.rate - rate) / 2), low = work.gain + loss,
			             rise = above.work.gain - work.gain - curved;
			return -2 * low / (rise + std::sqrt(rise * rise - 4 * curved * low));
		}
	};
	struct Range {
		Trial below, above, last; // the greatest spin without energy made, the least with it; the last solve
	};
	std::vector<SpinRow<K>> rows, sound; // now; the last with which no joint made energy
	std::vector<Range> ranges;           // by row
	FewBlocks<K> fewBlocks;
};

} // namespace masonry::wall
