// Corners that meet corners: frames that lean on each other, in the plane and in space.
#include "core/dynamics/localised/space_rig.hpp"
#include <algorithm>
#include <catch.hpp>

using namespace rig;

namespace {

// A block of thickness t and length L that leans by the angle th against the upright through `x`, on the side 1 or -1 of it, foot at the
// height z: its foot is at x + side L sin th, its upper inner corner at (x, z + L cos th).
struct Leaning {
	double t, L, th, side {1}, x {0}, z {0}, weight {1}; // weight: relative to that of its density
	Vector2 center() const { return {x + side * (std::cos(th) * t + std::sin(th) * L) / 2, z + (std::sin(th) * t + std::cos(th) * L) / 2}; }
};

constexpr double depth = 0.4; // m, half size across the plane, in space

int add(RigidSystem<Plane>& s, const Vector2& half, const Vector2& center, double angle, double weight)
{
	return addBlock(s, half.x(), half.y(), center, angle, weight * density * 4 * half.prod());
}
// Bodies with odd numbers are narrower: their vertices are then on edges, not on vertices.
int add(RigidSystem<Space>& s, const Vector2& half, const Vector2& center, double angle, double weight, double odd)
{
	Pose pose;
	pose.position << center.x(), 0, center.y();
	pose.orientation = turn(-angle, Vector3::UnitY());
	const bool narrow = s.bodies.size() % 2 == 1;
	const int b = addBox(s, {half.x(), narrow ? odd * depth : depth, half.y()}, pose);
	const double factor = weight * (narrow ? 1 / odd : 1);
	s.bodies[b].mass *= factor;
	s.bodies[b].inertia *= factor;
	s.bodies[b].force *= factor;
	return b;
}

template <class K>
struct Frames {
	RigidSystem<K> s = emptyScene<K>();
	double odd {1};

