// Shakes or rests walls by the step of `wall` (dynamics/wall), in the core alone.
//
//     wall_bench key=value ...
//
// dim       2 (default), 3
// scene     wall (default), column, heavy (a block `heavy` times as heavy on the wall), pillar (a block that rocks on the wall with `w0`),
//           tilt (gravity turns by `rate` degrees a second until a block has moved by a tenth of its height), row (two rows of blocks that
//           a head wall clamps)
// courses, per, L, T, H   size of the wall and of its blocks (m)
// amp, angle, hertz       of the base's sine (g, degrees from the wall's direction, Hz)
// rest, shake, after, h   s
// settings of the solver, by the keys of runWithOptions
// file                    writes the scene as gauss_seidel_space.cpp reads it, and ends
#include "dynamics/model/neighbours.hpp"
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>

namespace {

using namespace masonry;

constexpr double g = 9.81, density = 2000;

std::map<std::string, std::string> options;
double number(const char* key, double otherwise)
{
	const auto found = options.find(key);
	return found == options.end() ? otherwise : std::atof(found->second.c_str());
}
std::string word(const char* key, const char* otherwise)
{
	const auto found = options.find(key);
	return found == options.end() ? otherwise : found->second;
}

// A sine from `begin` to `end`; then the velocity that it has.
class Sine : public BaseDrive {
public:
	Sine(double acceleration, double hertz, double begin, double end) : a(acceleration), w(2 * M_PI * hertz), begin(begin), end(end) {}
	double displacement(double t) const override
	{
		const double s = std::min(std::max(0., t - begin), end - begin);
		return a / w * (s - std::sin(w * s) / w) + velocity(end) * std::max(0., t - end);
	}
	double velocity(double t) const override
	{
		const double s = std::min(std::max(0., t - begin), end - begin);
		return a / w * (1 - std::cos(w * s));
	}
	double nextKink(double, double) const override { return INFINITY; }
	double jumpAt(double) override { return 0; }
	double respond(int, double) override { return 0; }
	bool ordered() const override { return false; }

private:
	double a, w, begin, end;
};

Vector2 sized(const RigidSystem<Plane>&, double x, double, double z) { return {x, z}; }
Vector3 sized(const RigidSystem<Space>&, double x, double y, double z) { return {x, y, z}; }

void setInertia(RigidBody<Plane>& b) { b.inertia[0] = b.mass * b.shape->halfSize().squaredNorm() / 3; }
void setInertia(RigidBody<Space>& b)
{
	const Vector3 squares = b.shape->halfSize().cwiseAbs2();
	b.inertia = b.mass / 3 * (Vector3::Constant(squares.sum()) - squares);
}

template <class K>
struct World {
	static constexpr int up = K::dimension - 1;
	RigidSystem<K> system;
	int wallBodies {0};
	std::vector<int> smooth; // bodies without friction
	double L, T, H;

