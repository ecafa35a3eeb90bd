#include "Gl1_ConvexBlock.hpp"
#include "opengl.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Gl1_ConvexBlock));

void Gl1_ConvexBlock::go(const shared_ptr<Shape>& shape, const shared_ptr<State>&, bool wire, const GLViewInfo&)
{
	const auto& block = static_cast<const ConvexBlock&>(*shape);
	if (!block.solid)
		return;
	gl::colour(block.color);
	for (int k = 0; k < block.solid->size(); ++k) {
		const masonry::ConvexPolyhedron& part = block.solid->part(k);
		for (const auto& face : part.faces()) {
			glBegin(wire || block.wire ? gl::lineLoop : gl::polygon);
			glNormal3d(face.normal[0], face.normal[1], face.normal[2]);
			for (const int vertex : face.loop)
				gl::vertex(part.vertices()[vertex]);
			glEnd();
		}
	}
}

} // namespace yade
