// The wall by Moreau-Jean time stepping with thousands of Gauss-Seidel sweeps a step, in double precision: an answer to compare with that
// shares neither code nor method with the plugin.
//
//     v = v0 + h g + M^-1 J^T p,   q = q0 + h v
//     0 <= p_n  _|_  u_n + max(gap, 0)/h >= 0,   |p_t| <= mu p_n, opposite to sliding       (Jean 1999: plastic impacts, Coulomb)
//
// Contacts anew in every step: of two rectangles the face with the largest separation, and the edge of the other that lies against it, cut
// to that face. What sweeps leave of penetration is taken off by positions alone.
//
//     wall_gauss_seidel <courses> <blocks per course> <amplitude, g> <rest, s> <shaking, s> <time step, s> <sweeps>
//
// One line: largest move relative to the base, m, looked at every 10 ms of shaking: of the mean of the top course, of its corner in -x,
// which the base's first stroke throws out, and of that in +x; then the deepest penetration, m.
#include "wall.hpp"

namespace {

struct Vector {
	double x, y;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
Vector turned(Vector a) { return {-a.y, a.x}; }

struct Rectangle {
	double half[2];             // m, along its own axes
	double perMass, perInertia; // 0: the base
	Vector place;
	double angle;
	Vector velocity;
	double spin;

	Vector axis(int k) const
	{
		const Vector x {std::cos(angle), std::sin(angle)};
		return k == 0 ? x : turned(x);
	}
	double reach(Vector n) const { return half[0] * std::abs(dot(n, axis(0))) + half[1] * std::abs(dot(n, axis(1))); }
};

struct Contact {
	int one, two;
	long id;                        // the pair, and which end of the edge
	Vector normal;                  // from one to two
	double gap;                     // m
	double n1, n2, t1, t2;          // arms about the centres, m
	double massN, massT;            // 1 / (J M^-1 J^T), kg
	double closing, pn {0}, pt {0}; // m/s; N s
};

constexpr double nearby = 0.02; // m: contacts are looked for that far

class World {
public:
	std::vector<Rectangle> bodies; // the base first

	explicit World(const Request& request)
	{
		bodies.push_back({{100, 1}, 0, 0, {request.perLevel / 2., -1}, 0, {0, 0}, 0});
		for (const Block& b : wall(request.courses, request.perLevel)) {
			const double mass = density * b.length * b.height * thickness;
			bodies.push_back({{b.length / 2, b.height / 2},
			                  1 / mass,
			                  12 / (mass * (b.length * b.length + b.height * b.height)),
			                  {b.x, b.z},
			                  0,
			                  {0, 0},
			                  0});
		}
	}

	// The base goes to `base` within the step.
	void step(double base, double h, int sweeps)
	{
		if (sincePairs++ % 20 == 0)
			findPairs();
		findContacts();
		bodies[0].velocity = {(base - bodies[0].place.x) / h, 0};
		for (Rectangle& b : bodies)
			if (b.perMass > 0)
				b.velocity.y -= gravity * h;
		for (Contact& c : contacts) {
			c.closing = std::max(c.gap, 0.) / h;
			push(c, c.pn, c.pt);
		}
		for (int k = 0; k < sweeps; ++k)
			k % 2 ? sweep(contacts.rbegin(), contacts.rend()) : sweep(contacts.begin(), contacts.end());
		for (Rectangle& b : bodies) {
			b.place = b.place + h * b.velocity;
			b.angle += h * b.spin;
		}
		part();
	}
	double deepest() const { return deep; }

private:
	void findPairs()
	{
		pairs.clear();
		for (int i = 0; i < int(bodies.size()); ++i)
			for (int j = i + 1; j < int(bodies.size()); ++j) {
				const Vector d = bodies[j].place - bodies[i].place;
				constexpr double margin = 0.2;
				if (i == 0 ? d.y < 1 + 0.5 + margin : std::abs(d.x) < 1 + margin && std::abs(d.y) < 0.5 + margin)
					pairs.push_back({i, j});
			}
	}

