// Ties of a scene in the core's form, and back after each step.

#include "rigid_scene.hpp"

#include <algorithm>
#include <array>

namespace yade {

namespace {

/// A point of a block, from its centre, from its own axes into those of the core.
masonry::Vector2 inCore(const Coordinates<Plane>& c, const Seat<Plane>& seat, const Vector3r& point)
{
	return c.in(seat.reference * point);
}
const Vector3r& inCore(const Coordinates<Space>&, const Seat<Space>&, const Vector3r& point) { return point; }

/// Returns whether any was another one.
template <class K>
bool takeAttributes(const BlockTie& from, masonry::Tie<K>& to)
{
	const auto values = [&] { return std::array<Real, 5> {to.length, to.stiffness, to.pretension, to.strength, Real(to.tensionOnly)}; };
	const auto before = values();
	to.length = from.length;
	to.stiffness = from.stiffness;
	to.pretension = from.pretension;
	to.strength = from.strength;
	to.tensionOnly = from.tensionOnly;
	return values() != before;
}

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
	for (size_t t = 0; t < ties.size(); ++t) {
		const masonry::Tie<K>& tie = system.ties[t];
		BlockTie& to = *ties[t];
		if (tie.broken != to.broken)
			to.brokenAt = tie.broken ? system.time : NaN;
		to.broken = tie.broken;
		to.force = tie.broken ? 0 : tie.force;
		to.extension = tie.extension;
		to.energy = tie.energy;
	}
}

template void RigidScene<Plane>::addTies(const Remembered<Plane>&);
template void RigidScene<Space>::addTies(const Remembered<Space>&);
template void RigidScene<Plane>::readTies();
template void RigidScene<Space>::readTies();
template void RigidScene<Plane>::writeTies() const;
template void RigidScene<Space>::writeTies() const;

} // namespace yade
