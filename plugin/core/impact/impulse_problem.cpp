#include "impact/impulse_problem.hpp"
#include "impact/impulse_system.hpp"

namespace masonry {

using namespace impulse;

namespace {

// States and slip directions for the next Newton step. `damped`: directions of points that go on slipping turn half as far.
template <class K, int most>
void updateStates(System<K, most>& s, bool damped = false)
{
	const auto u = s.velocity();
	for (int i = 0; i < s.nPoints; ++i) {
		PointState<K>& point = s.points[i];
		const PointState<K> before = point;
		constexpr int rows = K::rows, tangents = rows - 1;
		const Rows<K> p = project(s, i, u.template segment<rows>(rows * i), point.state);
		const Tangential<K> y =
		    s.p.template segment<tangents>(rows * i + 1) - u.template segment<tangents>(rows * i + 1) / s.points[i].response;
		if (point.state != State::slip || !(y.norm() > 0))
			continue;
		point.slipDirection = y.normalized();
		point.slipTurn = p.template tail<tangents>().norm() / y.norm();
		if (damped && before.state == State::slip) {
			point.slipDirection = (point.slipDirection + before.slipDirection).normalized();
			point.slipTurn = (point.slipTurn + before.slipTurn) / 2;
		}
	}
}

// Goes from `before` to s.p, or half as far, or a quarter ...: where the residual is least.
template <class K, int most>
void shortenStep(System<K, most>& s, const typename System<K, most>::Vector& before)
{
	constexpr int halvings = 9;
	const typename System<K, most>::Vector step = s.p - before;
	typename System<K, most>::Vector best = s.p;
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
template <class K, int most>
void letPullingPointsGo(System<K, most>& s)
{
	// Share of the largest pull. Smaller: round-off chooses between the two corners of an edge; larger: points go that would not pull.
	constexpr double alike = 1e-6;
	for (PointState<K>& point : s.points)
		point.state = State::stick;
	for (int left = s.nPoints; left >= 0; --left) {
		solveForStates(s);
		double pull = 0;
		for (int i = 0; i < s.nPoints; ++i)
			pull = std::max(pull, -s.p[K::rows * i]);
		if (pull == 0)
			return;
		for (int i = 0; i < s.nPoints; ++i)
			if (-s.p[K::rows * i] >= (1 - alike) * pull)
				s.points[i].state = State::open;
	}
}

constexpr int minCentres = 2, maxCentres = 60;

// Centre after centre the impulses come to be those of rigid contacts, with the states as they are.
template <class K, int most>
void harden(System<K, most>& s)
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
template <class K, int most>
double target(const System<K, most>& s)
{
	const auto terms = (s.G.cwiseAbs() * s.p.cwiseAbs()).eval();
	const double roundOff = 64 * std::numeric_limits<double>::epsilon() * terms.maxCoeff();
	return s.noise + roundOff;
}

// Whether a residual counts as none.
template <class K, int most>
bool isEnough(const System<K, most>& s, double missed)
{
	return missed <= std::max(target(s), tolerance::impulseEnough * s.speed);
}

// Without the points that would pull. Returns the residual. Where points that stick ask for motions that no rigid body has, no impulses
// obey the laws, and those of soft contacts would grow as the softness falls: then the least impulses that miss the laws least are taken.
template <class K, int most>
double solveWithoutPulls(System<K, most>& s)
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
template <class K, int most>
bool hardenAtOnce(System<K, most>& s)
{
	constexpr int maxSteps = 10;
	const auto soft = s.points;
	const auto isSame = [](const PointState<K>& a, const PointState<K>& b) { return a.state == b.state; };
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
template <class K, int most>
int gaussSeidel(System<K, most>& s)
{
	constexpr int maxSweeps = 4000, checkEvery = 20;
	for (int sweep = 1; sweep <= maxSweeps; ++sweep) {
		for (int i = 0; i < s.nPoints; ++i) {
			State ignored;
			constexpr int rows = K::rows;
			const Rows<K> u = s.G.template middleCols<rows>(rows * i).transpose() * s.p + s.free.template segment<rows>(rows * i);
			s.p.template segment<rows>(rows * i) = project(s, i, u, ignored);
		}
		for (int row = K::rows * s.nPoints; row < s.p.size(); ++row)
			s.p[row] -= (s.G.col(row).dot(s.p) + s.free[row]) / s.G(row, row);
		if (sweep % checkEvery == 0 && residual(s) <= target(s))
			return sweep;
	}
	return maxSweeps;
}

// Finds the impulses of one problem: from several states and softnesses in turn, until one leads to a solution.
//
// Newton's method may cycle; which problems it cycles in depends on the states that it starts from, and on its steps.
template <class K, int most>
class Search {
	using Vector = typename System<K, most>::Vector;
	enum class Steps { full, shorter, damped };

public:
	explicit Search(System<K, most>& system) : s(system), best(system.p), last(system.p)
	{
		const auto slips = [](const PointState<K>& point) { return point.law.kind == PointLaw::Coulomb; };
		anySlips = std::any_of(s.points.begin(), s.points.end(), slips);
		allSlip = std::all_of(s.points.begin(), s.points.end(), slips);
	}

	ImpulseReport run()
	{
		if (ofOneFace())
			return report;
		newton();
		if (!solved && anySlips) {
			fromSofterContacts();
			fromOtherStates();
		}
		inTurnsWithSweeps();
		toRigidContacts();
		if (!allSlip && !isEnough(s, report.residual))
			report.residual = solveWithoutPulls(s);
		report.solved = isEnough(s, report.residual);
		return report;
	}

private:
	// Softness, relative to the one at first, of the first try of one face, whose redundant impulses then have fewer digits of round-off;
	// the largest; the share by which it falls at least.
	static constexpr double gentle = 1e4, softest = 1e6, slowest = 0.8;

	void startAnew()
	{
		report.residual = std::numeric_limits<double>::infinity();
		solved = false;
	}
	void keepBest()
	{
		const double r = residual(s);
		solved = r <= target(s);
		if (!(r < report.residual))
			return;
		report.residual = r;
		best = s.p;
	}
	void newton(Steps steps = Steps::full, int times = 30)
	{
		for (int k = 0; k < times && !solved; ++k, ++report.iterations) {
			const Vector before = s.p;
			solveForStates(s);
			if (steps == Steps::shorter)
				shortenStep(s, before);
			keepBest();
			updateStates(s, steps == Steps::damped);
		}
	}

	// Returns whether the problem is solved, with soft contacts first. If not, the states are those of the beginning.
	bool ofOneFace()
	{
		constexpr int ofFace = 4;
		if (s.nPoints > ofFace)
			return false;
		const auto given = s.points;
		s.soften(gentle);
		newton();
		if (solved && hardenAtOnce(s)) {
			report.residual = residual(s);
			return true;
		}
		s.soften(1);
		s.p.setZero();
		s.points = given;
		startAnew();
		return false;
	}

	// Starts from the impulses of softer contacts, which come nearer to the softness at first in ever smaller steps.
	void fromSofterContacts()
	{
		last.setZero();
		for (double fall = 0.1; fall < slowest && !(solved && s.softer == 1);) {
			s.soften(std::max(1., fall * reached));
			s.p = last;
			updateStates(s);
			startAnew();
			newton();
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

	// Starts from the states of the velocities without impulses, of points that all stick, and of those of them that do not pull.
	void fromOtherStates()
	{
		if (!solved) {
			s.p.setZero();
			updateStates(s);
			newton();
		}
		if (!solved) {
			for (PointState<K>& point : s.points)
				point.state = State::stick;
			newton();
		}
		if (!solved) {
			letPullingPointsGo(s);
			updateStates(s);
			newton();
		}
	}

	void inTurnsWithSweeps()
	{
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
	}

	void toRigidContacts()
	{
		s.p = best;
		updateStates(s);
		s.moveCentre();
		report.residual = residual(s);
		for (int k = 0; k < maxCentres && solved && (k < minCentres || report.residual > target(s)); ++k) {
			best = s.p;
			solved = false;
			newton();
			s.p = best;
			s.moveCentre();
			report.residual = residual(s);
		}
	}

	System<K, most>& s;
	ImpulseReport report {0, std::numeric_limits<double>::infinity()};
	bool solved {false}, anySlips, allSlip;
	Vector best;                   // impulses of the least residual
	Vector last;                   // those of the stiffest contacts that were solved,
	double reached {10 * softest}; // which are so many times as soft as at first
};

template <class K, int most>
ImpulseReport solveDense(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	System<K, most> s(bodies, points, couples);
	const ImpulseReport report = Search(s).run();
	apply(s, bodies, points, couples);
	return report;
}

} // namespace

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

template <class K>
ImpulseReport solveImpulses(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	if (points.empty() && couples.empty())
		return {0, 0.};
	const bool few = points.size() <= fewPoints && K::rows * points.size() + couples.size() <= fewRows;
	return few ? solveDense<K, fewRows>(bodies, points, couples) : solveDense<K, Eigen::Dynamic>(bodies, points, couples);
}

template <class K>
ImpulseReport letPullingPointsGo(Bodies<K>& bodies, ImpulsePoints<K>& points, CoupleRows<K>& couples)
{
	System<K, Eigen::Dynamic> s(bodies, points, couples);
	const double missed = solveWithoutPulls(s);
	apply(s, bodies, points, couples);
	return {0, missed, missed <= tolerance::impulseEnough * s.speed};
}

template ImpulseReport solveImpulses(Bodies<Plane>&, ImpulsePoints<Plane>&, CoupleRows<Plane>&);
template ImpulseReport solveImpulses(Bodies<Space>&, ImpulsePoints<Space>&, CoupleRows<Space>&);
template ImpulseReport letPullingPointsGo(Bodies<Plane>&, ImpulsePoints<Plane>&, CoupleRows<Plane>&);
template ImpulseReport letPullingPointsGo(Bodies<Space>&, ImpulsePoints<Space>&, CoupleRows<Space>&);

} // namespace masonry
