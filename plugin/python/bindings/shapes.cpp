// Convex polyhedra: the hull of points, its faces and its mass, by the shapes of the simulation.
#include "expose.hpp"
#include "shape/convex_polyhedron.hpp"
#include "tolerances.hpp"
#include "validation.hpp"

namespace masonry::python {

namespace {

std::vector<Vector3> toPoints(const py::object& array)
{
	const std::vector<double> numbers = toVector(array);
	std::vector<Vector3> points;
	for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
		points.emplace_back(&numbers[k]);
	return points;
}

// Loops, which are given as one number after the other and the places where each begins, with the end of the last.
std::vector<std::vector<int>> toLoops(const py::object& numbers, const py::object& starts)
{
	const std::vector<long> all = toVector<long>(numbers), start = toVector<long>(starts);
	std::vector<std::vector<int>> loops;
	for (std::size_t k = 1; k < start.size(); ++k)
		loops.emplace_back(all.begin() + start[k - 1], all.begin() + start[k]);
	return loops;
}

// Refuses points inside the polyhedron.
void requireVertices(const std::vector<Vector3>& points, const PlacedPolyhedron& placed)
{
	const double tolerance = 4 * tolerance::shape::plane * placed.shape.radius();
	for (std::size_t k = 0; k < points.size(); ++k) {
		const Vector3 point = placed.pose.orientation.conjugate() * (points[k] - placed.pose.position);
		double depth = std::numeric_limits<double>::infinity();
		for (const ConvexPolyhedron::Face& face : placed.shape.faces())
			depth = std::min(depth, face.offset - face.normal.dot(point));
		require("vertex " + std::to_string(k) + ": depth inside the convex hull", depth, depth <= tolerance,
		        "m: leave it out, or make two blocks");
	}
}

// The polyhedron in its own axes: principal axes, the origin at the centre of mass. Points that are in them already stay, bit by bit.
py::dict convexBlock(const py::object& points, const py::object& faces, const py::object& starts, bool inOwnAxes)
{
	const std::vector<std::vector<int>> given = toLoops(faces, starts);
	const std::vector<Vector3> corners = toPoints(points);
	const ConvexPolyhedron shape = given.empty() ? ConvexPolyhedron::hull(corners) : ConvexPolyhedron::fromFaces(corners, given);
	const PlacedPolyhedron placed =
	    inOwnAxes ? PlacedPolyhedron {shape, {Vector3::Zero(), Quaternion::Identity()}} : inPrincipalAxes(shape);
	requireVertices(corners, placed);
	const MassProperties mass = placed.shape.massProperties(1);
	std::vector<double> vertices, inertia;
	std::vector<long> loops, start {0};
	for (const Vector3& vertex : placed.shape.vertices())
		vertices.insert(vertices.end(), vertex.begin(), vertex.end());
	for (const ConvexPolyhedron::Face& face : placed.shape.faces()) {
		loops.insert(loops.end(), face.loop.begin(), face.loop.end());
		start.push_back(static_cast<long>(loops.size()));
	}
	for (int axis = 0; axis < 3; ++axis)
		inertia.push_back(mass.inertia(axis, axis));
	const Vector3& at = placed.pose.position;
	const Quaternion& turn = placed.pose.orientation;
	py::dict found;
	found["vertices"] = toArray(vertices, py::make_tuple(placed.shape.vertices().size(), 3));
	found["faces"] = toArray(loops);
	found["face_start"] = toArray(start);
	found["position"] = toArray(std::vector<double> {at.x(), at.y(), at.z()});
	found["orientation"] = toArray(std::vector<double> {turn.w(), turn.x(), turn.y(), turn.z()});
	found["volume"] = mass.mass;
	found["inertia"] = toArray(inertia);
	found["is_box"] = placed.shape.isBox();
	return found;
}

} // namespace

void exposeShapes()
{
	py::def("convex_block", convexBlock, py::args("points", "faces", "starts", "in_own_axes"),
	        "The convex polyhedron over points (or of faces, checked) in its principal axes: vertices (k, 3), faces one after the other "
	        "and where each "
	        "begins, position and orientation (w, x, y, z) of these axes, volume, principal moments of inertia per unit of density, "
	        "whether it is a box");
}

} // namespace masonry::python
