// Contact points of two convex polygons in random positions: rectangles decide as a search by half sizes does, and the gaps are those of
// the hull of all differences of the vertices.
#include "contact/kinematics.hpp"
#include "oracle/plane_minkowski.hpp"
#include "oracle/rectangles.hpp"
#include "tolerances.hpp"
#include <catch.hpp>
#include <random>

using namespace masonry;

namespace {

using Points = std::vector<Vector2>;

std::mt19937 generator(1);
double unit() { return std::uniform_real_distribution<double>(-1, 1)(generator); }

PlanePose at(double x, double y, double angle)
{
	PlanePose pose;
	pose.position << x, y;
	pose.setAngle(angle);
	return pose;
}

Feature featureOf(const oracle::RectangleFeature& f)
{
	return f.vertexBody == 0 ? Feature() : Feature::ofVertex(f.vertexBody, f.vertex, f.face);
}

// Both searches for the same two rectangles, each with its own memory.
struct Rectangles {
	Vector2 half1, half2;
	ConvexPolygon shape1 {ConvexPolygon::box(half1)}, shape2 {ConvexPolygon::box(half2)};
	PlaneMemory memory {};
	oracle::RectangleMemory oracleMemory {};

	Rectangles(const Vector2& first, const Vector2& second) : half1(first), half2(second) {}
	bool decideAlike(const PlanePose& pose1, const PlanePose& pose2, double margin)
	{
		FoundPoints<Plane> found;
		oracle::RectanglePoints expected;
		const bool near = Plane::findPoints(shape1, pose1, shape2, pose2, margin, memory, found);
		if (near != oracle::findPoints(half1, pose1, half2, pose2, margin, oracleMemory, expected))
			return false;
		if (!near)
			return true;
		Plane::addSecondNormals(shape1, pose1, shape2, pose2, found);
		oracle::addSecondNormals(half1, pose1, half2, pose2, expected);
		bool same = found.size() == expected.size && found.places == expected.places && found.face1 == expected.face1 &&
		            found.face2 == expected.face2 && memory.reference == oracleMemory.reference && memory.face1 == oracleMemory.face1 &&
		            memory.face2 == oracleMemory.face2;
		for (int i = 0; same && i < found.size(); ++i)
			same = found.features[i] == featureOf(expected.features[i]) && (i < found.places || found.cornerOf(i) == expected.corner[i]);
		for (int i : {0, 1})
			same &= memory.features[i] == featureOf(oracleMemory.features[i]);
		return same;
	}
};

// Random shapes about 1 m large, of the kinds that are hard: wedges down to 5 degrees, slivers down to 1:100, up to 48 sides.
Points randomPoints(int kind)
{
	Points points;
	const auto add = [&points](double x, double y) { points.emplace_back(x, y); };
	if (kind == 0) { // hull of random points
		const int count = 3 + int(5 * (1 + unit()));
		while (int(points.size()) < count)
			add(unit(), unit());
	} else if (kind == 1) { // wedge, from 5 to 60 degrees
		const double angle = M_PI / 180 * (32.5 + 27.5 * unit()), slant = 0.2 * unit();
		add(0, 0);
		add(1, std::tan(slant));
		add(1, std::tan(slant + angle));
	} else if (kind == 2) { // sliver
		const double thickness = std::pow(10, -1.5 + 0.5 * unit()) / 2;
		for (const double x : {-1., 1.})
			for (const double y : {-1., 1.})
				add(x + 0.2 * unit(), thickness * y * (1 + 0.5 * unit()));
	} else if (kind == 3) { // regular polygon
		const int sides = 3 + int(22.9 * (1 + unit()));
		for (int k = 0; k < sides; ++k)
			add(std::cos(2 * M_PI * k / sides), std::sin(2 * M_PI * k / sides));
	} else { // rectangle
		const Vector2 half(1 + 0.9 * unit(), 1 + 0.9 * unit());
		for (const double x : {-1., 1.})
			for (const double y : {-1., 1.})
				add(x * half.x(), y * half.y());
	}
	return points;
}

ConvexPolygon randomShape() { return ConvexPolygon::hull(randomPoints(int(2.5 * (1 + unit())))); }

Points placed(const ConvexPolygon& shape, const PlanePose& pose)
{
	Points points;
	for (const Vector2& vertex : shape.vertices())
		points.push_back(pose.toGlobal(vertex));
	return points;
}

struct Pair {
	ConvexPolygon shape1, shape2;
	PlanePose pose1, pose2;
	oracle::PlaneSeparation separation() const { return oracle::separation(placed(shape1, pose1), placed(shape2, pose2)); }
	double length() const { return std::min(shape1.thickness(), shape2.thickness()); }
};

// Two shapes that are about `gap` thicknesses apart.
Pair randomPair(double gap)
{
	Pair pair {randomShape(), randomShape(), at(unit(), unit(), 4 * unit()), at(2 * unit(), 2 * unit(), 4 * unit())};
	const auto before = pair.separation();
	pair.pose2.position += (gap * pair.length() - before.value) * before.normal;
	return pair;
}

struct Found : FoundPoints<Plane> {
	bool near;
	std::vector<ContactFrame<Plane>> frames;
	double smallestGap {std::numeric_limits<double>::infinity()};
};

Found find(const ConvexPolygon& shape1, const PlanePose& pose1, const ConvexPolygon& shape2, const PlanePose& pose2, double margin)
{
	Found found;
	PlaneMemory memory;
	found.near = Plane::findPoints(shape1, pose1, shape2, pose2, margin, memory, found);
	for (const Feature& feature : found.features) {
		found.frames.push_back(Plane::frame(feature, shape1, pose1, shape2, pose2));
		found.smallestGap = std::min(found.smallestGap, found.frames.back().gap);
	}
	return found;
}
Found find(const Pair& pair, double margin) { return find(pair.shape1, pair.pose1, pair.shape2, pair.pose2, margin); }

} // namespace