	// In the order of their ids, with the impulses that they had.
	void findContacts()
	{
		const std::vector<Contact> before = std::move(contacts);
		contacts.clear();
		for (const auto& [i, j] : pairs)
			touch(i, j);
		std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) { return a.id < b.id; });
		auto old = before.begin();
		for (Contact& c : contacts) {
			old = std::find_if(old, before.end(), [&](const Contact& b) { return b.id >= c.id; });
			if (old != before.end() && old->id == c.id && c.gap < nearby / 10)
				c.pn = old->pn, c.pt = old->pt;
		}
	}

	void touch(int i, int j)
	{
		double most = -INFINITY, sign = 1;
		int one = i, two = j, face = 0;
		for (const auto& [a, b] : {std::pair(i, j), std::pair(j, i)})
			for (int k = 0; k < 2; ++k) {
				const double d = dot(bodies[a].axis(k), bodies[b].place - bodies[a].place),
				             apart = std::abs(d) - bodies[a].half[k] - bodies[b].reach(bodies[a].axis(k));
				if (apart > most + 1e-9) // of faces that lie upon each other, i's
					most = apart, one = a, two = b, face = k, sign = d < 0 ? -1 : 1;
			}
		if (most > nearby)
			return;
		const Rectangle &a = bodies[one], &b = bodies[two];
		const Vector n = sign * a.axis(face), along = a.axis(1 - face);
		const int edge = std::abs(dot(b.axis(0), n)) > std::abs(dot(b.axis(1), n)) ? 0 : 1;
		const Vector middle = b.place - (dot(b.axis(edge), n) > 0 ? b.half[edge] : -b.half[edge]) * b.axis(edge),
		             half = b.half[1 - edge] * b.axis(1 - edge);
		const double from = dot(middle - a.place, along), slope = dot(half, along), limit = a.half[1 - face],
		             ends[2] = {(-limit - from) / slope, (limit - from) / slope};
		const double low = std::max(-1., std::min(ends[0], ends[1])), high = std::min(1., std::max(ends[0], ends[1]));
		if (!(high - low > 1e-9))
			return;
		// Ends are told apart along the joint as i sees it, whosever face it is.
		const bool lowIsFirst = dot(half, turned(one == i ? n : -1. * n)) > 0;
		for (const bool isLow : {true, false})
			add(one, two, (long(i) * long(bodies.size()) + j) * 2 + (isLow != lowIsFirst), n, a.half[face],
			    middle + (isLow ? low : high) * half);
	}
	void add(int one, int two, long id, Vector n, double toFace, Vector point)
	{
		const Rectangle &a = bodies[one], &b = bodies[two];
		const Vector arm1 = point - a.place, arm2 = point - b.place, t = turned(n);
		Contact c {one, two, id, n, dot(arm1, n) - toFace, cross(arm1, n), cross(arm2, n), cross(arm1, t), cross(arm2, t), 0, 0, 0};
		const double m = a.perMass + b.perMass;
		c.massN = 1 / (m + a.perInertia * c.n1 * c.n1 + b.perInertia * c.n2 * c.n2);
		c.massT = 1 / (m + a.perInertia * c.t1 * c.t1 + b.perInertia * c.t2 * c.t2);
		if (c.gap < nearby)
			contacts.push_back(c);
	}

