#include "dynamics/wall/joint_work.hpp"

namespace masonry::wall {

template <class K>
JointWork jointWork(const RigidSystem<K>& s, const ContactSet<K>& c, const AdmmResults<K>& results, int block, int face)
{
	const LaneArray& before = c.bodies().velocity();
	JointWork result;
	for (const SpinRow<K>& row : results.spins)
		if (row.block() == block && row.face == face)
			result.add(row.couple, row.rate(before), row.rate(results.velocity));
	for (size_t g = 0; g < c.points().groups().size(); ++g) {
		const Group<K>& group = c.points().groups()[g];
		const LaneGroup& lanes = c.layout().groups()[g];
		for (int i = 0; i < lanes.count; ++i) {
			const ContactPair<K>& pair = s.pairs[lanes.pair[i]];
			if (!(pair.body1 == block && pair.face1 == face) && !(pair.body2 == block && pair.face2 == face))
				continue;
			for (int k = 0; k < group.count; ++k)
				for (int n = 0; n < K::rows; ++n) {
					const auto rate = [&](const LaneArray& v) {
						return rateOf(group.point[k], n, i, 2, &v[packs<K> * group.body2[i]]) -
						       rateOf(group.point[k], n, i, 1, &v[packs<K> * group.body1[i]]);
					};
					const auto& acted = results.points[g][k];
					result.add(n == 0 ? acted.actedN[i] : component(acted.actedT, n - 1, i), rate(before), rate(results.velocity));
				}
		}
	}
	return result;
}

template JointWork jointWork(const RigidSystem<Plane>&, const ContactSet<Plane>&, const AdmmResults<Plane>&, int, int);
template JointWork jointWork(const RigidSystem<Space>&, const ContactSet<Space>&, const AdmmResults<Space>&, int, int);

} // namespace masonry::wall