TEST_CASE("rectangles decide as a search by half sizes does")
{
	const auto half = [] { return Vector2(1 + 0.9 * unit(), 1 + 0.9 * unit()); };
	for (int i = 0; i < 20000; ++i) {
		Rectangles pair(half(), half());
		PlanePose pose1 = at(2 * unit(), 2 * unit(), 4 * unit()), pose2 = at(2 * unit(), 2 * unit(), 4 * unit());
		for (int step = 0; step < 20; ++step) { // with the memory of each search
			REQUIRE(pair.decideAlike(pose1, pose2, 0.2));
			for (PlanePose* pose : {&pose1, &pose2}) {
				pose->position += 0.03 * Vector2(unit(), unit());
				pose->turn(0.03 * unit());
			}
		}
	}
	// Joints that touch exactly, or to round-off, and blocks that rock about them and slide along them.
	for (int i = 0; i < 20000; ++i) {
		const Vector2 first = half(), second = half();
		Rectangles pair(first, second);
		const double scale = std::pow(10, -9 + 8 * unit());
		const auto nudge = [scale](PlanePose& pose) {
			pose.position += scale * Vector2(unit(), unit());
			pose.turn(scale * unit());
		};
		const bool above = i % 2, aligned = i % 3 == 0;
		const double aside = aligned ? first[1 - above] - second[1 - above] : unit() * (first[1 - above] + second[1 - above]);
		Vector2 centre;
		centre[above] = first[above] + second[above];
		centre[1 - above] = aside;
		PlanePose pose1 = at(0, 0, 0), pose2 = at(centre.x(), centre.y(), 0);
		for (int step = 0; step < 20; ++step) {
			REQUIRE(pair.decideAlike(pose1, pose2, 0.2));
			nudge(pose1);
			nudge(pose2);
		}
	}
}

TEST_CASE("the smallest gap of polygons is their separation")
{
	int touching = 0, apart = 0, slivers = 0;
	for (int i = 0; i < 200000; ++i) {
		const Pair pair = randomPair(i % 2 ? -0.05 * (1 + unit()) / 2 : 0.1 * (1 + unit()));
		const auto expected = pair.separation();
		const double length = pair.length(), margin = length;
		const Found found = find(pair, margin);
		CAPTURE(i, expected.value, expected.fromEnd, length, found.near, found.size(), found.smallestGap);
		if (expected.value > margin) {
			REQUIRE_FALSE(found.near);
			continue;
		}
		if (expected.fromEnd < 4 * tolerance::contact::sliver * length && !found.near) { // corner beside corner
			++slivers;
			REQUIRE(expected.value > -4 * tolerance::contact::sliver * length);
			continue;
		}
		REQUIRE(found.near);
		if (expected.value <= 0) {
			++touching;
			REQUIRE(std::abs(found.smallestGap - expected.value) < 1e-14);
		} else {
			++apart;
			const double cosine =
			    -pair.pose1.rotate(pair.shape1.faces()[found.face1].normal).dot(pair.pose2.rotate(pair.shape2.faces()[found.face2].normal));
			REQUIRE(found.smallestGap > expected.value * std::max(0., cosine) - 1e-14);
		}
	}
	CHECK(touching > 80000);
	CHECK(apart > 80000);
	CHECK(slivers < 2000);
}

