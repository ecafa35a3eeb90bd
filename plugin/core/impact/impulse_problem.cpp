#include "impact/impulse_problem.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <utility>

namespace masonry {

namespace {

enum class State { open, stick, slip };

// Up to so many points and rows everything lies on the stack.
constexpr int fewPoints = 16, fewRows = 56;
template <class T>
using PerPoint = boost::container::small_vector<T, fewPoints>;
template <class T>
using PerRow = boost::container::small_vector<T, fewRows>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// How a row acts on one free body: the velocity that it sees is direction.(v, w), and an impulse p along it changes (v, w)
// by response p.
struct Side {
	int body;
	Vector6 direction, response;
};

struct Row {
	int sides {0}; // free bodies
	std::array<Side, 2> side;
};

struct PointState {
	double friction;
	State state;
	Matrix3 axes;                            // rows: the normal and two tangents
	Vector2 slipDirection {Vector2::Zero()}; // unit vector d of p_t while the point slips
	double slipTurn {0};                     // beta = mu p_n / |y_t|: how d turns with y_t
	// Stiffness of the point's impulse against its own velocity, an upper bound: with r = 1/response the map below contracts.
	double response {0};
};

// Rows: three a point (normal, two tangents), then one a couple, each couple multiplied by a length so that all rows
// are velocities. u + R (p - c) = G p + free, where G = J M^-1 J^T + R, and free has the term -R c. `most`: rows, or Eigen::Dynamic.
template <int most>
struct System {
	using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most>;
	using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;

	PerRow<Row> rows;
	Matrix G;
	Vector free, p, compliance, centre; // compliance: R, centre: c
	int nPoints, nCouples;
	double length; // of the couple rows, m
	double speed;  // largest velocity that the impulses have to take away, m/s
	double noise;  // velocity that counts as zero, m/s
	double softer {1};
	PerPoint<PointState> points;

