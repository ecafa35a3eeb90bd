// Which faces are joints, and which body bears which: known structures, however they are turned, mirrored and numbered.
#include "contact/kinematics.hpp"
#include "joints/joint_table.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

using namespace masonry;

namespace {

struct Block {
	bool prescribed;
	Vector2 half;
	std::shared_ptr<const ConvexPolygon> shape;
	PlanePose pose;

	Block(bool prescribed, const Vector2& half)
	    : prescribed(prescribed), half(half), shape(std::make_shared<const ConvexPolygon>(ConvexPolygon::box(half)))
	{
	}
};
const Vector2& faceNormal(const Block& body, int face) { return body.shape->faces()[face].normal; }

// Blocks in a plane; pairs are those that touch, found by the search for contacts.
struct Structure {
	Vector2 gravity {0, -9.81};
	std::vector<Block> bodies;
	std::vector<NearPair> pairs;

	void add(const Vector2& half, const Vector2& centre, double angle = 0, bool prescribed = false)
	{
		Block block(prescribed, half);
		block.pose.position = centre;
		block.pose.setAngle(angle);
		bodies.push_back(block);
	}
	void turn(double angle)
	{
		PlanePose by;
		by.setAngle(angle);
		gravity = by.rotate(gravity);
		for (Block& body : bodies) {
			body.pose.position = by.rotate(body.pose.position);
			body.pose.setAngle(body.pose.angle + angle);
		}
	}
	void mirror()
	{
		gravity.x() = -gravity.x();
		for (Block& body : bodies) {
			body.pose.position.x() = -body.pose.position.x();
			body.pose.setAngle(-body.pose.angle);
		}
	}
	void findPairs()
	{
		pairs.clear();
		for (int a = 0; a < int(bodies.size()); ++a)
			for (int b = a + 1; b < int(bodies.size()); ++b) {
				const Block &one = bodies[a], &other = bodies[b];
				PlaneMemory memory;
				FoundPoints<Plane> found;
				if ((one.prescribed && other.prescribed) ||
				    !Plane::findPoints(*one.shape, one.pose, *other.shape, other.pose, 1e-6, memory, found))
					continue;
				bool upright = true;
				for (int i = 0; i < found.size(); ++i) {
					const auto frame = Plane::frame(found.features[i], *one.shape, one.pose, *other.shape, other.pose);
					upright &= isUpright<Vector2>(frame.axes.row(0).transpose(), gravity);
				}
				pairs.push_back({a, b, found.face1, found.face2, upright});
			}
	}

	// Block and support of each joint by the names of the blocks (their places in `order`); equals in order of their names.
	std::set<std::tuple<int, int>> joints(const std::vector<int>& names)
	{
		findPairs();
		JointTable table;
		table.find(bodies, pairs);
		const std::vector<int>& level = table.levels();
		std::set<std::tuple<int, int>> result;
		for (int c = 0; c < int(pairs.size()); ++c) {
			const JointFace joint = table.of(bodies, pairs, c);
			if (joint.block < 0)
				continue;
			CHECK(joint.face == (joint.block == pairs[c].body2 ? pairs[c].face2 : pairs[c].face1));
			const int other = joint.block == pairs[c].body2 ? pairs[c].body1 : pairs[c].body2;
			const auto [least, most] = std::minmax(names[joint.block], names[other]);
			level[joint.block] == level[other] ? result.insert({least, most}) : result.insert({names[joint.block], names[other]});
		}
		return result;
	}
	std::set<std::tuple<int, int>> joints()
	{
		std::vector<int> names(bodies.size());
		std::iota(names.begin(), names.end(), 0);
		return joints(names);
	}
	// The same blocks in another order, with their names.
	std::vector<int> shuffle(unsigned seed)
	{
		std::vector<int> names(bodies.size());
		std::iota(names.begin(), names.end(), 0);
		std::shuffle(names.begin(), names.end(), std::mt19937(seed));
		const std::vector<Block> before = bodies;
		for (size_t k = 0; k < names.size(); ++k)
			bodies[k] = before[names[k]];
		return names;
	}
};

void addBase(Structure& s) { s.add({20, 1}, {0, -1}, 0, true); }

// Running bond, bricks of 0.4 x 0.2 m and half bricks at the ends; body 1 + course * 4 is the first brick of a course of four (three and
// two halves in every other course).
Structure wall(int courses)
{
	Structure s;
	addBase(s);
	for (int c = 0; c < courses; ++c) {
		const double y = 0.1 + 0.2 * c;
		if (c % 2 == 0) {
			for (int i = 0; i < 4; ++i)
				s.add({0.2, 0.1}, {0.2 + 0.4 * i, y});
			continue;
		}
		s.add({0.1, 0.1}, {0.1, y});
		for (int i = 0; i < 3; ++i)
			s.add({0.2, 0.1}, {0.4 + 0.4 * i, y});
		s.add({0.1, 0.1}, {1.5, y});
	}
	return s;
}

// A half circle of boxes whose neighbours' inner edges are together, closed by `open` (rad) at each joint as wedges would be: boxes touch
// in their inner edges, and the faces that meet are those of voussoirs.
Structure arch(int voussoirs)
{
	Structure s;
	addBase(s);
	const double half = M_PI / voussoirs / 2, inside = 2 * std::cos(half);
	for (int k = 0; k < voussoirs; ++k) {
		const double angle = half * (2 * k + 1);
		s.add({2 * std::sin(half), 0.2}, (inside + 0.2) * Vector2(std::cos(angle), std::sin(angle)), angle - M_PI / 2);
	}
	return s;
}

int levelOfVoussoir(int k, int voussoirs) { return std::min(k, voussoirs + 1 - k); } // 1 and `voussoirs` are the springers

} // namespace