// Oracle: bodies that are apart have no gap of 0 or less.
TEST_CASE("polygons that are farther apart than their thickness have no closed point")
{
	int found = 0;
	for (int i = 0; i < 200000; ++i) {
		const Pair pair = randomPair(30 * (1 + unit()));
		const Found points = find(pair, std::numeric_limits<double>::infinity());
		found += points.near;
		CAPTURE(i, pair.separation().value, pair.length());
		REQUIRE((!points.near || points.smallestGap > 0));
	}
	CHECK(found > 50000);
}

// The other order gives the same features seen from the other side, and the same frames but for their signs, bit by bit.
TEST_CASE("the order of two polygons changes no point")
{
	for (int i = 0; i < 50000; ++i) {
		const Pair pair = randomPair(0.05 * unit());
		Found found = find(pair, 0.1 * pair.length()),
		      swapped = find(pair.shape2, pair.pose2, pair.shape1, pair.pose1, 0.1 * pair.length());
		REQUIRE(found.near == swapped.near);
		REQUIRE(found.size() == swapped.size());
		Plane::addSecondNormals(pair.shape1, pair.pose1, pair.shape2, pair.pose2, found);
		Plane::addSecondNormals(pair.shape2, pair.pose2, pair.shape1, pair.pose1, swapped);
		REQUIRE(found.size() == swapped.size());
		CHECK(found.face1 == swapped.face2);
		CHECK(found.face2 == swapped.face1);
		for (int k = 0; k < found.places; ++k) {
			const int other = found.places - 1 - k;
			const Feature &a = found.features[k], &b = swapped.features[other];
			REQUIRE(a == Feature::ofVertex(3 - b.vertexBody(), b.vertex(), b.face()));
			CHECK(found.frames[k].gap == swapped.frames[other].gap);
			CHECK(found.frames[k].axes == -swapped.frames[other].axes);
		}
	}
}

// Its vertices have other numbers and its poses other digits; places and gaps are the same to round-off of numbers near 3.
TEST_CASE("a mirrored pair, and one in another frame, has the mirrored and moved points")
{
	const auto mirrored = [](const ConvexPolygon& shape) {
		Points points;
		for (const Vector2& vertex : shape.vertices())
			points.emplace_back(-vertex.x(), vertex.y());
		return ConvexPolygon::hull(points);
	};
	for (int i = 0; i < 50000; ++i) {
		const Pair pair = randomPair(0.05 * unit());
		const double margin = 0.1 * pair.length();
		const Found found = find(pair, margin);
		const auto mirror = [](const PlanePose& pose) { return at(-pose.position.x(), pose.position.y(), -pose.angle); };
		const PlanePose frame = at(unit(), unit(), 4 * unit());
		const auto moved = [&frame](const PlanePose& pose) {
			const Vector2 position = frame.toGlobal(pose.position);
			return at(position.x(), position.y(), pose.angle + frame.angle);
		};
		const Found other = find(mirrored(pair.shape1), mirror(pair.pose1), mirrored(pair.shape2), mirror(pair.pose2), margin),
		            there = find(pair.shape1, moved(pair.pose1), pair.shape2, moved(pair.pose2), margin);
		REQUIRE(found.size() == other.size());
		REQUIRE(found.features == there.features);
		for (int k = 0; k < found.size(); ++k) {
			const auto &a = found.frames[k], &b = other.frames[found.size() - 1 - k], &c = there.frames[k];
			CHECK(std::abs(a.gap - b.gap) < 1e-13);
			CHECK(std::abs(a.gap - c.gap) < 1e-13);
			CHECK((Vector2(-a.position.x(), a.position.y()) - b.position).norm() < 1e-13);
			CHECK((frame.toGlobal(a.position) - c.position).norm() < 1e-13);
		}
	}
}