	int add(double x, double z, double l, double h, double times = 1, double y = 0, double t = 0)
	{
		RigidBody<K> b;
		t = t > 0 ? t : T;
		b.setBox(sized(system, l / 2, t / 2, h / 2));
		b.mass = times * density * l * t * h;
		setInertia(b);
		b.pose.position = sized(system, x, y, z);
		b.force.template head<K::dimension>() = b.mass * system.gravity;
		system.bodies.push_back(b);
		return int(system.bodies.size()) - 1;
	}
	void build()
	{
		system.gravity[up] = -g;
		const std::string scene = word("scene", "wall");
		const int courses = int(number("courses", 10)), per = int(number("per", 10));
		L = number("L", 1), T = number("T", 0.5), H = number("H", 0.5);
		RigidBody<K> base;
		typename K::Vector half = K::Vector::Constant(500 * L);
		half[up] = 1;
		base.setBox(half);
		base.pose.position[up] = -1;
		base.origin = base.pose.position;
		base.prescribed = true;
		system.bodies.push_back(base);
		const double left = -per * L / 2;
		if (scene == "row")
			return buildRow(per);
		for (int c = 0; c < courses; ++c) {
			const double z = H * (c + 0.5);
			const bool odd = c % 2;
			if (scene == "column") {
				add(0, z, L, H);
				continue;
			}
			if (odd) {
				add(left + L / 4, z, L / 2, H);
				add(left + per * L - L / 4, z, L / 2, H);
			}
			for (int i = 0; i < per - odd; ++i)
				add(left + (i + 0.5 + 0.5 * odd) * L, z, L, H);
		}
		wallBodies = int(system.bodies.size());
		const double w0 = number("w0", 0);
		if (scene == "heavy")
			add(0, H * (courses + 0.5), per * L, H, number("heavy", 100));
		if (scene == "pillar")
			add(0, H * courses + L, 0.2 * L, 2 * L);
		for (size_t b = 1; b < system.bodies.size() && w0 != 0; ++b) {
			auto& body = system.bodies[b];
			if (scene == "pillar" && int(b) < wallBodies)
				continue;
			typename K::Vector pivot = K::Vector::Zero();
			pivot[0] = scene == "pillar" ? -0.1 * L : -L / 2;
			pivot[up] = scene == "pillar" ? H * courses : 0;
			const typename K::Vector r = body.pose.position - pivot;
			// Turns about the left corner, counter-clockwise seen with x to the right and z up.
			body.velocity[0] = -w0 * r[up];
			body.velocity[up] = w0 * r[0];
			if constexpr (K::dimension == 2)
				body.velocity[2] = w0;
			else
				body.velocity[4] = -w0;
		}
	}
	void prescribe(int b)
	{
		system.bodies[b].prescribed = true;
		system.bodies[b].force.setZero();
	}
	// Boxes 0.2 m long between a wall and a pusher that two smooth shelves guide, 5 m above the base; friction 0.4 (mu=0.4).
	void buildRow(int n)
	{
		T = 0.4, H = 0.4;
		constexpr double z = 5;
		const double end = 0.2 * n + 0.3;
		double weight = 0;
		for (int k = 0; k < n; ++k)
			weight += system.bodies[add(0.1 + 0.2 * k, z, 0.2, 0.4)].mass * g;
		wallBodies = n + 1;
		const int pusher = add(end, z, 0.6, 1);
		system.bodies[pusher].force[0] = -number("thrust", 6) * std::max(weight / 0.8, weight * n / 16);
		prescribe(add(-0.5, z, 1, 3, 1, 0, 1));
		for (const double side : {-0.55, 0.55}) {
			smooth.push_back(add(end, z + side, 0.58, 0.1, 1, 0, 1));
			prescribe(smooth.back());
		}
	}
	double energy() const
	{
		double sum = system.kineticEnergy();
		for (const auto& body : system.bodies)
			if (!body.prescribed)
				sum += body.mass * g * body.pose.position[up];
		return sum;
	}
};

void write(const RigidSystem<Plane>&, const std::string&) {}
void write(const RigidSystem<Space>& s, const std::string& name)
{
	std::ofstream out(name);
	out.precision(17);
	for (const auto& b : s.bodies)
		out << b.pose.position.transpose() << ' ' << 2 * b.shape->halfSize().transpose() << " 1 0 0 0 "
		    << (b.prescribed ? 0 : b.mass / (8 * b.shape->halfSize().prod())) << '\n';
}

double cpu() { return double(std::clock()) / CLOCKS_PER_SEC; }

template <class K>
void run(wall::WallStep<K>& step)
{
	World<K> world;
	world.build();
	RigidSystem<K>& s = world.system;
	if (options.count("file"))
		return write(s, options["file"]);
	const double h = number("h", 1e-3), rest = number("rest", 0.02), shake = number("shake", 0.5), after = number("after", 0),
	             mu = number("mu", 0.7);
	Sine sine(number("amp", 0) * g, number("hertz", 2), rest, rest + shake);
	const double angle = number("angle", 0) * M_PI / 180;
	typename K::Vector direction = K::Vector::Zero();
	direction[0] = K::dimension == 2 ? 1 : std::cos(angle);
	if constexpr (K::dimension == 3)
		direction[1] = std::sin(angle);
	s.drives.push_back({{{&sine, direction}}});
	s.bodies[0].drive = 0;
	Neighbours<K> near(0.1 * world.H, [&](ContactPair<K>& pair) {
		const auto isSmooth = [&](int b) { return std::count(world.smooth.begin(), world.smooth.end(), b) > 0; };
		pair.friction = isSmooth(pair.body1) || isSmooth(pair.body2) ? 0 : mu;
		pair.restitution = number("C", NAN);
	});
	constexpr int up = K::dimension - 1;
	std::vector<typename K::Vector> start;
	double topHeight = 0;
	for (const auto& b : s.bodies)
		start.push_back(b.pose.position);
	for (int b = 1; b < world.wallBodies; ++b)
		topHeight = std::max(topHeight, start[b][up]);
	std::vector<int> top;
	for (int b = 1; b < world.wallBodies; ++b)
		if (start[b][up] > topHeight - 1e-6)
			top.push_back(b);
	const auto moved = [&](int b) ->
	    typename K::Vector { return s.bodies[b].pose.position - start[b] - (s.bodies[0].pose.position - start[0]); };
	const long steps = std::lround((rest + shake + after) / h), looks = std::max(1l, std::lround(0.01 / h)),
	           restSteps = std::lround(rest / h);
	double mean = 0, drift = 0, rises = 0, loss = 0, deepest = 0, created = 0, sumIterations = 0, factors = 0, kinetic = 0;
	typename K::Vector last = K::Vector::Zero();
	double before = world.energy() - s.baseWork;
	const double begin = cpu();
	double inStep = 0, firstStep = 0;
	int firstIterations = 0;
	double tilted = -1, worstImpact = 0;
	int impacts = 0, capped = 0;
	const double rate = number("rate", 0) * M_PI / 180;
	for (long k = 1; k <= steps; ++k) {
		near.update(s, h);
		if (rate > 0) {
			const double a = rate * std::max(0., s.time - rest);
			s.gravity.setZero();
			s.gravity[0] = g * std::sin(a);
			s.gravity[up] = -g * std::cos(a);
			for (auto& b : s.bodies)
				if (!b.prescribed)
					b.force.template head<K::dimension>() = b.mass * s.gravity;
		}
		const double t0 = cpu();
		step.advance(s, h);
		(k == 1 ? firstStep : inStep) += cpu() - t0;
		firstIterations = k == 1 ? step.report.iterations : firstIterations;
		created += step.report.created;
		for (const Impact& impact : s.impacts) {
			++impacts;
			capped += impact.capped;
			worstImpact = std::max(worstImpact, impact.residual / (impact.joint.before * world.L));
		}
		sumIterations += step.report.iterations;
		factors += step.report.factorisations;
		const double now = world.energy() + step.potentialShift() - s.baseWork, change = now - before;
		before = now;
		if (k > 3)
			(change > 0 ? rises : loss) += std::abs(change);
		if (number("trace", 0) > 0 && k % long(number("trace", 0)) == 0) {
			std::printf("t %.3f residual %.2e iterations %d factors %d top %.5f mm change %.3g kinetic %.3g base %.3f\n", s.time,
			            step.report.residual, step.report.iterations, step.report.factorisations, 1e3 * moved(top.front())[0], change,
			            s.kineticEnergy(), s.baseWork);
		}
		if (k > restSteps && (k - restSteps) % looks == 0) {
			typename K::Vector sum = K::Vector::Zero();
			for (const int b : top)
				sum += moved(b) / double(top.size());
			sum[up] = 0;
			mean = std::max(mean, sum.norm());
			last = sum;
			for (int b = 1; b < world.wallBodies; ++b)
				drift = std::max(drift, moved(b).template head<up>().norm());
			step.showPoints(s);
			for (const auto& pair : s.pairs)
				for (int i = 0; i < pair.size(); ++i)
					deepest = std::max(deepest, -pair.points[i].gap);
			kinetic = s.kineticEnergy();
			if (rate > 0 && tilted < 0 && drift > 0.1 * world.H) {
				tilted = rate * std::max(0., s.time - rest) * 180 / M_PI;
				break;
			}
		}
		if (!(std::abs(now) < 1e12) || !(mean < 1e3)) {
			std::printf("BLOWN at %g s\n", s.time);
			break;
		}
	}
	const double seconds = s.time;
	double sink = 0;
	for (const int b : top)
		sink -= moved(b)[up] / double(top.size());
	std::printf("%zu blocks | mean %.2f mm (end %.2f) drift %.4g sink %.3g mm | cpu/s %.3f (step %.3f) its %.1f fac %.2f | rises/loss "
	            "%.1e loss %.4g created %.2g | pen %.2g mm kin %.2g tilt %.2f | first step %d | impacts %d capped %d residual %.1e\n",
	            s.bodies.size() - 1, 1e3 * mean, 1e3 * last.norm(), 1e3 * drift, 1e3 * sink, (cpu() - begin - firstStep) / seconds,
	            inStep / seconds, sumIterations / double(steps), factors / double(steps), rises / std::max(loss, 1e-30), loss, created,
	            1e3 * deepest, kinetic, tilted, firstIterations, impacts, capped, worstImpact);
	std::fflush(stdout);
}

template <class K>
void runWithOptions()
{
	wall::WallStep<K> step;
	auto& a = step.settings.solver;
	a.iterations = int(number("k", a.iterations));
	a.small = int(number("few", a.small));
	a.first = int(number("first", a.first));
	a.strictForces = number("strict", 0) > 0;
	a.tolerance = number("tol", a.tolerance);
	a.reserve = int(number("reserve", a.reserve));
	a.softness = number("r", a.softness);
	a.restSoftness = number("rr", a.restSoftness);
	a.restMost = int(number("rmost", a.restMost));
	a.restFollows = number("rfollows", a.restFollows);
	a.minSoftness = number("least", a.minSoftness);
	a.relaxation = number("over", a.relaxation);
	a.boundShare = number("theta", a.boundShare);
	a.pullBack = number("pull", a.pullBack);
	a.reach = number("reach", a.reach);
	a.filterTime = number("filter", a.filterTime);
	a.refactorTime = number("refactor", a.refactorTime);
	a.follows = number("follows", a.follows);
	a.turned = number("turned", a.turned);
	a.leftPenetration = number("left", a.leftPenetration);
	a.least = int(number("quick", a.least));
	a.early = number("early", a.early);
	a.ofInstant = int(number("instant", a.ofInstant));
	a.instantTolerance = number("itol", a.instantTolerance);
	a.instantEnough = number("ienough", a.instantEnough);
	a.maxOfInstant = int(number("imost", a.maxOfInstant));
	step.settings.threads = int(number("threads", 1));
	run<K>(step);
}

} // namespace

int main(int argc, char** argv)
{
	for (int i = 1; i < argc; ++i) {
		const std::string one = argv[i];
		const auto equals = one.find('=');
		options[one.substr(0, equals)] = one.substr(equals + 1);
	}
	number("dim", 2) == 3 ? runWithOptions<Space>() : runWithOptions<Plane>();
}