// Every brick is the block of its joints with the bricks under it, and head joints are none: counted by hand from the bond.
TEST_CASE("the joints of a wall in running bond are its bed joints")
{
	Structure s = wall(5);
	std::set<std::tuple<int, int>> beds;
	const auto overlaps = [&](int above, int below) {
		const Block &a = s.bodies[above], &b = s.bodies[below];
		const Vector2 apart = (a.pose.position - b.pose.position).cwiseAbs(), halves = a.shape->halfSize() + b.shape->halfSize();
		return a.pose.position.y() > b.pose.position.y() && std::abs(apart.y() - halves.y()) < 1e-9 && halves.x() - apart.x() > 1e-9;
	};
	for (int a = 1; a < int(s.bodies.size()); ++a)
		for (int b = 0; b < int(s.bodies.size()); ++b)
			if (overlaps(a, b))
				beds.insert({a, b});
	CHECK(s.joints() == beds);
}

// Each voussoir rocks on the next one towards its springer. Of an even number the two at the crown are equals, and their joint is one
// although it is upright; so it is in fine arches, where neighbours of the crown joint are within 5.7 degrees of it.
TEST_CASE("all joints of an arch rock, and the two blocks at its crown are equals")
{
	const int n = GENERATE(6, 7, 8, 9, 40, 41);
	Structure s = arch(n);
	std::set<std::tuple<int, int>> wanted {{1, 0}, {n, 0}};
	for (int k = 1; k < n; ++k) {
		const bool up = levelOfVoussoir(k, n) < levelOfVoussoir(k + 1, n), equal = levelOfVoussoir(k, n) == levelOfVoussoir(k + 1, n);
		up || equal ? wanted.insert({equal ? k : k + 1, equal ? k + 1 : k}) : wanted.insert({k, k + 1});
	}
	CAPTURE(n);
	CHECK(s.joints() == wanted);
}

// Nothing in the rule knows the axes of the world, left from right, or the order of the blocks.
TEST_CASE("joints are the same when the scene is turned with its gravity, mirrored and renumbered")
{
	const bool isWall = GENERATE(true, false);
	const auto build = [&] { return isWall ? wall(6) : arch(10); };
	const auto wanted = build().joints();
	for (const double angle : {M_PI / 2, M_PI / 6, -M_PI / 2, 3.0}) {
		Structure turned = build();
		turned.turn(angle);
		CHECK(turned.joints() == wanted);
	}
	Structure mirrored = build();
	mirrored.mirror();
	CHECK(mirrored.joints() == wanted);
	for (const unsigned seed : {1u, 2u, 3u}) {
		Structure other = build();
		const std::vector<int> names = other.shuffle(seed);
		CHECK(other.joints(names) == wanted);
	}
}

// A keystone between two blocks rests on both, at any inclination of its faces: its joints are its own, one on each face.
TEST_CASE("a keystone has a joint with each of its neighbours")
{
	const double lean = GENERATE(0.02, 0.2, 0.6); // of its faces from upright, rad
	const std::vector<NearPair> pairs {{0, 1, 3, 2, false}, {0, 2, 3, 2, false}, {1, 3, 1, 0, lean < 0.1}, {2, 3, 0, 1, lean < 0.1}};
	const std::vector<Block> bodies {{true, {1, 1}}, {false, {1, 1}}, {false, {1, 1}}, {false, {1, 1}}};
	JointTable table;
	table.find(bodies, pairs);
	CHECK(table.of(bodies, pairs, 2) == JointFace {3, 0});
	CHECK(table.of(bodies, pairs, 3) == JointFace {3, 1});
}

// A brick beside a prescribed jamb, or beside a block of two courses, stands on its bed: what is beside it is a head joint, as between
// bricks of one course.
TEST_CASE("a block that stands on its bed does not rock on what is beside it")
{
	Structure s;
	addBase(s);
	s.add({0.2, 0.1}, {0.2, 0.1});
	s.add({0.2, 0.1}, {0.2, 0.3});
	s.add({0.2, 0.2}, {0.6, 0.2});
	s.add({0.1, 1}, {-0.1, 1}, 0, true);
	CHECK(s.joints() == std::set<std::tuple<int, int>> {{1, 0}, {2, 1}, {3, 0}});
}

// Without gravity the graph alone decides. In flight there is no chain to a prescribed body, and blocks that touch are equals.
TEST_CASE("blocks without gravity and blocks in flight have joints")
{
	Structure s = wall(3);
	const auto wanted = s.joints();
	s.gravity.setZero();
	CHECK(s.joints() == wanted);
	Structure flying;
	flying.add({0.2, 0.1}, {0, 5});
	flying.add({0.2, 0.1}, {0, 5.2});
	flying.add({0.2, 0.1}, {0.4, 5.2});
	CHECK(flying.joints() == std::set<std::tuple<int, int>> {{0, 1}, {1, 2}});
}
