#pragma once
// The compliant joint between two blocks: springs, dashpots and Coulomb friction at the points of a contact patch.
//
// The joint has stiffness per area, normal k_n and shear k_s (N/m^3). Point i has the share w_i of the patch area A
// (sum w_i = 1), so the total stiffness k A does not depend on the number of points:
//
//     N_i = max(0, k_n A w_i d_i + c_n w_i d_i'),   d_i = -gap_i,   N_i = 0 when d_i <= 0
//     T_i = -(k_s A w_i s_i + c_s w_i u_t,i),       |T_i| <= mu N_i
//
// s_i is the elastic tangential displacement, which slips as far as Coulomb's bound asks; c = 2 zeta sqrt(k A m) with m the
// reduced mass of the pair. Where corners meet corners the bound is mu N_i along their edge and tan(half angle + atan mu) N_i across it
// (contact/corner_patch.hpp). N_i acts at the point, and T_i at the point's share of an even friction (contact/friction_points.hpp), where
// s_i and u_t,i are measured too: wherever it moves to, the power of T_i is that of its spring, dashpot and slip. A muted point carries no
// force (see pivot_handoff.hpp).
#include "body.hpp"
#include "contact/corner_patch.hpp"
#include "contact/friction_points.hpp"

namespace masonry {

struct JointLaw {
	double normalStiffness {0}; // N/m^3
	double shearStiffness {0};  // N/m^3
	double dampingRatio {0};    // zeta, of the contact springs
	double friction {0};        // mu, or noSlip
	double restitution {0};     // C in [0, 1], or NaN: natural
};

struct JointPoint {
	int identity {-1};
	bool muted {false};
	Vector3 shear {Vector3::Zero()};      // s_i, of body 2 relative to body 1, m
	double normalForce {0};               // N_i on body 2 along the normal, N
	Vector3 shearForce {Vector3::Zero()}; // T_i on body 2, N
	Vector3 grip {Vector3::Zero()};       // from the point to where T_i acts, in the plane of the joint, m
};

struct JointEnergy {
	double elastic {0};  // stored now, J
	double taken {0};    // work of the bodies on the springs in this step, J: elastic energy that changes otherwise is made or lost
	double friction {0}; // dissipated in this step, J
	double damping {0};  // dissipated in this step, J
};

struct JointContact {
	int body1 {-1}, body2 {-1};
	ContactPatch patch;
	CornerNormals corner;
	JointLaw law;
	int size {0};
	std::array<JointPoint, 8> points; // parallel to patch.points
	JointEnergy energy;

	double stiffnessArea() const; // m^2, what the stiffness per area is multiplied with
	double normalStiffness(int i) const { return law.normalStiffness * stiffnessArea() * patch.points[i].weight; }
	double shearStiffness(int i) const { return law.shearStiffness * stiffnessArea() * patch.points[i].weight; }
	double dampingNormal(double mass) const; // c_n of a pair of that reduced mass, N s/m
	double dampingShear(double mass) const;
	Vector3 position(int i) const { return 0.5 * (patch.points[i].position1 + patch.points[i].position2); }
	// How a turn (or spin) moves the friction point across the normal, relative to the point.
	Vector3 gripMotion(int i, const Vector3& turn) const { return patch.normal.dot(turn) * patch.normal.cross(points[i].grip); }
	Vector3 force(int i) const { return points[i].normalForce * patch.normal + points[i].shearForce; } // on body 2
	Vector3 moment(int i, const Vector3& center) const;                                                // of the same, about `center`
	double power(int i, const Body& body) const;                                                       // of the same, on points of the body
	// From the points to where their friction acts if their normal forces are these, m.
	std::array<Vector3, maxFrictionPoints> gripsFor(const std::array<double, maxFrictionPoints>& forces) const;
	bool rocking() const; // some point is muted
};

// 0 where neither body is free, kg
double reducedMass(const Body& body1, const Body& body2);

// Carries the points' state over to a new patch, by identity. A point without a past is muted when the joint rocks.
void renewPatch(JointContact& contact, const ContactPatch& patch);

// Forces and energies after a step dt that ended in the present patch, velocities those of that step.
void updateForces(JointContact& contact, const Body& body1, const Body& body2, double dt);

// Forces and stored energy of the present gaps and shears, nothing moved (after a hand-off has set them). Springs slip to what the
// normal forces allow.
void holdForces(JointContact& contact);

} // namespace masonry
