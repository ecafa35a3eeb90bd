#pragma once
// Mortar of walls (dynamics/model/mortar_joint.hpp).
//
// A rigid joint has no rows of its own: its corners bear more than those of a dry joint, each by its share w (mortar_patch.hpp)
//
//     p_n >= -h w f_t A,    |p_t| <= h w c A + mu p_n
//
// so that in the plane its resultants obey |M| <= (N + f_t A) d/2 and |V| <= c A + mu N, with the depth d and the compression N; in space
// N + f_t A acts within the patch, and torsion is resisted as by an even cohesion. These are exactly the limits of a joint with cohesive
// points (tension w f_t A, cohesion w c A) and pressed corners. A structure of rigid joints is nearly a linear problem: with a small
// penalty R the solver ends it in few iterations, and unfinished ones crack nothing.
//
// A rigid joint that opens or slips, by more than a dead zone, yields: the step is solved again with rows for its cohesive points and with
// the corners of a dry joint. With the largest opening d so far, b = (gap - d)/h, w = u + b and the damped tension g, a row obeys
//
//     -c_n <= p_n <= 0,    w = 0 where p_n is between, w <= 0 where p_n = 0, w >= 0 where p_n = -c_n
//     |p_t| <= c_t + mu g
//
// c_n and c_t are means over the step. With the strength S at its start, the opening e_n and the slip e_t by the mean of the velocities
// before and after it, and dx = f_t/G_I e_n + c/G_II e_t,
//
//     c_n = h A f_t S (1 - exp(-dx))/dx,    c_t = h A c S (1 - exp(-dx))/dx
//
// The damage of a step is the work of p_n and c_t over the fracture energies. A joint that yields and has not been damaged is rigid again
// when it is closed and its forces are within its strength.
//
// An instant (StepContext::instant) has no length, so that a traction gives no impulse, and a jump opens a joint in no time. Its rows are
// those of a step so long that what rests is held whatever it takes, while the velocities change at once: with u- after the jump, dx is
// large and
//
//     c_n = G_I A S/((u- + u+)/2),    c_t = G_II A S/(|u_t- + u_t+|/2)
//
// (less if the joint opens and slips). A point keeps its bond if the kinetic energy that it has to stop is below the fracture energy that
// is left of it, and else takes as much: the limit of the law of a step for a strength that grows without bound at the same fracture
// energy. What is stopped counts as damage too. A crack that opens or slips before the instant, or that has to open before it pulls, bears
// nothing at it: the next step stops it.
#include "dynamics/model/rigid_system.hpp"
#include "dynamics/wall/mortar_patch.hpp"
#include "dynamics/wall/step_context.hpp"
#include "dynamics/wall/tie_rows.hpp"

namespace masonry::wall {

// Rigid mortar bears the tension `pull` at a point of a lane, and its cohesion is as if it pressed more by `shift`, N s.
template <class K>
struct alignas(alignment) Strength {
	std::array<Lanes, lanePoints<K>> pull {}, shift {};

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(pull, shift);
	}
};

// By group; nullptr: no mortar.
template <class K>
const Strength<K>* firstOf(const Array<Strength<K>>* strength)
{
	return strength && !strength->empty() ? strength->data() : nullptr;
}

// An instant counts as a step of this length, s.
constexpr double timeOfInstant = 1 / std::numeric_limits<float>::epsilon();
inline double mortarTime(const StepContext& step) { return step.instant ? timeOfInstant : step.h; }

// These values are the same for all rows of a step.
struct RowStep {
	double h, fall, softness, minSoftness, relaxation, boundShare;
};

template <class K>
struct MortarRow {
	static constexpr int n = K::rows;
	using Values = std::array<double, n>; // along the normal and the tangents

