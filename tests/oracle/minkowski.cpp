#include "oracle/minkowski.hpp"
#include <vector>

namespace oracle {

namespace {

std::vector<Vector3> corners(const Box& box, const Pose& pose)
{
	std::vector<Vector3> all;
	for (double x : {-1., 1.})
		for (double y : {-1., 1.})
			for (double z : {-1., 1.})
				all.push_back(pose.toGlobal(Vector3(x, y, z).cwiseProduct(box.halfSize)));
	return all;
}

} // namespace

Separation separation(const Box& box1, const Pose& pose1, const Box& box2, const Pose& pose2)
{
	std::vector<Vector3> differences;
	for (const auto& a : corners(box1, pose1))
		for (const auto& b : corners(box2, pose2))
			differences.push_back(b - a);
	const double size = box1.halfSize.norm() + box2.halfSize.norm();
	Separation best;
	for (size_t i = 0; i < differences.size(); ++i)
		for (size_t j = 0; j < i; ++j)
			for (size_t k = 0; k < j; ++k) {
				Vector3 normal = (differences[j] - differences[i]).cross(differences[k] - differences[i]);
				if (normal.norm() < 1e-9 * size * size)
					continue;
				normal.normalize();
				for (const Vector3& inward : {normal, Vector3(-normal)}) {
					const double level = inward.dot(differences[i]);
					bool isHull = level > best.value;
					for (size_t l = 0; isHull && l < differences.size(); ++l)
						isHull = inward.dot(differences[l]) >= level - 1e-12 * size;
					if (isHull)
						best = {level, inward};
				}
			}
	return best;
}

} // namespace oracle
