#pragma once
// The proximal semi-smooth Newton method of contact_problem.hpp. With the impulses l of the rows as centre and V their velocities, w is
// the root of
//
//     F(w) = M w - J^T (P(y) - l),  y = l - (u + J w)/R
//
// Only increments enter, so that round-off does not grow with 1/R; and P(y) is the next centre.
#include "dynamics/rigid/block_factor.hpp"
#include "dynamics/rigid/contact_state.hpp"
#include "tolerances.hpp"

namespace masonry::rigid {

template <class K>
class ContactNewton {
public:
	explicit ContactNewton(ContactState<K>& state) : s(state) {}

	void forget() { kept.clear(); }

	// With a small R at once, for impulses that are close to the solution: from the states in the kept factor, else from
	// those of the impulses. That factor is of another problem with the same points; as only increments enter, this slows
	// convergence but does not move the solution. False: too far.
	bool resume(double tolerance, SolveReport& report)
	{
		constexpr int maxCentres = 6, maxSteps = 10;
		constexpr double slow = 0.1; // ratio of residuals from centre to centre that calls for a new factor
		const bool known = factorIsKept();
		begin(tolerance);
		factored = known;
		softness = tolerance::contactProblem::resumedSoftness;
		if (!factored) {
			for (int i = 0; i < s.nPoints; ++i)
				points[i].rate = projectionRate<Rows>(onCone(s.rows[i].impulse), s.rows[i].friction);
		}
		for (int k = 0; k < maxCentres; ++k) {
			if (!findRoot(true, maxSteps, report))
				return false;
			for (int i = 0; i < s.nPoints; ++i)
				s.rows[i].impulse = points[i].next;
			s.applyImpulses();
			const double present = report.residual;
			report.residual = s.residual();
			if (report.residual <= tolerance) {
				keepFactor();
				return true;
			}
			if (report.residual > slow * present)
				factored = false;
		}
		return false;
	}

	// Centre after centre. R falls while roots are found, so that the centres converge faster than linearly; where one is not it grows, and
	// falls in smaller steps from there on, until roots come easily again. As the load on springs of stiffness 1/R, a centre moves the
	// forces by what the points still move, over R: forces that have far to go need a small R, and a path of many changes of state small
	// steps.
	double converge(double target, SolveReport& report)
	{
		constexpr int maxCentres = 40, maxSteps = 30, easy = 3;  // factorisations
		constexpr double growth = 10, most = 1, steepest = 1e-2; // of the softness
		double fall = steepest;
		begin(target);
		softness = tolerance::contactProblem::softness;
		double present = s.residual();
		bool found = false;
		for (int k = 0; k < maxCentres && softness <= most; ++k) {
			const int before = report.factorisations;
			found = findRoot(found, maxSteps, report);
			const bool easily = found && report.factorisations - before <= easy;
			for (int i = 0; i < s.nPoints; ++i)
				std::swap(s.rows[i].impulse, points[i].next);
			s.applyImpulses();
			const double next = found ? goOn(s.residual()) : s.residual();
			s.keepBest(next);
			if (next <= target)
				return next;
			if (!found && next > present) {
				for (int i = 0; i < s.nPoints; ++i)
					s.rows[i].impulse = points[i].next;
				s.applyImpulses();
			} else {
				present = next;
			}
			if (easily)
				fall = std::max(steepest, fall * fall);
			softness = found ? std::max(tolerance::contactProblem::leastSoftness, fall * softness) : growth * softness;
			if (!found)
				fall = std::sqrt(fall);
			factored = false;
		}
		return present;
	}

private:
	using Rows = typename ContactRows<K>::Rows;
	using Block = typename OnePoint<K::rows>::Block;
	using Velocity = typename K::Velocity;
	using Edge = typename BlockFactor<K::dof>::Edge;

	struct Point {
		Rows centre, next, move;                              // u at the centre, P(y), last change of the centre
		Block rate {Block::Zero()}, factored {Block::Zero()}; // derivative of P(y), and the one that is in the factor
		int edge;                                             // between its bodies; -1: one of them is prescribed
	};

	struct Body {
		Eigen::Matrix<double, K::dof, K::dof> mass;
		Velocity w, start, force; // w: velocity minus that of the centre, and before the line search; force: F
	};

