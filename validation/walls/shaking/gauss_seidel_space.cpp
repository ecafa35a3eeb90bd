// Structures of boxes in space by Moreau-Jean time stepping with Gauss-Seidel sweeps over all contacts, in double precision: an answer to
// compare with that shares no code with the plugin.
//
//     v = v0 + h g + M^-1 J^T p,   x = x0 + h v;   turns: angular momentum + h J^T p, then the rotation by h spin
//     0 <= p_n  _|_  u_n + max(gap, 0)/h >= 0          (Jean 1999: plastic impacts, in the velocities at the end of the step)
//     |p_t| <= mu p_n, and where it slides p_t = -mu p_n u_t/|u_t|                                  (Coulomb, circular cone)
//
// J, M and contacts are those of the middle of the step, as the velocities of its beginning reach it; gaps are taken back from there to the
// beginning. Contacts anew in every step: of two boxes the axis that separates them most, of faces (the face that lies against it, cut to
// it: a contact at each corner of what is left) or of two edges (the point between them). Impulses start from those of the step before in
// the same place. What sweeps and linearisation leave of penetration is taken off by positions alone.
//
//     wall_gauss_seidel_space <scene> <amplitude, g> <angle from x, degrees> <seconds> <time step, s> <sweeps> [<seed>]
//
// The scene: a line for each body, the base first: centre and full sizes (m), orientation (quaternion w x y z), density (kg/m^3; base: 0).
// The base moves in a sine of 2 Hz. A line at the start and every 10 ms: time (s), work of the base (J), deepest penetration so far (m),
// and x, y, z of every block's centre from that of the base (m). Sweeps: at most so many a step, fewer where none changes a contact's
// velocity by more than 1e-6 g h. A seed other than 0 shuffles the contacts anew in every step.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Vector = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

constexpr double gravity = 9.81, friction = 0.7, frequency = 2; // m/s^2; -; Hz
constexpr double nearby = 0.02;                                 // m: contacts are looked for that far

struct Body {
	Vector place, half; // m; half sizes along its own axes
	Quaternion turn;
	double perMass {0};        // 1/kg; 0: the base
	Vector inertia {0, 0, 0};  // kg m^2, about its own axes
	Vector velocity {0, 0, 0}; // m/s
	Vector spin {0, 0, 0};     // rad/s, in space
	Eigen::Matrix3d axes;      // columns, in space
	Eigen::Matrix3d perInertia {axes.Zero()};

	Vector axis(int k) const { return axes.col(k); }
	double reach(const Vector& n) const { return half.dot((axes.transpose() * n).cwiseAbs()); }
	Vector momentum() const { return axes * inertia.cwiseProduct(axes.transpose() * spin); }
	void rotate(const Vector& by)
	{
		const double angle = by.norm();
		if (angle > 0)
			turn = (Quaternion(Eigen::AngleAxisd(angle, by / angle)) * turn).normalized();
		axes = turn.toRotationMatrix();
		if (perMass > 0)
			perInertia = axes * inertia.cwiseInverse().asDiagonal() * axes.transpose();
	}
	// To where the velocities take `from` in h; the angular momentum stays.
	void go(const Body& from, double h)
	{
		const Vector kept = momentum();
		place = from.place + h * velocity;
		turn = from.turn;
		rotate(h * spin);
		spin = perInertia * kept;
	}
};

struct Contact {
	int one, two;
	double gap;                              // m
	Vector place;                            // m, in the axes of `one`: which of the pair's contacts it is
	std::array<Vector, 3> along;             // normal, from one to two; two tangents
	std::array<Vector, 3> arm1, arm2;        // about the centres, m
	std::array<Vector, 3> turn1, turn2;      // spins that an impulse of 1 N s gives
	double massN, massT;                     // 1 / (J M^-1 J^T), kg; along the plane the least
	double closing {0};                      // m/s
	std::array<double, 3> impulse {0, 0, 0}; // N s

	Vector total() const { return impulse[0] * along[0] + impulse[1] * along[1] + impulse[2] * along[2]; }
};

