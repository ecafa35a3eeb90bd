// Boxes that touch or not, by the contact geometry of the simulation.
#include "contact/box_axes.hpp"
#include "contact/face_patch.hpp"
#include "expose.hpp"

namespace masonry::python {

namespace {

// Pairs of boxes, which are given as one number after the other: centres, full sizes, m, axes.
struct BoxPairs {
	std::vector<double> centers, sizes, axes;
	std::vector<long> first, second;

	BoxPairs(const py::object& boxes, const py::object& first, const py::object& second)
	    : centers(toVector(boxes[0])), sizes(toVector(boxes[1])), axes(toVector(boxes[2])), first(toVector<long>(first)),
	      second(toVector<long>(second))
	{
	}

	Box box(long k) const { return {Vector3(&sizes[3 * k]) / 2}; }
	Vector3 center(long k) const { return Vector3(&centers[3 * k]); }
	Matrix3 rotation(long k) const { return Matrix3(&axes[9 * k]); } // by columns, as Eigen stores it
	RelativePose seenFromFirst(size_t pair) const
	{
		const Matrix3 back = rotation(first[pair]).transpose();
		return {back * rotation(second[pair]), back * (center(second[pair]) - center(first[pair]))};
	}
};

np::ndarray boxAxes(const py::object& boxes, const py::object& first, const py::object& second)
{
	const BoxPairs pairs(boxes, first, second);
	std::vector<double> table(60 * pairs.first.size());
	forEachCase(pairs.first.size(), [&](size_t pair) {
		const long one = pairs.first[pair];
		double* row = &table[60 * pair];
		for (const SeparatingAxis& axis : separatingAxes(pairs.box(one), pairs.box(pairs.second[pair]), pairs.seenFromFirst(pair))) {
			Eigen::Map<Vector3> {row} = pairs.rotation(one) * axis.normal;
			row[3] = axis.separation;
			row += 4;
		}
	});
	return toArray(table, py::make_tuple(pairs.first.size(), 15, 4));
}

np::ndarray facePatches(const py::object& boxes, const py::object& first, const py::object& second, const py::object& margins)
{
	const BoxPairs pairs(boxes, first, second);
	const std::vector<double> margin = toVector(margins);
	std::vector<ConvexPolyhedron> shapes;
	for (size_t k = 0; 3 * k < pairs.sizes.size(); ++k)
		shapes.push_back(ConvexPolyhedron::box(pairs.box(long(k)).halfSize));
	std::vector<double> table(31 * pairs.first.size());
	forEachCase(pairs.first.size(), [&](size_t pair) {
		const long one = pairs.first[pair], other = pairs.second[pair];
		const ConvexPolyhedron &box1 = shapes[one], &box2 = shapes[other];
		const RelativePose seen = pairs.seenFromFirst(pair);
		const double length = std::min(box1.thickness(), box2.thickness());
		FaceSeparation face = bestFace(box1, box2, seen, {}, length);
		if (face.body == 2) // the one of the first box that it meets
			face = {1, faceAlong(box1, -(seen.rotation * box2.faces()[face.face].normal)), face.separation};
		const FacePair faces = facePair(box1, box2, seen, face, {}, length);
		ContactPatch patch;
		const Pose pose {pairs.center(one), Quaternion(pairs.rotation(one))};
		if (face.separation > margin[pair] || !facePatch(faces, overlapTask(faces, {}), pose, {}, patch, 0))
			return;
		double* row = &table[31 * pair];
		row[0] = patch.size();
		row[1] = patch.area;
		row[2] = patch.nominalArea;
		row[3] = patch.points[0].gap;
		Eigen::Map<Vector3> {row + 4} = patch.normal;
		for (int k = 0; k < 8; ++k) {
			const PatchPoint& point = patch.points[std::min(k, patch.size() - 1)];
			row[3] = std::min(row[3], point.gap);
			Eigen::Map<Vector3> {row + 7 + 3 * k} = point.position1;
		}
	});
	return toArray(table, py::make_tuple(pairs.first.size(), 31));
}

} // namespace

void exposeBoxes()
{
	using py::args;
	py::def("box_axes", boxAxes, args("boxes", "first", "second"),
	        "(m, 15, 4) of pairs: unit normal and gap of the faces of the first, of the second, and of products of edges");
	py::def("face_patches", facePatches, args("boxes", "first", "second", "margins"),
	        "(m, 31) of pairs: number of corners (0: no patch), area, that of the smaller face, least gap, normal, eight corners on the "
	        "first box");
}

} // namespace masonry::python