	// From the new centre, with the old one in `next`, on by its last move, ever farther while the residual hardly grows: where no point
	// changes its state, centre after centre moves by the same u/R. Returns the residual.
	double goOn(double present)
	{
		constexpr double slack = 1e-2, most = 1e6;
		for (int i = 0; i < s.nPoints; ++i) {
			points[i].move = s.rows[i].impulse - points[i].next;
			points[i].next = s.rows[i].impulse;
		}
		const auto residualAt = [&](double moves) {
			for (int i = 0; i < s.nPoints; ++i)
				s.rows[i].impulse = moves > 0 ? project<Rows>(points[i].next + moves * points[i].move, s.rows[i].friction) : points[i].next;
			s.applyImpulses();
			return s.residual();
		};
		double reached = 0;
		for (double moves = 1; moves <= most; moves *= 2) {
			const double next = residualAt(moves);
			if (!(next <= (1 + slack) * present))
				break;
			present = next;
			reached = moves;
		}
		return residualAt(reached);
	}

	double compliance(int i) const { return softness * s.points[i].alone.trace; } // R

	void begin(double tolerance)
	{
		constexpr double share = 0.1; // of the merit that lets the lightest body miss its velocity by the tolerance
		bodies.resize(s.nBodies);
		points.resize(s.nPoints);
		step.resize(s.nBodies);
		double lightest = std::numeric_limits<double>::infinity();
		for (int b = 0; b < s.nBodies; ++b) {
			lightest = std::min(lightest, 1 / s.bodies[b].inverseMass.linear);
			auto& mass = bodies[b].mass;
			mass.setZero();
			mass.diagonal().template head<K::dimension>().setConstant(1 / s.bodies[b].inverseMass.linear);
			mass.template bottomRightCorner<K::spins, K::spins>() = s.bodies[b].inverseMass.angular.inverse();
		}
		rootMerit = share * lightest * tolerance * tolerance;
		edges = *s.near;
		int last = 0;
		for (int i = 0; i < s.nPoints; ++i) {
			const Edge edge {s.rows[i].body1, s.rows[i].body2};
			points[i].edge = edge[0] >= 0 && edge[1] >= 0 ? last = numberOf(edge, last) : -1;
		}
		factor.setGraph(s.nBodies, edges);
		factored = false;
		kept.clear();
	}

	// Points come pair by pair: the edge is sought from that of the last point on.
	int numberOf(const Edge& edge, int last)
	{
		auto found = std::find(edges.begin() + last, edges.end(), edge);
		if (found == edges.end())
			found = std::find(edges.begin(), edges.begin() + last, edge);
		if (found == edges.end() || *found != edge)
			found = edges.insert(edges.end(), edge);
		return int(found - edges.begin());
	}

	// Sets F, P(y) and its derivative; returns F^T M^-1 F.
	double evaluate()
	{
		for (int b = 0; b < s.nBodies; ++b)
			bodies[b].force = bodies[b].mass * bodies[b].w;
		for (int i = 0; i < s.nPoints; ++i) {
			const ContactRows<K>& c = s.rows[i];
			Point& p = points[i];
			Rows u = p.centre;
			if (c.body1 >= 0)
				u += c.J1 * bodies[c.body1].w;
			if (c.body2 >= 0)
				u += c.J2 * bodies[c.body2].w;
			const Rows y = c.impulse - u / compliance(i);
			p.next = project(y, c.friction);
			p.rate = projectionRate(y, c.friction);
			const Rows change = p.next - c.impulse;
			if (c.body1 >= 0)
				bodies[c.body1].force -= c.J1.transpose() * change;
			if (c.body2 >= 0)
				bodies[c.body2].force -= c.J2.transpose() * change;
		}
		double merit = 0;
		for (int b = 0; b < s.nBodies; ++b)
			merit += bodies[b].force.dot(s.bodies[b].inverseMass * bodies[b].force);
		return merit;
	}

	bool factorIsPresent() const
	{
		return factored && std::all_of(points.begin(), points.begin() + s.nPoints, [](const Point& p) { return p.rate == p.factored; });
	}