std::vector<Body> bodiesOf(const std::string& scene)
{
	std::vector<Body> bodies;
	std::ifstream file(scene);
	for (std::string line; std::getline(file, line);) {
		std::istringstream numbers(line);
		std::array<double, 11> x;
		for (double& one : x)
			numbers >> one;
		if (!numbers || (x[10] > 0) == bodies.empty())
			throw std::runtime_error(scene + ": must have eleven numbers a line, the base first, with a density of 0: " + line);
		Body b;
		b.place = {x[0], x[1], x[2]};
		b.half = Vector(x[3], x[4], x[5]) / 2;
		b.turn = Quaternion(x[6], x[7], x[8], x[9]).normalized();
		if (x[10] > 0) {
			const Vector squares = 4 * b.half.cwiseAbs2();
			b.perMass = 1 / (x[10] * 8 * b.half.prod());
			b.inertia = (Vector::Constant(squares.sum()) - squares) / (12 * b.perMass);
		}
		b.rotate({0, 0, 0});
		bodies.push_back(b);
	}
	if (bodies.size() < 2)
		throw std::runtime_error(scene + ": no blocks");
	return bodies;
}

class World {
public:
	std::vector<Body> bodies; // the base first
	double work {0};          // J, of the base
	double deepest {0};       // m

	World(const std::string& scene, unsigned seed) : bodies(bodiesOf(scene)), shuffled(seed != 0), random(seed) {}

	// The base goes to `base` within the step.
	void step(const Vector& base, double h, int sweeps)
	{
		if (sincePairs++ % 10 == 0)
			findPairs();
		const std::vector<Body> before = bodies;
		const std::vector<Contact> held = contacts;
		for (Body& b : bodies)
			b.go(b, h / 2);
		findContacts();
		load((base - before[0].place) / h, held, h);
		sweepAll(sweeps, 1e-6 * gravity * h);
		for (const Contact& c : contacts)
			if (c.one == 0)
				work += c.total().dot(bodies[0].velocity);
		for (size_t k = 0; k < bodies.size(); ++k)
			bodies[k].go(before[k], h);
		part();
	}

private:
	void findPairs()
	{
		constexpr double margin = 0.1; // m: farther than anything moves within ten steps
		const auto reach = [](const Body& b) -> Vector { return b.axes.cwiseAbs() * b.half; };
		pairs.clear();
		for (int i = 0; i < int(bodies.size()); ++i)
			for (int j = i + 1; j < int(bodies.size()); ++j)
				if (((bodies[i].place - bodies[j].place).cwiseAbs() - reach(bodies[i]) - reach(bodies[j])).maxCoeff() < margin)
					pairs.push_back({i, j});
	}

	void findContacts()
	{
		contacts.clear();
		for (const auto& [i, j] : pairs)
			touch(i, j);
		if (shuffled)
			std::shuffle(contacts.begin(), contacts.end(), random);
	}

	void touch(int i, int j)
	{
		int one = i, two = j, face = 0;
		double most = -INFINITY;
		for (const auto& [a, b] : {std::pair(i, j), std::pair(j, i)})
			for (int k = 0; k < 3; ++k) {
				const Vector n = bodies[a].axis(k);
				const double apart = std::abs(n.dot(bodies[b].place - bodies[a].place)) - bodies[a].half[k] - bodies[b].reach(n);
				if (apart > most + 1e-9) // of faces that lie upon each other, i's
					most = apart, one = a, two = b, face = k;
			}
		if (most > nearby || touchEdges(i, j, bodies[one].axis(face), most))
			return;
		touchFace(one, two, face);
	}

