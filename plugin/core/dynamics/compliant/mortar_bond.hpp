#pragma once
// The mortar of a compliant joint: fibres that carry tension and cohesion where the corners of the patch carry compression.
//
// The patch in which a joint is bonded is divided into at most 4 x 4 cells. Each has a fibre at its centroid, of the area of the cell: a
// point of either body that stays where it is on its body, whatever the patch does afterwards. The opening and the displacement between its
// two points follow the law of mortar (laws/mortar_law.hpp). Forces of compression act at the corners as in a dry joint
// (joint_contact.hpp), so that a joint that opens turns about its edge: a section of depth h and width b then bears f_t b h^2/2 if it is
// stiff. Cohesion and friction act at the fibres together. A fibre has the share of the compression that a linear pressure with the
// resultant of the corners gives to it.
//
// Four fibres a direction: with the corners they bear the moments of a continuous bed within 3 % (docs/mortar.md).
//
// Dashpots act where mortar is elastic, as those of the dry joint, up to its strength. When the last fibre breaks the joint is dry: its
// corners take over the mean displacement of the fibres, as far as friction lets them.
#include "dynamics/compliant/joint_system.hpp"
#include "laws/mortar_law.hpp"
#include <vector>

namespace masonry {

struct MortarFibre {
	Vector3 place1, place2;          // on the bodies, in their axes, m
	Vector2 place {Vector2::Zero()}; // from the centroid of the fibres, along the tangents, m
	double area {0};                 // m^2
	double rest {0};                 // opening without tension, m
	Vector2 shift {Vector2::Zero()}; // added to the displacement across, m
	MortarPoint point;
	MortarTraction now;                    // with dashpots, of the last step
	double spring {0};                     // of that: without dashpots, Pa
	Vector2 shearSpring {Vector2::Zero()}; // the same

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(place1, place2, place, area, rest, shift, point, now.pull, now.shear, spring, shearSpring);
	}
};

struct MortarBond {
	MortarLaw law;
	Vector3 normal1, tangent1;                        // in the axes of body 1; the normal from body 1 to body 2
	Vector3 normal2, tangent2;                        // the same directions in the axes of body 2
	double area {0};                                  // m^2
	Eigen::Matrix2d spread {Eigen::Matrix2d::Zero()}; // inverse of the second moments of the fibres' areas over the area, 1/m^2
	std::vector<MortarFibre> fibres;
	bool isBroken {false}; // no fibre is left: the joint is dry

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(law, normal1, tangent1, normal2, tangent2, area, spread, fibres, isBroken);
	}
};

// The state of a joint that dem.damage() returns.
struct MortarState {
	double damage {0}, worst {0};   // mean over the area, largest
	double byTension {0};           // share of the spent fracture energies that cracks in tension have
	double opening {0}, slip {0};   // largest opening of a crack, and path of slip, m
	double opened {0}, sheared {0}; // energies spent so far, J
};
MortarState stateOf(const MortarBond& bond);

// Bonds the joint as it is now, without tension: contact.bond. The fibres take over the shear of the corners.
void makeBond(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, const MortarLaw& law);

// Forces and energies of the fibres after a step dt that ended in the present poses; those of the corners are up to date.
void updateBond(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt);

// While it lives the bonded joints of a system are no joints: their forces are loads of their bodies. Impacts and jumps of the base act at
// one instant, in which the springs of mortar do not move; it feels them in the steps that follow.
class MortarAside {
public:
	explicit MortarAside(JointSystem& system);
	~MortarAside();

private:
	void addLoads(double sign);

	JointSystem& system;
	std::vector<std::pair<size_t, JointContact>> aside;
};

} // namespace masonry
