#pragma once
// The step of a wall that stands still: all contact laws at once, by the method of multipliers (ADMM) with one factorisation that is
// kept as long as the same points touch.
//
// Unknown are the velocities V at the end of the step, moved with (q+ = q + h V+), the impulses p and the relative velocities z that the
// laws allow. With w = J V - b, R = r / (J M^-1 J^T) of each point and A = M + J^T J / R over all points that touch, whatever their state,
//
//     V += A^-1 [ M (V_free - V) + J^T (p + (z - w)/R) ]
//     y  = p - (1.6 w - 0.6 z)/R
//     p  = the impulse nearest to y with |p_t| <= mu p_n
//     z  = (p - y) R
//
// until w = z. Nothing in A depends on which points stick, slide or part: states may chatter and A stays. Only residuals are corrected,
// so that A may be of slightly other positions.
//
// That p makes the problem convex: the iteration goes towards impulses with which a wall stands where there are any. What slides by this
// law also lifts, by mu times as much: but a step in which blocks move is not done in this mode.
//
// b_n = -gap/h (an open point may close), b_t = 0; but of what a few iterations have left, a penetration or a slip x, a share g is taken
// back in each step, b = -g x/h, so that it does not add up. Penetrations that were there when the wall came to rest stay: pushed out, they
// would wedge blocks against friction.
//
// That is done only while the loads change with the motion of the base (`stirred`): nothing adds up else, and it drives what gives way. Of
// a mode in which J^T J/R is k times the inertia, one solve a step makes for small k, per step,
//
//     V' = p - k (V + g x)      p' = -1.6 k (V + g x)      x' = V      s^3 + k s^2 + k (1.6 + g) s + 1.6 k g = 0
//
// which grows where k (1.6 + g) < 1.6 g. After a wall has been shaken, blocks that stand on points near each other have such modes: taken
// back from at rest, walls shivered at 1e-4 m/s and set off again after seconds.
#include "dynamics/wall/wall_contacts.hpp"
#include "linalg/block_ldlt.hpp"

namespace masonry::rigid::wall {

struct KeptReport {
	int solves {0}, factorisations {0};
	double velocity {0}; // largest |J V - b - z|, m/s
	double force {0};    // largest error of an impulse, as the velocity that it gives its point, m/s
	double motion {0};   // largest relative velocity of a point, in touch or open, m/s
};

// 1/R
template <class K>
MASONRY_INLINE Lanes stiffnessOf(const PointLanes<K>& p, double softness)
{
	return p.massN * p.massT / ((p.massN + p.massT) * (0.5 * softness));
}

template <class K>
class KeptFactor {
public:
	// r; 0: small enough for corrections to cross all courses in some solves.
	explicit KeptFactor(double softness = 0) : given(softness) {}

	using Tangent = typename PointLanes<K>::Tangent;
	struct alignas(alignment) Row { // of a point
		Lanes bn;
		Lanes resistance, stiffness; // R and 1/R; zero: does not touch
		Lanes perMass;               // 1 / p.massN
		Lanes un;                    // J V, m/s
		Tangent ut;
	};
	using Rows = std::array<Row, lanePoints<K>>;
	struct alignas(alignment) Before { // what a step that is given up finds again
		Lanes pn;
		Tangent pt;
		Lanes zn;
		Tangent zt;
	};
	using Befores = std::array<Before, lanePoints<K>>;

