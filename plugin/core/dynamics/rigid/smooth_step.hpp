#pragma once
// One step without events: theta = 1/2, contact laws on the mean velocity.
//
// From the state (q, V) to (q+, V+) in the time h, with the contact rows J taken in the middle of the step:
//
//     M (V+ - V) = h f + sum J^T p            M with the inertia of the predicted end
//     q+ = q advanced by h (V + V+)/2         orientation by the exponential of the mean spin
//     u = J (V + V+) - damping delta          for points in touch: the laws of contact_problem.hpp act on the MEAN velocity
//     u = J V+ (+ 2 gap_mid / h, normal)      for points that land and are not localised: still open (and, one step later, just closed);
//                                             gap_mid from zero where the step starts with a penetration
//
// Why the mean. The work of the contact forces in the step is p . J (V + V+)/2, which the laws make zero for sticking and negative
// for sliding points: the step never gives energy, whatever h. It is symmetric in time and of second order; no gap curvature has to be
// computed. What is left undamped is an error delta = J(q) V of the velocity at the start that changes sign each step; a small share
// `damping` of it is taken off (tolerances.hpp).
//
// The middle is predicted with the acceleration of the last step, V + h/2 dV/dt: then gaps of points in touch drift by O(h^4) a step, and
// `project` closes them without a change of velocity.
#include "dynamics/rigid/scales.hpp"

namespace masonry::rigid {

// A contact point of the system: its pair and its number there.
struct PointRef {
	int pair, point;
};

// End of a step of which nothing has been accepted yet.
template <class K> struct Trial {
	struct BodyEnd {
		typename K::Pose     middle, predicted, end;
		typename K::Velocity velocity, mean;
		int                  unknown; // index in the solver; -1: prescribed
	};
	double               h { 0 };
	std::vector<BodyEnd> bodies;
	std::vector<PointRef> rows; // as in solver.points
	std::vector<ContactFrame<K>> frames; // at the end, of all points, pair by pair
	SolveReport          solved;
};

template <class K> class SmoothStep {
public:
	// Forgets earlier steps: a run that was saved goes on with the same bits.
	void begin(const RigidSystem<K>& system)
	{
		solver.forget();
		scales = Scales(system);
	}
	// Computes the trial of length h from the system's state. Open points do not act, but for those in `anticipated`.
	void attempt(const RigidSystem<K>& system, double h);
	// Makes it the system's state: poses, velocities, forces, energies; gaps of loaded points closed.
	void accept(RigidSystem<K>& system);

	const Trial<K>&       trial() const { return last; }
	Scales                scales;              // of this step
	std::vector<PointRef> anticipated;         // open points that are about to close and are not localised
	bool                  stopsInside { false }; // sliding points may stop inside the step: friction opposes their last velocity, not the mean

	// Normal rate of a point's gap, and its tangential velocity, at the end of the trial.
	Eigen::Matrix<double, K::rows, 1> relativeVelocity(const RigidSystem<K>& system, int pair, int point) const;
	const ContactFrame<K>&            frame(int pair, int point) const { return last.frames[first[pair] + point]; }

private:
	void predict(const RigidSystem<K>& system, double h);
	void assemble(const RigidSystem<K>& system, double h);
	void finish(const RigidSystem<K>& system, double h);
	void project(RigidSystem<K>& system);

	Trial<K>         last;
	std::vector<int> first; // index in last.frames of a pair's first point
	std::vector<typename K::Velocity> increments, shifts;
	std::vector<double> gaps;
	std::vector<typename K::Vector> positions; // of the rows of one pair
	ContactSolver<K> solver;
};

// Relative velocity (body 2 minus body 1) at a point of a frame, along its axes.
template <class K>
Eigen::Matrix<double, K::rows, 1> relativeVelocity(const ContactFrame<K>& frame, const typename K::Vector& center1, const typename K::Velocity& v1,
                                                   const typename K::Vector& center2, const typename K::Velocity& v2)
{
	const auto at = [&](const typename K::Vector& center, const typename K::Velocity& v) {
		return typename K::Vector(v.template head<K::dimension>() + K::cross(v.template tail<K::spins>(), frame.position - center));
	};
	return frame.axes * (at(center2, v2) - at(center1, v1));
}

} // namespace masonry::rigid
