#include "Gl1_BlockGeom.hpp"
#include "opengl.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Gl1_BlockGeom));

void Gl1_BlockGeom::go(const shared_ptr<IGeom>& shown, const shared_ptr<Interaction>&, const shared_ptr<Body>&, const shared_ptr<Body>&,
                       bool)
{
	const auto& geom = static_cast<const BlockGeom&>(*shown);
	const vector<Vector3r> points = geom.points(), normals = geom.normals();
	Real size = 0; // from the first point to the farthest, m
	for (const Vector3r& point : points)
		size = std::max(size, (point - points[0]).norm());
	gl::colour({1, 0.6, 0});
	glBegin(gl::lineLoop);
	for (const Vector3r& point : points)
		gl::vertex(point);
	glEnd();
	glBegin(gl::lines);
	for (size_t k = 0; k < std::min(points.size(), normals.size()); ++k) {
		gl::vertex(points[k]);
		gl::vertex(points[k] + 0.2 * size * normals[k]);
	}
	glEnd();
}

} // namespace yade
