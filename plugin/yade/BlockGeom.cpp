#include "BlockGeom.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockGeom));

masonry::PatchFeature BlockGeom::feature() const
{
	masonry::PatchFeature result {masonry::PatchKind(kind), feature1, feature2, {}};
	for (size_t i = 0; 3 * i < vertices.size(); ++i)
		result.add(featureAt(vertices, i));
	return result;
}

void BlockGeom::setPatch(const masonry::ContactPatch& found)
{
	patch = found;
	kind = int(patch.feature.kind);
	feature1 = patch.feature.feature1;
	feature2 = patch.feature.feature2;
	vertices.clear();
	for (const masonry::Feature& vertex : patch.feature.vertices)
		append(vertex, vertices);
	area = patch.area;
	normal = patch.normal;
	pointNormals.assign(patch.points.size(), patch.normal);
	contactPoint.setZero();
	for (const masonry::PatchPoint& point : patch.points)
		contactPoint += point.weight * 0.5 * (point.position1 + point.position2);
}

vector<Real> BlockGeom::gaps() const
{
	vector<Real> result;
	for (const masonry::PatchPoint& point : patch.points)
		result.push_back(point.gap);
	return result;
}

vector<Vector3r> BlockGeom::points() const
{
	vector<Vector3r> result;
	for (const masonry::PatchPoint& point : patch.points)
		result.push_back(0.5 * (point.position1 + point.position2));
	return result;
}

} // namespace yade
