#include "dynamics/rigid/contact_problem.hpp"
#include "dynamics/rigid/block_factor.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid {

namespace {

// P: the normal part on p_n >= 0, then the tangential part on the disc of radius mu p_n.
template <class Rows>
Rows project(const Rows& y, double friction)
{
	if (!(y[0] > 0))
		return Rows::Zero();
	Rows p = y;
	auto tangential = p.template tail<Rows::RowsAtCompileTime - 1>();
	const double bound = friction * y[0], square = tangential.squaredNorm();
	if (square > bound * bound)
		tangential *= bound / std::sqrt(square);
	return p;
}

// Derivative of P.
template <class Rows>
auto projectionRate(const Rows& y, double friction)
{
	constexpr int tangents = Rows::RowsAtCompileTime - 1;
	Eigen::Matrix<double, tangents + 1, tangents + 1> rate;
	rate.setZero();
	if (!(y[0] > 0))
		return rate;
	rate.setIdentity();
	const double size = y.template tail<tangents>().norm();
	if (size <= friction * y[0])
		return rate;
	const Eigen::Matrix<double, tangents, 1> d = y.template tail<tangents>() / size;
	rate.template bottomLeftCorner<tangents, 1>() = friction * d;
	auto turn = rate.template bottomRightCorner<tangents, tangents>();
	turn = friction * y[0] / size * (turn - d * d.transpose()).eval();
	return rate;
}

// The law of one point alone, whose impulse p makes u = u0 + G p.
template <int rows>
struct OnePoint {
	using Rows = Eigen::Matrix<double, rows, 1>;
	using Block = Eigen::Matrix<double, rows, rows>;
	using Tangential = Eigen::Matrix<double, rows - 1, 1>;

	Block G {Block::Zero()}, inverse {Block::Zero()};
	double trace {0};

	// Without slip a point may ask for a pull; then, as where slip finds nothing, it is held along the normal alone.
	Rows impulse(const Rows& u0, double friction) const
	{
		if (u0[0] >= 0)
			return Rows::Zero();
		const Rows stick = -(inverse * u0);
		const double bound = friction * stick[0];
		if (stick[0] > 0 && stick.template tail<rows - 1>().squaredNorm() <= bound * bound)
			return stick;
		Rows p = Rows::Zero();
		if (friction > 0 && friction < noSlip && slip(u0, friction, stick.template tail<rows - 1>(), p))
			return p;
		p << -u0[0] / G(0, 0), Tangential::Zero();
		return p;
	}

	// False: no slip that starts near the direction of `guess`.
	bool slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const;

	// p = p_n (1, mu d) with the p_n that makes u_n = 0. False: it would have to pull.
	bool slipAlong(const Tangential& d, const Rows& u0, double friction, Rows& p, Tangential& ut) const
	{
		const double stiffness = G(0, 0) + friction * G.template topRightCorner<1, rows - 1>().dot(d);
		if (!(stiffness > 0))
			return false;
		p[0] = -u0[0] / stiffness;
		p.template tail<rows - 1>() = friction * p[0] * d;
		ut = u0.template tail<rows - 1>() + G.template bottomRows<rows - 1>() * p;
		return true;
	}
};

// Plane: two directions, that of the sticking impulse first.
template <>
bool OnePoint<2>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
{
	Tangential ut;
	for (const double d : {std::copysign(1., guess[0]), -std::copysign(1., guess[0])})
		if (slipAlong(Tangential(d), u0, friction, p, ut) && ut[0] * d <= 0)
			return true;
	return false;
}

// Space: Newton on the angle of d, a root of e.u_t with e = d turned by 90 degrees, where u_t looks against d.
template <>
bool OnePoint<3>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
{
	constexpr int maxIterations = 20;
	constexpr double roundOff = 1e-15, largestTurn = 0.5;
	const double scale = std::abs(u0[0]) + std::abs(u0[1]) + std::abs(u0[2]);
	Tangential d = guess.normalized(), ut;
	for (int k = 0; k < maxIterations; ++k) {
		if (!slipAlong(d, u0, friction, p, ut))
			return false;
		const Tangential e(-d[1], d[0]);
		const double miss = e.dot(ut), against = -d.dot(ut);
		if (std::abs(miss) <= roundOff * scale && against >= 0)
			return true;
		const double pnRate = friction * p[0] * p[0] * (G(0, 1) * e[0] + G(0, 2) * e[1]) / u0[0];
		const Tangential ptRate = friction * (pnRate * d + p[0] * e);
		const double rate = against + e.dot(Tangential(G.block<2, 1>(1, 0) * pnRate + G.block<2, 2>(1, 1) * ptRate));
		if (rate > 0 && against >= 0)
			d = (d + std::clamp(-miss / rate, -largestTurn, largestTurn) * e).normalized();
		else
			d = -ut.normalized();
	}
	return false;
}

} // namespace

