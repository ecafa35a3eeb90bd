#pragma once
// YADE's collider looks for new pairs when a coordinate of a body's centre has moved by its sweep length. It is told here where turning
// carries the corners that far by the end of the step.

#include "block_shape.hpp"
#include <core/Body.hpp>
#include <core/Bound.hpp>
#include <core/Scene.hpp>

namespace yade {

class TurningBounds {
public:
	/// The reference is set back by twice the way, along the axis of the largest displacement and against it, so that the motion of this
	/// step cannot bring the body back within its sweep length of it.
	void update(const Scene& scene, const vector<int>& ids)
	{
		seenAt.resize(scene.bodies->size());
		for (int id : ids) {
			const Body& body = *(*scene.bodies)[id];
			if (!body.bound)
				continue;
			Bound& bound = *body.bound;
			const State& state = *body.state;
			Seen& seen = seenAt[id];
			if (seen.iteration != bound.lastUpdateIter)
				seen = {bound.lastUpdateIter, state.ori};
			const Real radius = BlockShape(*body.shape).radius();
			const Vector3r displacement = state.pos - bound.refPos;
			const Real turn = seen.orientation.angularDistance(state.ori) + state.angVel.norm() * scene.dt;
			const Real way = displacement.norm() + radius * turn;
			if (!(radius * turn > 0 && way > bound.sweepLength))
				continue; // the collider sees translations by itself
			int axis;
			displacement.cwiseAbs().maxCoeff(&axis);
			bound.refPos = state.pos - 2 * way * (displacement[axis] < 0 ? -1 : 1) * Vector3r::Unit(axis);
		}
	}
	void forget() { seenAt.clear(); }

private:
	struct Seen { // a body when the collider last looked
		long iteration = -1;
		Quaternionr orientation = Quaternionr::Identity();
	};
	vector<Seen> seenAt; // by body id
};

} // namespace yade
