#pragma once
// The problem of contact_problem.hpp while it is being solved: impulses, the velocities that they give, and how far they miss the laws.
#include "laws/contact_problem.hpp"
#include "laws/point_law.hpp"
#include <limits>

namespace masonry {

template <class K>
struct ContactState {
	using Rows = typename ContactRows<K>::Rows;
	using Velocities = Eigen::Matrix<double, K::dof, K::rows>;

	struct Response {
		OnePoint<K::rows> alone; // with the compliance of its law
		double share {1};        // of u that the point's impulse can change: less than 1 at a compliant row
		Velocities W1, W2;       // M^-1 J^T: velocities per impulse
	};

	FreeBody<K>* bodies {nullptr}; // the solver's own, as of this call
	ContactRows<K>* rows {nullptr};
	const std::vector<std::array<int, 2>>* near {nullptr};
	int nBodies {0}, nPoints {0};
	std::vector<Response> points;
	std::vector<Rows> best; // impulses
	double bestResidual {0};

	void begin(ContactSolver<K>& solver)
	{
		bodies = solver.bodies.data();
		rows = solver.points.data();
		near = &solver.near;
		nBodies = int(solver.bodies.size());
		nPoints = int(solver.points.size());
		points.resize(nPoints);
		for (int i = 0; i < nPoints; ++i) {
			const ContactRows<K>& c = rows[i];
			Response& p = points[i];
			p.alone.G.setZero();
			if (c.body1 >= 0) {
				p.W1 = response(bodies[c.body1].inverseMass, c.J1);
				p.alone.G += c.J1 * p.W1;
			}
			if (c.body2 >= 0) {
				p.W2 = response(bodies[c.body2].inverseMass, c.J2);
				p.alone.G += c.J2 * p.W2;
			}
			const double rigid = p.alone.G(0, 0);
			if (c.law.compliance > 0)
				p.alone.G(0, 0) += c.law.compliance;
			p.share = c.law.compliance > 0 ? rigid / p.alone.G(0, 0) : 1;
			p.alone.trace = p.alone.G.trace();
		}
	}

	// u, to which a compliant row adds its compliance times its impulse.
	Rows relativeVelocity(const ContactRows<K>& c) const
	{
		Rows u = c.offset;
		if (c.body1 >= 0)
			u += c.J1 * bodies[c.body1].velocity;
		if (c.body2 >= 0)
			u += c.J2 * bodies[c.body2].velocity;
		if (c.law.compliance > 0)
			u[0] += c.law.compliance * c.impulse[0];
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
		return points[i].share * masonry::residual(rows[i].law, rows[i].impulse, u, points[i].alone.trace);
	}

	double residual() const
	{
		double worst = 0;
		for (int i = 0; i < nPoints; ++i) {
			const double miss = violation(i, relativeVelocity(rows[i]));
			if (std::isnan(miss))
				return std::numeric_limits<double>::infinity();
			worst = std::max(worst, miss);
		}
		return worst;
	}

	// Impulses that miss the laws may have p.u > 0, which the laws exclude. In a step, whose u is the sum of the velocities before and
	// after, that is twice the energy that they give. Then they are scaled until it is zero: with u0 the free velocities, s p.u0 + s^2 p.Gp
	// = 0. Compliant rows store energy: they keep their impulses, and count as forces.
	void addNoEnergy()
	{
		const auto isElastic = [&](int i) { return rows[i].law.compliance > 0; };
		const auto power = [&] {
			double sum = 0;
			for (int i = 0; i < nPoints; ++i)
				if (!isElastic(i))
					sum += rows[i].impulse.dot(relativeVelocity(rows[i]));
			return sum;
		};
		const double after = power();
		for (int b = 0; b < nBodies; ++b)
			bodies[b].velocity = bodies[b].free;
		for (int i = 0; i < nPoints; ++i)
			if (isElastic(i))
				push(i, rows[i].impulse);
		const double before = power();
		if (after > 0) {
			const double scale = std::max(0., -before / (after - before));
			for (int i = 0; i < nPoints; ++i)
				if (!isElastic(i))
					rows[i].impulse *= scale;
		}
		applyImpulses();
	}

	// A point that parts may keep an impulse of the last step that is too small for its law to tell, `missed` (m/s) or less: it does not
	// press.
	void letPartingGo(double missed)
	{
		for (int i = 0; i < nPoints; ++i) {
			const double trace = points[i].alone.trace, pressing = rows[i].impulse[0] * trace;
			if (rows[i].law.kind == PointLaw::Bilateral || rows[i].law.compliance > 0 || !(pressing > 0) || pressing > missed ||
			    relativeVelocity(rows[i])[0] < pressing)
				continue;
			push(i, -rows[i].impulse);
			rows[i].impulse.setZero();
		}
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

private:
	static Velocities response(const InverseMass<K>& m, const typename ContactRows<K>::Jacobian& J)
	{
		Velocities W;
		W.template topRows<K::dimension>() = m.linear * J.template leftCols<K::dimension>().transpose();
		W.template bottomRows<K::spins>() = m.angular * J.template rightCols<K::spins>().transpose();
		return W;
	}
};

} // namespace masonry
