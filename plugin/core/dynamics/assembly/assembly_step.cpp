#include "dynamics/assembly/assembly_step.hpp"
#include "dynamics/rigid/drive_kinks.hpp"
#include "dynamics/rigid/free_motion.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid::assembly {

using wall::all;

template <class K>
StepReport AssemblyStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	s.impacts.clear();
	for (double left = dt; left > 0 && !report.diverged;) {
		const double h = untilKink(s, left, dt);
		advancePart(s, h);
		left = h == left ? 0 : left - h;
	}
	report.residual = report.velocityResidual;
	report.sweeps = report.iterations;
	report.courses = contacts.depth;
	return report;
}

template <class K>
void AssemblyStep<K>::advancePart(RigidSystem<K>& s, double h)
{
	const Scales scales(s);
	const StepContext step(scales, h);
	team.setThreads(settings.threads);
	solver.settings = settings.solver;
	ledger.open(s, h);
	takeContacts(s);
	placeFrames(s, h);
	contacts.setUnit(h);
	setLoads(s, h);
	solver.solve(s, contacts, loads, step);
	ledger.takeContacts(s, contacts, solver, solver.advanceGaps(contacts, h));
	moveBodies(s, h);
	s.time += h;
	s.moved = false;
	report.iterations += solver.report.iterations;
	report.factorisations += solver.report.factorisations;
	report.velocityResidual = std::max(report.velocityResidual, solver.report.residual);
	report.diverged |= !solver.report.finite || !s.isFinite();
}

template <class K>
void AssemblyStep<K>::takeContacts(RigidSystem<K>& s)
{
	wall::Members members {std::vector<char>(s.bodies.size()), std::vector<char>(s.bodies.size(), 0)};
	for (size_t b = 0; b < s.bodies.size(); ++b)
		members.own[b] = !s.bodies[b].prescribed;
	contacts.take(s, members, nobody);
	contacts.measure(s, false);
}

// Normals and arms of a step are those at its middle: those at its start would lag by half of it, and take energy from what rocks in
// proportion to it.
template <class K>
void AssemblyStep<K>::placeFrames(const RigidSystem<K>& s, double h)
{
	middle.resize(s.bodies.size());
	contacts.eachShare(middle.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			const auto& body = s.bodies[b];
			middle[b] = body.pose;
			K::advance(middle[b], body.velocity, h / 2);
			if (body.drive >= 0)
				middle[b].position = s.driven(body, s.time + h / 2);
		}
	});
	contacts.lean(s, middle);
}

// Velocities of the prescribed bodies in the step, and what forces add to those of the free ones.
template <class K>
void AssemblyStep<K>::setLoads(const RigidSystem<K>& s, double h)
{
	loads.assign(contacts.velocity.size(), all(0));
	contacts.eachShare(s.bodies.size(), [&](size_t begin, size_t end, int) {
		for (size_t b = begin; b < end; ++b) {
			const auto& body = s.bodies[b];
			contacts.takeForce(body.force, h, b, loads);
			if (body.prescribed && body.drive >= 0)
				contacts.setLinearVelocity(int(b), s.drives[body.drive].meanVelocity(s.time, h));
		}
	});
}

template <class K>
void AssemblyStep<K>::moveBodies(RigidSystem<K>& s, double h)
{
	contacts.shift.resize(solver.velocity.size());
	for (size_t b = 0; b < contacts.shift.size(); ++b)
		contacts.shift[b] = h * solver.velocity[b];
	contacts.velocity = solver.velocity;
	const double deepest = projection.settle(contacts);
	if (deepest > tolerance::wall::sunk * contacts.length)
		report.deepest = std::max(report.deepest, deepest);
	double work = 0; // of the forces, J
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		auto& body = s.bodies[b];
		body.fresh = false;
		if (body.prescribed) {
			K::advance(body.pose, body.velocity, h);
			if (body.drive >= 0) {
				body.pose.position = s.driven(body, s.time + h);
				body.velocity.template head<K::dimension>() = s.drives[body.drive].velocity(s.time + h);
			}
			continue;
		}
		const typename K::Velocity moved = contacts.inGlobal(contacts.shift, b), before = body.velocity;
		body.velocity = contacts.inGlobal(contacts.velocity, b);
		moveFree(body, moved, h);
		body.increment = (body.velocity - before) / h;
		work += body.force.dot(moved);
	}
	report.created += ledger.close(s, Scales(s), h, work);
}

template class AssemblyStep<Plane>;
template class AssemblyStep<Space>;

} // namespace masonry::rigid::assembly
