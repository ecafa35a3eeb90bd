#include "shape/union_of_parts.hpp"

namespace masonry {

// The inertia about the common centre by Steiner's theorem: I = sum (I_k + m_k (d.d 1 - d d^T)), d from the common centre to that of part
// k.
MassProperties massProperties(const std::vector<ConvexPolyhedron>& parts, double density)
{
	std::vector<MassProperties> own;
	MassProperties all {0, Vector3::Zero(), Matrix3::Zero()};
	for (const ConvexPolyhedron& part : parts) {
		own.push_back(part.massProperties(density));
		all.mass += own.back().mass;
		all.center += own.back().mass * own.back().center;
	}
	all.center /= all.mass;
	for (const MassProperties& part : own) {
		const Vector3 arm = part.center - all.center;
		all.inertia += part.inertia + part.mass * (arm.squaredNorm() * Matrix3::Identity() - arm * arm.transpose());
	}
	return all;
}

PlacedUnion inPrincipalAxes(const std::vector<ConvexPolyhedron>& parts)
{
	const MassProperties mass = massProperties(parts, 1);
	PlacedUnion placed {{}, {mass.center, mass.principalAxes()}};
	for (const ConvexPolyhedron& part : parts) {
		std::vector<Vector3> points;
		for (const Vector3& point : part.vertices())
			points.push_back(placed.pose.toLocal(point));
		placed.parts.push_back(ConvexPolyhedron::hull(std::move(points)));
	}
	return placed;
}

} // namespace masonry
