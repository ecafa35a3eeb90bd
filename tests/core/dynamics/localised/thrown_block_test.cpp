// Blocks that are thrown on a base: their motion depends neither on the axes of the world, nor on the scale, nor on which hand is the
// right.
#include "core/dynamics/localised/space_rig.hpp"
#include <catch.hpp>
#include <random>

using namespace rig;

namespace {

// Another view of the same scene: mirrored in the plane y = 0, then turned about the vertical, lengths times `scale` and times times its
// root.
struct View {
	double turned {0}, scale {1};
	bool mirrored {false};

	Vector3 hand() const { return {1, mirrored ? -1. : 1., 1}; }
	Quaternion about() const { return turn(turned, Vector3::UnitZ()); }
	Vector3 vector(const Vector3& v) const { return about() * hand().cwiseProduct(v); }
	Vector3 spin(const Vector3& w) const { return (mirrored ? -1. : 1.) * vector(w); } // a spin is a cross product of two vectors
	Quaternion orientation(const Quaternion& q) const
	{
		const Matrix3 hands = hand().asDiagonal();
		return about() * Quaternion(hands * q.toRotationMatrix() * hands);
	}
	double time() const { return std::sqrt(scale); }
};

struct Throw {
	Vector3 half, velocity, spin;
	Quaternion orientation;
	double height, friction, restitution, h;

	explicit Throw(std::mt19937& random)
	{
		const auto number = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
		const auto vector = [&](double size) {
			const double x = number(-size, size), y = number(-size, size);
			return Vector3(x, y, number(-size, size));
		};
		const double a = number(.1, .5), b = number(.1, .5);
		half = {a, b, number(.1, .5)};
		velocity = vector(2);
		spin = vector(3);
		const Vector3 axis = vector(1);
		orientation = turn(number(0, .4), axis);
		height = number(1, 1.3) * half.norm();
		friction = number(.2, .8);
		restitution = std::array<double, 3> {0, .5, NAN}[int(number(0, 3))];
		h = 5e-4 * std::sqrt(half.norm());
	}

	System scene(const View& view) const
	{
		System s = emptyScene<Space>(20 * view.scale, view.scale);
		s.bodies[0].pose.orientation = view.about();
		Pose pose;
		pose.position = view.scale * Vector3(0, 0, height);
		pose.orientation = view.orientation(orientation);
		addBox(s, view.scale * half, pose);
		s.bodies[1].velocity << view.scale / view.time() * view.vector(velocity), 1 / view.time() * view.spin(spin);
		addPair(s, 0, 1, restitution, friction);
		return s;
	}
};

struct Flight {
	System s;
	LocalisedStep<Space> step {};
	double made {0}; // J

	void advance(double h)
	{
		const double before = energyOf(s);
		CHECK(step.advance(s, h).converged);
		made = std::max(made, energyOf(s) - before);
		for (const Impact& impact : s.impacts)
			if (!impact.capped && !std::isnan(impact.asked) && impact.switched)
				CHECK(impact.joint.after == Approx(impact.asked * impact.joint.before).margin(1e-9));
	}
};

} // namespace

// Oracle: symmetry. Bound, of speeds relative to sqrt(g R): a slip that is slower than 1e-3 g h = 1e-6 sqrt(g R) may end anywhere in a step
// (tolerance::localised::slowSlip), and the landings that follow multiply that by up to a hundred.
TEST_CASE("a thrown block moves alike in all views", "[long]")
{
	std::mt19937 random(5);
	const std::vector<View> views {{1}, {2.5}, {0, 3}, {0, 37}, {0, 1, true}, {2, 10, true}};
	for (int k = 0; k < 150; ++k) {
		const Throw thrown(random);
		CAPTURE(k, thrown.restitution, thrown.friction);
		const double radius = thrown.half.norm(), speed = std::sqrt(g * radius);
		Flight first {thrown.scene({})};
		std::vector<Flight> others;
		for (const View& view : views)
			others.push_back({thrown.scene(view)});
		double worst = 0;
		for (int n = 0; n < 800; ++n) {
			first.advance(thrown.h);
			for (size_t v = 0; v < views.size(); ++v) {
				const View& view = views[v];
				others[v].advance(view.time() * thrown.h);
				const auto &one = first.s.bodies[1].velocity, &other = others[v].s.bodies[1].velocity;
				const Vector3 velocity = view.vector(one.head<3>()) - view.time() / view.scale * other.head<3>(),
				              spin = view.spin(one.tail<3>()) - view.time() * other.tail<3>();
				worst = std::max({worst, velocity.norm() / speed, spin.norm() * radius / speed});
			}
		}
		CHECK(worst < 1e-4);
		CHECK(first.made < 1e-6 * overturning(first.s.bodies[1]));
	}
}
