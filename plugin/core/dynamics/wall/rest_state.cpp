#include "dynamics/wall/rest_state.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::wall {

template <class K>
int RestState<K>::movingBlocks(const RigidSystem<K>& s, const ContactSet<K>& contacts, const PointsReport& points, double level)
{
	std::vector<char> isHeld(s.bodies.size(), 0), moves(s.bodies.size(), 0);
	for (size_t g = 0; g < contacts.layout().groups().size(); ++g) {
		const LaneGroup& lanes = contacts.layout().groups()[g];
		for (int i = 0; i < lanes.count; ++i)
			for (const int b : {lanes.body1[i], lanes.body2[i]}) {
				isHeld[b] |= points.reached[g] >> i & 1;
				moves[b] |= points.moving[g] >> i & 1;
			}
	}
	int count = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		count += contacts.bodies().isFree(b) && (moves[b] || (!isHeld[b] && !(s.bodies[b].velocity.norm() <= level)));
	return count;
}

template <class K>
void RestState<K>::take(const RigidSystem<K>& s, const SolverStatus& status, int movingBlocks, double h)
{
	const bool turns = std::any_of(s.bodies.begin(), s.bodies.end(), [h](const RigidBody<K>& body) { // so far that frames must follow
		return !(h * body.velocity.template tail<K::spins>().norm() <= tolerance::wall::turned);
	});
	quiet = movingBlocks == 0 && !turns && !status.leftRest ? quiet + 1 : 0;
}

template class RestState<Plane>;
template class RestState<Space>;

} // namespace masonry::wall
