// Sweeps with the widest vectors of this processor against those with narrow ones.
#include "dynamics/wall/sweep_groups.hpp"
#include <catch.hpp>
#include <random>

using namespace masonry::rigid;
using namespace masonry::rigid::wall;

namespace {

constexpr int groupCount = 7, bodyCount = 2 * width * groupCount; // not a whole number of wide groups; each lane has its own bodies

template <class K>
struct Scene {
	std::mt19937 random {7};
	std::vector<Group<K>> groups {groupCount};
	Array<FloatPack> velocity;

	float number(double least, double most) { return float(std::uniform_real_distribution<>(least, most)(random)); }

	Scene()
	{
		for (int b = 0; b <= bodyCount; ++b)
			for (int pack = 0; pack < packs<K>; ++pack) {
				const float perMass = b < bodyCount && b % 5 != 0 ? 1e-3f : 0; // some are prescribed, the last is that of empty lanes
				velocity.push_back(FloatPack {number(-1, 1), number(-1, 1), number(-1, 1), perMass});
			}
		for (int g = 0; g < groupCount; ++g) {
			Group<K>& group = groups[g];
			group.setCount(lanePoints<K>);
			group.friction = all(0.5);
			for (int i = 0; i < width; ++i) {
				group.body1[i] = 2 * (width * g + i);
				group.body2[i] = group.body1[i] + 1;
			}
			for (PointLanes<K>& p : group.point) { // any numbers will do: the same goes in
				auto* numbers = reinterpret_cast<double*>(&p);
				for (size_t k = 0; k < sizeof p / sizeof(double); ++k)
					numbers[k] = number(0.1, 1);
				for (int i = 0; i < width; ++i)
					p.gap[i] = number(-1e-3, 1e-3);
			}
		}
	}
};

// All that a substep does and tells, in numbers.
template <class K>
std::vector<double> substep(SweepGroups<K>& points)
{
	Scene<K> scene;
	std::vector<Quarters> which;
	for (int g = 0; g < groupCount; ++g) {
		if (g % points.quarters() == 0)
			which.push_back({-1, -1, -1, -1});
		which.back()[g % points.quarters()] = g;
	}
	Group<K> empty {};
	for (int i = 0; i < width; ++i)
		empty.body1[i] = empty.body2[i] = bodyCount;
	for (PointLanes<K>& p : empty.point)
		p.gap = all(farAway);
	const int count = int(which.size());
	Array<FloatPack> contactPart, known;
	for (const FloatPack& pack : scene.velocity) {
		contactPart.push_back(FloatPack {0, 0, 0, pack[3]});
		known.push_back(FloatPack {pack[3] > 0 ? scene.number(0, 1) : 0, 0, 0, pack[3]});
	}
	points.resize(count);
	points.take(scene.groups.data(), which.data(), empty, 0, count, known.data());
	for (const bool watched : {false, true})
		points.sweep(0, count, scene.velocity.data(), {8000, 1.2f, 0.02f, 0.1f, -1e-4f, 1000, 0.1f, !watched, watched});
	points.moveGaps(0, count, scene.velocity.data(), 1.25e-4f);
	points.sum(0, count, contactPart.data());
	Lanes loss = all(0);
	points.handOn(0, count, scene.velocity.data(), {0.1f, 0.02f, 1e-3f, 0.1f, FloatPack {1, -1, 0, 0}}, contactPart.data(), loss);
	const LaneArray shift(packs<K> * (bodyCount + 1), all(1e-3));
	points.giveBack(0, count, which.data(), shift.data(), scene.groups.data());

	std::vector<double> numbers {points.residual()};
	for (int i = 0; i < width; ++i)
		numbers.push_back(loss[i]);
	for (const auto* packsOfBodies : {&scene.velocity, &contactPart})
		for (const FloatPack& pack : *packsOfBodies)
			for (int k = 0; k < 4; ++k)
				numbers.push_back(pack[k]);
	for (int g = 0; g < groupCount; ++g) {
		Lanes motion;
		points.motion(g / points.quarters(), g % points.quarters(), motion);
		for (int i = 0; i < width; ++i) {
			numbers.push_back(motion[i]);
			for (const PointLanes<K>& p : scene.groups[g].point)
				for (const double number : {p.gap[i], p.pn[i], p.steady[i], component(p.pt, 0, i)})
					numbers.push_back(number);
		}
	}
	return numbers;
}

} // namespace

// Each lane is computed as a scalar would be, and sums are in the same order. Where the widest vectors are narrow the test says nothing.
TEMPLATE_TEST_CASE("the widest sweeps give the bits of narrow ones", "", Plane, Space)
{
	const auto wide = sweepGroups<TestType>(), narrow = narrowSweepGroups<TestType>();
	const std::vector<double> expected = substep(*narrow);
	CHECK(substep(*wide) == expected);
	CHECK(std::all_of(expected.begin(), expected.end(), [](double number) { return std::isfinite(number); }));
	CHECK(expected[0] > 0); // the sweeps have something to do
}