	int add(const Vector2& half, const Vector2& center, double angle = 0, double weight = 1)
	{
		if constexpr (K::dimension == 2)
			return ::add(s, half, center, angle, weight);
		else
			return ::add(s, half, center, angle, weight, odd);
	}
	int add(const Leaning& l) { return add({l.t / 2, l.L / 2}, l.center(), l.side * l.th, l.weight); }
	void meet(int body1, int body2, double friction) { addPair(s, std::min(body1, body2), std::max(body1, body2), 0, friction); }
	double along(int b) const { return s.bodies[b].pose.position[0]; }
};

// Largest way of a block, and of the middle between blocks 1 and 2, in a time. m
struct Moved {
	double farthest {0}, middle {0}, residual {0};
};

template <class K>
Moved run(Frames<K>& f, double time, double dt = 1e-3)
{
	LocalisedStep<K> step;
	Moved moved;
	std::vector<typename K::Vector> start;
	for (const auto& body : f.s.bodies)
		start.push_back(body.pose.position);
	while (f.s.time < time) {
		const StepReport report = step.advance(f.s, dt);
		REQUIRE_FALSE(report.diverged);
		for (size_t b = 0; b < start.size(); ++b)
			moved.farthest = std::max(moved.farthest, (f.s.bodies[b].pose.position - start[b]).norm());
		moved.middle = std::max(moved.middle, std::abs(f.along(1) + f.along(2) - start[1][0] - start[2][0]));
		moved.residual = std::max(moved.residual, report.residual);
	}
	return moved;
}

// Moments of one block about its foot: H L cos th = W (L sin th - t cos th)/2, and the foot carries W: mu = H/W.
double frictionOfFrame(double th, double slender) { return (std::tan(th) - 1 / slender) / 2; }

template <class K>
Frames<K> aFrame(double th, double slender, double friction, double atTop, bool swapped, double odd = 1)
{
	Frames<K> f;
	f.odd = odd;
	const double L = 1, t = L / slender;
	const int first = f.add(Leaning {t, L, th, swapped ? 1. : -1.}), second = f.add(Leaning {t, L, th, swapped ? -1. : 1.});
	f.meet(0, first, friction);
	f.meet(0, second, friction);
	f.meet(first, second, atTop);
	return f;
}

constexpr double margin = 0.02; // of the friction: what the criteria are tested with
constexpr double stands = 1e-6; // m, a block of 1 m that stands
constexpr double falls = 1e-4;  // m, one that falls: of the least friction, 0.013, 2 % are 2.6e-4 g, which is 3e-4 m in half a second
// The solver's residual of 1e-9 of what gravity gives in a step leaves 1e-9 g t^2/2 = 1.2e-9 m, and a frame that falls increases it.
constexpr double symmetric = 1e-8; // m

template <class K>
void requireFrame(double th, double slender, double atTop, bool swapped, double odd = 1)
{
	CAPTURE(K::dimension, th, slender, atTop, swapped, odd);
	const double mu = frictionOfFrame(th, slender);
	auto enough = aFrame<K>(th, slender, (1 + margin) * mu, atTop, swapped, odd);
	const Moved at = run(enough, 0.5);
	CHECK(at.farthest < stands);
	CHECK(at.middle < symmetric);
	auto less = aFrame<K>(th, slender, (1 - margin) * mu, atTop, swapped, odd);
	const Moved gone = run(less, 0.5);
	CHECK(gone.farthest > falls);
	CHECK(gone.middle < symmetric);
}

// Two frames upon each other: the upper one stands on a plate on the upper outer corners of the lower one, at t cos th from its middle. The
// plate is smooth below. With W, W' the weights of a lower and an upper block and P = (plate + 2 W')/2 that on one corner, moments about
// the foot give H L cos th = (W/2 + P)(L sin th - t cos th), and the foot carries W + P. The upper frame is one on its own.
template <class K>
Frames<K> cardHouse(double th, double upperTh, double factor, double upperFactor)
{
	Frames<K> f;
	const double t = 0.1, L = 1, plate = 0.04, W = t * L, upper = 0.8, P = (plate * 2 * upper + 2 * t * upper) / 2;
	const double mu = (W / 2 + P) / (W + P) * (std::tan(th) - t / L), muUpper = frictionOfFrame(upperTh, upper / t);
	const double height = L * std::cos(th) + t * std::sin(th);
	const int a = f.add(Leaning {t, L, th, -1}), b = f.add(Leaning {t, L, th, 1});
	const int p = f.add({upper, plate / 2}, {0, height + plate / 2});
	const int c = f.add(Leaning {t, upper, upperTh, -1, 0, height + plate}), d = f.add(Leaning {t, upper, upperTh, 1, 0, height + plate});
	for (const int foot : {a, b})
		f.meet(0, foot, factor * mu);
	f.meet(a, b, 0);
	for (const int corner : {a, b})
		f.meet(corner, p, 0);
	for (const int foot : {c, d})
		f.meet(p, foot, upperFactor * muUpper);
	f.meet(c, d, 0);
	return f;
}

// Three hinges: two equal blocks with feet that do not slip, the second k times as heavy. With l the arm of a weight about its foot, x, h
// those of the upper corner and (H, V) the force on block 2 there, moments about the feet give h H - x V = W l and h H + x V = k W l, so
// that tan(delta) = V/H = (k - 1)/(k + 1) h/x. The normals are between -th and th, hence |delta| <= th + atan(mu).
template <class K>
Frames<K> threeHinges(double th, double friction, double factor, bool mirrored)
{
	Frames<K> f;
	const double share = std::tan(th) * std::tan(factor * (th + std::atan(friction))), k = (1 + share) / (1 - share);
	Leaning light {0.1, 1, th, -1}, heavy {0.1, 1, th, 1};
	heavy.weight = k;
	if (mirrored)
		std::swap(light.side, heavy.side);
	const int a = f.add(light), b = f.add(heavy);
	f.meet(0, a, noSlip);
	f.meet(0, b, noSlip);
	f.meet(a, b, friction);
	return f;
}

} // namespace

