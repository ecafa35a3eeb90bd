#include "dynamics/wall/few_blocks.hpp"

namespace masonry::wall {

namespace {

template <class K>
typename K::Velocity velocityOf(const LaneArray& from, size_t body)
{
	typename K::Velocity v;
	for (int k = 0; k < K::dof; ++k)
		v[k] = from[packs<K> * body + k / 3][k % 3];
	return v;
}

} // namespace

// visit(g, i, k): group, lane and point, of all that are in reach.
template <class K>
template <class Visit>
void FewBlocks<K>::eachPoint(const AdmmProblem<K>& problem, const AdmmResults<K>& results, const Visit& visit) const
{
	const ContactSet<K>& c = problem.contacts;
	for (size_t g = 0; g < c.points().groups().size(); ++g)
		for (int i = 0; i < c.layout().groups()[g].count; ++i)
			for (int k = 0; k < c.points().groups()[g].count; ++k)
				if (results.points[g][k].inReach[i])
					visit(g, i, k);
}

template <class K>
void FewBlocks<K>::refine(const AdmmProblem<K>& problem, const AdmmSettings& settings, AdmmResults<K>& results, SolverStatus& status)
{
	const StepContext& step = problem.step;
	const BodyLanes<K>& bodies = problem.contacts.bodies();
	const double tolerance = settings.fewTolerance * step.speed;
	int blocks = 0;
	for (size_t b = 0; b < bodies.size(); ++b)
		blocks += bodies.isFree(b);
	if (blocks > settings.few || step.stands || !(status.residual > (step.instant ? settings.instantTolerance * step.speed : tolerance)))
		return;
	if (!problem.ties.empty() || !problem.mortar.empty() || firstOf(problem.strength))
		return;
	pose(problem, results);
	for (const SpinRow<K>& spin : results.spins)
		if (!poseSpin(problem, spin))
			return;
	solver.forget();
	const SolveReport report = solver.solve(tolerance);
	if (!report.converged)
		return;
	take(problem, report.residual, results);
	status.residual = report.residual;
}

// In packs a body has one mass for all components.
template <class K>
void FewBlocks<K>::pose(const AdmmProblem<K>& problem, const AdmmResults<K>& results)
{
	const BodyLanes<K>& bodies = problem.contacts.bodies();
	unknown.assign(bodies.size(), -1);
	solver.bodies.clear();
	for (size_t b = 0; b < bodies.size(); ++b)
		if (bodies.isFree(b)) {
			unknown[b] = int(solver.bodies.size());
			FreeBody<K> body;
			body.inverseMass.linear = bodies.perMass(b);
			body.inverseMass.angular = bodies.perMass(b) * K::InverseInertia::Identity();
			body.free = velocityOf<K>(bodies.velocity(), b) + velocityOf<K>(problem.load, b);
			solver.bodies.push_back(body);
		}
	solver.points.clear();
	eachPoint(problem, results, [&](size_t g, int i, int k) {
		const Group<K>& group = problem.contacts.points().groups()[g];
		const PointLanes<K>& at = group.point[k];
		const PointState<K>& state = results.states[g][k];
		const PointResult<K>& row = results.points[g][k];
		ContactRows<K> point;
		point.body1 = unknown[group.body1[i]];
		point.body2 = unknown[group.body2[i]];
		point.law = group.friction[i] < maxFriction ? group.friction[i] : noSlip;
		point.most = group.most[i] < farAway ? group.most[i] : unlimited;
		for (int r = 0; r < K::rows; ++r) {
			for (int d = 0; d < K::dof; ++d) {
				point.J1(r, d) = -partOf(at, r, i, 1, d / 3)[d % 3];
				point.J2(r, d) = partOf(at, r, i, 2, d / 3)[d % 3];
			}
			point.impulse[r] = r == 0 ? state.pn[i] : component(state.pt, r - 1, i);
			point.offset[r] = r == 0 ? row.bn[i] : component(row.bt, r - 1, i);
		}
		if (point.body1 < 0)
			point.offset += point.J1 * velocityOf<K>(bodies.velocity(), group.body1[i]);
		if (point.body2 < 0)
			point.offset += point.J2 * velocityOf<K>(bodies.velocity(), group.body2[i]);
		solver.points.push_back(point);
	});
}

// A prescribed spin is a row that pulls as well as pushes: its couple is a force with the smallest half size as its arm. False: it joins
// more than two blocks.
template <class K>
bool FewBlocks<K>::poseSpin(const AdmmProblem<K>& problem, const SpinRow<K>& spin)
{
	const BodyLanes<K>& bodies = problem.contacts.bodies();
	const double arm = problem.step.length;
	ContactRows<K> row;
	row.law = PointLaw::Bilateral;
	row.J1.setZero();
	row.J2.setZero();
	row.impulse[0] = spin.couple / arm;
	row.offset[0] = -arm * spin.target;
	for (const auto& part : spin.parts) {
		typename K::Velocity along;
		for (int d = 0; d < K::dof; ++d)
			along[d] = arm * part.arm[d / 3][d % 3];
		const int number = unknown[part.body];
		if (number < 0) {
			row.offset[0] += along.dot(velocityOf<K>(bodies.velocity(), part.body));
			continue;
		}
		int& first = row.body1 < 0 || row.body1 == number ? row.body1 : row.body2;
		if (first >= 0 && first != number)
			return false;
		first = number;
		(&first == &row.body1 ? row.J1 : row.J2).row(0) += along.transpose();
	}
	solver.points.push_back(row);
	return true;
}

template <class K>
void FewBlocks<K>::take(const AdmmProblem<K>& problem, double residual, AdmmResults<K>& results) const
{
	for (size_t b = 0; b < unknown.size(); ++b)
		for (int d = 0; d < K::dof && unknown[b] >= 0; ++d)
			results.velocity[packs<K> * b + d / 3][d % 3] = solver.bodies[unknown[b]].velocity[d];
	size_t number = 0;
	eachPoint(problem, results, [&](size_t g, int i, int k) {
		PointState<K>& state = results.states[g][k];
		PointResult<K>& row = results.points[g][k];
		const auto& impulse = solver.points[number++].impulse;
		state.pn[i] = row.actedN[i] = row.bound[i] = impulse[0];
		for (int r = 1; r < K::rows; ++r) {
			setComponent(state.pt, r - 1, i, impulse[r]);
			setComponent(row.actedT, r - 1, i, impulse[r]);
		}
	});
	for (SpinRow<K>& spin : results.spins)
		spin.couple = problem.step.length * solver.points[number++].impulse[0];
	constexpr double onRim = 1 - 1e-14, slipping = 10; // of the bound; of the residual
	for (size_t g = 0; g < results.points.size(); ++g) {
		const Group<K>& group = problem.contacts.points().groups()[g];
		const Bodies<K> v1(results.velocity.data(), group.body1), v2(results.velocity.data(), group.body2);
		for (int k = 0; k < group.count; ++k) {
			PointState<K>& state = results.states[g][k];
			PointResult<K>& row = results.points[g][k];
			row.un = normalRate(v1, v2, group.point[k]);
			row.ut = slipRate(v1, v2, group.point[k]);
			state.zn = larger(row.un + row.bn, all(0));
			state.zt = row.ut + row.bt;
			// What slides is on the rim of its cone, whatever the round-off.
			const Mask slips = row.inReach & (length(state.zt) > slipping * residual) & (group.friction > 0);
			row.bound = slips ? onRim * length(state.pt) / group.friction : row.bound;
		}
	}
}

template class FewBlocks<Plane>;
template class FewBlocks<Space>;

} // namespace masonry::wall
