#pragma once
// One step of a wall, frozen.
#include "core/dynamics/wall/wall_rig.hpp"

namespace rig {

using namespace masonry::wall;

// The contact problem of one step, from the system as it is, with the frames of the start of the step and without impulses.
template <class K>
struct Frozen {
	static constexpr int packs = wall::packs<K>;
	parallel::Team team;
	wall::ContactSet<K> contacts {team};
	wall::AdmmSolver<K> solver;
	wall::AdmmResults<K> results;
	wall::StepContext step;
	LaneArray loads;

	Frozen(RigidSystem<K>& s, double h) : step(Scales(s), h)
	{
		contacts.update(s, true);
		contacts.setUnit(h);
		contacts.bodies().takeForces(s.bodies, h, loads);
	}

	void solve(double tolerance, int iterations)
	{
		AdmmSettings settings;
		settings.tolerance = tolerance;
		settings.first = iterations;
		solver.solve({contacts, step, loads, {}, {}}, settings, results);
		PointStates<K> found = results.states;
		contacts.swapStates(found);
	}

	// The same problem for the general solver: in the packs of the contacts each body has one mass for all components. `unknown` are its
	// bodies; the impulses are those that the solver has found.
	ContactSolver<K> general() const
	{
		ContactSolver<K> result;
		const BodyLanes<K>& bodies = contacts.bodies();
		std::vector<int> unknown(bodies.size(), -1);
		const auto velocityOf = [&](const LaneArray& from, size_t b) {
			typename K::Velocity v;
			for (int k = 0; k < K::dof; ++k)
				v[k] = from[packs * b + k / 3][k % 3];
			return v;
		};
		for (size_t b = 0; b < bodies.size(); ++b)
			if (bodies.isFree(b)) {
				unknown[b] = int(result.bodies.size());
				FreeBody<K> body;
				body.inverseMass.linear = bodies.perMass(b);
				body.inverseMass.angular = body.inverseMass.linear * K::InverseInertia::Identity();
				body.free = velocityOf(bodies.velocity(), b) + velocityOf(loads, b);
				body.velocity = body.free;
				result.bodies.push_back(body);
			}
		for (size_t g = 0; g < contacts.points().groups().size(); ++g)
			for (int i = 0; i < contacts.layout().groups()[g].count; ++i)
				for (int k = 0; k < contacts.points().groups()[g].count; ++k) {
					const auto& row = results.points[g][k];
					if (!row.inReach[i])
						continue;
					const auto& group = contacts.points().groups()[g];
					const auto& p = group.point[k];
					const int body[2] = {group.body1[i], group.body2[i]};
					ContactRows<K> point;
					point.body1 = unknown[body[0]];
					point.body2 = unknown[body[1]];
					point.law = group.friction[i];
					for (int r = 0; r < K::rows; ++r) {
						for (int c = 0; c < K::dof; ++c) {
							point.J1(r, c) = -partOf(p, r, i, 1, c / 3)[c % 3];
							point.J2(r, c) = partOf(p, r, i, 2, c / 3)[c % 3];
						}
						point.offset[r] = r == 0 ? row.bn[i] : component(row.bt, r - 1, i);
						for (int side = 0; side < 2; ++side)
							if (!bodies.isFree(body[side]))
								point.offset[r] += (side == 0 ? point.J1 : point.J2).row(r) * velocityOf(bodies.velocity(), body[side]);
					}
					const PointState<K>& state = results.states[g][k];
					point.impulse[0] = state.pn[i];
					for (int r = 1; r < K::rows; ++r)
						point.impulse[r] = component(state.pt, r - 1, i);
					for (int side = 0; side < 2; ++side)
						if (const int b = unknown[body[side]]; b >= 0)
							result.bodies[b].velocity +=
							    result.bodies[b].inverseMass *
							    typename K::Velocity((side == 0 ? point.J1 : point.J2).transpose() * point.impulse);
					result.points.push_back(point);
				}
		return result;
	}
};

} // namespace rig
