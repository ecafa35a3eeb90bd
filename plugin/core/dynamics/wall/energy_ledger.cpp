#include "dynamics/wall/energy_ledger.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

template <class K>
void EnergyLedger<K>::open(const RigidSystem<K>& s, const ContactSet<K>& c, std::vector<Vector> half, double h)
{
	kinetic = s.kineticEnergy();
	baseWork = friction = 0;
	halfBack = std::move(half);
	if (list != s.lists || carrier.size() != s.bodies.size())
		findCarriers(s, c);
	carried = carriedWork(s, c, h);
}

template <class K>
void EnergyLedger<K>::findCarriers(const RigidSystem<K>& s, const ContactSet<K>& c)
{
	list = s.lists;
	carrier.assign(s.bodies.size(), -1);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed)
			carrier[b] = int(b);
	for (bool found = true; found;) {
		found = false;
		for (const ContactPair<K>& pair : s.pairs)
			for (const auto& [from, to] : {std::pair(pair.body1, pair.body2), std::pair(pair.body2, pair.body1)})
				if (carrier[from] >= 0 && carrier[to] < 0 && c.supportLevel[to] == c.supportLevel[from] + 1) {
					carrier[to] = carrier[from];
					found = true;
				}
	}
}

template <class K>
double EnergyLedger<K>::carriedWork(const RigidSystem<K>& s, const ContactSet<K>& c, double h) const
{
	constexpr int n = K::dimension;
	double sum = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const int base = carrier[b];
		if (s.bodies[b].prescribed || base < 0)
			continue;
		const int drive = s.bodies[base].drive;
		const Vector change = drive < 0 ? Vector(Vector::Zero()) : Vector(-2 * halfBack[drive]);
		const typename K::Velocity ofBase = c.inGlobal(c.velocity, base), before = c.inGlobal(c.velocity, b);
		const Vector apart = before.template head<n>() - (ofBase.template head<n>() - change);
		const Vector turned = K::cross(ofBase.template tail<K::spins>(), Vector(h * apart));
		sum -= h * s.bodies[b].force.template head<n>().dot(change + turned) / 2;
	}
	return sum;
}

template <class K>
double EnergyLedger<K>::work(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmSolver<K>& solver) const
{
	double sum = carried;
	for (const auto& [g, i] : c.onBase) {
		const Group<K>& group = c.groups[g];
		const bool first = s.bodies[group.body1[i]].prescribed;
		const int base = (first ? group.body1 : group.body2)[i];
		Lanes v[packs<K>];
		std::copy_n(&c.velocity[packs<K> * base], packs<K>, v);
		if (const int drive = s.bodies[base].drive; drive >= 0)
			for (int k = 0; k < K::dimension; ++k)
				v[0][k] += halfBack[drive][k];
		for (int k = 0; k < group.count; ++k) {
			const auto& row = solver.rows[g][k];
			Eigen::Matrix<double, K::rows, 1> impulse;
			impulse[0] = row.actedN[i];
			for (int n = 1; n < K::rows; ++n)
				impulse[n] = component(row.actedT, n - 1, i);
			for (int n = 0; n < K::rows; ++n)
				sum += (first ? impulse[n] : -impulse[n]) * rateOf(group.point[k], n, i, first ? 1 : 2, v);
		}
	}
	for (const SpinRow<K>& row : solver.spins)
		sum += row.couple * row.baseSpin(c.velocity);
	return sum;
}

template <class K>
void EnergyLedger<K>::takeContacts(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmSolver<K>& solver, double loss)
{
	friction = loss;
	baseWork = work(s, c, solver);
}

template <class K>
double EnergyLedger<K>::close(RigidSystem<K>& s, const Scales& scales, double h, double work, double onMean, double taken)
{
	double mass = 0;
	for (const auto& body : s.bodies)
		mass += body.prescribed ? 0 : body.mass;
	impacts = work + baseWork + kinetic - s.kineticEnergy() - friction;
	lag = work - onMean + carried;
	s.baseWork += baseWork;
	s.frictDissip += friction;
	s.impactDissip += impacts;
	const double atStake = std::abs(baseWork) + std::abs(work) + kinetic, liftedAll = mass * scales.acceleration * scales.length,
	             slowest = tolerance::wall::createdTravel * scales.length / h;
	const double allowed = tolerance::wall::createdShare * atStake + tolerance::wall::createdLift * liftedAll + mass * slowest * slowest;
	const double balance = impacts + taken;
	gained = std::max(0., lag - balance - friction / 2);
	return balance < -allowed ? -balance : 0;
}

template class EnergyLedger<Plane>;
template class EnergyLedger<Space>;

} // namespace masonry::wall
