#pragma once
// The step of a wall that stands still: all contact laws at once, by the method of multipliers (ADMM) with one factorisation that is
// kept as long as the same points touch.
//
// Unknown are the velocities V at the end of the step, moved with (q+ = q + h V+), the impulses p and the relative velocities z that the
// laws allow. With w = J V - b, R = r / (J M^-1 J^T) of each point and A = M + J^T J / R over all points that touch, whatever their state,
//
//     V += A^-1 [ M (V_free - V) + J^T (p + (z - w)/R) ]
//     y  = p - (1.6 w - 0.6 z)/R
//     p  = clip(y): normal part on p_n >= 0, then tangential part on |p_t| <= mu p_n
//     z  = (p - y) R
//
// until w = z. Nothing in A depends on which points stick, slide or part: states may chatter and A stays. Only residuals are corrected,
// so that A may be of slightly other positions.
//
// b_n = -gap/h (an open point may close), b_t = 0; but of what a few iterations have left, a penetration or a slip, a share is taken back
// in each step, so that it does not add up. Penetrations that were there when the wall came to rest stay: pushed out, they would wedge
// blocks against friction.
#include "dynamics/wall/symmetric_factor.hpp"
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::wall {

struct KeptReport {
	int solves {0}, factorisations {0};
	double velocity {0}; // largest |J V - b - z|, m/s
	double force {0};    // largest error of an impulse, as the velocity that it gives its point, m/s
	double motion {0};   // largest relative velocity of a point, in touch or open, m/s
};

template <class K>
class KeptFactor {
public:
	using Tangent = typename PointLanes<K>::Tangent;
	struct alignas(alignment) Row { // of a point
		Lanes bn;
		Tangent bt;
		Lanes resistance, stiffness; // R and 1/R; zero: does not touch
		Lanes un;                    // J V, m/s
		Tangent ut;
	};
	using Rows = std::array<Row, lanePoints<K>>;

	// The wall has moved since the last step in this mode, and holds what it finds.
	static void forget(WallContacts<K>& contacts);
	// Starts a step from the contacts' velocities; `load` is the change of velocity by external forces, per body.
	void begin(WallContacts<K>& contacts, const LaneArray& load, double h, bool newPoints);
	// Solves until both residuals are at most theirs, at most `most` times. May be called again to go on.
	void iterate(int most, double velocityResidual, double forceResidual);
	void keepSlip(); // of the step that ends
	void giveUp();   // impulses as they were at the beginning

	KeptReport report;
	LaneArray velocity;     // V
	std::vector<Rows> rows; // by group
	size_t factorBlocks() const { return factor.blocks(); }

private:
	bool takeRows(bool newPoints);
	void factorise();

	struct alignas(alignment) Before {
		Lanes pn;
		Tangent pt;
		Lanes zn;
		Tangent zt;
	};

	WallContacts<K>* contacts {nullptr};
	SymmetricFactor factor; // a node for each pack
	std::vector<SymmetricFactor::Edge> edges;
	LaneArray free, force;
	std::vector<std::array<Before, lanePoints<K>>> before; // by group
	double h {0}, softness {0};
};

} // namespace masonry::rigid::wall