// Corner on corner: the admissible normals u are those along which no point of body 2 is below the common corner and none of body 1 above
// it. All directions, 0.01 degrees apart, are tried; the normals of the point and of its second normal bound them.
TEST_CASE("corners of any angle have the normals between their two bounds")
{
	constexpr int directions = 36000;
	constexpr double spacing = 2 * M_PI / directions;
	int corners = 0, ofOtherFace = 0, beside = 0;
	for (int i = 0; i < 3000; ++i) {
		Pair pair {randomShape(), randomShape(), at(unit(), unit(), 4 * unit()), at(0, 0, 4 * unit())};
		const auto corner = [](const ConvexPolygon& shape) { return shape.vertices()[size_t((1 + unit()) / 2 * shape.vertices().size())]; };
		const Vector2 place = pair.pose1.toGlobal(corner(pair.shape1));
		pair.pose2.position = place - pair.pose2.rotate(corner(pair.shape2));
		const Points points1 = placed(pair.shape1, pair.pose1), points2 = placed(pair.shape2, pair.pose2);
		std::vector<Vector2> admissible;
		for (int k = 0; k < directions; ++k) {
			const Vector2 u(std::cos(k * spacing), std::sin(k * spacing));
			const auto reaches = [&](const Points& points, double sign) {
				return std::all_of(points.begin(), points.end(), [&](const Vector2& p) { return sign * u.dot(p - place) < 1e-14; });
			};
			if (reaches(points1, 1) && reaches(points2, -1))
				admissible.push_back(u);
		}
		Found found = find(pair, 0.01 * pair.length());
		if (admissible.size() * spacing < 0.03) // cornerSpread and the spacing
			continue;
		if (!found.near) { // both faces of the corner are past the end of the other's: corner beside corner
			++beside;
			continue;
		}
		Plane::addSecondNormals(pair.shape1, pair.pose1, pair.shape2, pair.pose2, found);
		REQUIRE(found.size() > found.places);
		for (int k = found.places; k < found.size(); ++k) {
			++corners;
			const auto normalOf = [&](int point) -> Vector2 {
				return Plane::frame(found.features[point], pair.shape1, pair.pose1, pair.shape2, pair.pose2).axes.row(0);
			};
			ofOtherFace += found.features[k].vertexBody() == found.features[found.cornerOf(k)].vertexBody();
			const Vector2 first = normalOf(found.cornerOf(k)), second = normalOf(k);
			const double between = std::acos(std::clamp(first.dot(second), -1., 1.));
			REQUIRE(between == Approx(admissible.size() * spacing).margin(2 * spacing));
			for (const Vector2& u : admissible)
				REQUIRE(std::max(std::acos(std::clamp(first.dot(u), -1., 1.)), std::acos(std::clamp(second.dot(u), -1., 1.))) <
				        between + spacing);
		}
	}
	CHECK(corners > 900);
	CHECK(ofOtherFace > 200); // the bound is a face of the body with the face, which right angles never have
	CHECK(beside < 300);
}

// An oblong and an upright block that is the same one turned by 90 degrees, flush and corner above corner: their faces are parallel, so
// that no corner has a second normal.
TEST_CASE("blocks turned by a quarter have the points of those that are not")
{
	const ConvexPolygon block = ConvexPolygon::box({0.5, 0.3}), turned = ConvexPolygon::box({0.3, 0.5});
	for (const double tilt : {-1e-3, 0., 1e-9, 1e-3}) {
		const auto frames = [&](const ConvexPolygon& upper, double angle) {
			const PlanePose pose1 = at(0, 0, 0), tilted = at(0, 0, tilt);
			const Vector2 pivot(tilt < 0 ? 0.5 : -0.5, 0.3), centre = pivot + tilted.rotate(Vector2(-pivot.x(), 0.3));
			const PlanePose pose2 = at(centre.x(), centre.y(), tilt + angle);
			Found found = find(block, pose1, upper, pose2, 0.01);
			Plane::addSecondNormals(block, pose1, upper, pose2, found);
			REQUIRE(found.size() == 2);
			return found.frames;
		};
		const auto plain = frames(block, 0), quarter = frames(turned, M_PI / 2);
		for (int k : {0, 1}) {
			CHECK((plain[k].position - quarter[k].position).norm() < 1e-15);
			CHECK(std::abs(plain[k].gap - quarter[k].gap) < 1e-15);
		}
	}
}
