#include "dynamics/rigid/contact_problem.hpp"
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace masonry::rigid {

namespace {

	// P: the normal part on p_n >= 0, then the tangential part on the disc of radius mu p_n.
	template <class Rows> Rows project(const Rows& y, double friction)
	{
		if (!(y[0] > 0)) return Rows::Zero();
		Rows         p = y;
		auto         tangential = p.template tail<Rows::RowsAtCompileTime - 1>();
		const double bound = friction * y[0], square = tangential.squaredNorm();
		if (square > bound * bound) tangential *= bound / std::sqrt(square);
		return p;
	}

	// The law of one point alone, whose impulse p makes u = u0 + G p.
	template <int rows> struct OnePoint {
		using Rows = Eigen::Matrix<double, rows, 1>;
		using Block = Eigen::Matrix<double, rows, rows>;
		using Tangential = Eigen::Matrix<double, rows - 1, 1>;

		Block  G { Block::Zero() }, inverse { Block::Zero() };
		double trace { 0 };

		// Without slip a point may ask for a pull; then, as where slip finds nothing, it is held along the normal alone.
		Rows impulse(const Rows& u0, double friction) const
		{
			if (u0[0] >= 0) return Rows::Zero();
			const Rows   stick = -(inverse * u0);
			const double bound = friction * stick[0];
			if (stick[0] > 0 && stick.template tail<rows - 1>().squaredNorm() <= bound * bound) return stick;
			Rows p = Rows::Zero();
			if (friction > 0 && friction < noSlip && slip(u0, friction, stick.template tail<rows - 1>(), p)) return p;
			p << -u0[0] / G(0, 0), Tangential::Zero();
			return p;
		}

		// False: no slip that starts near the direction of `guess`.
		bool slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const;

		// p = p_n (1, mu d) with the p_n that makes u_n = 0. False: it would have to pull.
		bool slipAlong(const Tangential& d, const Rows& u0, double friction, Rows& p, Tangential& ut) const
		{
			const double stiffness = G(0, 0) + friction * G.template topRightCorner<1, rows - 1>().dot(d);
			if (!(stiffness > 0)) return false;
			p[0] = -u0[0] / stiffness;
			p.template tail<rows - 1>() = friction * p[0] * d;
			ut = u0.template tail<rows - 1>() + G.template bottomRows<rows - 1>() * p;
			return true;
		}
	};

	// Plane: two directions, that of the sticking impulse first.
	template <> bool OnePoint<2>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
	{
		Tangential ut;
		for (const double d : { std::copysign(1., guess[0]), -std::copysign(1., guess[0]) })
			if (slipAlong(Tangential(d), u0, friction, p, ut) && ut[0] * d <= 0) return true;
		return false;
	}

	// Space: Newton on the angle of d, a root of e.u_t with e = d turned by 90 degrees, where u_t looks against d.
	template <> bool OnePoint<3>::slip(const Rows& u0, double friction, const Tangential& guess, Rows& p) const
	{
		constexpr int    maxIterations = 20;
		constexpr double roundOff = 1e-15, largestTurn = 0.5;
		const double     scale = std::abs(u0[0]) + std::abs(u0[1]) + std::abs(u0[2]);
		Tangential       d = guess.normalized(), ut;
		for (int k = 0; k < maxIterations; ++k) {
			if (!slipAlong(d, u0, friction, p, ut)) return false;
			const Tangential e(-d[1], d[0]);
			const double     miss = e.dot(ut), against = -d.dot(ut);
			if (std::abs(miss) <= roundOff * scale && against >= 0) return true;
			const double     pnRate = friction * p[0] * p[0] * (G(0, 1) * e[0] + G(0, 2) * e[1]) / u0[0];
			const Tangential ptRate = friction * (pnRate * d + p[0] * e);
			const double     rate = against + e.dot(Tangential(G.block<2, 1>(1, 0) * pnRate + G.block<2, 2>(1, 1) * ptRate));
			if (rate > 0 && against >= 0)
				d = (d + std::clamp(-miss / rate, -largestTurn, largestTurn) * e).normalized();
			else
				d = -ut.normalized();
		}
		return false;
	}

} // namespace

template <class K> struct ContactSolver<K>::Workspace {
	using Rows = typename ContactRows<K>::Rows;
	using Velocity = typename K::Velocity;
	using Response = Eigen::Matrix<double, K::dof, K::rows>;

	struct Point {
		OnePoint<K::rows> alone;
		Response          W1, W2; // M^-1 J^T: velocities per impulse
	};

	FreeBody<K>*       bodies { nullptr }; // the solver's own, as of this call
	ContactRows<K>*    rows { nullptr };
	int                nBodies { 0 }, nPoints { 0 };
	std::vector<Point> points;
	std::vector<Rows>  best;
	double             bestResidual { 0 };

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
			Point&                p = points[i];
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
		if (c.body1 >= 0) u += c.J1 * bodies[c.body1].velocity;
		if (c.body2 >= 0) u += c.J2 * bodies[c.body2].velocity;
		return u;
	}

	void push(int i, const Rows& impulse)
	{
		if (rows[i].body1 >= 0) bodies[rows[i].body1].velocity += points[i].W1 * impulse;
		if (rows[i].body2 >= 0) bodies[rows[i].body2].velocity += points[i].W2 * impulse;
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
		const Rows&  p = rows[i].impulse;
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
			const Rows   u = relativeVelocity(rows[i]);
			const double miss = violation(i, u);
			worst = std::max(worst, miss);
			if (miss <= tolerance) continue;
			const OnePoint<K::rows>& alone = points[i].alone;
			const Rows               next = alone.impulse(u - alone.G * rows[i].impulse, rows[i].friction);
			push(i, next - rows[i].impulse);
			rows[i].impulse = next;
		}
		return worst;
	}

	// Sweeps until solved, or, given `patience`, until the rate of convergence tells that `limit` will not do.
	double gaussSeidel(double tolerance, int limit, bool patient, SolveReport& report)
	{
		constexpr int look = 4; // sweeps between two looks at the rate
		double        last = std::numeric_limits<double>::infinity();
		for (int k = 1;; ++k) {
			const double miss = sweep(tolerance);
			++report.sweeps;
			if (miss <= tolerance || k == limit) return miss;
			if (k % look) continue;
			if (!patient && std::log(miss / tolerance) * look > (limit - k) * std::log(last / miss)) return miss;
			last = miss;
		}
	}

	void keepBest(double residual)
	{
		if (!(residual < bestResidual)) return;
		bestResidual = residual;
		best.resize(nPoints);
		for (int i = 0; i < nPoints; ++i)
			best[i] = rows[i].impulse;
	}
};

template <class K> void ContactSolver<K>::Deleter::operator()(Workspace* w) const { delete w; }

template <class K> double ContactSolver<K>::residual()
{
	if (!workspace) workspace.reset(new Workspace);
	workspace->prepare(*this);
	return workspace->residual();
}

template <class K> SolveReport ContactSolver<K>::solve(double tolerance)
{
	if (!workspace) workspace.reset(new Workspace);
	Workspace&  w = *workspace;
	SolveReport report;
	w.prepare(*this);
	w.applyImpulses();
	report.residual = w.gaussSeidel(tolerance, lastSweeps, true, report);
	report.converged = report.residual <= tolerance;
	return report;
}

template class ContactSolver<Plane>;
template class ContactSolver<Space>;

} // namespace masonry::rigid
