#include "Gl1_ConvexBlock.hpp"
#include "opengl.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Gl1_ConvexBlock));

void Gl1_ConvexBlock::go(const shared_ptr<Shape>& shape, const shared_ptr<State>&, bool wire, const GLViewInfo&)
{
	const auto& block = static_cast<const ConvexBlock&>(*shape);
	if (!block.polyhedron)
		return;
	gl::colour(block.color);
	for (const auto& face : block.polyhedron->faces()) {
		glBegin(wire || block.wire ? gl::lineLoop : gl::polygon);
		glNormal3d(face.normal[0], face.normal[1], face.normal[2]);
		for (const int k : face.loop)
			gl::vertex(block.polyhedron->vertices()[k]);
		glEnd();
	}
}

} // namespace yade
