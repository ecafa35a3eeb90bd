// The common normal of two edges turns over where they become parallel, and the gap along it changes its sign, however far apart they are.
#include "core/dynamics/localised/polyhedron_rig.hpp"
#include "oracle/polyhedra.hpp"
#include "tolerances.hpp"
#include <catch.hpp>

using namespace rig;

namespace {

constexpr double half = .2, length = 1; // m: of the section, and of a bar

// The corners of a bar along x whose sharp edge is the x axis, above (1) or below (-1) the rest of it.
std::vector<Vector3> bar(double side)
{
	std::vector<Vector3> points;
	for (const double x : {-length / 2, length / 2})
		for (const Vector3& corner : {Vector3(x, 0, 0), Vector3(x, half, -side * half), Vector3(x, -half, -side * half)})
			points.push_back(corner);
	return points;
}

// Two random polyhedra that fall side by side, up to 5 cm apart, and turn. Their edges pass through parallel again and again.
struct Falling {
	System s = emptyScene<Space>(.5);

	explicit Falling(unsigned seed)
	{
		oracle::RandomShapes random(seed);
		for (int k = 0; k < 2; ++k) {
			const ConvexPolyhedron shape = random.shape(12);
			addPolyhedron(s, shape.vertices(), {0, 0, 100}, random.orientation());
		}
		const Vector3 way = random.vector().normalized();
		s.bodies[2].pose.position += 4 * way;
		for (int k = 0; k < 60 && width() > .05; ++k)
			s.bodies[2].pose.position -= .9 * (width() - .02) * way;
		s.bodies[2].velocity << .1 * random.vector(), 2 * random.vector();
		s.bodies[1].velocity << 0, 0, 0, 2 * random.vector();
		addPair(s, 1, 2, 0);
	}
	double width() const
	{
		const auto &one = s.bodies[1], &other = s.bodies[2];
		return oracle::slabOfAxes(one.shape->part(0), one.pose, other.shape->part(0), other.pose).width;
	}
};

} // namespace

// Oracle: the slab between the hulls of all differences of vertices. A sharp crossing leaves the faces' normal by no more than
// tolerance::contact::crossing says; here these faces are 45 degrees steep.
TEST_CASE("contacts of bars that turn through parallel push upwards, and have a gap while the bars are apart")
{
	const ConvexPolyhedron lower = ConvexPolyhedron::hull(bar(1)), upper = ConvexPolyhedron::hull(bar(-1));
	for (const double apart : {.02, 6e-3})
		for (const double pitch : {0., 1e-9, 1e-6, 1e-4, 1e-3, 1e-2})
			for (const double aside : {0., 1e-3, .01}) {
				PatchFeature memory;
				for (double yaw = -.05; yaw < .05; yaw += 1.3e-4) {
					CAPTURE(apart, pitch, aside, yaw);
					Pose pose;
					pose.position = {0, aside, apart};
					pose.orientation = turn(yaw, Vector3::UnitZ()) * turn(pitch, Vector3::UnitY());
					REQUIRE(oracle::slabOfDifferences(lower, Pose(), upper, pose).width > 0);
					FoundPoints<Space> found;
					Space::findPoints(lower, Pose(), upper, pose, 1, memory, found); // nothing where an edge lies along an edge
					for (const Feature& feature : found.features) {
						const auto frame = Space::frame(feature, lower, Pose(), upper, pose);
						CHECK(frame.axes(0, 2) > tolerance::contact::crossing / std::sqrt(2.));
						CHECK(frame.gap > 0);
					}
				}
			}
}

// Oracle: the widest slab along all axes. These are the seeds, of 3,000, in which a point whose gap had changed its sign hid a real one:
// the bodies went into each other by 0.2 to 60 mm. Bound: a hundredth of what a step may leave unseen (tolerance::contact::unseen).
TEST_CASE("bodies that fall side by side do not go into each other where edges become parallel")
{
	for (const unsigned seed : {73, 177, 1179, 2364}) {
		CAPTURE(seed);
		Falling pair(seed);
		REQUIRE(pair.width() > 0);
		LocalisedStep<Space> step {};
		double least = pair.width();
		for (int n = 0; n < 60 && pair.s.impacts.empty(); ++n) {
			CHECK(step.advance(pair.s, 3e-3).converged);
			least = std::min(least, pair.width());
		}
		CHECK(least > -1e-6);
	}
}

// Gaps are not saved: a loaded run measures them anew.
TEST_CASE("bodies whose gaps are measured anew before each step have the same faces, and go on with the same bits")
{
	for (unsigned seed = 0; seed < 20; ++seed) {
		Falling pair(seed), loaded(seed);
		LocalisedStep<Space> step {}, ofLoaded {};
		for (int n = 0; n < 40; ++n) {
			CAPTURE(seed, n);
			loaded.s.moved = true;
			step.advance(pair.s, 3e-3);
			ofLoaded.advance(loaded.s, 3e-3);
			REQUIRE(loaded.s.pairs[0].face1 == pair.s.pairs[0].face1);
			REQUIRE(loaded.s.pairs[0].face2 == pair.s.pairs[0].face2);
			for (int b : {1, 2}) {
				REQUIRE(loaded.s.bodies[b].pose.position == pair.s.bodies[b].pose.position);
				REQUIRE(loaded.s.bodies[b].velocity == pair.s.bodies[b].velocity);
			}
		}
	}
}

// Oracle and bound as above. These are seeds, of 30,000, in which thin bodies went into each other by up to ten times their half thickness:
// through a vertex that the face held as reference lacks (59, 740), because a point that had closed was moved out of touch by what closes
// the gaps of the others, and did not land (22616), or because edges that pass on the far side of a thin body counted as deep (the others),
// which also cost up to 25 events in a step.
TEST_CASE("thin bodies that fall side by side do not go into each other, and need few events")
{
	for (const auto& [seed, friction] : {std::pair(59, noSlip),
	                                     {740, noSlip},
	                                     {4405, noSlip},
	                                     {6173, noSlip},
	                                     {2095, .5},
	                                     {1452, noSlip},
	                                     {2364, .5},
	                                     {4405, .5},
	                                     {5957, .5},
	                                     {22616, .5}}) {
		CAPTURE(seed, friction);
		Falling pair(seed);
		pair.s.pairs[0].friction = friction;
		REQUIRE(pair.width() > 0);
		LocalisedStep<Space> step {};
		double least = pair.width();
		int events = 0;
		for (int n = 0; n < 60; ++n) {
			const StepReport report = step.advance(pair.s, 3e-3);
			CHECK(report.converged);
			events = std::max(events, int(report.events));
			least = std::min(least, pair.width());
		}
		CHECK(least > -1e-6);
		CHECK(events <= 6);
	}
}