// A block that falls on a base at v with both points d deep: before the move its share of
// d - allowed goes in the substep, or as fast as is allowed; without
// parting, after the move, it stops, by m v and no more. Bound: a rounding in single precision of v.
TEST_CASE("a point that is too deep parts, and is let go again")
{
	const double mass = 1000, v = 0.01, allowed = 1e-6, perSubstep = 8000, fastest = 1.2e-3;
	const double share = GENERATE(0., 0.4), d = GENERATE(0.5e-6, 1.2e-6, 3e-6);
	const double rise = std::min(std::max(0., share * perSubstep * (d - allowed)), fastest);
	const auto points = GENERATE(0, 1) ? sweepGroups<Plane>() : narrowSweepGroups<Plane>();
	Group<Plane> group {}, empty {};
	for (int i = 0; i < width; ++i)
		group.body1[i] = group.body2[i] = empty.body1[i] = empty.body2[i] = 2; // of no lane
	group.body1[0] = 0;
	group.body2[0] = 1;
	for (int k = 0; k < 2; ++k) {
		empty.point[k].gap = group.point[k].gap = all(farAway);
		PointLanes<Plane>& p = group.point[k];
		p.ny[0] = 1;
		p.a2n[0] = k == 0 ? -0.8 : 0.8;
		p.massN[0] = mass / (1 + 0.8 * 0.8);
		p.massT[0] = mass;
		p.gap[0] = -d;
	}
	Array<FloatPack> velocity {FloatPack {}, FloatPack {0, float(-v), 0, float(1 / mass)}, FloatPack {}}, known = velocity;
	known[1] = FloatPack {float(share), 0, 0, float(1 / mass)};
	const Quarters which {0, -1, -1, -1};
	points->resize(1);
	points->take(&group, &which, empty, 0, 1, known.data());
	const auto impulse = [&] {
		double sum = 0;
		for (int k = 0; k < 2; ++k) {
			double rows[2];
			points->impulse(0, 0, k, rows);
			sum += rows[0];
		}
		return sum;
	};
	constexpr double single = 1e-6;
	points->sweep(0, 1, velocity.data(), {8000, 1, 0, 0, float(-allowed), float(perSubstep), float(fastest), false, false});
	CHECK(velocity[1][1] == Approx(rise).margin(single * v));
	CHECK(impulse() == Approx(mass * (v + rise)).epsilon(single));
	points->sweep(0, 1, velocity.data(), {8000, 1, 0, 0, float(-allowed), 0, float(fastest), false, true});
	CHECK(std::abs(velocity[1][1]) < single * v);
	CHECK(impulse() == Approx(mass * v).epsilon(single));
}

// Of four points of a face three tell the motion of the block, so that A = J M^-1 J^T has no inverse. What velocities no motion has
// (+ - - +) are answered by nothing, and not by impulses without end: in single precision with e = 5e-3 by the mass times 1e-7 / e^2.
// Bound: a tenth of the mass. Those of a motion are answered by what gives them, but for 2 e over the eigenvalue of D^-1 A: with
// D = (1 + (x^2 + y^2)/rho^2)/m, 4/(m D) of a shift, 4 (y/rho)^2/(m D) and 4 (x/rho)^2/(m D) of a turn; and for rounding, 1e-7 / e of
// velocities of some m/s.
TEST_CASE("the normals of a face's four points answer what a motion can ask of them")
{
	std::mt19937 random(3);
	const auto number = [&](double least, double most) { return float(std::uniform_real_distribution<>(least, most)(random)); };
	for (int sample = 0; sample < 100; ++sample) {
		const float mass = number(100, 1e4), x = number(0.1, 1), y = number(0.1, 1), rho = number(0.3, 0.6), height = number(-1, 0);
		const Floats none = all<Floats>(0), perMass = all<Floats>(1 / mass);
		PointLanes<Space, Floats> point[4];
		for (int i = 0; i < 4; ++i) {
			Row<Floats>& normal = point[i].normal;
			const float r[] = {number(0, 1e-6f) + (i & 1 ? x : -x), i & 2 ? y : -y, height};
			normal.axis = {none, none, all<Floats>(1)};
			normal.arm1 = {none, none, none};
			normal.arm2 = {all<Floats>(r[1] / rho), all<Floats>(-r[0] / rho), none};
			point[i].massN = normalMass(point[i], none, perMass);
		}
		Coupling<Space, Floats> w {};
		w.set(point, none, perMass);
		const auto impulses = [&](const std::array<double, 4>& velocity) {
			std::array<double, 4> p {};
			for (int i = 0; i < 4; ++i)
				for (int j = 0; j < 4; ++j)
					p[i] += w.inverse[w.place(i, j)][0] * velocity[j];
			return p;
		};
		for (const double p : impulses({1, -1, -1, 1}))
			CHECK(std::abs(p) < 0.1 * mass);
		const double v = number(-1, 1), spinX = number(-1, 1), spinY = number(-1, 1);
		std::array<double, 4> asked;
		for (int i = 0; i < 4; ++i)
			asked[i] = v + spinX * point[i].normal.arm2.x[0] + spinY * point[i].normal.arm2.y[0];
		const double e = 5e-3, ax = y / rho, ay = x / rho, mD = 1 + ax * ax + ay * ay;
		const double bound = 1e-4 + 2 * e * mD / 4 * (std::abs(v) + std::abs(spinX) / ax + std::abs(spinY) / ay);
		const auto p = impulses(asked);
		for (int i = 0; i < 4; ++i) {
			double got = 0;
			for (int j = 0; j < 4; ++j)
				got += w.response[w.place(i, j)][0] * p[j];
			CHECK(std::abs(got - asked[i]) < bound);
		}
	}
}
