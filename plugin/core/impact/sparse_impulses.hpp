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
	ImpulseReport solve(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples);

private:
	void addPoint(const std::vector<Body>& bodies, const ImpulsePoint& point);
	void addCouple(const std::vector<Body>& bodies, const CoupleRow& couple, double length);
	ImpulseReport solveSparse(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples);
	SolveReport solveRows(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, const std::vector<CoupleRow>& couples,
	                      double length);

	ContactSolver<K> solver;
	std::vector<int> unknown; // of a body in the solver; -1: prescribed
	std::vector<masonry::Body> before;
};

// In space, with a memory of its own (of each thread).
ImpulseReport solveSparsely(std::vector<masonry::Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples);

} // namespace masonry
