#include "ConvexBlock.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((ConvexBlock));

void ConvexBlock::postLoad(ConvexBlock&)
{
	polyhedron.reset();
	if (vertices.empty())
		return;
	polyhedron = std::make_shared<const masonry::ConvexPolyhedron>(masonry::ConvexPolyhedron::hull(vertices));
	vertices = polyhedron->vertices();
}

boost::python::list ConvexBlock::surfaces() const
{
	boost::python::list result;
	if (!polyhedron)
		return result;
	for (const auto& face : polyhedron->faces()) {
		boost::python::list loop;
		for (const int vertex : face.loop)
			loop.append(vertex);
		result.append(loop);
	}
	return result;
}

} // namespace yade