template <class K>
struct ContactSolver<K>::Workspace {
	using Rows = typename ContactRows<K>::Rows;
	using Velocity = typename K::Velocity;
	using Response = Eigen::Matrix<double, K::dof, K::rows>;

	using Block = typename OnePoint<K::rows>::Block;
	using Mass = Eigen::Matrix<double, K::dof, K::dof>;

	struct Point {
		OnePoint<K::rows> alone;
		Response W1, W2; // M^-1 J^T: velocities per impulse
		// Newton: u at the centre, P(y), its derivative, and the derivative that is in the factor
		Rows centre, next;
		Block rate {Block::Zero()}, factored {Block::Zero()};
	};

	struct NewtonBody {
		Mass mass;
		Velocity w, start, force; // w: velocity minus that of the centre, and before the line search; force: F
	};

	FreeBody<K>* bodies {nullptr}; // the solver's own, as of this call
	ContactRows<K>* rows {nullptr};
	int nBodies {0}, nPoints {0};
	std::vector<Point> points;
	std::vector<Rows> best;
	double bestResidual {0};

	std::vector<NewtonBody> newtonBodies;
	std::vector<Velocity> step;
	std::vector<typename BlockFactor<K::dof>::Edge> edges; // points between two free bodies, in order
	BlockFactor<K::dof> factor;
	bool factored {false};
	std::vector<typename BlockFactor<K::dof>::Edge> kept; // bodies of the points of the factor that the next solve may start with
	double softness {0};   // R relative to the response of the point
	double rootMerit {0};  // kg m^2/s^2: below it F is zero

	static Response response(const InverseMass<K>& m, const typename ContactRows<K>::Jacobian& J)
	{
		Response W;
		W.template topRows<K::dimension>() = m.linear * J.template leftCols<K::dimension>().transpose();
		W.template bottomRows<K::spins>() = m.angular * J.template rightCols<K::spins>().transpose();
		return W;
	}

	void prepare(ContactSolver& solver)
	{
		bodies = solver.bodies.data();
		rows = solver.points.data();
		nBodies = int(solver.bodies.size());
		nPoints = int(solver.points.size());
		points.resize(nPoints);
		for (int i = 0; i < nPoints; ++i) {
			const ContactRows<K>& c = rows[i];
			Point& p = points[i];
			p.alone.G.setZero();
			if (c.body1 >= 0) {
				p.W1 = response(bodies[c.body1].inverseMass, c.J1);
				p.alone.G += c.J1 * p.W1;
			}
			if (c.body2 >= 0) {
				p.W2 = response(bodies[c.body2].inverseMass, c.J2);
				p.alone.G += c.J2 * p.W2;
			}
			p.alone.trace = p.alone.G.trace();
			p.alone.inverse = p.alone.G.inverse();
		}
	}

	Rows relativeVelocity(const ContactRows<K>& c) const
	{
		Rows u = c.offset;
		if (c.body1 >= 0)
			u += c.J1 * bodies[c.body1].velocity;
		if (c.body2 >= 0)
			u += c.J2 * bodies[c.body2].velocity;
		return u;
	}

