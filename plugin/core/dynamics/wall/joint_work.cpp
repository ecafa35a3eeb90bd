#include "dynamics/wall/joint_work.hpp"

namespace masonry::wall {

template <class K>
std::vector<JointWork> workOfPairs(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results)
{
	const LaneArray& before = c.bodies().velocity();
	std::vector<JointWork> works(s.pairs.size());
	for (size_t g = 0; g < c.points().groups().size(); ++g) {
		const Group<K>& group = c.points().groups()[g];
		const LaneGroup& lanes = c.layout().groups()[g];
		for (int i = 0; i < lanes.count; ++i)
			for (int k = 0; k < group.count; ++k)
				for (int n = 0; n < K::rows; ++n) {
					const auto rate = [&](const LaneArray& v) {
						return rateOf(group.point[k], n, i, 2, &v[packs<K> * group.body2[i]]) -
						       rateOf(group.point[k], n, i, 1, &v[packs<K> * group.body1[i]]);
					};
					const auto& acted = results.points[g][k];
					works[lanes.pair[i]].add(n == 0 ? acted.actedN[i] : component(acted.actedT, n - 1, i), rate(before),
					                         rate(results.velocity));
				}
	}
	return works;
}

template <class K>
JointWork jointWork(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, const std::vector<JointWork>& pairs,
                    const SpinRow<K>& row)
{
	JointWork result;
	result.add(row.couple, row.rate(c.bodies().velocity()), row.rate(results.velocity));
	for (size_t k = 0; k < pairs.size(); ++k)
		if (isOfJoint(s.pairs[k], row))
			result.add(pairs[k]);
	return result;
}

template std::vector<JointWork> workOfPairs(const RigidSystem<Plane>&, const ContactSet<Plane>&, const AdmmResults<Plane>&);
template std::vector<JointWork> workOfPairs(const RigidSystem<Space>&, const ContactSet<Space>&, const AdmmResults<Space>&);
template JointWork jointWork(const RigidSystem<Plane>&, const ContactSet<Plane>&, const AdmmResults<Plane>&, const std::vector<JointWork>&,
                             const SpinRow<Plane>&);
template JointWork jointWork(const RigidSystem<Space>&, const ContactSet<Space>&, const AdmmResults<Space>&, const std::vector<JointWork>&,
                             const SpinRow<Space>&);

} // namespace masonry::wall