	// These pairs have moved since the last step in this mode, and hold what they find.
	static void forget(WallContacts<K>& contacts, const LaneBits& lanes);
	// Starts a step from the contacts' velocities; `load` is the change of velocity by external forces, per body; `stirred`, 0 to 1: of
	// the share that is taken back.
	void begin(WallContacts<K>& contacts, const LaneArray& load, double h, double stirred);
	// There are other points here than before.
	void outdate(const WallContacts<K>& here) { outdated |= contacts == &here; }
	// Pairs are in other lanes here than before, and some may have come or gone. Without those that have gone the factor stays, a block for
	// each structure, until they are most of it.
	void follow(const WallContacts<K>& here);
	// Solves until both residuals are at most theirs, at most `most` times. May be called again to go on.
	void iterate(int most, double velocityResidual, double forceResidual);
	// Largest velocity, m/s, that the iterations have kept from a point since it parts or slides, this step included. Few iterations find
	// impulses that let go at once, but velocities that follow slowly, by r each: a wall would stick to the state of rest for many steps.
	double findHeld();
	// Pairs that miss the laws by more than `residual`, or move by more than `motion`, m/s.
	LaneBits unsolved(double residual, double motion) const;
	// Pairs with a point that has been kept from more than `held`, m/s.
	LaneBits held(double held) const;
	// Pairs with a point that was kept from at least `held` and goes faster than `speed` the way it was kept from, m/s.
	LaneBits gone(double held, double speed) const;
	void forgetHeld(const LaneBits& lanes);
	// What these pairs have been kept from in the steps before this one, into the contacts' velocities.
	void giveHeld(const LaneBits& lanes);
	// Of the step that ends, in which gaps have moved. Returns what friction has taken, J. `fall` is what gravity gives in a step, m/s.
	double keepSlip(double fall);
	// What the next step starts from, where there has been an impact, or `always`. An impact gives some point more than what it had, and
	// more than the courses upon it weigh.
	void handOn(double fall, bool always);
	// Impulses as they were at the beginning, of all pairs or of these, which then have not moved in this step.
	void giveUp();
	void giveUp(const LaneBits& lanes);

	KeptReport report;
	LaneArray velocity;     // V
	std::vector<Rows> rows; // by group

	// As of the contacts, whose own numbers have been passed. A factor is made anew from the poses that it was of.
	template <class Flow>
	void pass(Flow& f, WallContacts<K>* sets, RigidSystem<K>& system)
	{
		int set = contacts == &sets[1];
		f(set);
		contacts = &sets[set];
		size_t count = rows.size();
		f(outdated), f(softness), f(count);
		rows.resize(count);
		Touches touches(count);
		for (size_t g = 0; g < count; ++g)
			for (int k = 0; k < lanePoints<K>; ++k)
				for (int i = 0; i < width; ++i) {
					bool touch = rows[g][k].stiffness[i] > 0;
					f(touch);
					touches[g][k][i] = touch ? -1 : 0;
				}
		const bool isNew = factored.empty();
		count = factored.size();
		f(count);
		factored.resize(count);
		for (auto& pose : factored)
			passPose(f, pose);
		size_t known = nodes;
		f(known);
		if (isNew && count > 0)
			refactorise(system, touches);
		nodes = known;
	}

private:
	using Touches = std::vector<std::array<Mask, lanePoints<K>>>; // which points touch, by group

	bool takeSoftness();
	using Block = linalg::BlockLDLT::Block;
	void factorise();
	void setGraph();
	void addPair(int group, int lane, int& edge);
	void refactorise(RigidSystem<K>& system, const Touches& touches);
	template <class Mark>
	LaneBits where(const Mark& mark) const;

	WallContacts<K>* contacts {nullptr};
	linalg::BlockLDLT factor; // a node for each pack of the bodies here
	std::vector<int> places;  // of the nodes
	std::vector<int> node;    // of a body, its first; -1: none
	size_t nodes {0};         // of the factor, those of bodies that have gone included
	std::vector<linalg::BlockLDLT::Edge> edges;
	LaneArray free, force;
	std::vector<Befores> before; // by group
	LaneArray mostHeld;          // by group, as findHeld() last found it
	const double given;
	double h {0}, softness {0}, backPerSecond {0};
	bool outdated {true};
	bool hit {false};                       // a point, by an impact in the last step
	std::vector<typename K::Pose> factored; // poses that the factor is of
};

} // namespace masonry::rigid::wall
