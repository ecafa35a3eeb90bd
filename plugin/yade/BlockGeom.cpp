#include "BlockGeom.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockGeom));

masonry::PatchFeature BlockGeom::feature() const { return {masonry::PatchKind(kind), feature1, feature2, vertices}; }

void BlockGeom::setPatch(const masonry::ContactPatch& found)
{
	patch = found;
	kind = int(patch.feature.kind);
	feature1 = patch.feature.feature1;
	feature2 = patch.feature.feature2;
	vertices = patch.feature.vertices;
	area = patch.area;
	normal = patch.normal;
	pointNormals.fill(patch.normal);
	contactPoint.setZero();
	for (int i = 0; i < patch.size; ++i)
		contactPoint += patch.points[i].weight * 0.5 * (patch.points[i].position1 + patch.points[i].position2);
}

vector<Real> BlockGeom::gaps() const
{
	vector<Real> result;
	for (int i = 0; i < patch.size; ++i)
		result.push_back(patch.points[i].gap);
	return result;
}

vector<Vector3r> BlockGeom::points() const
{
	vector<Vector3r> result;
	for (int i = 0; i < patch.size; ++i)
		result.push_back(0.5 * (patch.points[i].position1 + patch.points[i].position2));
	return result;
}

vector<Vector3r> BlockGeom::normals() const { return {pointNormals.begin(), pointNormals.begin() + patch.size}; }

} // namespace yade
