// The restitution law where several joints, several corners or nothing at all carries a block: closed forms, invariants and
// conservation laws.
#include "impact/rocking_restitution.hpp"
#include <array>
#include <catch.hpp>
#include <cmath>
#include <cstdlib>
#include <new>
#include <random>

using namespace masonry;

namespace {

size_t allocations = 0;

} // namespace

void* operator new(size_t size)
{
	++allocations;
	if (void* memory = std::malloc(size))
		return memory;
	throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept // the sanitizer pairs it with the delete below
{
	++allocations;
	return std::malloc(size ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }

namespace {

struct Scene {
	Bodies<Space> bodies {1};
	RockingImpact<Space> impact;

	Scene() { bodies[0].prescribed = true; }

	int addBox(const Vector3& half, const Vector3& centre)
	{
		RigidBody<Space> body;
		body.pose.position = centre;
		body.mass = 2000 * 8 * half.prod();
		const Vector3 s = half.cwiseProduct(half);
		body.inertia = body.mass / 3 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
		bodies.push_back(body);
		return int(bodies.size()) - 1;
	}

	// The body turns with w about a point that stands still.
	void turnAbout(int body, const Vector3& point, const Vector3& w)
	{
		bodies[body].spin() = w;
		bodies[body].linear() = w.cross(bodies[body].pose.position - point);
	}

	// A joint between two bodies one above the other, with horizontal points.
	void addJoint(int support, int block, double C, double friction, const std::vector<Vector3>& newSupport,
	              const std::vector<Vector3>& oldSupport)
	{
		const int first = int(impact.points.size());
		for (const auto* side : {&newSupport, &oldSupport})
			for (const Vector3& x : *side)
				impact.points.push_back({support, block, x, Vector3::UnitZ(), friction});
		const int middle = first + int(newSupport.size());
		impact.joints.push_back({block, support, Vector3::UnitZ(), C, first, middle, int(impact.points.size())});
	}

	const JointResult& joint(int j = 0) const { return impact.joints[j].result; }
	const Vector3& axis() const { return impact.joints.front().landing.axis; }
	double closingSpeed(int i) const
	{
		const ImpulsePoint<Space>& p = impact.points[i];
		return (bodies[p.body2].velocityAt(p.position) - bodies[p.body1].velocityAt(p.position)).z();
	}

	// The whole scene turned about the vertical, or mirrored in the plane y = 0.
	void transform(const Matrix3& map)
	{
		const double handed = map.determinant(); // angular velocity is an axial vector
		for (RigidBody<Space>& body : bodies) {
			body.pose.position = map * body.pose.position;
			body.pose.orientation = Quaternion(Matrix3(handed * map * body.pose.orientation.toRotationMatrix()));
			body.linear() = map * body.linear();
			body.spin() = handed * (map * body.spin());
		}
		for (ImpulsePoint<Space>& point : impact.points)
			point.position = map * point.position;
	}
};

Vector3 corner(const Vector3& half, int x, int y) { return {x * half.x(), y * half.y(), 0}; }

// A box on corner O = (-x, -y) with random roll; `closing`: that many of the other three corners land.
Scene randomCorner(std::mt19937& random, double C, double friction, double twist, int closing)
{
	const auto number = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
	const double slenderness = number(1, 10);
	const Vector3 half(0.3, 0.3 * number(1, 2), 0.3 * slenderness);
	Scene scene;
	const int block = scene.addBox(half, {0, 0, half.z()});
	// Corners on the +x side come down when w_y > 0, those on the +y side when w_x < 0.
	scene.turnAbout(block, corner(half, -1, -1), {-number(0.01, 1), number(0.01, 1), number(-twist, twist)});
	std::vector<Vector3> landing {corner(half, 1, -1), corner(half, -1, 1), corner(half, 1, 1)};
	landing.resize(closing);
	scene.addJoint(0, block, C, friction, landing, {corner(half, -1, -1)});
	return scene;
}

} // namespace

TEST_CASE("A flat landing out of free flight is plastic: no row, and all of the energy of a vertical fall is lost")
{
	const Vector3 half(0.3, 0.4, 1.2);
	for (double C : {0., 0.7, 1.}) {
		Scene scene;
		const int block = scene.addBox(half, {0, 0, half.z()});
		scene.bodies[block].linear() = Vector3(0, 0, -2);
		scene.addJoint(0, block, C, 0.5, {corner(half, -1, -1), corner(half, -1, 1), corner(half, 1, -1), corner(half, 1, 1)}, {});
		const double energy = kineticEnergy(scene.bodies);
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		CHECK(scene.bodies[block].linear().norm() < 1e-14);
		CHECK(scene.bodies[block].spin().norm() < 1e-14);
		CHECK(result.energyLost == Approx(energy).epsilon(1e-12));
		CHECK(scene.axis().isZero(0));
		CHECK(scene.joint().application == 0);
		CHECK(!result.capped);
	}
}

TEST_CASE("A square base tilted about its diagonal keeps C^2 of the energy when its three other corners land at once")
{
	const double b = 0.3;
	for (double a : {0.6, 1.5, 3.})
		for (double C : {0., 0.5, 0.9, 1.}) {
			const Vector3 half(b, b, a);
			Scene scene;
			const int block = scene.addBox(half, {0, 0, a});
			scene.turnAbout(block, corner(half, -1, -1), Vector3(-1, 1, 0).normalized());
			scene.addJoint(0, block, C, noSlip, {corner(half, 1, -1), corner(half, -1, 1), corner(half, 1, 1)}, {corner(half, -1, -1)});
			const double energy = kineticEnergy(scene.bodies);
			const auto result = applyRockingImpact(scene.bodies, scene.impact);
			INFO("a " << a << " C " << C);
			CHECK(std::abs(kineticEnergy(scene.bodies) / energy - C * C) < 1e-10); // round-off of the solve
			CHECK(std::abs(scene.joint().restitution() - C) < 1e-11);
			CHECK((scene.axis() - Vector3(-1, 1, 0).normalized()).norm() < 1e-12);
			CHECK(!result.capped);
			CHECK(scene.bodies[block].velocityAt(corner(half, 1, 1)).norm() < 1e-10);
		}
	// Without a row: 1 - 2 m r^2 / I_O with r half the diagonal, I_O about the corner.
	const Vector3 half(b, b, 1.5);
	Scene scene;
	const int block = scene.addBox(half, {0, 0, 1.5});
	scene.turnAbout(block, corner(half, -1, -1), Vector3(-1, 1, 0).normalized());
	scene.addJoint(0, block, NAN, noSlip, {corner(half, 1, -1), corner(half, -1, 1), corner(half, 1, 1)}, {corner(half, -1, -1)});
	applyRockingImpact(scene.bodies, scene.impact);
	const double r2 = 2 * b * b, inertia = (b * b + 1.5 * 1.5) / 3 + 1.5 * 1.5 + r2;
	CHECK(scene.joint().restitution() == Approx(1 - 2 * r2 / inertia).epsilon(1e-10));
}

TEST_CASE("An edge that lands with one end a merge tolerance ahead of the other keeps C")
{
	// The roll about x that goes with it is a share 1e-6 of the rocking, so is the change of the ratio at most.
	const Vector3 half(0.3, 0.5, 1.5);
	for (double C : {0., 0.7, 1.}) {
		Scene scene;
		const int block = scene.addBox(half, {0, 0, half.z()});
		scene.turnAbout(block, corner(half, -1, -1), {1e-6, 1, 0});
		scene.addJoint(0, block, C, noSlip, {corner(half, 1, -1) + Vector3(0, 0, 5e-7), corner(half, 1, 1)},
		               {corner(half, -1, -1), corner(half, -1, 1)});
		applyRockingImpact(scene.bodies, scene.impact);
		CHECK(std::abs(scene.joint().restitution() - C) < 2e-6);
		CHECK(scene.bodies[block].velocityAt(corner(half, 1, 0)).norm() < 1e-5);
	}
}

TEST_CASE("Random corner states: no energy is gained, no point pulls, and the ratio is C unless the cap acts")
{
	std::mt19937 random(5);
	for (int trial = 0; trial < 2000; ++trial) {
		const double C = std::array<double, 4> {0, 0.5, 0.9, 1}[trial % 4];
		const double friction = trial / 4 % 2 ? noSlip : 0.3;
		const double twist = trial / 8 % 2;
		const int closing = 1 + trial % 3;
		Scene scene = randomCorner(random, C, friction, twist, closing);
		const double energy = kineticEnergy(scene.bodies);
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		INFO("trial " << trial << " C " << C << " friction " << friction << " twist " << twist << " closing " << closing << " residual "
		              << result.residual);
		CHECK(kineticEnergy(scene.bodies) <= energy * (1 + 2e-11)); // tolerance::energyGain and round-off
		CHECK(result.energyLost == Approx(energy - kineticEnergy(scene.bodies)).margin(1e-10 * energy));
		if (!result.capped)
			CHECK(std::abs(scene.joint().restitution() - C) < 1e-9);
		if (friction != noSlip)
			CHECK(result.residual < 1e-9);
		// The states that never ask for the cap: friction with C <= 0.9, one corner without twist.
		if (friction != noSlip && C > 0 && C <= 0.9)
			CHECK(!result.capped);
		if (twist == 0 && closing == 1)
			CHECK(!result.capped);
		const double noise = 1e-9 * scene.bodies[1].mass; // of speeds of order 1 m/s
		for (const ImpulsePoint<Space>& p : scene.impact.points) {
			CHECK(p.impulse.z() >= -noise);
			if (friction != noSlip)
				CHECK(p.impulse.head<2>().norm() <= friction * p.impulse.z() + noise);
		}
	}
}

TEST_CASE("For one landing corner the old support leaves with C times the speed of the landing")
{
	std::mt19937 random(9);
	for (int trial = 0; trial < 100; ++trial) {
		const double C = 0.2 * (trial % 5);
		Scene scene = randomCorner(random, C, noSlip, 0., 1);
		const double approach = scene.closingSpeed(0);
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		CHECK(result.residual < 1e-10);
		CHECK(scene.closingSpeed(1) == Approx(-C * approach).margin(1e-10));
	}
}

TEST_CASE("Turning the scene about the vertical or mirroring it turns and mirrors the answer")
{
	std::mt19937 random(17);
	Matrix3 mirror = Vector3(1, -1, 1).asDiagonal();
	for (int trial = 0; trial < 60; ++trial)
		for (const Matrix3& map : {Matrix3(Eigen::AngleAxisd(0.3 + trial, Vector3::UnitZ()).toRotationMatrix()), mirror}) {
			Scene ours = randomCorner(random, 0.9, trial % 2 ? noSlip : 0.3, 1., 1 + trial % 3), other = ours;
			other.transform(map);
			const auto result = applyRockingImpact(ours.bodies, ours.impact);
			applyRockingImpact(other.bodies, other.impact);
			ours.transform(map);
			INFO("trial " << trial << " residual " << result.residual);
			// Round-off times the condition number of the solve (slenderness up to 10).
			CHECK((ours.bodies[1].linear() - other.bodies[1].linear()).norm() < 1e-11);
			CHECK((ours.bodies[1].spin() - other.bodies[1].spin()).norm() < 1e-11);
		}
}

namespace {

// Two boxes, the upper one a little turned, rock as one body about the lower edge x = -b of the base joint, and both
// joints or the lower one alone are at the instant of closing.
Scene rockingStack(double C, double friction, bool both)
{
	const double b = 0.3, a = 0.6;
	const Vector3 half(b, b, a), up(0, 0, 2 * a);
	Scene scene;
	for (int k = 0; k < 2; ++k)
		scene.turnAbout(scene.addBox(half, Vector3(0, 0, a) + k * up), {-b, 0, 0}, {0, 1, 0});
	std::vector<Vector3> right {corner(half, 1, -1), corner(half, 1, 1)}, left {corner(half, -1, -1), corner(half, -1, 1)};
	scene.addJoint(0, 1, C, friction, right, left);
	for (auto* side : {&right, &left})
		for (Vector3& x : *side)
			x += up;
	if (both) {
		scene.turnAbout(2, up - Vector3(b, 0, 0), {0, 2, 0}); // the upper joint closes as fast as the lower one
		scene.bodies[2].linear() += scene.bodies[1].velocityAt(up - Vector3(b, 0, 0));
		scene.addJoint(1, 2, C, friction, right, left);
	} else {
		scene.addJoint(1, 2, NAN, friction, right, left);
		scene.impact.joints.pop_back(); // its points touch, and stay
		for (ImpulsePoint<Space>& point : scene.impact.points)
			point.holds = true;
	}
	return scene;
}

} // namespace

TEST_CASE("Simultaneous law: two joints that close at one instant both have their C, and energy balances")
{
	for (double C : {0.3, 0.7, 0.9}) {
		Scene scene = rockingStack(C, noSlip, true);
		const double energy = kineticEnergy(scene.bodies);
		const auto result = applyRockingImpact(scene.bodies, scene.impact);
		INFO("C " << C << " residual " << result.residual << " capped " << result.capped);
		CHECK(!result.capped);
		for (int j : {0, 1})
			CHECK(std::abs(scene.joint(j).restitution() - C) < 1e-10);
		CHECK(result.energyLost == Approx(energy - kineticEnergy(scene.bodies)).epsilon(1e-9));
		CHECK(result.energyLost > 0);
	}
}

TEST_CASE("Sequential law: the pair alone, then a plastic problem of everything, and the ratio reported is the realised one")
{
	// The same two stages with solveImpulses alone. The pair: the lower block on its own keeps C about the base edge.
	for (double friction : {0.7, noSlip}) {
		const double C = 0.8;
		Scene scene = rockingStack(C, friction, false), other = scene;
		const double energy = kineticEnergy(scene.bodies);
		const auto result = applySequentially(scene.bodies, scene.impact);

		ImpulsePoints<Space> own(other.impact.points.begin(), other.impact.points.begin() + 4);
		CoupleRows<Space> row {{0, 1, Vector3::UnitY(), C}}, none;
		solveImpulses(other.bodies, own, row);
		CHECK(other.bodies[1].spin().y() == Approx(C).epsilon(1e-10));
		solveImpulses(other.bodies, other.impact.points, none);
		for (int b : {1, 2}) {
			CHECK((scene.bodies[b].linear() - other.bodies[b].linear()).norm() < 1e-10);
			CHECK((scene.bodies[b].spin() - other.bodies[b].spin()).norm() < 1e-10);
		}
		// What a joint has carried and asked for is of both stages: the lower one's new edge, points 0 and 1.
		const Vector3 pressed = own[0].impulse + own[1].impulse + other.impact.points[0].impulse + other.impact.points[1].impulse;
		CHECK(other.impact.points[0].impulse.norm() > 0.01 * own[0].impulse.norm());
		CHECK((scene.impact.points[0].impulse + scene.impact.points[1].impulse - pressed).norm() < 1e-10 * pressed.norm());
		CHECK(scene.joint().frictionDemand == Approx(std::hypot(pressed.x(), pressed.y()) / pressed.z()).epsilon(1e-10));
		CHECK(scene.joint().application == Approx(row[0].couple / pressed.z()).epsilon(1e-10));
		CHECK(scene.joint().after == Approx(scene.bodies[1].spin().y()).epsilon(1e-12));
		CHECK(result.energyLost == Approx(energy - kineticEnergy(scene.bodies)).epsilon(1e-9));
		CHECK(result.energyLost > 0);
	}
}

TEST_CASE("For one block alone both laws are the same")
{
	std::mt19937 random(23);
	for (int trial = 0; trial < 50; ++trial) {
		Scene ours = randomCorner(random, 0.7, 0.3, 1., 1), other = ours;
		applyRockingImpact(ours.bodies, ours.impact);
		applySequentially(other.bodies, other.impact);
		CHECK((ours.bodies[1].linear() - other.bodies[1].linear()).norm() < 1e-9);
	}
}

TEST_CASE("A second impact of the same size takes no memory from the heap")
{
	for (const auto law : {applyRockingImpact<Space>, applySequentially<Space>})
		for (double C : {0.7, 1.}) {
			Scene scene = rockingStack(C, 0.5, true);
			auto start = scene.bodies;
			law(scene.bodies, scene.impact);
			std::swap(scene.bodies, start);
			const size_t before = allocations;
			law(scene.bodies, scene.impact);
			CHECK(allocations == before);
		}
}
