#pragma once
// Whether a structure rests: then gaps are added up and frames stay, and points have the stiffness of rest (admm_solver.hpp).
#include "dynamics/wall/admm_results.hpp"

namespace masonry::wall {

template <class K>
class RestState {
public:
	bool stands() const { return quiet >= enough; }
	// Blocks of a pair in reach that has a point faster than `level` (m/s), and blocks without a pair in reach that are as fast.
	static int movingBlocks(const RigidSystem<K>& system, const ContactSet<K>& contacts, const PointsReport& points, double level);
	// Takes a step of length h with so many moving blocks into account.
	void take(const RigidSystem<K>& system, const SolverStatus& status, int movingBlocks, double h);

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(quiet);
	}

private:
	static constexpr int enough = 8; // steps. Fewer: blocks at the peak of a half cycle seem to stand
	int quiet {0};                   // steps in which nothing has moved or turned, up to now
};

} // namespace masonry::wall
