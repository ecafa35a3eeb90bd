#include "ConvexBlock.hpp"
#include "sentence.hpp"

#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((ConvexBlock));

void ConvexBlock::postLoad(ConvexBlock&)
{
	solid.reset();
	if (vertices.empty())
		return;
	vector<int> starts = firstVertices.empty() ? vector<int> {0} : firstVertices;
	starts.push_back(int(vertices.size()));
	vector<masonry::ConvexPolyhedron> parts;
	for (size_t k = 0; k + 1 < starts.size(); ++k) {
		if (starts.front() != 0 || starts[k] >= starts[k + 1])
			throw std::invalid_argument(sentence(
			    "ConvexBlock.firstVertices[", k, "] = ", starts[k],
			    " is not allowed: the numbers must begin with 0 and ascend, below the number of vertices, ", vertices.size(), '.'));
		parts.push_back(masonry::ConvexPolyhedron::hull({vertices.begin() + starts[k], vertices.begin() + starts[k + 1]}));
	}
	solid = std::make_shared<const masonry::Solid<masonry::ConvexPolyhedron>>(std::move(parts));
	vertices = solid->vertices();
	firstVertices.clear();
	for (int part = 0; solid->size() > 1 && part < solid->size(); ++part)
		firstVertices.push_back(solid->first(part).vertex);
}

boost::python::list ConvexBlock::surfaces() const
{
	boost::python::list result;
	for (int part = 0; part < parts(); ++part)
		for (const auto& face : solid->part(part).faces()) {
			boost::python::list loop;
			for (const int vertex : face.loop)
				loop.append(solid->first(part).vertex + vertex);
			result.append(loop);
		}
	return result;
}

} // namespace yade
