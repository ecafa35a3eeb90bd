#pragma once
// One set of contact laws for every step, and the solvers that meet it.
//
// Unknown are the velocities V of the free bodies and an impulse p per contact point. With u = J1 V1 + J2 V2 + offset, whose first
// component is normal and the others tangential,
//
//     M (V - free) = sum J^T p                     momentum
//     p_n >= 0,  u_n >= 0,  p_n u_n = 0            unilateral
//     u_t = 0                 if |p_t| <  mu p_n   stick
//     p_t = -mu p_n u_t/|u_t| otherwise            slip (Coulomb)
//
// Points may have other laws too (point_law.hpp): without slip, or a row that pulls as well as pushes. A normal row may have a compliance:
// its laws then hold for u_n + compliance p_n.
//
// The residual, one for all solvers: with r = 1/trace(J M^-1 J^T) of the point, |p - P(p - r u)| / r, in m/s, where P projects the
// normal part on p_n >= 0 and then the tangential part on the disc of radius mu p_n; V is always the one that p gives by the
// momentum equation. It is zero if and only if the laws hold.
//
// Method. A proximal semi-smooth Newton method: with R = softness * trace and a centre l (the last impulses) the regularised law
// p = P(l - u/R) makes V the root of M (V - free) - J^T P(l - (J V + offset)/R); each linear system M + J^T P' J / R is
// factorised over the graph of bodies (block_lu.hpp). Redundant points and any mass ratio are harmless to it.
// A point alone is solved by its law at once. Else, first, Newton with a small R from the states of the impulses given (stick, slip,
// open), and with the factor of the last solve while the points are the same: one back-substitution where no state changes. From
// impulses far from the solution: in space the impulses given stay the centre while R falls (contact_approach.hpp); in the plane, and where
// that fails without slip, block Gauss-Seidel. Where that does not converge, Newton with a large R that falls as the centres move, each
// going on along its move while that does no harm, in turns with Gauss-Seidel. Redundant points, and friction, leave several solutions: all
// of an edge's load at one corner, which turns the block about it, is one where no loaded point slips. With the centre kept, the solution
// is that nearest to the impulses given, weighted with R. It does not depend on the order of the points, and a scene that is its own mirror
// image stays so. Gauss-Seidel, which takes the points in their order, and a small R at once from far away do not find it: so impulses that
// an impact lets expect are not resumed from in space. Impulses that still miss the laws are returned with their residual, and made to add
// no energy (seen from the offsets).
#include "contact/kinematics.hpp"
#include "laws/point_law.hpp"
#include "tolerances.hpp"
#include <memory>
#include <vector>

namespace masonry {

template <class K>
struct InverseMass {
	double linear {0};                                              // 1/kg
	typename K::InverseInertia angular {K::InverseInertia::Zero()}; // global axes
	typename K::Velocity operator*(const typename K::Velocity& impulse) const
	{
		typename K::Velocity v;
		v.template head<K::dimension>() = linear * impulse.template head<K::dimension>();
		v.template tail<K::spins>() = angular * impulse.template tail<K::spins>();
		return v;
	}
};

template <class K>
struct FreeBody {
	InverseMass<K> inverseMass;
	typename K::Velocity free {K::Velocity::Zero()};     // without contact
	typename K::Velocity velocity {K::Velocity::Zero()}; // result
};

template <class K>
struct ContactRows {
	using Rows = Eigen::Matrix<double, K::rows, 1>;
	using Jacobian = Eigen::Matrix<double, K::rows, K::dof>;
	int body1 {-1}, body2 {-1}; // indices of free bodies; -1: prescribed, its motion is in the offset
	Jacobian J1, J2;            // of body 1 with its minus sign
	Rows offset {Rows::Zero()}; // m/s
	PointLaw law;
	double most {unlimited}; // N s, normal impulse of a body with prescribed motion where the laws have no solution (contact_limits.hpp)
	Rows impulse {Rows::Zero()}; // in: first guess; out: result. N s, on body 2 along the rows

	// Whether the impulse has reached the friction cone.
	bool slides() const
	{
		return impulse[0] > 0 &&
		       impulse.template tail<K::rows - 1>().norm() >= (1 - tolerance::contactProblem::cone) * law.friction * impulse[0];
	}
};

struct SolveReport {
	int sweeps {0}, factorisations {0};
	double residual {0}; // m/s
	bool converged {true};
	bool jammed {false}; // the laws have no solution: bodies with prescribed motion press as much as they may
};

// Owns its workspace: no heap allocation once it has seen a problem of this size.
template <class K>
class ContactSolver {
public:
	std::vector<FreeBody<K>> bodies;
	std::vector<ContactRows<K>> points;
	// Pairs of free bodies that may meet, if known: the order of elimination then stays while points come and go.
	std::vector<std::array<int, 2>> near;

	// Until the residual is at most `tolerance` (m/s); where Newton stops short of that, `enough` will do.
	SolveReport solve(double tolerance, double enough = 0);
	double residual(); // of the present velocities and impulses
	void forget();     // the next solve starts without the factor of the last: its bits depend on its input alone

	bool guessed {false};  // the impulses given are what an impact lets expect, not those of the last solve
	int lastSweeps {2000}; // of Gauss-Seidel, between the attempts of Newton

private:
	struct Workspace;
	struct Deleter {
		void operator()(Workspace*) const;
	};
	std::unique_ptr<Workspace, Deleter> workspace;
};

} // namespace masonry
