#pragma once
// Blocks and their compliant joints, as all stages of a step see them.
#include "dynamics/compliant/joint_contact.hpp"
#include "dynamics/model/tie.hpp"
#include "impact/rocking_restitution.hpp"
#include <algorithm>
#include <vector>

namespace masonry {

struct PointRef {
	int contact, point;
};

struct JointSystem {
	Bodies<Space> bodies;
	std::vector<JointContact> contacts; // sorted by body pair: the order of every sum
	std::vector<Tie<Space>> ties;
	Vector3 gravity {Vector3::Zero()};
	double dt {0};
	ImpactOrder order {ImpactOrder::simultaneous}; // sequential: the springs of the neighbours are the second stage
	// Bodies at the rim of a part cut out of a larger structure: they take impulses, but what else stands on them is not
	// here, so between impulses they keep their velocity (they are marked as prescribed). Empty: none.
	std::vector<int> rim;
	// Impulse problems since these were last set to zero: their largest residual (of accelerations: times dt, the velocity that they
	// are used for), m/s, and how many miss their laws by more than counts as zero.
	double residual {0};
	int unsolved {0};

	void note(double missedBy, bool solved)
	{
		residual = std::max(residual, missedBy);
		unsolved += !solved;
	}
	JointPoint& point(const PointRef& p) { return contacts[p.contact].points[p.point]; }
	const JointPoint& point(const PointRef& p) const { return contacts[p.contact].points[p.point]; }
	bool carries(const PointRef& p) const { return contacts[p.contact].springs[p.point] > 0; }
	Vector3 position(const PointRef& p) const { return contacts[p.contact].position(p.point); }
	double gap(const PointRef& p) const { return contacts[p.contact].patch.points[p.point].gap; }
	double gapRate(const PointRef& p) const // speed at which the gap opens, m/s
	{
		const JointContact& contact = contacts[p.contact];
		const Vector3 x = contact.position(p.point);
		return contact.patch.normal.dot(bodies[contact.body2].velocityAt(x) - bodies[contact.body1].velocityAt(x));
	}
};

struct ImpulseResponse {
	double work {0};       // of the moved bodies: their impulses, and the changed forces up to the end of the step, J
	double dissipated {0}; // by the plastic, frictional response, or by settling on new pivots (of either sign), J
};

// Whether `points` has this point of this contact.
template <class Points>
bool has(const Points& points, int contact, int point)
{
	return std::any_of(points.begin(), points.end(), [&](const auto& p) { return p.contact == contact && p.point == point; });
}

// Power of the prescribed bodies on the others, W.
double supportPower(const JointSystem& system);

// Energy stored in all joints, as of their last forces, J.
double storedEnergy(const JointSystem& system);

// Kinetic energy at the end of the step by the present forces, energy stored, and that of the loads, J.
double mechanicalEnergy(const JointSystem& system);

// Bodies have moved from the poses in `before` to their present ones: points, gaps and shears follow.
void moveContacts(JointSystem& system, const Bodies<Space>& before);

} // namespace masonry