TEMPLATE_TEST_CASE("corners: a frame of two leaning blocks stands from mu = (tan th - t/L)/2 on and is symmetric", "[corner]", Plane, Space)
{
	for (const double th : {0.15, 0.3, 0.6, 0.9})
		for (const double slender : {8., 20.})
			for (const double atTop : {0., 0.5})
				requireFrame<TestType>(th, slender, atTop, false);
	requireFrame<TestType>(0.3, 10, 0.2, true);
}

TEST_CASE("corners: a frame of blocks of different depths stands likewise", "[corner]")
{
	for (const double odd : {0.7, 1.3})
		requireFrame<Space>(0.3, 10, 0, false, odd);
}

TEMPLATE_TEST_CASE("corners: a card house stands while the feet of both its frames hold", "[corner]", Plane, Space)
{
	const auto moved = [](double lower, double upper) {
		auto house = cardHouse<TestType>(0.3, 0.4, lower, upper);
		return run(house, 0.5);
	};
	const Moved at = moved(1 + margin, 1 + margin);
	CHECK(at.farthest < stands);
	CHECK(at.middle < symmetric);
	CHECK(moved(1 - margin, 1 + margin).farthest > falls);
	CHECK(moved(1 + margin, 1 - margin).farthest > falls);
}

TEMPLATE_TEST_CASE("corners: three hinges hold while their force is between the normals of the faces and the friction angle", "[corner]",
                   Plane, Space)
{
	for (const double th : {0.3, 0.5})
		for (const double friction : {0., 0.1, 0.3})
			for (const bool mirrored : {false, true}) {
				CAPTURE(TestType::dimension, th, friction, mirrored);
				auto holds = threeHinges<TestType>(th, friction, 1 - margin, mirrored);
				CHECK(run(holds, 0.5).farthest < stands);
				auto slips = threeHinges<TestType>(th, friction, 1 + margin, mirrored);
				CHECK(run(slips, 0.5).farthest > falls);
			}
}

// Two frames' halves that fall against each other meet with both corners at one instant: the answer is symmetric.
TEMPLATE_TEST_CASE("corners: blocks that fall against each other stay mirror images", "[corner]", Plane, Space)
{
	for (const bool swapped : {false, true}) {
		Frames<TestType> f;
		const double gap = 0.02;
		const int first = f.add(Leaning {0.1, 1, 0.3, swapped ? 1. : -1., swapped ? gap : -gap}),
		          second = f.add(Leaning {0.1, 1, 0.3, swapped ? -1. : 1., swapped ? -gap : gap});
		f.meet(0, first, 0.6);
		f.meet(0, second, 0.6);
		f.meet(first, second, 0.3);
		const Moved moved = run(f, 0.5);
		CHECK(moved.middle < symmetric);
		CHECK(std::abs(f.along(1) - f.along(2)) > 0.3); // they have not passed each other
	}
}

// A corner that moves over the face of another body slides on that face, from the border on: its own face has no say.
TEMPLATE_TEST_CASE("corners: a corner that moves over a face is not held by the other one", "[corner]", Plane, Space)
{
	for (const double speed : {0.3, -0.3}) {
		Frames<TestType> f;
		const double th = 0.3, L = 1, t = 0.2;
		const int block = f.add(Leaning {t, L, th, 1, 5 - L * std::sin(th)}); // its foot on the border of the base
		f.meet(0, block, 0);
		f.s.bodies[block].velocity[0] = speed;
		LocalisedStep<TestType> step;
		step.advance(f.s, 1e-3);
		CAPTURE(TestType::dimension, speed);
		// A smooth face gives no impulse along itself; the weight's push in a step is below g dt.
		const double tilt = f.s.bodies[block].velocity[0] - speed;
		CHECK(std::abs(tilt) < 1e-12);
	}
}
