#include "contact/friction_points.hpp"
#include "contact/features.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

namespace {

constexpr double line = 1e-6;                                                // sides whose squares are round-off of each other
constexpr double towardsSquare = 0.6, squareDirection = 0.78539816339744831; // rad
constexpr double roundOff = 1e-9;                                            // relative

// Integral of the distance from the origin over the triangle of the origin, p and q, and its area. With the line p q at the distance h from
// the origin and s along it from the foot of h, it is h/6 (s r + h^2 asinh(s/h)) between the ends.
Vector2 distanceAndArea(const Vector2& p, const Vector2& q)
{
	const double length = (q - p).norm(), twice = cross(p, q);
	if (!(length > 0))
		return Vector2::Zero();
	const double h = std::abs(twice) / length;
	const auto upTo = [&](const Vector2& end) {
		const double s = end.dot(q - p) / length;
		const double r = end.norm();
		return s * r + (h > 0 ? h * h * std::copysign(std::log((std::abs(s) + r) / h), s) : 0.); // the logarithm is asinh(s/h)
	};
	return {h / 6 * (upTo(q) - upTo(p)), h * length / 2};
}

// Mean distance of the patch from its centroid. Its corners come in any order.
double meanDistance(const PatchCorner* corners, int size, const Vector2& centroid)
{
	PerPoint<Vector2> around(size);
	for (int i = 0; i < size; ++i)
		around[i] = corners[i].position - centroid;
	const auto turn = [](const Vector2& p) { // grows with the angle, -2 to 2
		const double x = p.x() / std::max(std::abs(p.x()) + std::abs(p.y()), std::numeric_limits<double>::min());
		return p.y() < 0 ? x - 1 : 1 - x;
	};
	std::sort(around.begin(), around.end(), [&](const Vector2& p, const Vector2& q) { return turn(p) < turn(q); });
	Vector2 sum = Vector2::Zero();
	for (int i = 0; i < size; ++i)
		sum += distanceAndArea(around[i], around[(i + 1) % size]);
	return sum.y() > 0 ? sum.x() / sum.y() : 0;
}

} // namespace

void frictionOffsets(const PatchCorner* corners, int size, Vector2* offsets)
{
	Vector2 centroid = Vector2::Zero(), center = Vector2::Zero();
	double force = 0;
	for (int i = 0; i < size; ++i) {
		const PatchCorner& corner = corners[i];
		centroid += corner.share * corner.position;
		center += corner.force * corner.position;
		force += corner.force;
	}
	center = force > 0 ? Vector2(center / force) : centroid;
	const auto carries = [&](const PatchCorner& corner) { return corner.force > roundOff * force; };
	if (size < 3 || (force > 0 && std::count_if(corners, corners + size, carries) < 3)) { // an edge or a corner
		std::fill_n(offsets, size, Vector2(Vector2::Zero()));
		return;
	}

	Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
	double cornerDistance = 0; // mean
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = corners[i].position - centroid;
		moments += corners[i].share * arm * arm.transpose();
		cornerDistance += corners[i].share * arm.norm();
	}
	const double evenShare = cornerDistance > 0 ? meanDistance(corners, size, centroid) / cornerDistance : 0; // s0
	Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
	axes.computeDirect(moments);
	const double across = std::max(axes.eigenvalues()[0], 0.), along = axes.eigenvalues()[1]; // b^2 <= a^2
	const Vector2 eccentricity = center - centroid;
	Vector2 narrowing = Vector2::Zero(); // Q^-1 d
	for (int k = 0; k < 2; ++k)
		if (axes.eigenvalues()[k] > std::numeric_limits<double>::epsilon() * along)
			narrowing += axes.eigenvectors().col(k) * (axes.eigenvectors().col(k).dot(eccentricity) / axes.eigenvalues()[k]);

	const double thin = std::sqrt(across), broad = std::sqrt(along), corner = std::hypot(broad, thin); // b, a and D
	const double direction = std::atan2(thin, broad) + towardsSquare * (squareDirection - std::atan2(thin, broad));
	Eigen::Matrix2d spread = Eigen::Matrix2d::Identity();
	if (thin > line * broad)
		spread = corner * axes.eigenvectors() * Vector2(std::sin(direction) / thin, std::cos(direction) / broad).asDiagonal() *
		         axes.eigenvectors().transpose();
	double before = 0, after = 0; // sums of N_i times the distance from c
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = corners[i].position - center, narrow = arm - eccentricity * narrowing.dot(arm);
		const double weight = force > 0 ? corners[i].force : corners[i].share;
		offsets[i] = spread * narrow;
		before += weight * narrow.norm();
		after += weight * offsets[i].norm();
	}
	const double share = after > 0 ? evenShare * before / after : 0;
	for (int i = 0; i < size; ++i)
		offsets[i] = share * offsets[i] - (corners[i].position - center);
}

} // namespace masonry
