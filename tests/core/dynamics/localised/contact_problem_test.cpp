// The contact solver against a dense solver of the same laws, against the other dimension, and against what must always hold.
#include "dynamics/localised/localised_step.hpp"
#include "impact/sparse_impulses.hpp"
#include "laws/contact_problem.hpp"
#include "space_rig.hpp"
#include <atomic>
#include <catch.hpp>
#include <cstdlib>
#include <new>
#include <random>

using namespace masonry;
using namespace masonry::localised;

namespace {

std::atomic<long> allocations {0};

} // namespace

void* operator new(std::size_t size)
{
	++allocations;
	if (void* p = std::malloc(size ? size : 1))
		return p;
	throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept // the sanitizer pairs it with the delete below
{
	++allocations;
	return std::malloc(size ? size : 1);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace {

using Random = std::mt19937;

double number(Random& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

Vector3 vector(Random& random, double size)
{
	return {number(random, -size, size), number(random, -size, size), number(random, -size, size)};
}

// A column of boxes on a base (body 0), normals up. Planar: motion in x, z alone.
struct Column {
	Bodies<Space> bodies;
	ImpulsePoints<Space> points;
};

RigidBody<Space> boxBody(const Vector3& centre, const Vector3& half, double density)
{
	RigidBody<Space> body;
	body.pose.position = centre;
	body.mass = 8 * density * half.prod();
	const Vector3 squares = half.cwiseAbs2();
	body.inertia = body.mass / 3 * Vector3(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
	return body;
}

Column randomColumn(Random& random, double friction, bool planar, int most = 3)
{
	Column column;
	const int blocks = 1 + int(number(random, 0, most));
	RigidBody<Space> base;
	base.prescribed = true;
	column.bodies.push_back(base);
	double top = 0;
	Vector3 below(2, 2, 2);
	for (int b = 1; b <= blocks; ++b) {
		const Vector3 half(number(random, 0.1, 0.5), number(random, 0.1, 0.5), number(random, 0.1, 1.));
		RigidBody<Space> body = boxBody({0, 0, top + half.z()}, half, std::pow(10., number(random, 2, 4)));
		body.linear() = vector(random, 1);
		body.spin() = vector(random, 2);
		if (planar) {
			body.linear().y() = 0;
			body.spin() = Vector3(0, body.spin().y(), 0);
		}
		const Vector3 face = half.cwiseMin(below);
		const Quaternion turn(Eigen::AngleAxisd(planar ? 0. : number(random, 0, 0.2), Vector3::UnitZ()));
		const int touching = int(number(random, 0, 3)); // all four, an edge, a corner
		for (int corner = 0; corner < (planar ? 2 : 4) >> (planar ? std::min(touching, 1) : touching); ++corner) {
			const double y = planar ? 0 : corner & 2 ? -face.y() : face.y();
			column.points.push_back({b - 1, b, turn * Vector3(corner & 1 ? -face.x() : face.x(), y, top), Vector3::UnitZ(), friction});
		}
		top += 2 * half.z();
		below = half;
		column.bodies.push_back(body);
	}
	return column;
}

// Rows: normal z, tangents x (and y).
void addPoint(ContactSolver<Space>& solver, const Column& column, const ImpulsePoint<Space>& point)
{
	ContactRows<Space> row;
	Matrix3 axes;
	axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
	row.body1 = point.body1 - 1;
	row.body2 = point.body2 - 1;
	for (int k = 0; k < 3; ++k) {
		const Vector3 a = axes.row(k);
		row.J1.row(k) << -a.transpose(), -(point.position - column.bodies[point.body1].pose.position).cross(a).transpose();
		row.J2.row(k) << a.transpose(), (point.position - column.bodies[point.body2].pose.position).cross(a).transpose();
	}
	row.law = point.friction;
	solver.points.push_back(row);
}

// The spin from x to z is minus that about y.
void addPoint(ContactSolver<Plane>& solver, const Column& column, const ImpulsePoint<Space>& point)
{
	ContactRows<Plane> row;
	row.body1 = point.body1 - 1;
	row.body2 = point.body2 - 1;
	const Vector3 r1 = point.position - column.bodies[point.body1].pose.position,
	              r2 = point.position - column.bodies[point.body2].pose.position;
	row.J1 << 0, -1, -r1.x(), -1, 0, r1.z();
	row.J2 << 0, 1, r2.x(), 1, 0, -r2.z();
	row.law = point.friction;
	solver.points.push_back(row);
}

FreeBody<Space> freeBody(Space, const RigidBody<Space>& body)
{
	FreeBody<Space> result;
	result.inverseMass.linear = body.inverseMass();
	result.inverseMass.angular = body.inverseInertia();
	result.free = body.velocity;
	return result;
}

FreeBody<Plane> freeBody(Plane, const RigidBody<Space>& body)
{
	FreeBody<Plane> result;
	result.inverseMass.linear = body.inverseMass();
	result.inverseMass.angular(0) = body.inverseInertia()(1, 1);
	result.free << body.linear().x(), body.linear().z(), -body.spin().y();
	return result;
}

template <class K>
void set(ContactSolver<K>& solver, const Column& column)
{
	solver.bodies.clear();
	solver.points.clear();
	for (size_t b = 1; b < column.bodies.size(); ++b)
		solver.bodies.push_back(freeBody(K {}, column.bodies[b]));
	for (const ImpulsePoint<Space>& point : column.points)
		addPoint(solver, column, point);
}

// Impulses times the relative velocities of their points, those of the bodies as they are (velocity) or without impulses (free).
template <class K>
double power(const ContactSolver<K>& solver, typename K::Velocity FreeBody<K>::*of)
{
	double sum = 0;
	for (const ContactRows<K>& c : solver.points) {
		typename ContactRows<K>::Rows u = c.offset;
		if (c.body1 >= 0)
			u += c.J1 * (solver.bodies[c.body1].*of);
		if (c.body2 >= 0)
			u += c.J2 * (solver.bodies[c.body2].*of);
		sum += c.impulse.dot(u);
	}
	return sum;
}

// Twice the gain of kinetic energy seen from the base: impulses times the sum of the velocities before and after. In a step the relative
// velocities are that sum themselves.
template <class K>
double gain(const ContactSolver<K>& solver)
{
	return power(solver, &FreeBody<K>::free) + power(solver, &FreeBody<K>::velocity);
}
template <class K>
double gainOfStep(const ContactSolver<K>& solver)
{
	return power(solver, &FreeBody<K>::velocity);
}

// Blocks 1.0 x 0.8 x 0.5 m at rest on each other, every second one `ratio` times as dense; free velocity: one step of gravity.
Column standing(int blocks, double ratio, double speed, bool planar)
{
	Column column;
	RigidBody<Space> base;
	base.prescribed = true;
	column.bodies.push_back(base);
	const Vector3 half(0.5, 0.4, 0.25);
	for (int b = 1; b <= blocks; ++b) {
		RigidBody<Space> body = boxBody({0, 0, half.z() * (2 * b - 1)}, half, b % 2 ? 2000 : 2000 * ratio);
		body.linear().z() = -speed;
		column.bodies.push_back(body);
		for (int corner = 0; corner < (planar ? 2 : 4); ++corner)
			column.points.push_back({b - 1, b,
			                         Vector3(corner & 1 ? -half.x() : half.x(),
			                                 planar       ? 0.
			                                 : corner & 2 ? -half.y()
			                                              : half.y(),
			                                 2 * half.z() * (b - 1)),
			                         Vector3::UnitZ(), 0.7});
	}
	return column;
}

// Running bond: blocks 1.0 x 0.5 m, half blocks at the ends of every second course; head joints touch.
RigidSystem<Plane> wall(int courses, int perLevel)
{
	auto s = rig::emptyScene<Plane>();
	std::vector<int> course, below;
	for (int c = 0; c < courses; ++c) {
		course.clear();
		const int blocks = perLevel + c % 2;
		double end = -0.5 * perLevel;
		for (int k = 0; k < blocks; ++k) {
			const double half = c % 2 && (k == 0 || k == blocks - 1) ? 0.25 : 0.5;
			const int block = rig::addBlock(s, half, 0.25, {end + half, 0.25 + 0.5 * c});
			const auto over = [&](int other) {
				const auto& b = s.bodies[other];
				return std::abs(b.pose.position.x() - end - half) < b.shape->halfSize().x() + half - 0.1;
			};
			if (c == 0)
				rig::addPair(s, 0, block, 0., 0.7);
			for (const int other : below)
				if (over(other))
					rig::addPair(s, other, block, 0., 0.7);
			if (k > 0)
				rig::addPair(s, course.back(), block, 0., 0.7);
			course.push_back(block);
			end += 2 * half;
		}
		below = course;
	}
	return s;
}

constexpr double solved = 1e-11; // m/s; speeds are of the order of one

} // namespace

TEST_CASE("contact problem: velocities are those of the dense solver")
{
	// Without friction velocities are unique. With it the laws can have several solutions (redundant points share the friction
	// in different ways), without slip too; about nine problems in ten have one. Bound: both residuals 1e-11, divided by the smallest
	// response of a box (spins: and by its smallest size).
	Random random(1);
	ContactSolver<Space> solver;
	const auto friction = GENERATE(0., 0.3, 0.7, noSlip);
	int compared = 0, equal = 0;
	for (int k = 0; k < 100; ++k) {
		Column column = randomColumn(random, friction, false);
		set(solver, column);
		const SolveReport report = solver.solve(solved);
		CoupleRows<Space> none;
		const ImpulseReport dense = solveImpulses(column.bodies, column.points, none);
		if (friction < noSlip)
			CHECK(report.converged);
		if (!report.converged || dense.residual > solved)
			continue;
		++compared;
		double worst = 0;
		for (size_t b = 0; b < solver.bodies.size(); ++b) {
			const RigidBody<Space>& body = column.bodies[b + 1];
			worst = std::max({worst, (solver.bodies[b].velocity.head<3>() - body.linear()).norm(),
			                  0.1 * (solver.bodies[b].velocity.tail<3>() - body.spin()).norm()});
		}
		equal += worst < 1e-9;
	}
	INFO("friction " << friction << ": " << equal << " of " << compared);
	CHECK(compared >= 80);
	CHECK(equal >= (friction == 0 ? 1 : 0.8) * compared);
}

TEST_CASE("contact problem: random columns with friction are solved and lose energy")
{
	Random random(2);
	const auto check = [&](auto solver, bool planar) {
		for (int k = 0; k < 2000; ++k) {
			set(solver, randomColumn(random, number(random, 0, 1), planar));
			const SolveReport report = solver.solve(solved);
			CHECK(report.converged);
			CHECK(report.residual == Approx(solver.residual()).margin(1e-14));
			CHECK(gain(solver) <= 1e-9);
		}
	};
	check(ContactSolver<Plane>(), true);
	check(ContactSolver<Space>(), false);
}

TEST_CASE("contact problem: plane and space agree on planar motion")
{
	Random random(3);
	ContactSolver<Plane> plane;
	ContactSolver<Space> space;
	for (int k = 0; k < 300; ++k) {
		const Column column = randomColumn(random, 0.5, true);
		set(plane, column);
		set(space, column);
		REQUIRE(plane.solve(solved).converged);
		REQUIRE(space.solve(solved).converged);
		for (size_t b = 0; b < plane.bodies.size(); ++b) {
			const auto& v = space.bodies[b].velocity;
			CHECK((plane.bodies[b].velocity - Vector3(v[0], v[2], -v[4])).norm() < 1e-8);
		}
	}
}

TEMPLATE_TEST_CASE("contact problem: stacks stand whatever their masses", "", Plane, Space)
{
	const double speed = 9.81e-3; // g h
	for (const double ratio : {1., 1e3, 1e-3})
		for (const int blocks : {2, 5, 20}) {
			ContactSolver<TestType> solver;
			set(solver, standing(blocks, ratio, speed, TestType::dimension == 2));
			const SolveReport report = solver.solve(1e-11 * speed);
			INFO(blocks << " blocks, ratio " << ratio << ", residual " << report.residual);
			CHECK(report.converged);
			// the residual bounds relative velocities at points; their sum over the column the blocks' own
			for (const auto& body : solver.bodies)
				CHECK(body.velocity.norm() < 1e-9 * speed * blocks);
			// warm: nothing left to do
			CHECK(solver.solve(1e-11 * speed).factorisations == 0);
		}
}

TEST_CASE("contact problem: a factor kept from another problem does not change the solution")
{
	// The same points, other masses and velocities; without friction velocities are unique. Bound: as for the dense solver.
	Random random(5);
	ContactSolver<Space> solver;
	set(solver, standing(5, 1., 0.01, false));
	for (auto& point : solver.points)
		point.law = 0;
	REQUIRE(solver.solve(solved).converged);
	const auto first = solver.bodies;
	for (int k = 0; k < 100; ++k) {
		for (size_t b = 0; b < first.size(); ++b) {
			auto& body = solver.bodies[b] = first[b];
			const double factor = std::pow(10., number(random, -1, 1));
			body.inverseMass.linear *= factor;
			body.inverseMass.angular *= factor;
			body.free << vector(random, 0.01), vector(random, 0.01);
		}
		ContactSolver<Space> anew;
		anew.bodies = solver.bodies;
		anew.points = solver.points;
		for (auto& point : anew.points)
			point.impulse.setZero();
		REQUIRE(solver.solve(solved).converged);
		REQUIRE(anew.solve(solved).converged);
		for (size_t b = 0; b < solver.bodies.size(); ++b)
			CHECK((solver.bodies[b].velocity - anew.bodies[b].velocity).norm() < 1e-9);
	}
}

TEST_CASE("contact problem: a wall that stands in slow shaking needs few factorisations")
{
	// 0.3 g at 2 Hz: nothing moves (mu 0.7, and too low to rock), forces change by 0.4 % of the weight a step. Three factorisations a step
	// at most: no factor is kept from one step to the next, and states that flip need another. Blocks stay on the base: their velocities
	// miss its by the residual, 1e-9 of g h, times the courses, and a head joint more for each column.
	constexpr int steps = 250;
	constexpr double h = 1e-3;
	auto s = wall(6, 6);
	rig::Harmonic motion(0.3 * rig::g, 2, 0);
	rig::moveBase(s, motion);
	LocalisedStep<Plane> step;
	int factorisations = 0;
	for (int k = 0; k < steps; ++k) {
		const StepReport report = step.advance(s, h);
		factorisations += report.factorisations;
		CHECK(report.converged);
		CHECK(report.residual <= 1e-9 * rig::g * h);
		for (size_t b = 1; b < s.bodies.size(); ++b)
			CHECK((s.bodies[b].velocity.head<2>() - s.bodies[0].velocity.head<2>()).norm() < 1e-7 * rig::g * h);
	}
	INFO(factorisations);
	CHECK(factorisations <= 3 * steps);
}

TEST_CASE("contact problem: no heap allocation once the size is known")
{
	ContactSolver<Space> solver;
	set(solver, standing(5, 1000., 0.01, false));
	solver.solve(1e-13);
	for (auto& point : solver.points)
		point.impulse.setZero();
	const long before = allocations;
	solver.solve(1e-13);
	CHECK(allocations == before);
}

namespace {

// Allocations in the steps of a run until `end`, and the impacts in it.
template <class K>
std::pair<long, int> allocationsOf(RigidSystem<K>& s, LocalisedStep<K>& step, double end)
{
	int impacts = 0;
	const long before = allocations;
	while (s.time < end) {
		step.advance(s, 1e-3);
		impacts += int(s.impacts.size());
	}
	return {allocations - before, impacts};
}

} // namespace

TEST_CASE("rigid step: no heap allocation in steps after the first")
{
	auto flat = rig::rockingBlock(0.3, 1.5, 0.17, 0.9);
	auto stood = rig::stack(20, 0.5, 0.25, 0.7, 0.7);
	auto box = rig::oneBox({0.3, 0.2, 1}, rig::placed(rig::turn(0.15, {-0.5, 0.8, 0}), {0.3, 0.2, -1}, {0, 0, 0}), 0.8, 0.7);
	const auto check = [](auto& s, auto step, double end) {
		step.advance(s, 1e-3);
		const auto [count, impacts] = allocationsOf(s, step, end);
		CHECK(count == 0);
		return impacts;
	};
	CHECK(check(flat, LocalisedStep<Plane>(), 0.5) == 0);
	CHECK(check(stood, LocalisedStep<Plane>(), 0.5) == 0);
	CHECK(check(box, LocalisedStep<Space>(), 0.3) == 0);
}

// The workspace has seen the sizes of all events once the motion has been run; a run of its copy goes through the same.
TEST_CASE("rigid step: no heap allocation in impacts once a motion has been seen")
{
	const auto check = [](auto& s, auto step, double end) {
		auto again = s;
		allocationsOf(s, step, end);
		again.impacts.reserve(s.impacts.capacity());
		const auto [count, impacts] = allocationsOf(again, step, end);
		CHECK(count == 0);
		CHECK(impacts >= 2);
	};
	auto flat = rig::rockingBlock(0.3, 1.5, 0.17, 0.9);
	check(flat, LocalisedStep<Plane>(), 3);
	auto box = rig::oneBox({0.3, 0.2, 1}, rig::placed(rig::turn(0.15, {-0.5, 0.8, 0}), {0.3, 0.2, -1}, {0, 0, 0}), 0.8, 0.7);
	check(box, LocalisedStep<Space>(), 1.5);
	for (int n : {2, 5}) { // thrown along: they rock, slide and come apart
		auto thrown = rig::stack(n, 0.25, 0.5, 0.7, 0.7);
		for (auto& body : thrown.bodies)
			body.velocity[0] = body.prescribed ? 0 : 0.6;
		check(thrown, LocalisedStep<Plane>(), n == 2 ? 2 : 0.3);
	}
}

namespace {

template <class K>
struct Problem {
	Bodies<K> bodies;
	ImpulsePoints<K> points;
};

Problem<Space> problemOf(Space, const Column& column) { return {column.bodies, column.points}; }

// Returns the equivalent column in the plane of x and z.
Problem<Plane> problemOf(Plane, const Column& column)
{
	const auto flat = [](const Vector3& v) { return Vector2(v.x(), v.z()); };
	Problem<Plane> result;
	for (const RigidBody<Space>& body : column.bodies) {
		RigidBody<Plane>& own = result.bodies.emplace_back();
		own.prescribed = body.prescribed;
		own.mass = body.mass;
		own.inertia[0] = body.inertia.y();
		own.pose.position = flat(body.pose.position);
		own.velocity << flat(body.linear()), -body.spin().y();
	}
	for (const ImpulsePoint<Space>& p : column.points)
		result.points.push_back({p.body1, p.body2, flat(p.position), flat(p.normal), p.friction});
	return result;
}

Plane::Spin spinOf(Plane, const Vector3& w) { return Plane::Spin(-w.y()); }
Vector3 spinOf(Space, const Vector3& w) { return w; }

struct Compared {
	int problems {0}, equal {0};
};

// Velocities and couples against those of the dense solver in space, where both solve the problem.
template <class K>
Compared compareWithDense(double friction, const ImpulseSolver<K>& solve)
{
	Random random(7);
	Compared compared;
	for (int k = 0; k < 300; ++k) {
		const bool planar = K::dimension == 2;
		Column column = randomColumn(random, friction, planar, 5);
		Problem<K> one = problemOf(K(), column);
		const int block = int(one.bodies.size()) - 1;
		const Vector3 axis = planar ? Vector3(0, -1, 0) : Vector3(number(random, -1, 1), 1, 0).normalized();
		CoupleRows<Space> couples {{block - 1, block, axis, number(random, -1, 1)}};
		CoupleRows<K> own {{block - 1, block, spinOf(K(), axis), couples[0].target}};
		const double residual = solve(one.bodies, one.points, own).residual;
		const double denseResidual = solveImpulses(column.bodies, column.points, couples).residual;
		if (one.points.size() <= 4 || std::max(residual, denseResidual) > 1e-9)
			continue;
		++compared.problems;
		double apart = 0;
		for (size_t b = 1; b < one.bodies.size(); ++b)
			apart = std::max(apart, (one.bodies[b].velocity - freeBody(K(), column.bodies[b]).free).norm());
		const double couple = std::abs(couples[0].couple - own[0].couple) / (1 + std::abs(couples[0].couple));
		compared.equal += apart < 1e-8 && couple < 1e-8;
	}
	return compared;
}

} // namespace

// Solutions are unique without friction, and most often with it; shares as for the contact solver, nearer to one in the plane.
TEST_CASE("impulses in the plane and sparse ones: velocities and couples are those of the dense solver in space")
{
	for (double friction : {0., 0.3, 0.7, noSlip}) {
		CAPTURE(friction);
		for (const ImpulseSolver<Plane>& solve : {ImpulseSolver<Plane>(solveSparsely<Plane>), ImpulseSolver<Plane>(solveImpulses<Plane>)}) {
			const Compared plane = compareWithDense<Plane>(friction, solve);
			CHECK(plane.problems > 60);
			CHECK(plane.equal >= (friction == 0 ? 1 : 0.95) * plane.problems);
		}
		const Compared space = compareWithDense<Space>(friction, solveSparsely<Space>);
		CHECK(space.problems > 60);
		CHECK(space.equal >= (friction == 0 ? 1 : 0.8) * space.problems);
	}
}

TEST_CASE("contact problem: without slip an unsolvable problem gains no energy, in an impact or in a step")
{
	Random random(4);
	ContactSolver<Space> solver;
	solver.lastSweeps = 200; // those without a solution take them all
	int unsolved = 0;
	for (int k = 0; k < 300; ++k) {
		set(solver, randomColumn(random, noSlip, false));
		const bool converged = solver.solve(solved).converged;
		unsolved += !converged;
		CHECK(gain(solver) <= 1e-9);
		if (!converged)
			CHECK(gainOfStep(solver) <= 1e-9);
	}
	INFO(unsolved);
	CHECK(unsolved < 150);
}
