// Motions and energies of a step, back into the system.
#include "dynamics/rigid/free_motion.hpp"
#include "dynamics/wall/wall_step.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

// A body's pose and velocity back into the system. Returns the work of the force on it, J.
template <class K>
double WallStep<K>::takeBody(RigidSystem<K>& s, size_t b, double h)
{
	auto& body = s.bodies[b];
	if (body.prescribed && body.drive >= 0) {
		if (!body.velocity.template tail<K::spins>().isZero(0))
			K::advance(body.pose, body.velocity, h);
		body.pose.position = s.driven(body, s.time + h);
		body.velocity.template head<K::dimension>() = s.drives[body.drive].velocity(s.time + h);
		return 0;
	}
	const bool stands = isStill(int(b)) || report.mode == WallMode::still;
	const Contacts& contacts = stands ? still() : moving();
	const typename K::Velocity moved = contacts.inGlobal(contacts.shift, b), before = body.velocity;
	body.velocity = contacts.inGlobal(contacts.velocity, b);
	if (body.prescribed) {
		K::advance(body.pose, moved, 1);
		return 0;
	}
	moveFree(body, moved, h);
	body.increment = (body.velocity - before) / h;
	return body.force.dot(moved);
}

// Poses and velocities back into the system; energies; what the next step compares with.
template <class K>
void WallStep<K>::takeMotion(RigidSystem<K>& s, double h, double workBefore)
{
	struct alignas(64) Energies { // of the bodies of a share; lines of the cache of their own
		double before {0}, gained {0}, work {0}, mass {0};
		double place {0}; // of no meaning, but finite if all places are
	};
	Energies of[wall::Team::mostParts];
	forces.resize(s.bodies.size());
	Contacts& contacts = report.mode == WallMode::still ? still() : moving();
	contacts.eachShare(s.bodies.size(), [&](size_t begin, size_t end, int number) {
		Energies sum;
		for (size_t b = begin; b < end; ++b) {
			const double before = s.bodies[b].kineticEnergy();
			sum.work += takeBody(s, b, h);
			sum.before += before;
			sum.gained += s.bodies[b].kineticEnergy() - before;
			sum.mass += s.bodies[b].prescribed ? 0 : s.bodies[b].mass;
			sum.place += s.bodies[b].pose.position.sum();
			s.bodies[b].fresh = false;
			forces[b] = s.bodies[b].force;
		}
		of[number] = sum;
	});
	const double baseWork = s.baseWork - workBefore;
	double lost = baseWork - frictionLoss - setOffEnergy, atStake = std::abs(baseWork), mass = 0;
	for (const Energies& share : of) {
		lost += share.work - share.gained;
		atStake += std::abs(share.work) + share.before;
		mass += share.mass;
		report.diverged |= !std::isfinite(share.gained + share.place);
	}
	s.frictDissip += frictionLoss;
	s.impactDissip += lost;
	const double liftedAll = mass * scales.acceleration * scales.length, slowest = tolerance::wall::createdTravel * scales.length / h;
	if (lost < -tolerance::wall::createdShare * atStake - tolerance::wall::createdLift * liftedAll - mass * slowest * slowest)
		report.created -= lost;
}

template void WallStep<Plane>::takeMotion(RigidSystem<Plane>&, double, double);
template void WallStep<Space>::takeMotion(RigidSystem<Space>&, double, double);

} // namespace masonry::rigid
