#include "contact/friction_points.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

double meanOverCornerDistance(double ratio)
{
	constexpr double line = 1e-6; // the terms left out are of the order of its square
	if (ratio < line)
		return 0.5;
	return 1. / 3 + (std::asinh(ratio) / ratio + ratio * ratio * std::asinh(1 / ratio)) / (6 * std::sqrt(1 + ratio * ratio));
}

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
	constexpr double roundOff = 1e-9;
	const auto carries = [&](const PatchCorner& corner) { return corner.force > roundOff * force; };
	if (size < 3 || (force > 0 && std::count_if(corners, corners + size, carries) < 3)) { // an edge or a corner
		std::fill_n(offsets, size, Vector2(Vector2::Zero()));
		return;
	}

	Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = corners[i].position - centroid;
		moments += corners[i].share * arm * arm.transpose();
	}
	Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
	axes.computeDirect(moments);
	const double across = std::max(axes.eigenvalues()[0], 0.), along = axes.eigenvalues()[1]; // b^2 <= a^2
	const Vector2 eccentricity = center - centroid;
	Vector2 narrowing = Vector2::Zero(); // Q^-1 d
	for (int k = 0; k < 2; ++k)
		if (axes.eigenvalues()[k] > std::numeric_limits<double>::epsilon() * along)
			narrowing += axes.eigenvectors().col(k) * (axes.eigenvectors().col(k).dot(eccentricity) / axes.eigenvalues()[k]);

	const double share = along > 0 ? meanOverCornerDistance(std::sqrt(across / along)) : 0;
	for (int i = 0; i < size; ++i) {
		const Vector2 arm = corners[i].position - center;
		offsets[i] = share * (arm - eccentricity * narrowing.dot(arm)) - arm;
	}
}

} // namespace masonry