	void push(int i, const Rows& impulse)
	{
		if (rows[i].body1 >= 0)
			bodies[rows[i].body1].velocity += points[i].W1 * impulse;
		if (rows[i].body2 >= 0)
			bodies[rows[i].body2].velocity += points[i].W2 * impulse;
	}

	// The velocities that the impulses give by the momentum equation.
	void applyImpulses()
	{
		for (int b = 0; b < nBodies; ++b)
			bodies[b].velocity = bodies[b].free;
		for (int i = 0; i < nPoints; ++i)
			push(i, rows[i].impulse);
	}

	double violation(int i, const Rows& u) const
	{
		const Rows& p = rows[i].impulse;
		const double trace = points[i].alone.trace;
		return (p - project<Rows>(p - u / trace, rows[i].friction)).norm() * trace;
	}

	double residual() const
	{
		double worst = 0;
		for (int i = 0; i < nPoints; ++i)
			worst = std::max(worst, violation(i, relativeVelocity(rows[i])));
		return worst;
	}

	// One pass over the points. A point that obeys its law is left alone, so that a pass that returns `tolerance` or less has
	// changed nothing, and what it returns is the residual.
	double sweep(double tolerance)
	{
		double worst = 0;
		for (int i = 0; i < nPoints; ++i) {
			const Rows u = relativeVelocity(rows[i]);
			const double miss = violation(i, u);
			worst = std::max(worst, miss);
			if (miss <= tolerance)
				continue;
			const OnePoint<K::rows>& alone = points[i].alone;
			const Rows next = alone.impulse(u - alone.G * rows[i].impulse, rows[i].friction);
			push(i, next - rows[i].impulse);
			rows[i].impulse = next;
		}
		return worst;
	}

	// A point alone needs no sweeps.
	double solveAlone()
	{
		for (int b = 0; b < nBodies; ++b)
			bodies[b].velocity = bodies[b].free;
		ContactRows<K>& row = rows[0];
		row.impulse = points[0].alone.impulse(relativeVelocity(row), row.friction);
		push(0, row.impulse);
		return violation(0, relativeVelocity(row));
	}

	// Sweeps until solved, up to `limit`; impatient: or until the rate of convergence tells that `limit` will not do.
	double gaussSeidel(double tolerance, int limit, bool patient, SolveReport& report)
	{
		constexpr int look = 4; // sweeps between two looks at the rate
		double last = std::numeric_limits<double>::infinity();
		for (int k = 1;; ++k) {
			const double miss = sweep(tolerance);
			++report.sweeps;
			if (miss <= tolerance || k == limit)
				return miss;
			if (k % look)
				continue;
			if (!patient && std::log(miss / tolerance) * look > (limit - k) * std::log(last / miss))
				return miss;
			last = miss;
		}
	}

	// Newton. With the impulses l of the rows as centre and V their velocities, w is the root of
	//
	//     F(w) = M w - J^T (P(y) - l),  y = l - (u + J w)/R
	//
	// Only increments enter, so that round-off does not grow with 1/R; and P(y) is the next centre.

	double compliance(int i) const { return softness * points[i].alone.trace; } // R

	void prepareNewton(double tolerance)
	{
		constexpr double share = 0.1; // of the merit that lets the lightest body miss its velocity by the tolerance
		newtonBodies.resize(nBodies);
		step.resize(nBodies);
		double lightest = std::numeric_limits<double>::infinity();
		for (int b = 0; b < nBodies; ++b) {
			lightest = std::min(lightest, 1 / bodies[b].inverseMass.linear);
			Mass& mass = newtonBodies[b].mass;
			mass.setZero();
			mass.diagonal().template head<K::dimension>().setConstant(1 / bodies[b].inverseMass.linear);
			mass.template bottomRightCorner<K::spins, K::spins>() = bodies[b].inverseMass.angular.inverse();
		}
		rootMerit = share * lightest * tolerance * tolerance;
		edges.clear();
		for (int i = 0; i < nPoints; ++i)
			if (rows[i].body1 >= 0 && rows[i].body2 >= 0)
				edges.push_back({rows[i].body1, rows[i].body2});
		factor.setGraph(nBodies, edges);
		factored = false;
		kept.clear();
	}