	// M + J^T P' J / R
	void factorise(SolveReport& report)
	{
		factor.setZero();
		for (int b = 0; b < s.nBodies; ++b)
			factor.diagonal(b) = bodies[b].mass;
		for (int i = 0; i < s.nPoints; ++i) {
			const ContactRows<K>& c = s.rows[i];
			points[i].factored = points[i].rate;
			if (points[i].rate.isZero(0))
				continue;
			const Block stiffness = points[i].rate / compliance(i);
			const typename ContactRows<K>::Jacobian K1 = stiffness.lazyProduct(c.J1), K2 = stiffness.lazyProduct(c.J2);
			if (c.body1 >= 0)
				factor.diagonal(c.body1).noalias() += c.J1.transpose().lazyProduct(K1);
			if (c.body2 >= 0)
				factor.diagonal(c.body2).noalias() += c.J2.transpose().lazyProduct(K2);
			if (points[i].edge < 0)
				continue;
			factor.firstSecond(points[i].edge).noalias() += c.J1.transpose().lazyProduct(K2);
			factor.secondFirst(points[i].edge).noalias() += c.J2.transpose().lazyProduct(K1);
		}
		factor.factorise();
		factored = true;
		++report.factorisations;
	}

	// One Newton step, shortened until the merit falls. False: it does not.
	bool takeStep(double& merit, bool& full)
	{
		constexpr double decrease = 1e-4, shortest = 0.01;
		for (int b = 0; b < s.nBodies; ++b) {
			step[b] = bodies[b].force;
			bodies[b].start = bodies[b].w;
		}
		factor.solve(step);
		for (double t = 1; t >= shortest; t /= 2) {
			for (int b = 0; b < s.nBodies; ++b)
				bodies[b].w = bodies[b].start - t * step[b];
			const double trial = evaluate();
			full = t == 1;
			if (trial <= (1 - decrease * t) * merit) {
				merit = trial;
				return true;
			}
		}
		return false;
	}

	// The root if every point were in its state in the factor: P(y) = P'(y) y since P is homogeneous.
	void predict(SolveReport& report)
	{
		if (!factored)
			factorise(report);
		for (Velocity& right : step)
			right.setZero();
		for (int i = 0; i < s.nPoints; ++i) {
			const ContactRows<K>& c = s.rows[i];
			const Rows change = points[i].factored * (c.impulse - points[i].centre / compliance(i)) - c.impulse;
			if (c.body1 >= 0)
				step[c.body1] += c.J1.transpose() * change;
			if (c.body2 >= 0)
				step[c.body2] += c.J2.transpose() * change;
		}
		factor.solve(step);
		for (int b = 0; b < s.nBodies; ++b)
			bodies[b].w = step[b];
	}

	// Root of F for the present centre. False: stopped short of it.
	bool findRoot(bool statesKnown, int maxSteps, SolveReport& report)
	{
		constexpr double reduction = 1e-8; // of the merit
		for (int i = 0; i < s.nPoints; ++i)
			points[i].centre = s.relativeVelocity(s.rows[i]);
		if (statesKnown) {
			predict(report);
		} else {
			for (Body& body : bodies)
				body.w.setZero();
		}
		double merit = evaluate();
		if (statesKnown && (merit <= rootMerit || factorIsPresent()))
			return true;
		const double enough = std::max(rootMerit, reduction * merit);
		for (int k = 0; k < maxSteps; ++k) {
			if (!factorIsPresent())
				factorise(report);
			bool full = false;
			if (!takeStep(merit, full))
				return false;
			if (merit <= enough || (full && factorIsPresent()))
				return true;
		}
		return false;
	}

	bool factorIsKept() const
	{
		return int(kept.size()) == s.nPoints && s.nBodies == int(bodies.size()) &&
		       std::equal(kept.begin(), kept.end(), s.rows,
		                  [](const auto& k, const ContactRows<K>& c) { return k[0] == c.body1 && k[1] == c.body2; });
	}

	void keepFactor()
	{
		kept.clear();
		for (int i = 0; i < s.nPoints; ++i)
			kept.push_back({s.rows[i].body1, s.rows[i].body2});
	}

	// An impulse that has reached the cone but for round-off, moved beyond it.
	static Rows onCone(Rows impulse)
	{
		impulse.template tail<K::rows - 1>() *= 1 + tolerance::contactProblem::onCone;
		return impulse;
	}

	ContactState<K>& s;
	std::vector<Point> points;
	std::vector<Body> bodies;
	std::vector<Velocity> step;
	std::vector<Edge> edges; // the pairs known to be near, then those of points between others
	BlockFactor<K::dof> factor;
	bool factored {false};
	std::vector<Edge> kept; // bodies of the points of the factor that the next solve may start with
	double softness {0};    // R relative to the response of the point
	double rootMerit {0};   // kg m^2/s^2: below it F is zero
};

} // namespace masonry::rigid
