#pragma once
// The compliant joint between two blocks: springs, dashpots and Coulomb friction at the points of a contact patch.
//
// The joint has stiffness per area, normal k_n and shear k_s (N/m^3). Point i has the share w_i of the patch area A
// (sum w_i = 1), so the total stiffness k A does not depend on the number of points:
//
//     N_i = w_i max(0, r k_n A d_i + (1 - r) sum N_j),   d_i = -gap_i
//     T_i = -(k_s A w_i s_i + c_s w_i u_t,i),            |T_i| <= mu N_i
//
// s_i is the elastic tangential displacement, which slips as far as Coulomb's bound asks. Where corners meet corners the bound is mu N_i
// along their edge and tan(half angle + atan mu) N_i across it (contact/corner_patch.hpp). N_i acts at the point, and T_i at the point's
// share of an even friction (contact/friction_points.hpp), where s_i and u_t,i are measured too: wherever it moves to, the power of T_i is
// that of its spring, dashpot and slip. A muted point carries no force (see pivot_handoff.hpp).
//
// Turn of a face. Springs at the corners would be too stiff: the pressure k_n d(x) of a closed face has the moment k_n J about an axis
// through the centroid, J the second moment of the area, and springs k_n A w_i at the corners have k_n A sum w_i a_i^2. Of a rectangle that
// is three times as much. With r = J / (A sum w_i a_i^2), both polar, the forces above have the sum k_n A d of the pressure, d = sum w_i
// d_i, and its moment: those of springs r k_n A w_i at the corners and (1 - r) k_n A at the centroid, whose force the corners bear by their
// shares. r is 1/3 of a rectangle, 1/4 of a triangle, 1 of an edge or a corner.
//
// Opening. The forces are those of a compliance, d_i = (N_i / w_i - (1 - r) sum N_j) / (r k_n A), with N_i >= 0: springs that store
// sum N_i d_i / 2 and give all of it back, whichever points open. A point carries until the rest of the face has lifted it beyond its own
// gap. Where the points with the share w of the face carry alone, sum N_j = r k_n A sum w_j d_j / (1 - (1 - r) w): the edge of a rectangle
// has a quarter of the stiffness of its face. Under the constant force N a rectangle of the width b turns in proportion to the moment, up
// to N b/2 at the turn 6 d/b; then it rocks about its edge, which is pressed in by 4 d. A pressure without tension would open from N b/6 on
// and come to N b/2 in the end: between, the turn is up to 1.6 times as stiff.
//
// Dashpots. They see the points that carry, in the same way, with c_n = 2 zeta sqrt(k_n A m) in the place of k_n A, m the reduced mass of
// the pair; c_s = 2 zeta sqrt(k_s A m). No joint pulls by them.
#include "contact/corner_patch.hpp"
#include "contact/friction_points.hpp"
#include "impact/rigid_body.hpp"
#include <memory>

namespace masonry {

struct JointLaw {
	double normalStiffness {0}; // N/m^3
	double shearStiffness {0};  // N/m^3
	double dampingRatio {0};    // zeta, of the contact springs
	double friction {0};        // mu, or noSlip
	double restitution {0};     // C in [0, 1], or NaN: natural
	bool hasMortar {false};     // it is to be bonded, in the first step or in this one
};

struct JointPoint {
	Feature feature;
	bool muted {false};
	Vector3 shear {Vector3::Zero()};      // s_i, of body 2 relative to body 1, m
	double normalForce {0};               // N_i on body 2 along the normal, N
	Vector3 shearForce {Vector3::Zero()}; // T_i on body 2, N
	Vector3 grip {Vector3::Zero()};       // from the point to where T_i acts, in the plane of the joint, m
	Vector3 place {Vector3::Zero()};      // of the point in the last patch, global, m
};

struct JointEnergy {
	double elastic {0};  // stored now, J
	double taken {0};    // work of the bodies on the springs in this step, J: elastic energy that changes otherwise is made or lost
	double friction {0}; // dissipated in this step, J
	double damping {0};  // dissipated in this step, J
	double crack {0};    // spent by cracks of mortar in this step, J
};

struct MortarBond;

// The forces of the mortar of a joint on body 2, on body 1 the opposite.
struct BondLoad {
	Vector3 place {Vector3::Zero()};                           // global, m
	Vector3 force {Vector3::Zero()}, moment {Vector3::Zero()}; // N; about the place, N m
};

using PointValues = PerPoint<double>;

struct JointContact {
	int body1 {-1}, body2 {-1};
	bool isUpright {false}; // when the pair was found (joint_table.hpp)
	ContactPatch patch;
	CornerNormals corner;
	JointLaw law;
	PerPoint<JointPoint> points; // parallel to patch.points
	JointEnergy energy;
	// Forces of the last step at points that the present patch has no more, less those that points without a past have taken over.
	PerPoint<JointPoint> replaced;
	double turnShare {1}; // r of the present patch
	PointValues springs;  // N_i of the springs at the present gaps, of the points that are not muted, N
	// Mortar (mortar_bond.hpp); none: a dry joint. Copies of a contact share it.
	std::shared_ptr<MortarBond> bond;
	BondLoad load; // of the bond in the last step