	int joint, point;               // numbers in the system
	int group, lane;                // of its pair
	std::array<TieArms<K>, n> arms; // J
	double massN;                   // 1/(J M^-1 J^T) of the normal, kg
	double friction;
	double openingRate, slipRate;   // dx per opening and per slip, 1/m
	std::array<double, 2> strength; // tension and cohesion at the start of the step, N s
	double beyond;                  // gap - d, m
	double bias;                    // b, m/s
	Values before;                  // u before the step, at an instant after the jump of the base, m/s
	Values baseBefore;              // the part of the prescribed bodies in it, at an instant before their jump, m/s
	Values baseJump;                // their jump at an instant, m/s
	bool atInstant;
	double resistance {0};       // R, 1/kg
	std::array<double, 2> bound; // c_n, c_t, N s
	double tension;              // g, N s
	Values p, z, u;              // N s, m/s, m/s

	double wantedResistance(const RowStep& step) const; // R by load
	void toInstant(const LaneArray& velocity);          // after the jump of the base
	void start(const LaneArray& velocity);
	// The laws after a solve. Returns the largest velocity by which they are missed, m/s.
	double pass(const LaneArray& velocity, const RowStep& step);
	void push(const LaneArray& velocity, LaneArray& momentum) const;
	double opening(double h) const; // e_n, m
	double slip(double h) const;    // e_t, m
	// The energies of an instant, J: that of |p_t| without friction, and that of friction.
	double shearWork() const;
	double frictionWork() const;
	double jumpWork(double pull, bool slips) const; // of the prescribed bodies, beyond that on the mean of their velocities

	// As far as A needs it.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(joint, point, group, lane, arms, resistance);
	}

private:
	double slipBound() const { return std::max(0., bound[1] + friction * tension); }
	bool slides() const;
};

struct MortarWork {
	double crack {0}, friction {0}; // J
	double base {0};                // of the prescribed bodies, since cracks are stopped after their jump, J
};

template <class K>
class Mortar {
public:
	// Opening over G_I/f_t, or slip over G_II/c, from which on a rigid joint yields. Smaller: unfinished iterations let joints go; larger:
	// cracks begin late.
	static constexpr double deadZone = 0.02;

	// For a step: strengths of the rigid joints, and rows of those that yield. `before`: velocities before it, at an instant before the
	// jump of the base.
	void begin(const RigidSystem<K>& system, const ContactSet<K>& contacts, const LaneArray& before, const StepContext& step);
	// Rigid joints that the step opens by so many dead zones. `after`: velocities after it.
	std::vector<int> yielding(const RigidSystem<K>& system, const ContactSet<K>& contacts, const LaneArray& before, const LaneArray& after,
	                          double h, double least) const;
	// Rigid joints that have stopped more energy at an instant than a crack may spend unnoticed. `states`, `after`: impulses and
	// velocities.
	std::vector<int> strained(const RigidSystem<K>& system, const ContactSet<K>& contacts, const PointStates<K>& states,
	                          const LaneArray& after) const;
	void letGo(RigidSystem<K>& system, const ContactSet<K>& contacts, const std::vector<int>& joints, double h) const;
	// Damage of the step by its rows. `missed`: by which velocities may be wrong, m/s.
	MortarWork finish(RigidSystem<K>& system, ContactSet<K>& contacts, const std::vector<MortarRow<K>>& done, double h,
	                  double missed) const;
	// The same of an instant, where `states` are the impulses of the contacts.
	MortarWork finishInstant(RigidSystem<K>& system, const PointStates<K>& states, const std::vector<MortarRow<K>>& done,
	                         double missed) const;

	std::vector<MortarRow<K>> rows;
	Array<Strength<K>> strength; // by group; empty: no mortar

private:
	void find(const RigidSystem<K>& system, const ContactSet<K>& contacts);
	void addRows(const RigidSystem<K>& system, const ContactSet<K>& contacts, const LaneArray& before, int joint, const StepContext& step);
	double pullOf(const RigidSystem<K>& system, const PointStates<K>& states, const MortarRow<K>& row, double missed) const;
	void hold(const RigidSystem<K>& system, MortarJoint<K>& joint, const MortarCorners& corners, ContactSet<K>& contacts,
	          const std::vector<const MortarRow<K>*>& rows, double h) const;

	std::vector<MortarCorners> corners; // by joint; empty: its pair is not among the lanes
	Follower known;                     // the contacts that they are of
};

} // namespace masonry::wall