	// Sets F, P(y) and its derivative; returns F^T M^-1 F.
	double evaluate()
	{
		for (int b = 0; b < nBodies; ++b)
			newtonBodies[b].force = newtonBodies[b].mass * newtonBodies[b].w;
		for (int i = 0; i < nPoints; ++i) {
			const ContactRows<K>& c = rows[i];
			Point& p = points[i];
			Rows u = p.centre;
			if (c.body1 >= 0)
				u += c.J1 * newtonBodies[c.body1].w;
			if (c.body2 >= 0)
				u += c.J2 * newtonBodies[c.body2].w;
			const Rows y = c.impulse - u / compliance(i);
			p.next = project(y, c.friction);
			p.rate = projectionRate(y, c.friction);
			const Rows change = p.next - c.impulse;
			if (c.body1 >= 0)
				newtonBodies[c.body1].force -= c.J1.transpose() * change;
			if (c.body2 >= 0)
				newtonBodies[c.body2].force -= c.J2.transpose() * change;
		}
		double merit = 0;
		for (int b = 0; b < nBodies; ++b)
			merit += newtonBodies[b].force.dot(bodies[b].inverseMass * newtonBodies[b].force);
		return merit;
	}

	bool factorIsPresent() const
	{
		return factored && std::all_of(points.begin(), points.begin() + nPoints, [](const Point& p) { return p.rate == p.factored; });
	}

	// M + J^T P' J / R
	void factorise(SolveReport& report)
	{
		factor.setZero();
		for (int b = 0; b < nBodies; ++b)
			factor.diagonal(b) = newtonBodies[b].mass;
		int edge = 0;
		for (int i = 0; i < nPoints; ++i) {
			const ContactRows<K>& c = rows[i];
			points[i].factored = points[i].rate;
			const int e = c.body1 >= 0 && c.body2 >= 0 ? edge++ : -1;
			if (points[i].rate.isZero(0))
				continue;
			const Block stiffness = points[i].rate / compliance(i);
			const typename ContactRows<K>::Jacobian K1 = stiffness.lazyProduct(c.J1), K2 = stiffness.lazyProduct(c.J2);
			if (c.body1 >= 0)
				factor.diagonal(c.body1).noalias() += c.J1.transpose().lazyProduct(K1);
			if (c.body2 >= 0)
				factor.diagonal(c.body2).noalias() += c.J2.transpose().lazyProduct(K2);
			if (e < 0)
				continue;
			factor.firstSecond(e).noalias() += c.J1.transpose().lazyProduct(K2);
			factor.secondFirst(e).noalias() += c.J2.transpose().lazyProduct(K1);
		}
		factor.factorise();
		factored = true;
		++report.factorisations;
	}