	double normalRate(const Contact& c) const
	{
		return dot(c.normal, bodies[c.two].velocity - bodies[c.one].velocity) + c.n2 * bodies[c.two].spin - c.n1 * bodies[c.one].spin;
	}
	double slipRate(const Contact& c) const
	{
		return dot(turned(c.normal), bodies[c.two].velocity - bodies[c.one].velocity) + c.t2 * bodies[c.two].spin -
		       c.t1 * bodies[c.one].spin;
	}
	void push(const Contact& c, double pn, double pt)
	{
		Rectangle &a = bodies[c.one], &b = bodies[c.two];
		const Vector p = pn * c.normal + pt * turned(c.normal);
		a.velocity = a.velocity - a.perMass * p;
		b.velocity = b.velocity + b.perMass * p;
		a.spin -= a.perInertia * (c.n1 * pn + c.t1 * pt);
		b.spin += b.perInertia * (c.n2 * pn + c.t2 * pt);
	}
	template <class Iterator>
	void sweep(Iterator c, Iterator end)
	{
		for (; c != end; ++c) {
			const double pn = std::max(0., c->pn - c->massN * (normalRate(*c) + c->closing));
			if (pn == 0 && c->pn == 0)
				continue;
			push(*c, pn - c->pn, 0);
			c->pn = pn;
			const double bound = friction * pn, pt = std::clamp(c->pt - c->massT * slipRate(*c), -bound, bound);
			push(*c, 0, pt - c->pt);
			c->pt = pt;
		}
	}

	// By displacements in the place of velocities.
	void part()
	{
		constexpr int sweeps = 50;
		constexpr double allowed = 1e-7; // m
		const std::vector<Rectangle> moved = bodies;
		const std::vector<Contact> impulses = contacts;
		findContacts();
		for (Rectangle& b : bodies)
			b.velocity = {0, 0}, b.spin = 0;
		for (Contact& c : contacts) {
			deep = std::max(deep, -c.gap);
			c.pn = 0;
		}
		for (int k = 0; k < sweeps; ++k)
			for (Contact& c : contacts) {
				const double p = std::max(0., c.pn - c.massN * (c.gap + allowed + normalRate(c)));
				push(c, p - c.pn, 0);
				c.pn = p;
			}
		for (size_t b = 0; b < bodies.size(); ++b) {
			const Vector shift = bodies[b].velocity;
			const double turn = bodies[b].spin;
			bodies[b] = moved[b];
			bodies[b].place = bodies[b].place + shift;
			bodies[b].angle += turn;
		}
		contacts = impulses;
	}

	std::vector<std::array<int, 2>> pairs;
	std::vector<Contact> contacts;
	long sincePairs {0};
	double deep {0};
};

} // namespace

int main(int argc, char** argv)
try {
	if (argc != 8)
		throw std::runtime_error("usage: <courses> <blocks per course> <amplitude, g> <rest, s> <shaking, s> <time step, s> <sweeps>");
	const Request request(argc - 2, argv);
	const double h = std::atof(argv[6]);
	const int sweeps = std::atoi(argv[7]), firstSweeps = 20 * sweeps; // of the first steps, which start without impulses
	World world(request);
	const std::vector<Rectangle> start = world.bodies;
	std::vector<size_t> top; // from -x to +x
	for (size_t b = 1; b < start.size(); ++b)
		if (start[b].place.y > 0.5 * request.courses - 0.5)
			top.push_back(b);
	std::sort(top.begin(), top.end(), [&](size_t a, size_t b) { return start[a].place.x < start[b].place.x; });
	double mean = 0, corners[2] = {0, 0};
	const long resting = std::lround(request.rest / h), steps = resting + std::lround(request.shaking / h), looks = std::lround(0.01 / h);
	for (long k = 1; k <= steps; ++k) {
		world.step(start[0].place.x + request.basePosition(k * h), h, k <= 3 ? firstSweeps : sweeps);
		if (k <= resting || (k - resting) % looks != 0)
			continue;
		const auto move = [&](size_t b) {
			return world.bodies[b].place.x - start[b].place.x - (world.bodies[0].place.x - start[0].place.x);
		};
		double sum = 0;
		for (const size_t b : top)
			sum += move(b);
		mean = std::max(mean, std::abs(sum) / double(top.size()));
		corners[0] = std::max(corners[0], std::abs(move(top.front())));
		corners[1] = std::max(corners[1], std::abs(move(top.back())));
	}
	std::printf("%.6g,%.6g,%.6g,%.3g\n", mean, corners[0], corners[1], world.deepest());
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
