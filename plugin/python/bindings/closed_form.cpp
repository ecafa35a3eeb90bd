#include "rocking/closed_form.hpp"
#include "expose.hpp"
#include "tolerances.hpp"
#include "validation.hpp"
#include <algorithm>
#include <limits>

namespace masonry::python {

Blocks toBlocks(const py::object& tuple)
{
	Blocks blocks;
	for (int k = 0; k < py::len(tuple); ++k)
		blocks.columns.push_back(toVector(tuple[k]));
	return blocks;
}

RockingBlock Blocks::symmetric(size_t i) const
{
	const RockingPrism block = (*this)[i];
	if (block.right.halfWidth != block.left.halfWidth)
		throw std::invalid_argument("block: must be symmetric for the closed form");
	return block.right;
}

namespace {
using Column = std::vector<double>;
using Table = std::vector<Column>;

py::tuple blockProperties(const py::object& geometry)
{
	const Blocks blocks = toBlocks(geometry);
	const size_t n = blocks.size();
	Column slenderness(n), radius(n), angle(n), frequency(n), acceleration(n), restitution(n);
	forEachCase(n, [&](size_t i) {
		const RockingBlock block = blocks[i].right;
		slenderness[i] = block.slenderness;
		radius[i] = block.radius;
		angle[i] = block.criticalAngle;
		frequency[i] = block.frequencyParameter;
		acceleration[i] = block.angularAcceleration;
		restitution[i] = block.naturalRestitution;
	});
	return py::make_tuple(toArray(slenderness), toArray(radius), toArray(angle), toArray(frequency), toArray(acceleration),
	                      toArray(restitution));
}

// Returns the row of one section that toBlocks() takes, without gravity, from the coordinates of its corners.
py::tuple prismOf(const py::object& xs, const py::object& ys)
{
	const Column x = toVector(xs), y = toVector(ys);
	std::vector<Vector2> points;
	for (size_t k = 0; k < x.size(); ++k)
		points.emplace_back(x[k], y[k]);
	Vector2 centre;
	const ConvexPolygon section = ConvexPolygon::hull(points, &centre);
	for (const Vector2& point : points) {
		double depth = std::numeric_limits<double>::infinity();
		for (const ConvexPolygon::Face& face : section.faces())
			depth = std::min(depth, face.offset - face.normal.dot(point - centre));
		require("depth of a corner of the polygon in the hull of the others", depth, depth <= tolerance::shape::flat * 2 * section.radius(),
		        "must be 0 m: a section is convex");
	}
	const RockingPrism block(section, 1);
	return py::make_tuple(block.right.halfWidth, block.left.halfWidth, block.right.halfHeight, section.gyrationSquared());
}

py::tuple singlePulse(const py::object& geometry, const py::object& impulses)
{
	const Blocks blocks = toBlocks(geometry);
	const Column impulse = toVector(impulses);
	const size_t n = blocks.size();
	Column velocity(n), duration(n), peak(n);
	forEachCase(n, [&](size_t i) {
		const auto pulse = closed_form::singlePulse(blocks.symmetric(i), impulse[i]);
		velocity[i] = pulse.angularVelocity;
		duration[i] = pulse.duration;
		peak[i] = pulse.peakAngle;
	});
	return py::make_tuple(toArray(velocity), toArray(duration), toArray(peak));
}

py::tuple pulseSequence(const py::object& geometry, const py::object& impulses, const py::object& restitutions, int halfCycles)
{
	const Blocks blocks = toBlocks(geometry);
	const Column impulse = toVector(impulses);
	const Column restitution = toVector(restitutions);
	const size_t n = blocks.size();
	Table velocity(n), duration(n), end(n), peak(n);
	forEachCase(n, [&](size_t i) {
		auto sequence = closed_form::pulseSequence(blocks.symmetric(i), impulse[i], restitution[i], halfCycles);
		velocity[i] = std::move(sequence.angularVelocity);
		duration[i] = std::move(sequence.duration);
		end[i] = std::move(sequence.endTime);
		peak[i] = std::move(sequence.peakAngle);
	});
	return py::make_tuple(toTable(velocity), toTable(duration), toTable(end), toTable(peak));
}

py::tuple stabilised(const py::object& geometry, const py::object& impulses, const py::object& restitutions)
{
	const Blocks blocks = toBlocks(geometry);
	const Column impulse = toVector(impulses);
	const Column restitution = toVector(restitutions);
	const size_t n = blocks.size();
	Column velocity(n), duration(n), period(n), peak(n), amplification(n), ratio(n);
	forEachCase(n, [&](size_t i) {
		const auto limit = closed_form::stabilised(blocks.symmetric(i), impulse[i], restitution[i]);
		velocity[i] = limit.angularVelocity;
		duration[i] = limit.duration;
		period[i] = limit.period;
		peak[i] = limit.peakAngle;
		amplification[i] = limit.amplification;
		ratio[i] = limit.ratio;
	});
	return py::make_tuple(toArray(velocity), toArray(duration), toArray(period), toArray(peak), toArray(amplification), toArray(ratio));
}

np::ndarray timeToStabilise(const py::object& geometry, const py::object& impulses, const py::object& restitutions,
                            const py::object& tolerances)
{
	const Blocks blocks = toBlocks(geometry);
	const Column impulse = toVector(impulses);
	const Column restitution = toVector(restitutions);
	const Column tolerance = toVector(tolerances);
	Column time(blocks.size());
	forEachCase(blocks.size(),
	            [&](size_t i) { time[i] = closed_form::timeToStabilise(blocks.symmetric(i), impulse[i], restitution[i], tolerance[i]); });
	return toArray(time);
}
} // namespace

void exposeClosedForm()
{
	using py::args;
	py::def("block_properties", blockProperties, args("blocks"),
	        "slenderness, radius, critical angle, frequency parameter, angular acceleration, natural restitution");
	py::def("prism_of", prismOf, args("x", "y"),
	        "levers about the right and the left edge, height of the centre, radius of gyration squared");
	py::def("single_pulse", singlePulse, args("blocks", "impulse"), "angular velocity, duration, peak angle (Eqs 1, 6, 5)");
	py::def("pulse_sequence", pulseSequence, args("blocks", "impulse", "restitution", "n"),
	        "angular velocity, duration, end time, peak angle of half cycles 1..n (Eqs 7, 9, 8)");
	py::def("stabilised", stabilised, args("blocks", "impulse", "restitution"),
	        "angular velocity, duration, period, peak angle, amplification, ratio (Eqs 10-13)");
	py::def("time_to_stabilise", timeToStabilise, args("blocks", "impulse", "restitution", "tolerance"),
	        "end time of the first half cycle in tolerance");
}

} // namespace masonry::python
