#include "dynamics/wall/body_lanes.hpp"

namespace masonry::wall {

template <class K>
void BodyLanes<K>::take(const std::vector<RigidBody<K>>& bodies)
{
	const size_t n = bodies.size();
	velocity_.resize(packs<K> * (n + 1));
	poses.resize(BodyPacks<K>::poses * (n + 1));
	rho.resize(n + 1);
	const auto takeOne = [this](size_t b, const typename K::Pose& at, const Velocity& v, double perMass) {
		Lanes* pose = &poses[BodyPacks<K>::poses * b];
		BodyPacks<K>::place(at, rho[b], pose);
		BodyPacks<K>::setVelocity(v, pose, rho[b], perMass, &velocity_[packs<K> * b]);
	};
	team.eachShare(n, [&](size_t begin, size_t end) {
		for (size_t b = begin; b < end; ++b) {
			const RigidBody<K>& body = bodies[b];
			if (body.prescribed)
				rho[b].setOnes();
			else
				rho[b] = BodyPacks<K>::gyration(body.inertia, body.mass);
			takeOne(b, body.pose, body.velocity, body.inverseMass());
		}
	});
	rho[n].setOnes();
	takeOne(n, {}, Velocity::Zero(), 0);
}

template <class K>
void BodyLanes<K>::takeForces(const std::vector<RigidBody<K>>& bodies, double h, LaneArray& to) const
{
	to.assign(velocity_.size(), all(0));
	team.eachShare(bodies.size(), [&](size_t begin, size_t end) {
		for (size_t b = begin; b < end; ++b) {
			const Packs given = inPacks(bodies[b].force, b, h * perMass(b));
			std::copy(given.begin(), given.end(), &to[packs<K> * b]);
		}
	});
}

template <class K>
void BodyLanes<K>::setShift(double h)
{
	shift_.resize(velocity_.size());
	for (size_t k = 0; k < shift_.size(); ++k)
		shift_[k] = h * velocity_[k];
}

template <class K>
void BodyLanes<K>::addShift(const LaneArray& by)
{
	for (size_t k = 0; k < shift_.size(); ++k)
		shift_[k] += noMass * by[k];
}

template class BodyLanes<Plane>;
template class BodyLanes<Space>;

} // namespace masonry::wall
