#include "shape/mass_properties.hpp"
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include "validation.hpp"
#include <cmath>

namespace masonry {

// The sum over the tetrahedra between an inner point r and the triangles a b c of the faces. With a, b, c from r, a tetrahedron has the
// volume V = a.(b x c)/6, the centroid s/4 and the second moments V/20 (a a^T + b b^T + c c^T + s s^T) about r, s = a + b + c.
MassProperties ConvexPolyhedron::massProperties(double density) const
{
	requirePositive("density", density);
	Vector3 inner = Vector3::Zero();
	for (const Vector3& point : points)
		inner += point / static_cast<double>(points.size());
	double volume = 0;
	Vector3 first = Vector3::Zero();
	Matrix3 second = Matrix3::Zero();
	for (const Face& face : planes)
		for (std::size_t k = 2; k < face.loop.size(); ++k) {
			const Vector3 a = points[face.loop[0]] - inner, b = points[face.loop[k - 1]] - inner, c = points[face.loop[k]] - inner;
			const Vector3 sum = a + b + c;
			const double part = a.dot(b.cross(c)) / 6;
			volume += part;
			first += part / 4 * sum;
			second += part / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
		}
	const Vector3 fromInner = first / volume;
	second -= volume * fromInner * fromInner.transpose();
	return {density * volume, inner + fromInner, density * (second.trace() * Matrix3::Identity() - second)};
}

// Jacobi's method: a turn about one axis takes the product of the other two away. Each turn is by 45 degrees at most.
Quaternion MassProperties::principalAxes() const
{
	constexpr int maxTurns = 60;
	Quaternion axes = Quaternion::Identity();
	Matrix3 moments = inertia;
	const double scale = inertia.trace();
	for (int turns = 0; turns < maxTurns; ++turns) {
		int about = -1;
		double largest = tolerance::shape::product * scale;
		for (int k = 0; k < 3; ++k) {
			const int i = (k + 1) % 3, j = (k + 2) % 3;
			const double product = std::abs(moments(i, j));
			const double apart = std::max(product, std::abs(moments(i, i) - moments(j, j)));
			if (product > largest && apart > tolerance::shape::equalMoments * scale) {
				largest = product;
				about = k;
			}
		}
		if (about < 0)
			break;
		const int i = (about + 1) % 3, j = (about + 2) % 3;
		const double difference = moments(i, i) - moments(j, j);
		const double angle = std::atan2(2 * moments(i, j), std::abs(difference)) / 2 * (difference < 0 ? -1 : 1);
		axes = (axes * Quaternion(Eigen::AngleAxisd(angle, Vector3::Unit(about)))).normalized();
		const Matrix3 turn = axes.toRotationMatrix();
		moments = turn.transpose() * inertia * turn;
	}
	return axes;
}

PlacedPolyhedron inPrincipalAxes(const ConvexPolyhedron& shape)
{
	if (shape.isBox())
		return {shape, {}};
	const MassProperties mass = shape.massProperties(1);
	const Pose pose {mass.center, mass.principalAxes()};
	std::vector<Vector3> points;
	for (const Vector3& point : shape.vertices())
		points.push_back(pose.toLocal(point));
	return {ConvexPolyhedron::hull(std::move(points)), pose};
}

} // namespace masonry