	// Whether two edges, not the faces, hold the boxes apart, or they are not near; a contact where the edges pass each other.
	bool touchEdges(int i, int j, const Vector& faceNormal, double most)
	{
		const Body &a = bodies[i], &b = bodies[j];
		int edgeA = -1, edgeB = -1;
		Vector normal;
		most += 1e-6; // faces come first
		for (int p = 0; p < 3; ++p)
			for (int q = 0; q < 3; ++q) {
				Vector n = a.axis(p).cross(b.axis(q));
				if (n.norm() < 1e-4)
					continue;
				n.normalize();
				if (n.dot(b.place - a.place) < 0)
					n = -n;
				const double apart = n.dot(b.place - a.place) - a.reach(n) - b.reach(n);
				if (apart > nearby)
					return true;
				if (apart > most && std::abs(n.dot(faceNormal)) < 0.9995)
					most = apart, normal = n, edgeA = p, edgeB = q;
			}
		if (edgeA < 0)
			return false;
		const auto middle = [](const Body& body, int edge, const Vector& towards) {
			Vector x = body.place;
			for (int k = 0; k < 3; ++k)
				if (k != edge)
					x += (body.axis(k).dot(towards) > 0 ? 1 : -1) * body.half[k] * body.axis(k);
			return x;
		};
		const Vector from = middle(a, edgeA, normal), to = middle(b, edgeB, -normal), u = a.axis(edgeA), v = b.axis(edgeB), d = to - from;
		const double c = u.dot(v), s = (d.dot(u) - c * d.dot(v)) / (1 - c * c), t = (c * d.dot(u) - d.dot(v)) / (1 - c * c);
		if (std::abs(s) > a.half[edgeA] + 1e-9 || std::abs(t) > b.half[edgeB] + 1e-9)
			return false;
		add(i, j, normal, (from + s * u + to + t * v) / 2, most);
		return true;
	}

	void touchFace(int one, int two, int face)
	{
		const Body &a = bodies[one], &b = bodies[two];
		const Vector n = (a.axis(face).dot(b.place - a.place) < 0 ? -1 : 1) * a.axis(face);
		int against = 0; // b's axis that the normal is nearest to
		for (int k = 1; k < 3; ++k)
			if (std::abs(b.axis(k).dot(n)) > std::abs(b.axis(against).dot(n)) + 1e-12)
				against = k;
		const Vector middle = b.place - (b.axis(against).dot(n) > 0 ? 1 : -1) * b.half[against] * b.axis(against);
		const int k1 = (against + 1) % 3, k2 = (against + 2) % 3;
		const Vector e1 = b.half[k1] * b.axis(k1), e2 = b.half[k2] * b.axis(k2);
		std::vector<Vector> corners {middle + e1 + e2, middle - e1 + e2, middle - e1 - e2, middle + e1 - e2};
		for (int k = 0; k < 3; ++k)
			if (k != face)
				for (const double side : {1., -1.})
					cut(corners, side * a.axis(k), side * a.axis(k).dot(a.place) + a.half[k]);
		if (thin(corners, n))
			return;
		std::vector<Vector> taken;
		for (const Vector& x : corners) {
			const double gap = n.dot(x - a.place) - a.half[face];
			if (gap > nearby || std::any_of(taken.begin(), taken.end(), [&](const Vector& y) { return (x - y).norm() < 1e-6; }))
				continue;
			taken.push_back(x);
			one < two ? add(one, two, n, x, gap) : add(two, one, -n, x, gap);
		}
	}

	// Leaves of a polygon what has n.x <= limit.
	static void cut(std::vector<Vector>& polygon, const Vector& n, double limit)
	{
		std::vector<Vector> left;
		for (size_t k = 0; k < polygon.size(); ++k) {
			const Vector &x = polygon[k], &y = polygon[(k + 1) % polygon.size()];
			const double dx = n.dot(x) - limit, dy = n.dot(y) - limit;
			constexpr double on = 1e-12; // m
			if (dx <= on)
				left.push_back(x);
			if ((dx < -on && dy > on) || (dx > on && dy < -on))
				left.push_back(x + dx / (dx - dy) * (y - x));
		}
		polygon = left;
	}

