#pragma once
// One step without events: theta = 1/2, contact laws on the mean velocity.
//
// From the state (q, V) to (q+, V+) in the time h, with the contact rows J taken in the middle of the step:
//
//     M (V+ - V) = h f + sum J^T p            M with the inertia of the middle
//     q+ = q advanced by h (V + V+)/2         orientation by the exponential of the mean spin
//     u = J (V + V+) - c                      for points in touch: the laws of contact_problem.hpp act on the MEAN velocity
//     u_n = max(J (V + V+) + 2 gap / h, J V+) for points that land and are not localised: they end with a gap of zero, or stop
//
// Why the mean. The work of the contact forces in the step is p . J (V + V+)/2, which the laws make zero for sticking and negative
// for sliding points: the step never gives energy, whatever h. It is symmetric in time and of second order; no gap curvature has to be
// computed.
//
// Spins. With W the spin in the body's own axes and the turn of the step about the mean of W and W+, which is the same vector in both poses
// and in the middle, the work of the change of angular momentum L on it is the change of the kinetic energy (Simo and Wong 1991). In the
// axes of the middle, D half the turn,
//
//     w + w+ := D w + I_mid^-1 D^T L+         L+ = L + h moment + sum of the contacts' moments
//
// where D and the small part (D^T - 1) L+ are those of the last pass: passes are repeated until the energies agree.
//
// Stray velocities. J(q+) V+ = -J(q) V + r: an error at the start changes its sign each step, about r/2, of the order h^2. The part that
// alternates is c = (J(q) V - J(q+) V+)/2 of a pass with c = 0. A step after an event takes it off, a landing's approach speed with it,
// where that gives no energy; else the next one does, when it has the other sign. All points or none: redundant points would otherwise be
// asked for motions that no rigid body makes. Steady steps take off a share, which only damps round-off.
//
// The middle is predicted with the acceleration of the last step, V + h/2 dV/dt: then gaps of points in touch drift by O(h^4) a step, and
// `project` closes them without a change of velocity.
#include "dynamics/localised/settings.hpp"
#include "dynamics/model/scales.hpp"
#include <optional>

namespace masonry::localised {

// A contact point of the system: its pair and its number there.
struct PointRef {
	int pair, point;
	bool operator==(const PointRef& o) const { return pair == o.pair && point == o.point; }
};
inline bool contains(const std::vector<PointRef>& list, PointRef ref) { return std::find(list.begin(), list.end(), ref) != list.end(); }

// Turned by phi about the middle of the step, an arm r there moves by 2 sin(phi/2) (phi/|phi|) x r: the rows act on this chord, so that a
// point at rest on average does not move at all.
template <class K>
double chord(const typename K::Velocity& mean, double h)
{
	return 1 - mean.template tail<K::spins>().squaredNorm() * h * h / 24;
}

// End of a step of which nothing has been accepted yet.
template <class K>
struct Trial {
	struct BodyEnd {
		typename K::Pose middle, end;
		typename K::Velocity velocity, mean; // at the end; over the step
		typename K::Spin momentum;           // angular, at the end
		int unknown;                         // index in the solver; -1: prescribed
	};
	double h {0};
	std::vector<BodyEnd> bodies;
	std::vector<PointRef> rows;          // as in solver.points, in which those of the ties follow
	std::vector<ContactFrame<K>> frames; // at the end, of all points, pair by pair
	SolveReport solved;
};

template <class K>
class SmoothStep {
public:
	// Forgets earlier steps: a run that was saved goes on with the same bits.
	void begin(const RigidSystem<K>& system, const Settings& settings, double dt);
	// The next of so many equal parts of what is left of the step: a step of its own, but for the prescribed bodies. Returns its length, s.
	double beginPart(const RigidSystem<K>& system, int parts);
	double left() const { return stepEnd - end; } // s, of the step after the part
	// Computes the trial of length h from the system's state. Open points do not act, but for those in `anticipated`. `again`: the last
	// trial was of the same step and points; its forces are the first guess, which decides where a sliding point stops by a jam (an impulse
	// however short the step). The friction of the system's points is placed by the forces of the last step, and by those of the first pass
	// where these tell nothing (grip.hpp).
	void attempt(RigidSystem<K>& system, double h, bool again = false);
	// Makes it the system's state: poses, velocities, forces, energies; gaps of loaded points closed.
	void accept(RigidSystem<K>& system);

