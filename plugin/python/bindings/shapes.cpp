// Convex polyhedra: the hull of points, its faces and its mass, by the shapes of the simulation.
#include "contact/collide.hpp"
#include "contact/separating_axes.hpp"
#include "expose.hpp"
#include "shape/convex_polyhedron.hpp"
#include "shape/union_of_parts.hpp"
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

// Parts of a block in its own axes, with the pose and the mass of the whole, as Python has them.
py::dict blockOf(const std::vector<ConvexPolyhedron>& parts, const Pose& pose)
{
	const MassProperties mass = massProperties(parts, 1);
	std::vector<double> vertices, inertia;
	std::vector<long> loops, start {0}, first;
	for (const ConvexPolyhedron& part : parts) {
		first.push_back(static_cast<long>(vertices.size() / 3));
		for (const Vector3& vertex : part.vertices())
			vertices.insert(vertices.end(), vertex.begin(), vertex.end());
		for (const ConvexPolyhedron::Face& face : part.faces()) {
			for (const int vertex : face.loop)
				loops.push_back(first.back() + vertex);
			start.push_back(static_cast<long>(loops.size()));
		}
	}
	for (int axis = 0; axis < 3; ++axis)
		inertia.push_back(mass.inertia(axis, axis));
	py::dict found;
	found["vertices"] = toArray(vertices, py::make_tuple(vertices.size() / 3, 3));
	found["first_vertices"] = toArray(first);
	found["faces"] = toArray(loops);
	found["face_start"] = toArray(start);
	found["position"] = toArray(std::vector<double>(pose.position.begin(), pose.position.end()));
	const Quaternion& turn = pose.orientation;
	found["orientation"] = toArray(std::vector<double> {turn.w(), turn.x(), turn.y(), turn.z()});
	found["volume"] = mass.mass;
	found["inertia"] = toArray(inertia);
	found["is_box"] = parts.size() == 1 && parts[0].isBox();
	return found;
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
	return blockOf({placed.shape}, placed.pose);
}

// The union of convex parts, whose corners stand one part after the other, likewise.
py::dict convexUnion(const py::object& points, const py::object& starts, bool inOwnAxes)
{
	const std::vector<Vector3> corners = toPoints(points);
	const std::vector<long> start = toVector<long>(starts);
	std::vector<ConvexPolyhedron> parts;
	for (std::size_t k = 0; k + 1 < start.size(); ++k)
		parts.push_back(ConvexPolyhedron::hull({corners.begin() + start[k], corners.begin() + start[k + 1]}));
	if (inOwnAxes)
		return blockOf(parts, {Vector3::Zero(), Quaternion::Identity()});
	const PlacedUnion placed = inPrincipalAxes(parts);
	return blockOf(placed.parts, placed.pose);
}

// Blocks, one after the other: vertices in own axes and where those of each block begin, with the end of the last; places, orientations (w,
// x, y, z).
struct Polyhedra {
	std::vector<ConvexPolyhedron> shapes;
	std::vector<Pose> poses;

	Polyhedra(const py::object& vertices, const py::object& starts, const py::object& poseNumbers)
	{
		const std::vector<Vector3> points = toPoints(vertices);
		const std::vector<long> start = toVector<long>(starts);
		const std::vector<double> numbers = toVector(poseNumbers);
		for (std::size_t k = 0; k + 1 < start.size(); ++k) {
			const double* own = &numbers[7 * k];
			shapes.push_back(ConvexPolyhedron::hull({points.begin() + start[k], points.begin() + start[k + 1]}));
			poses.push_back({Vector3(own), Quaternion(own[3], own[4], own[5], own[6])});
		}
	}

	// Gap along the axis that separates the pair best, m; negative where they overlap. A face that separates them is enough.
	double gap(long one, long other) const
	{
		const ConvexPolyhedron &first = shapes[one], &second = shapes[other];
		const Matrix3 back = poses[one].orientation.toRotationMatrix().transpose();
		const RelativePose seen {back * poses[other].orientation.toRotationMatrix(), back * (poses[other].position - poses[one].position)};
		const double length = std::min(first.thickness(), second.thickness());
		double best = bestFace(first, second, seen, {}, length).separation;
		if (best >= -tolerance::contact::slack * length)
			return best;
		for (const ConvexPolyhedron::Edge& edge1 : first.edges())
			for (const ConvexPolyhedron::Edge& edge2 : second.edges()) {
				const Vector3 axis = edge1.direction.cross(seen.rotation * edge2.direction);
				if (axis.norm() < tolerance::contact::parallelEdges)
					continue;
				for (const Vector3& normal : {Vector3(axis.normalized()), Vector3(-axis.normalized())}) {
					const Vector3 own = seen.rotation.transpose() * normal;
					const double far1 = normal.dot(first.vertices()[farthestVertex(first, normal)]);
					best = std::max(best, normal.dot(seen.offset) + own.dot(second.vertices()[farthestVertex(second, -own)]) - far1);
				}
			}
		return best;
	}

	// Cosine of the angle between the two faces that a patch is made of; 0 for edges.
	double cosine(long one, long other, const PatchFeature& feature) const
	{
		if (feature.kind != PatchKind::Face1 && feature.kind != PatchKind::Face2)
			return 0;
		const Vector3 normal1 = poses[one].orientation * shapes[one].faces()[feature.feature1].normal;
		return -normal1.dot(poses[other].orientation * shapes[other].faces()[feature.feature2].normal);
	}
};

np::ndarray polyhedronPairs(const py::tuple& blocks, const py::object& first, const py::object& second, const py::object& margins)
{
	const Polyhedra all(blocks[0], blocks[1], blocks[2]);
	const std::vector<long> ones = toVector<long>(first), others = toVector<long>(second);
	const std::vector<double> margin = toVector(margins);
	std::vector<std::vector<double>> rows(ones.size());
	forEachCase(ones.size(), [&](std::size_t pair) {
		const long one = ones[pair], other = others[pair];
		ContactPatch patch;
		if (!collide(all.shapes[one], all.poses[one], all.shapes[other], all.poses[other], margin[pair], {}, patch))
			patch = {};
		const Vector3& normal = patch.normal;
		std::vector<double>& row = rows[pair];
		row = {all.gap(one, other), double(patch.size()), patch.area, patch.nominalArea, all.cosine(one, other, patch.feature),
		       normal.x(),          normal.y(),           normal.z()};
		for (const PatchPoint& point : patch.points)
			row.insert(row.end(), point.position1.begin(), point.position1.end());
	});
	return toTable(rows);
}

} // namespace

void exposeShapes()
{
	py::def("polyhedron_pairs", polyhedronPairs, py::args("blocks", "first", "second", "margins"),
	        "One row a pair: gap along the axis that separates them best, then of the patch where they are at most the margin apart: "
	        "number of corners (0: there is "
	        "none), area, that of the smaller face, cosine of the angle between the faces, normal, corners on the first. Filled with NaN.");
	py::def(
	    "convex_union", convexUnion, py::args("points", "starts", "in_own_axes"),
	    "The rigid union of convex parts in its principal axes, as convex_block: the parts begin at `starts`, with the end of the last.");
	py::def("convex_block", convexBlock, py::args("points", "faces", "starts", "in_own_axes"),
	        "The convex polyhedron over points (or of faces, checked) in its principal axes: vertices (k, 3), first vertex of each part, "
	        "faces one after the other "
	        "and where each "
	        "begins, position and orientation (w, x, y, z) of these axes, volume, principal moments of inertia per unit of density, "
	        "whether it is a box");
}

} // namespace masonry::python
