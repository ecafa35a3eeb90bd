// What the prescribed bodies do to a wall in a step, J.
#include "dynamics/wall/wall_step.hpp"
#include <algorithm>

namespace masonry::rigid {

using wall::Lanes;

template <class K>
typename K::Velocity WallStep<K>::startVelocity(const RigidSystem<K>& s, int b) const
{
	typename K::Velocity velocity = s.bodies[b].velocity;
	if (const int drive = s.bodies[b].drive; drive >= 0)
		velocity.template head<K::dimension>() = s.drives[drive].velocity(s.time);
	return velocity;
}

// What a jump of the base gives to what cannot slip works on the mean of the velocities before and after, not on the last.
template <class K>
typename K::Vector WallStep<K>::halfJump(const RigidSystem<K>& s, const wall::WallContacts<K>& contacts, int group, int lane) const
{
	const int drive = s.bodies[contacts.base(s, group, lane)].drive;
	if (s.time != jumpTime || drive < 0 || s.pairs[contacts.features[group].pair[lane]].friction != noSlip)
		return K::Vector::Zero();
	return jumps[drive] / 2;
}

// What carries a weight works on the way of the base in the substep h, not at the velocity at its start: of a base that moves up and down
// the difference, where it carries what goes along with it, whose impulse is that of gravity and of the base's own acceleration.
template <class K>
typename K::Vector WallStep<K>::carries(const RigidSystem<K>& s, int drive, double h) const
{
	using Vector = typename K::Vector;
	const double weight = s.gravity.norm() * h;
	if (drive < 0 || !(weight > 0))
		return Vector::Zero();
	const Vector up = -s.gravity.normalized();
	const double change = up.dot(s.drives[drive].meanVelocity(s.time, h) - s.drives[drive].velocity(s.time)), given = 2 * change;
	constexpr double most = 3; // of the share: near free fall what lands on the base has no weight to carry
	return weight / std::max(weight + given, weight / most) * change * up;
}

// Of the impulses that the prescribed bodies give in a substep h, J, with their velocities at its start: the mean of those that blocks
// which go with them have before and after it.
template <class K>
double WallStep<K>::baseWork(const RigidSystem<K>& s, Contacts& contacts, double h)
{
	double work = 0;
	const bool ofSweeps = &contacts == &moving();
	setBase(s, contacts, 0);
	int under = -1; // drive
	typename K::Vector bears = K::Vector::Zero();
	for (const auto& [g, i] : contacts.onBase) {
		const wall::Group<K>& group = contacts.groups[g];
		const bool first = s.bodies[group.body1[i]].prescribed;
		if (isStill(first ? group.body2[i] : group.body1[i]) == ofSweeps)
			continue;
		Lanes v[wall::packs<K>];
		std::copy_n(&contacts.velocity[wall::packs<K> * (first ? group.body1 : group.body2)[i]], wall::packs<K>, v);
		if (const int drive = s.bodies[contacts.base(s, g, i)].drive; drive != under)
			bears = carries(s, under = drive, h);
		const typename K::Vector other = bears - halfJump(s, contacts, g, i);
		for (int k = 0; k < K::dimension; ++k)
			v[0][k] += other[k];
		for (int k = 0; k < group.count; ++k) {
			const wall::PointLanes<K>& p = group.point[k];
			const auto impulse = ofSweeps ? sweeps.impulse(g, i, k) : wall::impulseOf(p, i);
			for (int row = 0; row < K::rows; ++row)
				work += (first ? impulse[row] : -impulse[row]) * wall::rateOf(p, row, i, first ? 1 : 2, v);
		}
	}
	return work;
}

// The same from the momentum that the blocks have taken up: of a few iterations, impulses are less right than velocities. Where prescribed
// bodies move differently, from the impulses.
template <class K>
double WallStep<K>::baseWorkWhenStill(const RigidSystem<K>& s, double h)
{
	using Vector = typename K::Vector;
	Contacts& contacts = still();
	int base = -1;
	Vector half = Vector::Zero();
	for (const auto& [g, i] : contacts.onBase) {
		if (!isStill(contacts.freeBody(g, i)))
			continue;
		const int b = contacts.base(s, g, i);
		if (base < 0) {
			base = b;
			half = halfJump(s, contacts, g, i);
		}
		const typename K::Velocity v = startVelocity(s, b);
		if (b != base && (v != startVelocity(s, base) || !v.template tail<K::spins>().isZero(0)))
			return baseWork(s, contacts, h);
	}
	if (base < 0)
		return 0;
	if (!s.bodies[base].velocity.template tail<K::spins>().isZero(0))
		return baseWorkWhenTurning(s, base, h);
	Vector momentum = Vector::Zero(), load = Vector::Zero(); // that the blocks have taken up, and that other forces have given
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (isStill(int(b)))
			for (int i = 0; i < K::dimension; ++i) {
				momentum[i] += s.bodies[b].mass * (kept.velocity[wall::packs<K> * b] - contacts.velocity[wall::packs<K> * b])[i];
				load[i] += s.bodies[b].mass * loads[wall::packs<K> * b][i];
			}
	// What changes velocities works on their mean, which the base has at the start; what carries a load goes with it all the way.
	const Vector start = startVelocity(s, base).template head<K::dimension>();
	const int drive = s.bodies[base].drive;
	return (momentum - load).dot(start - half) -
	       load.dot(drive < 0 ? Vector(Vector::Zero()) : Vector(s.drives[drive].meanVelocity(s.time, h) - start));
}

// The same of a base that turns: with the moment about its centre, of arms in the middle of the step.
template <class K>
double WallStep<K>::baseWorkWhenTurning(const RigidSystem<K>& s, int base, double h)
{
	const Contacts& contacts = still();
	typename K::Velocity impulse = K::Velocity::Zero();
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		if (!isStill(int(b)))
			continue;
		const auto& body = s.bodies[b];
		const typename K::Velocity change =
		    contacts.inGlobal(kept.velocity, b) - contacts.inGlobal(contacts.velocity, b) - contacts.inGlobal(loads, b);
		const typename K::Vector own = body.mass * change.template head<K::dimension>();
		impulse.template head<K::dimension>() += own;
		const typename K::Velocity apart = body.velocity - s.bodies[base].velocity;
		const typename K::Vector arm = body.pose.position - s.bodies[base].pose.position + h / 2 * apart.template head<K::dimension>();
		impulse.template tail<K::spins>() +=
		    K::moment(arm, own) + K::angularMomentum(body.inertia, body.pose, change.template tail<K::spins>());
	}
	return impulse.dot(startVelocity(s, base));
}

#define MASONRY_OF(K)                                                                                                                      \
	template double WallStep<K>::baseWork(const RigidSystem<K>&, Contacts&, double);                                                       \
	template double WallStep<K>::baseWorkWhenStill(const RigidSystem<K>&, double);
MASONRY_OF(Plane)
MASONRY_OF(Space)
#undef MASONRY_OF

} // namespace masonry::rigid
