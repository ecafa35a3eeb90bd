#pragma once
// A problem of the contact laws of a structure, and what its solver (admm_solver.hpp) returns. The caller owns both.
#include "dynamics/wall/mortar_rows.hpp"
#include "dynamics/wall/spin_row.hpp"
#include "dynamics/wall/step_context.hpp"
#include "dynamics/wall/tie_rows.hpp"

namespace masonry::wall {

template <class K>
struct AdmmProblem {
	const ContactSet<K>& contacts;
	const StepContext& step;
	const LaneArray& load;               // change of velocity by external forces, in packs
	const LaneArray& guess;              // change that is expected altogether; may be empty
	const std::vector<SpinRow<K>>& rows; // prescribed spins
	std::vector<TieRow<K>> ties {};
	std::vector<MortarRow<K>> mortar {};
	const Array<Strength<K>>* strength {nullptr}; // by group, of sound mortar
};

template <class K>
struct alignas(alignment) PointResult {
	using Tangent = typename PointLanes<K>::Tangent;
	Mask inReach; // the point is in A; others carry nothing
	Lanes bn;     // bias, m/s
	Tangent bt;
	Lanes bound; // g, N s
	Lanes un;    // J V, m/s
	Tangent ut;
	Lanes actedN; // impulse with which V obeys the momentum equation, N s
	Tangent actedT;
};
template <class K>
using GroupResult = std::array<PointResult<K>, lanePoints<K>>;

template <class K>
struct AdmmResults {
	LaneArray velocity;                           // V, in the packs of the contacts
	PointStates<K> states;                        // p and z
	std::vector<GroupResult<K>> points;           // by group of the contacts
	std::vector<SpinRow<K>> spins;                // the rows of the problem with their couples
	std::vector<TieRow<K>> ties;                  // the same with their impulses
	std::vector<MortarRow<K>> mortar;             // the same
	const Array<Strength<K>>* strength {nullptr}; // that of the problem
};

struct SolverStatus {
	int iterations {0}, factorisations {0};
	double residual {0};   // largest |w - z|, and mu R |g - p_n| where points slide, m/s
	bool finite {true};    // no velocity is infinite or NaN
	bool leftRest {false}; // R was that of a structure at rest, until the residual would not fall
};

} // namespace masonry::wall
