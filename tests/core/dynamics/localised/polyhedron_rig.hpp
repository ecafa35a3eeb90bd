#pragma once
// Blocks that are no boxes in space, for the tests.
#include "core/dynamics/localised/space_rig.hpp"

namespace rig {

// The hull of these points, turned by `orientation` about the origin of its axes, which is then at `place`.
inline int addPolyhedron(System& s, const std::vector<Vector3>& points, const Vector3& place = Vector3::Zero(),
                         const Quaternion& orientation = Quaternion::Identity())
{
	const ConvexPolyhedron hull = ConvexPolyhedron::hull(points);
	const PlacedPolyhedron block = inPrincipalAxes(hull);
	const MassProperties mass = block.shape.massProperties(density);
	RigidBody<Space> body;
	body.shape = std::make_shared<const Solid<ConvexPolyhedron>>(block.shape);
	body.mass = mass.mass;
	body.inertia = mass.inertia.diagonal();
	body.pose.position = place + orientation * block.pose.position;
	body.pose.orientation = orientation * block.pose.orientation;
	body.force.head<3>() = body.mass * s.gravity;
	s.bodies.push_back(body);
	return int(s.bodies.size()) - 1;
}

// A regular polygon about the origin with a corner on the x axis, m.
inline std::vector<Vector2> regular(int sides, double radius)
{
	std::vector<Vector2> points;
	for (int k = 0; k < sides; ++k)
		points.emplace_back(radius * std::cos(2 * M_PI * k / sides), radius * std::sin(2 * M_PI * k / sides));
	return points;
}

// The corners of an upright prism on z = 0.
inline std::vector<Vector3> prism(const std::vector<Vector2>& base, double height)
{
	std::vector<Vector3> points;
	for (const Vector2& p : base)
		for (const double z : {0., height})
			points.emplace_back(p.x(), p.y(), z);
	return points;
}

} // namespace rig