	int size() const { return int(points.size()); }
	double stiffnessArea() const;                                                    // m^2, what the stiffness per area is multiplied with
	double normalStiffness() const { return law.normalStiffness * stiffnessArea(); } // of the closed face, N/m
	double shearStiffness(int i) const { return law.shearStiffness * stiffnessArea() * patch.points[i].weight; }
	// A face of the stiffness k gives its points `among` w_i (r k x_i + (1 - r) sum), and the others zero.
	PointValues shared(double k, const PointValues& x, const PerPoint<bool>& among) const;
	PointValues springForces(const PointValues& depths) const; // N_i at these depths (m), N
	// d_i at which the springs bear these forces, m; 0 where they vanish. Points without weight bear none.
	PointValues depthsFor(const PointValues& forces) const;
	double normalEnergy() const;             // stored by the normal springs now, J
	double dampingNormal(double mass) const; // c_n of a pair of that reduced mass, N s/m
	double dampingShear(double mass) const;
	Vector3 position(int i) const { return 0.5 * (patch.points[i].position1 + patch.points[i].position2); }
	// How a turn (or spin) moves the friction point across the normal, relative to the point.
	Vector3 gripMotion(int i, const Vector3& turn) const { return patch.normal.dot(turn) * patch.normal.cross(points[i].grip); }
	// The bond has this moment about `center` on body 2, N m, and this power on points of a body, W.
	Vector3 bondMoment(const Vector3& center) const { return load.moment + (load.place - center).cross(load.force); }
	double bondPower(const RigidBody<Space>& body) const
	{
		return load.force.dot(body.velocityAt(load.place)) + load.moment.dot(body.spin());
	}
	Vector3 force(int i) const { return points[i].normalForce * patch.normal + points[i].shearForce; } // on body 2
	Vector3 moment(int i, const Vector3& center) const;                                                // of the same, about `center`
	double power(int i, const RigidBody<Space>& body) const;                                           // of the same, on points of the body
	// From the points to where their friction acts if their normal forces are these, m.
	PerPoint<Vector3> gripsFor(const PointValues& forces) const;
	bool rocking() const; // some point is muted
	bool isBonded() const { return bond && isSound(*bond); }

private:
	static bool isSound(const MortarBond& bond); // some of its mortar is left
};

// 0 where neither body is free, kg
double reducedMass(const RigidBody<Space>& body1, const RigidBody<Space>& body2);

// Carries the points' state over to a new patch, by their features. A point without a past is muted when the joint rocks.
void renewPatch(JointContact& contact, const ContactPatch& patch);

// Finds r and the springs anew where points of the present patch have moved.
void followPatch(JointContact& contact);

// Finds the springs anew where points have been muted, or are muted no longer.
void updateSprings(JointContact& contact);

// Forces and energies after a step dt that ended in the present patch, velocities those of that step. In a bonded joint the fibres of the
// mortar have the friction too.
void updateForces(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt);

// Forces and stored energy of the present gaps and shears, nothing moved (after a hand-off has set them). Springs slip to what the
// normal forces allow.
void holdForces(JointContact& contact);

// Gives the points that carry this elastic displacement, as far as friction allows, and the others none. Returns the energy of the shear
// springs, J.
double restartShear(JointContact& contact, const Vector3& shear);

// No forces, and no energy of this step.
void releaseForces(JointContact& contact);

} // namespace masonry
