#include "dynamics/wall/energy_ledger.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

template <class K>
void EnergyLedger<K>::open(const RigidSystem<K>& s, const BodyLanes<K>& bodies, const std::vector<typename K::Vector>& halfBack)
{
	kinetic = s.kineticEnergy();
	baseWork = friction = crack = forces = lifted = power = 0;
	before = bodies.velocity();
	last.swap(undriven);
	undriven.clear();
	std::vector<size_t> places;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		if (!s.bodies[b].prescribed)
			continue;
		const int drive = s.bodies[b].drive;
		for (int k = 0; k < K::dimension && drive >= 0; ++k)
			before[packs<K> * b][k] += 2 * halfBack[drive][k];
		for (int pack = 0; pack < packs<K> && drive < 0; ++pack) {
			places.push_back(packs<K> * b + pack);
			undriven.push_back(before[places.back()]);
		}
	}
	for (size_t k = 0; k < places.size() && last.size() == places.size(); ++k)
		before[places[k]] = last[k];
}

template <class K>
double EnergyLedger<K>::work(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results) const
{
	double sum = 0;
	const LaneArray& velocity = c.bodies().velocity();
	for (const auto& [g, i] : c.layout().onBase()) {
		const Group<K>& group = c.points().groups()[g];
		const bool first = s.bodies[group.body1[i]].prescribed;
		const int base = (first ? group.body1 : group.body2)[i];
		Lanes mean[packs<K>];
		for (int pack = 0; pack < packs<K>; ++pack)
			mean[pack] = (before[packs<K> * base + pack] + velocity[packs<K> * base + pack]) / 2;
		for (int k = 0; k < group.count; ++k) {
			const auto& row = results.points[g][k];
			for (int r = 0; r < K::rows; ++r) {
				const double impulse = r == 0 ? row.actedN[i] : component(row.actedT, r - 1, i);
				sum += (first ? impulse : -impulse) * rateOf(group.point[k], r, i, first ? 1 : 2, mean);
			}
		}
	}
	for (const SpinRow<K>& row : results.spins)
		sum += row.couple * row.baseSpin(velocity);
	for (const TieRow<K>& row : results.ties)
		sum -= row.impulse * (row.baseRate(before) + row.baseRate(velocity)) / 2;
	for (const MortarRow<K>& row : results.mortar)
		for (int k = 0; k < K::rows; ++k)
			sum -= row.p[k] * (row.baseBefore[k] + row.arms[k].baseRate(velocity)) / 2;
	return sum;
}

template <class K>
double EnergyLedger<K>::workOfCatches(const ContactSet<K>& c, const AdmmResults<K>& results) const
{
	double sum = 0;
	for (size_t g = 0; g < c.points().groups().size(); ++g) {
		const Group<K>& group = c.points().groups()[g];
		for (int n = 0; n < c.layout().groups()[g].count * group.count; ++n) {
			const int i = n / group.count, k = n % group.count;
			double made = 0;
			for (int r = 1; r < K::rows; ++r)
				for (const LaneArray* v : {&before, &results.velocity})
					made += component(results.points[g][k].actedT, r - 1, i) / 2 *
					        (rateOf(group.point[k], r, i, 2, &(*v)[packs<K> * group.body2[i]]) -
					         rateOf(group.point[k], r, i, 1, &(*v)[packs<K> * group.body1[i]]));
			sum += std::max(0., made);
		}
	}
	return sum;
}

template <class K>
void EnergyLedger<K>::takeContacts(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, double loss,
                                   double spent, double ofBase)
{
	friction = loss;
	crack = spent;
	baseWork = work(s, c, results) + ofBase;
	for (const TieRow<K>& row : results.ties)
		forces += row.work(before, results.velocity);
}

template <class K>
double EnergyLedger<K>::allowed(const RigidSystem<K>& s, const Scales& scales, double h, double ofBase, double ofForces) const
{
	const double mass = freeMass(s), atStake = std::abs(ofBase) + std::abs(ofForces) + kinetic,
	             lifts = mass * scales.acceleration * scales.length, slowest = tolerance::wall::createdTravel * scales.length / h;
	return tolerance::wall::createdShare * atStake + tolerance::wall::createdLift * lifts + mass * slowest * slowest;
}

template <class K>
bool EnergyLedger<K>::makesEnergy(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, const LaneArray& load,
                                  double h) const
{
	const LaneArray& after = results.velocity;
	double change = 0, ofForces = 0;
	for (size_t p = 0; p < after.size(); ++p)
		for (int k = 0; k < 3 && after[p][3] > 0; ++k) {
			const double momentum = (before[p][k] + after[p][k]) / (2 * after[p][3]);
			change += momentum * (after[p][k] - before[p][k]);
			ofForces += momentum * load[p][k];
		}
	for (const TieRow<K>& row : results.ties)
		ofForces += row.work(before, after);
	const double ofBase = work(s, c, results);
	return change - ofForces - ofBase > allowed(s, Scales(s), h, ofBase, ofForces);
}

template <class K>
double EnergyLedger<K>::close(RigidSystem<K>& s, const Scales& scales, double h, double earlier)
{
	taken = forces + baseWork + kinetic - s.kineticEnergy();
	const double impacts = taken + lifted - friction - crack;
	s.baseWork += baseWork;
	s.crackDissip += crack;
	s.frictDissip += friction;
	s.impactDissip += impacts;
	gained = std::max(0., friction + crack - taken - earlier);
	const double balance = impacts + earlier;
	return balance < -allowed(s, scales, h, baseWork, forces) ? -balance : 0;
}

template <class K>
void EnergyLedger<K>::finish(RigidSystem<K>& s, double dt)
{
	const double now = dt / 2 * power;
	s.impactDissip += shifted - (now - potentialShift);
	potentialShift = now;
	shifted = 0;
}

template class EnergyLedger<Plane>;
template class EnergyLedger<Space>;

} // namespace masonry::wall
