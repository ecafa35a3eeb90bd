#pragma once
// Joints: which contacts belong to one, and the part of a structure that an impact of one is solved on.
#include "dynamics/compliant/joint_system.hpp"

namespace masonry {

// All patches under one face of a block (joint_table.hpp). Head joints do not rock and are left out; joints in which some mortar is left
// do not rock either.
struct Joint {
	int block;
	Vector3 normal; // from the supports to the block
	std::vector<int> contacts;
	std::vector<PointRef> points;

	bool has(int contact) const;
};

std::vector<Joint> groupJoints(const JointSystem& system);

// Largest distance of the joint's points from the first of them, m.
double sizeOf(const JointSystem& system, const Joint& joint);

// Whether points of a joint are an edge or a corner, about which it rocks: all on one line, as against a face.
bool isPivot(const JointSystem& system, const Joint& joint, const std::vector<PointRef>& points);

// An impact of a joint is solved on the whole system while that has at most `small` contacts, else on
// the block, its neighbours and their contacts, with the bodies beyond them as its rim.
struct Neighbourhood {
	JointSystem system;
	Joint joint;                       // in its numbers
	std::vector<int> bodies, contacts; // its numbers -> those of the whole
};

Neighbourhood neighbourhood(const JointSystem& system, const Joint& joint, size_t small = 16);
void putBack(const Neighbourhood& part, JointSystem& system);

} // namespace masonry
