#pragma once
// One root of the proximal semi-smooth Newton method of contact_problem.hpp. With the impulses l of the rows as centre and V their
// velocities, w is the root of
//
//     F(w) = M w - J^T (P(y) - l),  y = l - (u + J w)/R
//
// Only increments enter, so that round-off does not grow with 1/R; and P(y) is the next centre. While a solution is sought a point may have
// another law than its own, and a least normal impulse b: then P(y) = P(y - b n) + b n. A row with a compliance c has R + c in the place of
// R, since its u grows by c (P(y) - l).
#include "laws/contact_state.hpp"
#include "linalg/block_lu.hpp"
#include "tolerances.hpp"

namespace masonry {

template <class K>
class ContactRoot {
protected:
	using Rows = typename ContactRows<K>::Rows;
	using Block = typename OnePoint<K::rows>::Block;
	using Velocity = typename K::Velocity;
	using Edge = typename linalg::BlockLU<K::dof>::Edge;

public:
	explicit ContactRoot(ContactState<K>& state) : s(state) {}

	void forget() { kept.clear(); }

	// Every point has its own law, and no state.
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
			points[i].law = s.rows[i].law;
			points[i].least = 0;
			points[i].next = s.rows[i].impulse;
		}
		factor.setGraph(s.nBodies, edges);
		factored = false;
		kept.clear();
	}

	const PointLaw& law(int i) const { return points[i].law; }
	double least(int i) const { return points[i].least; }
	bool parts(int i) const { return s.rows[i].impulse[0] - velocityAt(i)[0] / compliance(i) <= 0; } // but for the least impulse
	const Rows& next(int i) const { return points[i].next; }                                         // P(y) at the root
	Rows velocityAt(int i) const                                                                     // u at the root
	{
		const ContactRows<K>& c = s.rows[i];
		Rows u = points[i].centre;
		if (c.body1 >= 0)
			u += c.J1 * bodies[c.body1].w;
		if (c.body2 >= 0)
			u += c.J2 * bodies[c.body2].w;
		return u;
	}
	// From the next root on. The point keeps its impulse as far as the law lets it.
	void setLaw(int i, const PointLaw& law, double least)
	{
		Point& p = points[i];
		p.law = law;
		p.least = least;
		p.next = p.lawAt(p.next);
		p.rate = p.rateAt(p.next);
	}

	// The root for a small R, with the impulses given as the centre. R falls, as far at once as Newton can follow: where the laws leave
	// forces open, those nearest to the centre are found, and not those that a path through other states ends at. `statesKnown`: the
	// states are probably those of the last root.
	bool descend(bool statesKnown, SolveReport& report)
	{
		constexpr int maxSteps = 30, maxTries = 40;
		constexpr double steepest = 1e-7, flattest = 0.7; // of the softness
		constexpr double least = tolerance::contactProblem::resumedSoftness;
		factored = false;
		softness = least;
		if (statesKnown && findRoot(true, maxSteps, report))
			return true;
		softness = tolerance::contactProblem::softness;
		if (!findRoot(false, maxSteps, report))
			return false;
		double fall = steepest, from = softness;
		for (int k = 0; k < maxTries && fall < flattest; ++k) {
			for (Body& body : bodies)
				body.root = body.w;
			softness = std::max(least, fall * from);
			factored = false;
			if (findRoot(true, maxSteps, report)) {
				if (softness == least)
					return true;
				from = softness;
				continue;
			}
			fall = std::sqrt(fall);
			softness = from;
			for (Body& body : bodies)
				body.w = body.root;
			evaluate();
		}
		return false;
	}

	// The next centre, and its root for the same R.
	bool moveCentre(SolveReport& report)
	{
		constexpr int maxSteps = 10;
		takeNext();
		factored = factorIsPresent();
		return findRoot(true, maxSteps, report);
	}

	void takeNext()
	{
		for (int i = 0; i < s.nPoints; ++i)
			s.rows[i].impulse = points[i].next;
		s.applyImpulses();
	}

protected:
	struct Point {
		Rows centre, next, move;                              // u at the centre, P(y), last change of the centre
		Block rate {Block::Zero()}, factored {Block::Zero()}; // derivative of P(y), and the one that is in the factor
		PointLaw law;                                         // for the time being
		double least;                                         // normal impulse, N s
		int edge;                                             // between its bodies; -1: one of them is prescribed

		Rows lawAt(const Rows& y) const { return project<Rows>(law, y - bound()) + bound(); }
		Block rateAt(const Rows& y) const { return projectionRate<Rows>(law, y - bound()); }
		Rows bound() const { return least * Rows::Unit(0); }
	};

	struct Body {
		Eigen::Matrix<double, K::dof, K::dof> mass;
		Velocity w, root, start, force; // w: velocity minus that of the centre, at the last root and before the line search; force: F
	};

	double compliance(int i) const
	{
		return softness * s.points[i].alone.trace + s.rows[i].law.compliance;
	} // R, and what the row has itself

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
			const Rows y = c.impulse - velocityAt(i) / compliance(i);
			p.next = p.lawAt(y);
			p.rate = p.rateAt(y);
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

	// The root if every point were in its state in the factor: P(y) = P'(y) y since P is homogeneous, but for the bound.
	void predict(SolveReport& report)
	{
		if (!factored)
			factorise(report);
		for (Velocity& right : step)
			right.setZero();
		for (int i = 0; i < s.nPoints; ++i) {
			const ContactRows<K>& c = s.rows[i];
			const Point& p = points[i];
			const Rows y = c.impulse - p.centre / compliance(i), change = p.factored * (y - p.bound()) + p.bound() - c.impulse;
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

	ContactState<K>& s;
	std::vector<Point> points;
	std::vector<Body> bodies;
	std::vector<Velocity> step;
	std::vector<Edge> edges; // the pairs known to be near, then those of points between others
	linalg::BlockLU<K::dof> factor;
	bool factored {false};
	std::vector<Edge> kept; // bodies of the points of the factor that the next solve may start with
	double softness {0};    // R relative to the response of the point
	double rootMerit {0};   // kg m^2/s^2: below it F is zero
};

} // namespace masonry
