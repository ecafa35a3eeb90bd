#include "dynamics/wall/crack_limits.hpp"
#include "dynamics/wall/mortar_rows.hpp"
#include <cmath>

namespace masonry::wall {

template <class K>
std::vector<int> Mortar<K>::strained(const RigidSystem<K>& s, const ContactSet<K>& c, const PointStates<K>& states,
                                     const LaneArray& after) const
{
	std::vector<int> result;
	for (int j = 0; j < int(s.mortar.size()); ++j) {
		const MortarJoint<K>& joint = s.mortar[j];
		if (!joint.isRigid)
			continue;
		double opened = 0, sheared = 0; // J
		for (const auto& [number, slot, k, share] : corners[j]) {
			const auto [g, i] = slot;
			const auto mean = [&, lane = slot.lane](int row) {
				const PointLanes<K>& at = c.points().groups()[slot.group].point[k];
				const auto rate = [&](const LaneArray& v) {
					return rateOf(at, row, lane, 2, &v[packs<K> * joint.body2]) - rateOf(at, row, lane, 1, &v[packs<K> * joint.body1]);
				};
				return (rate(c.bodies().velocity()) + rate(after)) / 2;
			};
			opened -= states[g][k].pn[i] * std::max(0., mean(0));
			for (int row = 1; row < K::rows; ++row)
				sheared += std::abs(component(states[g][k].pt, row - 1, i) * mean(row));
		}
		const double damage = std::max(0., opened) / joint.law.fractureEnergy + sheared / joint.law.shearFractureEnergy;
		if (damage * joint.points.size() > crack::counts * joint.area) // one point may take it all
			result.push_back(j);
	}
	return result;
}

template <class K>
MortarWork Mortar<K>::finishInstant(RigidSystem<K>& s, const PointStates<K>& states, const std::vector<MortarRow<K>>& done,
                                    double missed) const
{
	MortarWork work;
	for (const MortarRow<K>& row : done) {
		MortarJoint<K>& joint = s.mortar[row.joint];
		CohesivePoint<K>& point = joint.points[row.point];
		const bool slips = row.slip(1) > crack::clear * missed;
		const double pull = row.opening(1) > crack::clear * missed ? pullOf(s, states, row, missed) : 0;
		const double byOpening = pull * row.opening(1) / (point.area * joint.law.fractureEnergy),
		             bySlip = slips ? row.shearWork() / (point.area * joint.law.shearFractureEnergy) : 0;
		if (point.state.spent == 0 && byOpening + bySlip < crack::counts)
			continue;
		work.crack += point.area * addDamage(joint.law, point.state, byOpening, bySlip);
		work.friction += slips ? row.frictionWork() : 0;
		work.base += row.jumpWork(pull, slips);
	}
	return work;
}

template std::vector<int> Mortar<Plane>::strained(const RigidSystem<Plane>&, const ContactSet<Plane>&, const PointStates<Plane>&,
                                                  const LaneArray&) const;
template MortarWork Mortar<Plane>::finishInstant(RigidSystem<Plane>&, const PointStates<Plane>&, const std::vector<MortarRow<Plane>>&,
                                                 double) const;
template std::vector<int> Mortar<Space>::strained(const RigidSystem<Space>&, const ContactSet<Space>&, const PointStates<Space>&,
                                                  const LaneArray&) const;
template MortarWork Mortar<Space>::finishInstant(RigidSystem<Space>&, const PointStates<Space>&, const std::vector<MortarRow<Space>>&,
                                                 double) const;

} // namespace masonry::wall