	System(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, const std::vector<CoupleRow>& couples);
	Vector velocity() const { return G * p + free; }
	// So many times as soft as at first.
	void soften(double times)
	{
		const Vector change = (times - softer) * compliance;
		softer = times;
		G.diagonal() += change;
		free -= change.cwiseProduct(centre);
	}
	// At p the velocity is then that of rigid contacts.
	void moveCentre()
	{
		free += softer * compliance.cwiseProduct(Vector(centre - p));
		centre = p;
	}
};

void addSides(Row* rows, const std::vector<Body>& bodies, const ImpulsePoint& point, const Matrix3& axes)
{
	for (const auto& [b, sign] : {std::pair(point.body1, -1.), std::pair(point.body2, 1.)}) {
		const Body& body = bodies[b];
		if (body.prescribed)
			continue;
		const Vector3 pressed = point.position - body.pose.position, gripped = pressed + point.grip;
		const Matrix3 inverseInertia = body.inverseInertia();
		for (int k = 0; k < 3; ++k) {
			Side& side = rows[k].side[rows[k].sides++];
			side.body = b;
			const Vector3 axis = sign * axes.row(k).transpose(), turn = (k == 0 ? pressed : gripped).cross(axis);
			side.direction << axis, turn;
			side.response << body.inverseMass() * axis, inverseInertia * turn;
		}
	}
}

void addSides(Row& row, const std::vector<Body>& bodies, const CoupleRow& couple, double length)
{
	for (const auto& [b, sign] : {std::pair(couple.body1, -1.), std::pair(couple.body2, 1.)}) {
		if (bodies[b].prescribed)
			continue;
		Side& side = row.side[row.sides++];
		side.body = b;
		const Vector3 turn = sign * length * couple.axis;
		side.direction << Vector3::Zero(), turn;
		side.response << Vector3::Zero(), bodies[b].inverseInertia() * turn;
	}
}

double coupling(const Row& r, const Row& s)
{
	double sum = 0;
	for (int i = 0; i < r.sides; ++i)
		for (int j = 0; j < s.sides; ++j)
			if (r.side[i].body == s.side[j].body)
				sum += r.side[i].direction.dot(s.side[j].response);
	return sum;
}

template <int most>
System<most>::System(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& given, const std::vector<CoupleRow>& couples)
    : nPoints(int(given.size())), nCouples(int(couples.size())), length(longestArm(bodies, given))
{
	if (length == 0)
		length = 1;
	const int n = 3 * nPoints + nCouples;
	rows.resize(n);
	free.resize(n);
	for (int i = 0; i < nPoints; ++i) {
		points.push_back({given[i].friction, given[i].holds ? State::stick : State::open, axesAlong(given[i].normal)});
		addSides(&rows[3 * i], bodies, given[i], points[i].axes);
		free.template segment<3>(3 * i) = points[i].axes * (relativeVelocity(bodies, given[i]) + given[i].bias);
	}
	for (int c = 0; c < nCouples; ++c) {
		const CoupleRow& couple = couples[c];
		addSides(rows[3 * nPoints + c], bodies, couple, length);
		const Vector3 spin = bodies[couple.body2].angularVelocity - bodies[couple.body1].angularVelocity;
		free[3 * nPoints + c] = length * (couple.axis.dot(spin) - couple.target);
	}
	speed = free.cwiseAbs().maxCoeff();
	noise = tolerance::impulse * speed;
	G.resize(n, n);
	for (int r = 0; r < n; ++r)
		for (int s = 0; s <= r; ++s)
			G(r, s) = G(s, r) = coupling(rows[r], rows[s]);
	compliance = tolerance::softness * G.diagonal();
	for (int i = 0; i < nPoints; ++i) {
		points[i].response = G.template block<3, 3>(3 * i, 3 * i).trace();
		compliance.template segment<3>(3 * i).setConstant(tolerance::softness * points[i].response);
	}
	G.diagonal() += compliance;
	p = centre = Vector::Zero(n);
}

// Newton step: solution, nearest to the present impulses, of the laws, linear for the present states. A slipping point obeys u_n = 0 and
//     p_t = mu p_n d(y_t),  y_t = p_t - r u_t,  d(y) = y/|y| ~ d + (1 - d d^T) y / |y_k|,
// so  p_t - mu p_n d - beta (1 - d d^T)(p_t - r u_t) = 0 with beta from the last iterate.
template <int most>
void solveForStates(System<most>& s)
{
	using Matrix = typename System<most>::Matrix;
	using Vector = typename System<most>::Vector;
	PerRow<int> active; // rows of p that may differ from zero
	for (int i = 0; i < s.nPoints; ++i)
		if (s.points[i].state != State::open)
			active.insert(active.end(), {3 * i, 3 * i + 1, 3 * i + 2});
	for (int row = 3 * s.nPoints; row < s.p.size(); ++row)
		active.push_back(row);
	if (active.empty()) {
		s.p.setZero();
		return;
	}
	const int n = int(active.size());
	Matrix A(n, n); // velocity rows by default
	Vector b(n);
	for (int k = 0; k < n; ++k) {
		for (int l = 0; l < n; ++l)
			A(l, k) = s.G(active[l], active[k]);
		b[k] = -s.free[active[k]];
	}
	for (int k = 0; k < n && active[k] < 3 * s.nPoints; k += 3) {
		const int i = active[k] / 3, t = k + 1; // t: first tangent
		const PointState& point = s.points[i];
		if (point.state != State::slip)
			continue;
		const Vector2& d = point.slipDirection;
		const Eigen::Matrix2d turn = point.slipTurn * (Eigen::Matrix2d::Identity() - d * d.transpose());
		const double stiffness = point.response; // 1/r: turns impulses into velocities, as in the other rows
		for (int l = 0; l < n; ++l)
			A.template block<2, 1>(t, l) = (turn * A.template block<2, 1>(t, l)).eval();
		b.template segment<2>(t) = (turn * b.template segment<2>(t)).eval();
		A.template block<2, 1>(t, k) -= stiffness * point.friction * d;
		A.template block<2, 2>(t, t) += stiffness * (Eigen::Matrix2d::Identity() - turn);
	}
	Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition(n, n);
	decomposition.setThreshold(tolerance::rank);
	decomposition.compute(A);
	Vector x(n);
	for (int k = 0; k < n; ++k)
		x[k] = s.p[active[k]];
	for (int refined = 0; refined < 2; ++refined) // twice: long arms on slender blocks cost four digits
		x += decomposition.solve(b - A * x);
	s.p.setZero();
	for (int k = 0; k < n; ++k)
		s.p[active[k]] = x[k];
}

// Projection of p - r u on the friction cone of one point; also tells the state that it stands for.
template <int most>
Vector3 project(const System<most>& s, int i, const Vector3& u, State& state)
{
	const Vector3 y = s.p.template segment<3>(3 * i) - u / s.points[i].response;
	state = State::open;
	// Without slip the projection jumps where y_n changes sign: a point that just touches (C = 0) must not be held by round-off.
	const double least = std::isinf(s.points[i].friction) ? s.noise / s.points[i].response : 0;
	if (!(y[0] > least))
		return Vector3::Zero();
	const double size = y.tail<2>().norm(), bound = s.points[i].friction * y[0];
	state = size > bound ? State::slip : State::stick;
	Vector3 result = y;
	if (size > bound)
		result.tail<2>() *= bound / size;
	return result;
}

template <int most>
double residual(const System<most>& s)
{
	const auto u = s.velocity();
	double worst = s.nCouples ? u.tail(s.nCouples).cwiseAbs().maxCoeff() : 0;
	for (int i = 0; i < s.nPoints; ++i) {
		State ignored;
		const Vector3 step = s.p.template segment<3>(3 * i) - project(s, i, u.template segment<3>(3 * i), ignored);
		worst = std::max(worst, step.norm() * s.points[i].response);
	}
	return worst;
}

// States and slip directions for the next Newton step. `damped`: directions of points that go on slipping turn half as far.
template <int most>
void updateStates(System<most>& s, bool damped = false)
{
	const auto u = s.velocity();
	for (int i = 0; i < s.nPoints; ++i) {
		PointState& point = s.points[i];
		const PointState before = point;
		const Vector3 p = project(s, i, u.template segment<3>(3 * i), point.state);
		const Vector2 y = s.p.template segment<2>(3 * i + 1) - u.template segment<2>(3 * i + 1) / s.points[i].response;
		if (point.state != State::slip || !(y.norm() > 0))
			continue;
		point.slipDirection = y.normalized();
		point.slipTurn = p.tail<2>().norm() / y.norm();
		if (damped && before.state == State::slip) {
			point.slipDirection = (point.slipDirection + before.slipDirection).normalized();
			point.slipTurn = (point.slipTurn + before.slipTurn) / 2;
		}
	}
}

// Goes from `before` to s.p, or half as far, or a quarter ...: where the residual is least.
template <int most>
void shortenStep(System<most>& s, const typename System<most>::Vector& before)
{
	constexpr int halvings = 9;
	const typename System<most>::Vector step = s.p - before;
	typename System<most>::Vector best = s.p;
	double least = residual(s), share = 1;
	for (int k = 0; k < halvings; ++k) {
		share /= 2;
		s.p = before + share * step;
		if (const double r = residual(s); r < least) {
			least = r;
			best = s.p;
		}
	}
	s.p = best;
}

// Without slip some problems have no solution. The way out keeps every promise on energy: all points held, then those
// that pull most let go, until none pulls: all that pull alike, so that their order decides nothing. A point let go may still approach,
// which the residual tells.
template <int most>
void letPullingPointsGo(System<most>& s)
{
	// Share of the largest pull. Smaller: round-off chooses between the two corners of an edge; larger: points go that would not pull.
	constexpr double alike = 1e-6;
	for (PointState& point : s.points)
		point.state = State::stick;
	for (int left = s.nPoints; left >= 0; --left) {
		solveForStates(s);
		double pull = 0;
		for (int i = 0; i < s.nPoints; ++i)
			pull = std::max(pull, -s.p[3 * i]);
		if (pull == 0)
			return;
		for (int i = 0; i < s.nPoints; ++i)
			if (-s.p[3 * i] >= (1 - alike) * pull)
				s.points[i].state = State::open;
	}
}

constexpr int minCentres = 2, maxCentres = 60;

// Centre after centre the impulses come to be those of rigid contacts, with the states as they are.
template <int most>
void harden(System<most>& s)
{
	for (int k = 0; k < maxCentres; ++k) {
		s.moveCentre();
		const double before = residual(s);
		solveForStates(s);
		if (!(residual(s) < before / 2))
			break;
	}
	s.moveCentre();
}

// Residual that counts as zero: a share of the approach speed, and round-off of the products in G p.
template <int most>
double target(const System<most>& s)
{
	const auto terms = (s.G.cwiseAbs() * s.p.cwiseAbs()).eval();
	const double roundOff = 64 * std::numeric_limits<double>::epsilon() * terms.maxCoeff();
	return s.noise + roundOff;
}

// Whether a residual counts as none.
template <int most>
bool isEnough(const System<most>& s, double missed)
{
	return missed <= std::max(target(s), tolerance::impulseEnough * s.speed);
}

// Without the points that would pull. Returns the residual. Where points that stick ask for motions that no rigid body has, no impulses
// obey the laws, and those of soft contacts would grow as the softness falls: then the least impulses that miss the laws least are taken.
template <int most>
double solveWithoutPulls(System<most>& s)
{
	letPullingPointsGo(s);
	harden(s);
	if (const double missed = residual(s); isEnough(s, missed))
		return missed;
	s.soften(0);
	s.p.setZero();
	letPullingPointsGo(s);
	return residual(s);
}

// From the solution for soft contacts to the nearest for rigid ones in the same states. False: these do not obey the laws.
template <int most>
bool hardenAtOnce(System<most>& s)
{
	constexpr int maxSteps = 10;
	const auto soft = s.points;
	const auto isSame = [](const PointState& a, const PointState& b) { return a.state == b.state; };
	s.soften(0);
	bool solved = false;
	for (int k = 0; k < maxSteps; ++k) {
		solveForStates(s);
		if (solved)
			return true;
		solved = residual(s) <= target(s); // one step more doubles the digits of the slip directions
		updateStates(s);
		if (!std::equal(soft.begin(), soft.end(), s.points.begin(), isSame))
			break;
	}
	return solved;
}

// G is symmetric, and its columns, not its rows, lie together in memory.
template <int most>
int gaussSeidel(System<most>& s)
{
	constexpr int maxSweeps = 4000, checkEvery = 20;
	for (int sweep = 1; sweep <= maxSweeps; ++sweep) {
		for (int i = 0; i < s.nPoints; ++i) {
			State ignored;
			const Vector3 u = s.G.template middleCols<3>(3 * i).transpose() * s.p + s.free.template segment<3>(3 * i);
			s.p.template segment<3>(3 * i) = project(s, i, u, ignored);
		}
		for (int row = 3 * s.nPoints; row < s.p.size(); ++row)
			s.p[row] -= (s.G.col(row).dot(s.p) + s.free[row]) / s.G(row, row);
		if (sweep % checkEvery == 0 && residual(s) <= target(s))
			return sweep;
	}
	return maxSweeps;
}

template <int most>
void apply(const System<most>& s, std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	for (int row = 0; row < s.p.size(); ++row)
		for (int i = 0; i < s.rows[row].sides; ++i) {
			const Side& side = s.rows[row].side[i];
			bodies[side.body].velocity += s.p[row] * side.response.template head<3>();
			bodies[side.body].angularVelocity += s.p[row] * side.response.template tail<3>();
		}
	for (int i = 0; i < s.nPoints; ++i)
		points[i].impulse = s.points[i].axes.transpose() * s.p.template segment<3>(3 * i);
	for (int c = 0; c < s.nCouples; ++c)
		couples[c].couple = s.length * s.p[3 * s.nPoints + c];
}

template <int most>
ImpulseReport solveDense(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	System<most> s(bodies, points, couples);
	const auto slips = [](const PointState& point) { return std::isfinite(point.friction); };
	const bool anySlips = std::any_of(s.points.begin(), s.points.end(), slips),
	           allSlip = std::all_of(s.points.begin(), s.points.end(), slips);
	ImpulseReport report {0, std::numeric_limits<double>::infinity()};
	bool solved = false;
	auto best = s.p;
	const auto keepBest = [&] {
		const double r = residual(s);
		solved = r <= target(s);
		if (!(r < report.residual))
			return;
		report.residual = r;
		best = s.p;
	};
	// Newton's method may cycle; which problems it cycles in depends on the states that it starts from, and on its steps.
	enum class Steps { full, shorter, damped };
	const auto newton = [&](Steps steps, int times) {
		for (int k = 0; k < times && !solved; ++k, ++report.iterations) {
			const auto before = s.p;
			solveForStates(s);
			if (steps == Steps::shorter)
				shortenStep(s, before);
			keepBest();
			updateStates(s, steps == Steps::damped);
		}
	};
	const auto fromTheseStates = [&] {
		constexpr int few = 30;
		newton(Steps::full, few);
	};
	// As many times as soft: of one face, whose redundant impulses then have fewer digits of round-off; where Newton's method cycles.
	constexpr int ofFace = 4;
	constexpr double gentle = 1e4, softest = 1e6, slowest = 0.8;
	if (s.nPoints <= ofFace) {
		const auto given = s.points;
		s.soften(gentle);
		fromTheseStates();
		if (solved && hardenAtOnce(s)) {
			report.residual = residual(s);
			apply(s, bodies, points, couples);
			return report;
		}
		s.soften(1);
		s.p.setZero();
		s.points = given;
		report.residual = std::numeric_limits<double>::infinity();
		solved = false;
	}
	fromTheseStates();
	double reached = 10 * softest;
	auto last = s.p;
	if (!solved && anySlips) { // from the impulses of softer contacts
		last.setZero();
		for (double fall = 0.1; fall < slowest && !(solved && s.softer == 1);) {
			s.soften(std::max(1., fall * reached));
			s.p = last;
			updateStates(s);
			report.residual = std::numeric_limits<double>::infinity();
			solved = false;
			fromTheseStates();
			if (solved) {
				reached = s.softer;
				last = s.p;
			} else {
				fall = std::sqrt(fall);
			}
		}
		s.soften(1);
		if (!solved)
			report.residual = std::numeric_limits<double>::infinity();
	}
	if (!solved && anySlips) { // those of the velocities without impulses
		s.p.setZero();
		updateStates(s);
		fromTheseStates();
	}
	if (!solved && anySlips) {
		for (PointState& point : s.points)
			point.state = State::stick;
		fromTheseStates();
	}
	if (!solved && anySlips) {
		letPullingPointsGo(s);
		updateStates(s);
		fromTheseStates();
	}
	const int rounds = anySlips ? 5 : 2; // where nothing slips there may be no solution to wait for
	for (int round = 0; round < rounds && !solved; ++round) {
		s.p = best;
		report.iterations += gaussSeidel(s);
		keepBest();
		updateStates(s);
		newton(round % 2 == 0 ? Steps::damped : Steps::shorter, anySlips ? 100 : 30);
	}
	if (!solved && reached <= softest) {
		s.soften(reached);
		best = last;
		solved = true;
	}
	s.p = best;
	updateStates(s);
	s.moveCentre();
	report.residual = residual(s);
	for (int k = 0; k < maxCentres && solved && (k < minCentres || report.residual > target(s)); ++k) {
		best = s.p;
		solved = false;
		fromTheseStates();
		s.p = best;
		s.moveCentre();
		report.residual = residual(s);
	}
	if (!allSlip && !isEnough(s, report.residual))
		report.residual = solveWithoutPulls(s);
	report.solved = isEnough(s, report.residual);
	apply(s, bodies, points, couples);
	return report;
}

} // namespace

Vector3 velocityAt(const Body& body, const ImpulsePoint& point)
{
	return body.velocityAt(point.position) + point.normal.dot(body.angularVelocity) * point.normal.cross(point.grip);
}

Vector3 relativeVelocity(const std::vector<Body>& bodies, const ImpulsePoint& point)
{
	return velocityAt(bodies[point.body2], point) - velocityAt(bodies[point.body1], point);
}

Matrix3 axesAlong(const Vector3& normal)
{
	int smallest;
	normal.cwiseAbs().minCoeff(&smallest);
	Matrix3 axes;
	axes.row(0) = normal;
	axes.row(1) = normal.cross(Vector3(Vector3::Unit(smallest))).normalized();
	axes.row(2) = normal.cross(Vector3(axes.row(1)));
	return axes;
}

double longestArm(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points)
{
	double longest = 0;
	for (const auto& point : points)
		for (int b : {point.body1, point.body2})
			if (!bodies[b].prescribed)
				longest = std::max(longest, (point.position - bodies[b].pose.position).norm());
	return longest;
}

ImpulseReport solveImpulses(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	if (points.empty() && couples.empty())
		return {0, 0.};
	const bool few = points.size() <= fewPoints && 3 * points.size() + couples.size() <= fewRows;
	return few ? solveDense<fewRows>(bodies, points, couples) : solveDense<Eigen::Dynamic>(bodies, points, couples);
}

ImpulseReport letPullingPointsGo(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	System<Eigen::Dynamic> s(bodies, points, couples);
	const double missed = solveWithoutPulls(s);
	apply(s, bodies, points, couples);
	return {0, missed, missed <= tolerance::impulseEnough * s.speed};
}

} // namespace masonry