	// One Newton step, shortened until the merit falls. False: it does not.
	bool newtonStep(double& merit, bool& full)
	{
		constexpr double decrease = 1e-4, shortest = 0.01;
		for (int b = 0; b < nBodies; ++b) {
			step[b] = newtonBodies[b].force;
			newtonBodies[b].start = newtonBodies[b].w;
		}
		factor.solve(step);
		for (double t = 1; t >= shortest; t /= 2) {
			for (int b = 0; b < nBodies; ++b)
				newtonBodies[b].w = newtonBodies[b].start - t * step[b];
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
		for (int i = 0; i < nPoints; ++i) {
			const ContactRows<K>& c = rows[i];
			const Rows change = points[i].factored * (c.impulse - points[i].centre / compliance(i)) - c.impulse;
			if (c.body1 >= 0)
				step[c.body1] += c.J1.transpose() * change;
			if (c.body2 >= 0)
				step[c.body2] += c.J2.transpose() * change;
		}
		factor.solve(step);
		for (int b = 0; b < nBodies; ++b)
			newtonBodies[b].w = step[b];
	}

	// Root of F for the present centre. False: stopped short of it.
	bool findRoot(bool statesKnown, int maxSteps, SolveReport& report)
	{
		constexpr double reduction = 1e-8; // of the merit
		for (int i = 0; i < nPoints; ++i)
			points[i].centre = relativeVelocity(rows[i]);
		if (statesKnown) {
			predict(report);
		} else {
			for (NewtonBody& body : newtonBodies)
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
			if (!newtonStep(merit, full))
				return false;
			if (merit <= enough || (full && factorIsPresent()))
				return true;
		}
		return false;
	}

	bool factorIsKept() const
	{
		return int(kept.size()) == nPoints && nBodies == int(newtonBodies.size())
		    && std::equal(kept.begin(), kept.end(), rows, [](const auto& k, const ContactRows<K>& c) { return k[0] == c.body1 && k[1] == c.body2; });
	}

	void keepFactor()
	{
		kept.clear();
		for (int i = 0; i < nPoints; ++i)
			kept.push_back({rows[i].body1, rows[i].body2});
	}

	// Newton with a small R at once, for impulses that are close to the solution: from the states in the kept factor, else from
	// those of the impulses. That factor is of another problem with the same points; as only increments enter, this slows
	// convergence but does not move the solution. False: too far.
	bool resume(double tolerance, SolveReport& report)
	{
		constexpr int maxCentres = 6, maxSteps = 10;
		constexpr double slow = 0.1; // ratio of residuals from centre to centre that calls for a new factor
		const bool known = factorIsKept();
		prepareNewton(tolerance);
		factored = known;
		softness = tolerance::contactProblem::resumedSoftness;
		if (!factored) {
			for (int i = 0; i < nPoints; ++i)
				points[i].rate = projectionRate<Rows>(onCone(rows[i].impulse), rows[i].friction);
		}
		for (int k = 0; k < maxCentres; ++k) {
			if (!findRoot(true, maxSteps, report))
				return false;
			for (int i = 0; i < nPoints; ++i)
				rows[i].impulse = points[i].next;
			applyImpulses();
			const double present = report.residual;
			report.residual = residual();
			if (report.residual <= tolerance) {
				keepFactor();
				return true;
			}
			if (report.residual > slow * present)
				factored = false;
		}
		return false;
	}

	// An impulse that has reached the cone but for round-off, moved beyond it.
	static Rows onCone(Rows impulse)
	{
		impulse.template tail<K::rows - 1>() *= 1 + tolerance::contactProblem::onCone;
		return impulse;
	}

	// Whether the impulses given meet the laws, or lead to those that do.
	bool startsClose(double tolerance, SolveReport& report)
	{
		report.residual = residual();
		if (report.residual <= tolerance)
			return true;
		bestResidual = std::numeric_limits<double>::infinity();
		keepBest(report.residual);
		if (resume(tolerance, report))
			return true;
		restoreBest();
		return false;
	}

	// Centre after centre. R falls while roots are found, so that the centres converge faster than linearly, and grows where
	// one is not.
	double newton(double target, SolveReport& report)
	{
		constexpr int maxCentres = 40, maxSteps = 30;
		constexpr double fall = 1e-2, growth = 10, most = 1; // of the softness
		prepareNewton(target);
		softness = tolerance::contactProblem::softness;
		double present = residual();
		bool found = false;
		for (int k = 0; k < maxCentres && softness <= most; ++k) {
			found = findRoot(found, maxSteps, report);
			for (int i = 0; i < nPoints; ++i)
				std::swap(rows[i].impulse, points[i].next);
			applyImpulses();
			const double next = residual();
			keepBest(next);
			if (next <= target)
				return next;
			if (!found && next > present) {
				for (int i = 0; i < nPoints; ++i)
					rows[i].impulse = points[i].next;
				applyImpulses();
			} else {
				present = next;
			}
			softness = found ? std::max(tolerance::contactProblem::leastSoftness, fall * softness) : growth * softness;
			factored = false;
		}
		return present;
	}

	// Newton, and where that stops sweeps from the best iterate to start anew from.
	double alternate(double tolerance, int lastSweeps, SolveReport& report)
	{
		constexpr int rounds = 8, shares = 36; // 1 + 2 + .. + 8: each round sweeps longer, all together lastSweeps
		bestResidual = std::numeric_limits<double>::infinity();
		for (int round = 1; round <= rounds; ++round) {
			applyImpulses();
			keepBest(residual());
			if (newton(tolerance, report) <= tolerance)
				return bestResidual;
			restoreBest();
			if (gaussSeidel(tolerance, lastSweeps * round / shares, true, report) <= tolerance)
				return residual();
		}
		applyImpulses();
		keepBest(residual());
		restoreBest();
		return bestResidual;
	}

	// Impulses that miss the laws may do work. If those of the rows do, they are scaled to the least energy: with p.u0 their
	// power on the free velocities (seen from the offsets) and p.Gp = p.(u - u0), the energy is s p.u0 + s^2 p.Gp / 2.
	void addNoEnergy()
	{
		const auto power = [&] {
			double sum = 0;
			for (int i = 0; i < nPoints; ++i)
				sum += rows[i].impulse.dot(relativeVelocity(rows[i]));
			return sum;
		};
		const double after = power();
		for (int b = 0; b < nBodies; ++b)
			bodies[b].velocity = bodies[b].free;
		const double before = power();
		if (before + after > 0) {
			const double scale = std::max(0., -before / (after - before));
			for (int i = 0; i < nPoints; ++i)
				rows[i].impulse *= scale;
		}
		applyImpulses();
	}

	void restoreBest()
	{
		for (int i = 0; i < nPoints; ++i)
			rows[i].impulse = best[i];
		applyImpulses();
	}

	void keepBest(double residual)
	{
		if (!(residual < bestResidual))
			return;
		bestResidual = residual;
		best.resize(nPoints);
		for (int i = 0; i < nPoints; ++i)
			best[i] = rows[i].impulse;
	}
};

template <class K>
void ContactSolver<K>::Deleter::operator()(Workspace* w) const
{
	delete w;
}

template <class K>
void ContactSolver<K>::forget()
{
	if (workspace)
		workspace->kept.clear();
}

template <class K>
double ContactSolver<K>::residual()
{
	if (!workspace)
		workspace.reset(new Workspace);
	workspace->prepare(*this);
	return workspace->residual();
}

template <class K>
SolveReport ContactSolver<K>::solve(double tolerance)
{
	if (!workspace)
		workspace.reset(new Workspace);
	Workspace& w = *workspace;
	SolveReport report;
	w.prepare(*this);
	if (w.nPoints == 1) {
		report.residual = w.solveAlone();
		if (report.residual <= tolerance)
			return report;
	}
	w.applyImpulses();
	constexpr int fewSweeps = 4;
	if (K::dimension == 2 && w.nPoints <= K::maxPoints) { // a block on its face: dearer to factorise than to sweep
		report.residual = w.gaussSeidel(tolerance, fewSweeps, true, report);
		if (report.residual <= tolerance)
			return report;
	}
	if (useNewton && w.startsClose(tolerance, report))
		return report;
	report.residual = w.gaussSeidel(tolerance, useNewton ? maxSweeps : lastSweeps, !useNewton, report);
	if (useNewton && report.residual > tolerance)
		report.residual = w.alternate(tolerance, lastSweeps, report);
	report.converged = report.residual <= tolerance;
	if (!report.converged) {
		w.addNoEnergy();
		report.residual = w.residual();
	}
	return report;
}

template class ContactSolver<Plane>;
template class ContactSolver<Space>;

} // namespace masonry::rigid