	// Whether a polygon, seen along n, is a line or less: less than a micrometre long or wide.
	static bool thin(const std::vector<Vector>& polygon, const Vector& n)
	{
		constexpr double least = 1e-6; // m
		double twiceArea = 0, length = 0;
		for (size_t k = 2; k < polygon.size(); ++k)
			twiceArea += n.dot((polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]));
		for (const Vector& x : polygon)
			for (const Vector& y : polygon)
				length = std::max(length, (x - y).norm());
		return length < least || std::abs(twiceArea) < 2 * least * length;
	}

	void add(int one, int two, const Vector& n, const Vector& point, double gap)
	{
		const Body &a = bodies[one], &b = bodies[two];
		Contact c;
		c.one = one, c.two = two, c.gap = gap;
		c.place = a.axes.transpose() * (point - a.place);
		const Vector some = std::abs(n[0]) < 0.6 ? Vector::UnitX() : Vector::UnitY(), t = (some - n * n.dot(some)).normalized();
		c.along = {n, t, n.cross(t)};
		for (int k = 0; k < 3; ++k) {
			c.arm1[k] = (point - a.place).cross(c.along[k]), c.turn1[k] = a.perInertia * c.arm1[k];
			c.arm2[k] = (point - b.place).cross(c.along[k]), c.turn2[k] = b.perInertia * c.arm2[k];
		}
		const auto mobility = [&](int k, int l) { // J M^-1 J^T, 1/kg
			return (k == l ? a.perMass + b.perMass : 0) + c.arm1[k].dot(c.turn1[l]) + c.arm2[k].dot(c.turn2[l]);
		};
		const double mean = (mobility(1, 1) + mobility(2, 2)) / 2, half = (mobility(1, 1) - mobility(2, 2)) / 2;
		c.massN = 1 / mobility(0, 0);
		c.massT = 1 / (mean + std::hypot(half, mobility(1, 2))); // by the larger eigenvalue: sweeps then converge
		contacts.push_back(c);
	}

	// Velocities after gravity, the base's and the impulses that contacts held in the step before; what each may close.
	void load(const Vector& baseVelocity, std::vector<Contact> held, double h)
	{
		for (Contact& c : contacts) {
			c.gap -= h / 2 * rate(c, 0);
			c.closing = std::max(c.gap, 0.) / h;
		}
		std::map<std::pair<int, int>, std::vector<Contact*>> ofPair;
		for (Contact& old : held)
			ofPair[{old.one, old.two}].push_back(&old);
		for (Contact& c : contacts) {
			std::vector<Contact*>& olds = ofPair[{c.one, c.two}];
			const auto distance = [&](const Contact* old) { return (old->place - c.place).norm(); };
			const auto same = std::min_element(olds.begin(), olds.end(), [&](auto* x, auto* y) { return distance(x) < distance(y); });
			if (same == olds.end() || distance(*same) > 0.03 || c.gap > nearby / 10)
				continue;
			const Vector p = (*same)->total();
			c.impulse = {std::max(0., p.dot(c.along[0])), p.dot(c.along[1]), p.dot(c.along[2])};
			intoCone(c.impulse);
			olds.erase(same);
		}
		bodies[0].velocity = baseVelocity;
		for (Body& b : bodies)
			if (b.perMass > 0)
				b.velocity.z() -= gravity * h;
		for (const Contact& c : contacts)
			for (int k = 0; k < 3; ++k)
				push(c, k, c.impulse[k]);
	}

	static void intoCone(std::array<double, 3>& p)
	{
		const double bound = friction * p[0], sideways = std::hypot(p[1], p[2]);
		if (sideways > bound)
			p[1] *= bound / sideways, p[2] *= bound / sideways;
	}

	double rate(const Contact& c, int k) const
	{
		const Body &a = bodies[c.one], &b = bodies[c.two];
		return c.along[k].dot(b.velocity - a.velocity) + c.arm2[k].dot(b.spin) - c.arm1[k].dot(a.spin);
	}
	void push(const Contact& c, int k, double p)
	{
		Body &a = bodies[c.one], &b = bodies[c.two];
		a.velocity -= a.perMass * p * c.along[k];
		a.spin -= p * c.turn1[k];
		b.velocity += b.perMass * p * c.along[k];
		b.spin += p * c.turn2[k];
	}

	// Forth and back, till no contact's velocity changes by more than `tolerance` (m/s).
	template <class Solve>
	void alternate(int sweeps, double tolerance, Solve solve)
	{
		for (int k = 0; k < sweeps; ++k) {
			double change = 0;
			for (size_t c = 0; c < contacts.size(); ++c)
				change = std::max(change, solve(contacts[k % 2 ? contacts.size() - 1 - c : c]));
			if (change < tolerance)
				return;
		}
	}

	void sweepAll(int sweeps, double tolerance)
	{
		alternate(sweeps, tolerance, [this](Contact& c) {
			std::array<double, 3> p = c.impulse;
			p[0] = std::max(0., p[0] - c.massN * (rate(c, 0) + c.closing));
			if (p[0] == 0 && c.impulse[0] == 0)
				return 0.;
			push(c, 0, p[0] - c.impulse[0]);
			for (int k = 1; k < 3; ++k)
				p[k] -= c.massT * rate(c, k);
			intoCone(p);
			const std::array<double, 3> before = std::exchange(c.impulse, p);
			for (int k = 1; k < 3; ++k)
				push(c, k, p[k] - before[k]);
			return std::max(
			    {std::abs(p[0] - before[0]) / c.massN, std::abs(p[1] - before[1]) / c.massT, std::abs(p[2] - before[2]) / c.massT});
		});
	}

	// By displacements in the place of velocities, without friction.
	void part()
	{
		constexpr double allowed = 1e-7; // m
		const std::vector<Contact> impulses = contacts;
		findContacts();
		double deep = 0;
		for (const Contact& c : contacts)
			deep = std::max(deep, -c.gap);
		deepest = std::max(deepest, deep);
		if (deep > allowed) {
			const std::vector<Body> moving = bodies;
			for (Body& b : bodies)
				b.velocity = b.spin = Vector::Zero();
			alternate(50, 1e-9, [this](Contact& c) {
				const double p = std::max(0., c.impulse[0] - c.massN * (c.gap + allowed / 2 + rate(c, 0)));
				const double change = p - std::exchange(c.impulse[0], p);
				push(c, 0, change);
				return std::abs(change) / c.massN;
			});
			for (size_t k = 0; k < bodies.size(); ++k) {
				Body& b = bodies[k];
				b.place += b.velocity;
				b.rotate(b.spin);
				b.velocity = moving[k].velocity, b.spin = moving[k].spin;
			}
		}
		contacts = impulses;
	}

	std::vector<std::array<int, 2>> pairs;
	std::vector<Contact> contacts;
	long sincePairs {0};
	bool shuffled;
	std::mt19937 random;
};

