// Ties of a scene in the core's form, and back after each step.

#include "rigid_scene.hpp"
#include "tie_attributes.hpp"

#include <algorithm>

namespace yade {

namespace {

/// A point of a block, from its centre, from its own axes into those of the core.
masonry::Vector2 inCore(const Coordinates<Plane>& c, const Seat<Plane>& seat, const Vector3r& point)
{
	return c.in(seat.reference * point);
}
const Vector3r& inCore(const Coordinates<Space>&, const Seat<Space>&, const Vector3r& point) { return point; }

} // namespace

template <class K>
void RigidScene<K>::addTies(const Remembered<K>& before)
{
	const auto numberOf = [&](int id) { return int(std::find(kept.ids.begin(), kept.ids.end(), id) - kept.ids.begin()); };
	const bool areKnown = before.ties.size() == ties.size();
	for (size_t t = 0; t < ties.size(); ++t) {
		BlockTie& of = *ties[t];
		masonry::Tie<K> tie = areKnown ? before.ties[t] : masonry::Tie<K>();
		tie.body1 = numberOf(of.body1);
		tie.body2 = numberOf(of.body2);
		tie.point1 = inCore(coordinates, kept.seats[tie.body1], of.point1);
		tie.point2 = inCore(coordinates, kept.seats[tie.body2], of.point2);
		const Real length = masonry::Tie<K>::line(tie, system.bodies[tie.body1].pose, system.bodies[tie.body2].pose).length;
		if (std::isnan(of.length))
			of.length = length;
		if (!areKnown) {
			tie.broken = of.broken;
			tie.force = of.force;
			tie.extension = length - of.length;
			tie.energy = of.energy;
		}
		takeAttributes(of, tie);
		if (std::isnan(tie.energy)) { // it has not acted yet
			tie.force = tie.forceAt(tie.extension);
			tie.energy = tie.energyAt(tie.extension);
		}
		system.ties.push_back(tie);
	}
	writeTies();
}

template <class K>
void RigidScene<K>::readTies()
{
	for (size_t t = 0; t < ties.size(); ++t)
		if (masonry::Tie<K>& tie = system.ties[t]; takeAttributes(*ties[t], tie) && !tie.broken)
			tie.energy = tie.energyAt(tie.extension); // what a script changes is no work of the blocks
}

template <class K>
void RigidScene<K>::writeTies() const
{
	for (size_t t = 0; t < ties.size(); ++t)
		writeTie(system.ties[t], system.time, *ties[t]);
}

template void RigidScene<Plane>::addTies(const Remembered<Plane>&);
template void RigidScene<Space>::addTies(const Remembered<Space>&);
template void RigidScene<Plane>::readTies();
template void RigidScene<Space>::readTies();
template void RigidScene<Plane>::writeTies() const;
template void RigidScene<Space>::writeTies() const;

} // namespace yade
