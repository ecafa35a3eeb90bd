#pragma once
// The bodies of a structure in packs (contact_groups.hpp): poses, velocities and displacements. It owns them from the start of a step,
// when it takes them over from the bodies, to its end. A body with 1/m = 0 is prescribed. One more body at the end, which is prescribed
// and at rest, stands for the bodies of empty lanes.
#include "dynamics/wall/contact_groups.hpp"
#include "impact/rigid_body.hpp"
#include "parallel/team.hpp"

namespace masonry::wall {

using parallel::Team;

template <class K>
class BodyLanes {
public:
	using Packs = std::array<Lanes, packs<K>>; // of one body
	using Velocity = typename K::Velocity;

	explicit BodyLanes(Team& team) : team(team) {}

	// Masses, poses and velocities of these bodies.
	void take(const std::vector<RigidBody<K>>& bodies);

	size_t size() const { return rho.size() - 1; }
	double perMass(size_t body) const { return velocity_[packs<K> * body][3]; }
	bool isFree(size_t body) const { return perMass(body) > 0; }
	const typename K::Spin& gyration(size_t body) const { return rho[body]; } // m
	const Lanes* pose(size_t body = 0) const { return &poses[BodyPacks<K>::poses * body]; }
	typename K::Vector position(size_t body) const { return BodyPacks<K>::position(pose(body)); }
	const LaneArray& velocity() const { return velocity_; }
	const LaneArray& shift() const { return shift_; } // how far the bodies have moved in the step; components as of velocities

	// Packs of a body as a velocity in global axes.
	Velocity inGlobal(const LaneArray& from, size_t body) const
	{
		return BodyPacks<K>::inGlobal(&from[packs<K> * body], pose(body), rho[body]);
	}
	// A force and its moment times a factor, so that their power is that of the packs.
	Packs inPacks(const Velocity& force, size_t body, double factor = 1) const
	{
		return BodyPacks<K>::ofForce(force, factor, pose(body), rho[body]);
	}
	// Sets the velocities that the bodies' forces give them in a time h.
	void takeForces(const std::vector<RigidBody<K>>& bodies, double h, LaneArray& to) const;

	void setVelocity(const LaneArray& v) { velocity_ = v; } // of all bodies, in packs with 1/m
	void setLinearVelocity(size_t body, const typename K::Vector& v)
	{
		for (int i = 0; i < K::dimension; ++i)
			velocity_[packs<K> * body][i] = v[i];
	}
	// The bodies move in a time h as the velocities are.
	void setShift(double h);
	void addShift(const LaneArray& by);

private:
	Team& team;
	LaneArray velocity_, shift_;
	LaneArray poses;                   // BodyPacks
	std::vector<typename K::Spin> rho; // radii of gyration, m
};

// e.w of a body.
template <class K>
std::array<Lanes, packs<K>> spinArm(const BodyLanes<K>& bodies, int body, const typename K::Spin& axis)
{
	typename K::Velocity couple = K::Velocity::Zero();
	couple.template tail<K::spins>() = axis;
	return bodies.inPacks(couple, body);
}

// n.v of the place r from the body's centre.
template <class K>
std::array<Lanes, packs<K>> speedArm(const BodyLanes<K>& bodies, int body, const typename K::Vector& n, const typename K::Vector& r)
{
	typename K::Velocity force;
	force << n, K::moment(r, n);
	return bodies.inPacks(force, body);
}

} // namespace masonry::wall