void print(const World& world, double time)
{
	std::printf("%.6g %.9g %.3g", time, world.work, world.deepest);
	for (size_t k = 1; k < world.bodies.size(); ++k) {
		const Vector x = world.bodies[k].place - world.bodies[0].place;
		std::printf(" %.9g %.9g %.9g", x[0], x[1], x[2]);
	}
	std::printf("\n");
}

} // namespace

int main(int argc, char** argv)
try {
	if (argc != 7 && argc != 8)
		throw std::runtime_error(
		    "usage: <scene> <amplitude, g> <angle from x, degrees> <seconds> <time step, s> <sweeps> [<seed of the order of contacts>]");
	const double amplitude = std::atof(argv[2]) * gravity, angle = std::atof(argv[3]) * M_PI / 180, h = std::atof(argv[5]);
	const int sweeps = std::atoi(argv[6]), firstSweeps = 20 * sweeps; // of the first steps, which start without impulses
	World world(argv[1], argc == 8 ? unsigned(std::atol(argv[7])) : 0);
	const Vector start = world.bodies[0].place, direction(std::cos(angle), std::sin(angle), 0);
	const double w = 2 * M_PI * frequency;
	const long steps = std::lround(std::atof(argv[4]) / h), looks = std::lround(0.01 / h);
	print(world, 0);
	for (long k = 1; k <= steps; ++k) {
		const double t = double(k) * h;
		world.step(start + amplitude / w * (t - std::sin(w * t) / w) * direction, h, k <= 3 ? firstSweeps : sweeps);
		if (k % looks == 0)
			print(world, t);
	}
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
