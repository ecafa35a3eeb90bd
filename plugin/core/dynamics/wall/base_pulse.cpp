#include "dynamics/wall/base_pulse.hpp"
#include <algorithm>

namespace masonry::wall {

template <class K>
void BasePulse<K>::hold(const RigidSystem<K>& s, ContactSet<K>& c)
{
	half.assign(velocity.size(), K::Vector::Zero());
	set(s, c);
}

template <class K>
bool BasePulse<K>::find(const RigidSystem<K>& s, const std::vector<int>& blocks)
{
	if (velocity.size() != s.drives.size()) {
		velocity.clear();
		for (const Drive<K>& drive : s.drives)
			velocity.push_back(drive.velocity(s.time));
	}
	jumps.resize(s.drives.size());
	for (size_t d = 0; d < s.drives.size(); ++d) {
		jumps[d] = s.drives[d].jumpAt(s.time);
		for (const int block : blocks)
			jumps[d] += s.drives[d].respond(block, s.time);
	}
	return speed() > 0;
}

template <class K>
double BasePulse<K>::speed() const
{
	double most = 0;
	for (const auto& jump : jumps)
		most = std::max(most, jump.norm());
	return most;
}

template <class K>
void BasePulse<K>::apply(RigidSystem<K>& s, ContactSet<K>& c)
{
	for (size_t d = 0; d < velocity.size(); ++d) {
		velocity[d] += jumps[d];
		half[d] = -jumps[d] / 2;
	}
	for (auto& body : s.bodies)
		if (body.prescribed && body.drive >= 0)
			body.velocity.template head<K::dimension>() += jumps[body.drive];
	set(s, c);
}

template <class K>
void BasePulse<K>::move(const RigidSystem<K>& s, ContactSet<K>& c, double h)
{
	half.resize(velocity.size());
	before = velocity;
	for (size_t d = 0; d < velocity.size(); ++d) {
		const typename K::Vector now = s.drives[d].meanVelocity(s.time, h);
		half[d] = (velocity[d] - lift(s, d) - now) / 2;
		velocity[d] = now;
	}
	set(s, c);
}

// Along gravity.
template <class K>
typename K::Vector BasePulse<K>::lift(const RigidSystem<K>& s, int drive) const
{
	const typename K::Vector down = s.gravity.normalized(); // zero without gravity
	return down * down.dot(jumps[drive]);
}

template <class K>
void BasePulse<K>::addLift(const RigidSystem<K>& s, LaneArray& of) const
{
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (const int drive = s.bodies[b].drive; s.bodies[b].prescribed && drive >= 0) {
			const typename K::Vector by = lift(s, drive);
			for (int k = 0; k < K::dimension; ++k)
				of[packs<K> * b][k] += by[k];
		}
}

template <class K>
void BasePulse<K>::set(const RigidSystem<K>& s, ContactSet<K>& c) const
{
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed && s.bodies[b].drive >= 0)
			c.setLinearVelocity(b, velocity[s.bodies[b].drive]);
}

template class BasePulse<Plane>;
template class BasePulse<Space>;

} // namespace masonry::wall
