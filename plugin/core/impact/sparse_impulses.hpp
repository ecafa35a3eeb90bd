#pragma once
// Impulse problems of many points, by the contact solver: its cost grows with their number, that of the dense solver with its cube.
#include "impact/impulse_problem.hpp"
#include "laws/contact_problem.hpp"

namespace masonry {

// Velocities instead of forces, the same laws: plastic and unilateral with friction; a couple is a row that pulls as well as pushes.
template <class K>
class SparseImpulses {
public:
	std::vector<std::array<int, 2>> near; // bodies that may meet, if known: as in the contact solver

	// As solveImpulses, which small problems are left to. Without slip some have no solution: points that pull are let go.
	ImpulseReport solve(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples);

private:
	void addPoint(const Bodies<K>& bodies, const ImpulsePoint<K>& point);
	void addCouple(const Bodies<K>& bodies, const CoupleRow<K>& couple, double length);
	ImpulseReport solveSparse(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples);
	SolveReport solveRows(const Bodies<K>& bodies, const ImpulsePoints<K>& points, const CoupleRows<K>& couples, double length);

	ContactSolver<K> solver;
	std::vector<int> unknown; // of a body in the solver; -1: prescribed
	Bodies<K> before;
};

// The same with a memory of its own (of each thread).
template <class K>
ImpulseReport solveSparsely(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	thread_local SparseImpulses<K> solver;
	return solver.solve(bodies, points, couples);
}

} // namespace masonry