	// The same with bases that keep the acceleration of the instant `of`: whether a point that rests and carries would leave or slip then.
	bool wouldMove(RigidSystem<K>& system, double h, double of);
	// Whether a point that rests and carries would pull or slip, were the forces of the trial to go on by `further` times what they have
	// changed by since the last step.
	bool isReleased(const RigidSystem<K>& system, double further) const;

	const Trial<K>& trial() const { return last; }
	Scales scales;                     // of this step
	double work {0};                   // of the forces on the bodies in this step so far, J
	std::vector<PointRef> anticipated; // open points that are about to close and are not localised
	bool stopsInside {false};          // sliding points may stop inside the step: friction opposes their last velocity, not the mean
	// Adds the bodies of points that press as much as they may, where the laws of the trial have no solution.
	void addJammed(const RigidSystem<K>& system, std::vector<int>& bodies) const;
	double slowSlip() const { return tolerance::localised::slowSlip * scales.stepSpeed(whole); } // m/s

	// Normal rate of a point's gap, and its tangential velocity, at the end of the trial.
	Eigen::Matrix<double, K::rows, 1> relativeVelocity(const RigidSystem<K>& system, int pair, int point) const;
	const ContactFrame<K>& frame(int pair, int point) const { return last.frames[first[pair] + point]; }

private:
	using Impulse = Eigen::Matrix<double, K::rows, 1>;
	double timeAfter(const RigidSystem<K>& system, double h) const; // s
	void predict(const RigidSystem<K>& system, double h, bool again);
	void assemble(const RigidSystem<K>& system, double h);
	int leader(const RigidSystem<K>& system, int pair) const;
	ContactRows<K> rowsOf(const RigidSystem<K>& system, PointRef ref, const ContactFrame<K>& frame, double h, Impulse astray) const;
	bool acts(const RigidSystem<K>& system, PointRef ref) const;
	void addTies(const RigidSystem<K>& system, double h);
	ContactRows<K> rowsOf(const RigidSystem<K>& system, const Tie<K>& tie, double h) const;
	bool holdTies(const RigidSystem<K>& system, double h);
	void holdAtStrength(const Tie<K>& tie, double h, ContactRows<K>& rows) const;
	void bookTies(RigidSystem<K>& system);
	void takeTies(RigidSystem<K>& system) const;
	void dampStray(const RigidSystem<K>& system, double h);
	void findStray(const RigidSystem<K>& system);
	double strayWork() const;
	double finish(const RigidSystem<K>& system, double h);
	void moveFriction(RigidSystem<K>& system) const;
	void findFrames(const RigidSystem<K>& system);
	double findShifts(const RigidSystem<K>& system, double most);
	void project(const RigidSystem<K>& system, double lost);
	double book(RigidSystem<K>& system) const;
	void takeBodies(RigidSystem<K>& system);
	bool takePoints(RigidSystem<K>& system) const;
	// A part of a step that tells nothing of how velocities change.
	bool isShort() const { return last.h < tolerance::localised::shortPart * whole; }

	Trial<K> last;
	std::vector<int> first; // index in last.frames of a pair's first point
	std::vector<typename K::Velocity> shifts;
	std::vector<double> misses, partings; // of the rows: m; normal velocities at the start of a part of a step, m/s
	std::vector<Impulse> guesses, stray;  // of the rows: impulses of the last pass; velocities that the step takes off (none: empty)
	double allowed {0};                   // Settings::tolerance
	double whole {0}, end {0};            // s, the part of the step that is being done up to its events, and when it ends
	double full {0}, stepEnd {0};         // s, the whole step, and when it ends
	double passed {0};                    // s, of the whole step
	std::vector<typename K::Pose> starts; // of the prescribed bodies: where they go does not depend on how a structure divides the step
	double mass {0};                      // of the free bodies, kg
	double weight {0};                    // the same times the scene's acceleration and length, J
	std::optional<double> steadyOf {};    // s: bases keep the acceleration of that instant
	bool unsteady {false};                // the stray velocities were left
	std::vector<char> breaking;           // by tie, 1: it reaches its strength in this trial, and pulls with that
	bool partBases {false}; // how much each of two bases that move apart carries is not determined: the last step's share grows
	std::vector<ContactFrame<K>> middles; // of the rows of one pair
	ContactSolver<K> solver;
};

// Relative velocity at a point of the system, in its present state.
template <class K>
Eigen::Matrix<double, K::rows, 1> relativeVelocity(const RigidSystem<K>& s, PointRef ref)
{
	const ContactPair<K>& pair = s.pairs[ref.pair];
	const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	return relativeVelocity(pair.points[ref.point].frame, body1.pose.position, body1.velocity, body2.pose.position, body2.velocity);
}

} // namespace masonry::localised
