#pragma once
// Recorders have in common when they are due, and which bodies they began with.

#include <core/Scene.hpp>
#include <pkg/common/PeriodicEngines.hpp>

namespace yade {

/// Whether a period has elapsed. O.time is a sum of steps, whose round-off must not put a sample off by a step.
inline bool isDue(PeriodicEngine& recorder)
{
	constexpr Real roundOff = 1e-6; // of the period
	const Real given = recorder.virtPeriod;
	recorder.virtPeriod = (1 - roundOff) * given;
	const bool is = recorder.PeriodicEngine::isActivated();
	recorder.virtPeriod = given;
	return is;
}

/// Another body that has come in the place of an erased one is not recorded for it.
class RecordedBodies {
public:
	/// Those of `ids` that are there now; `isGone(k)`: the k-th had been erased before, in what a file had. Does nothing a second time.
	template <class IsGone>
	void begin(const Scene& scene, const vector<int>& ids, IsGone isGone)
	{
		for (size_t k = bodies.size(); k < ids.size(); ++k)
			bodies.push_back(isGone(k) || !scene.bodies->exists(ids[k]) ? nullptr : (*scene.bodies)[ids[k]]);
	}
	/// Null: erased since.
	const Body* find(const Scene& scene, const vector<int>& ids, size_t k) const
	{
		const auto body = bodies[k].lock();
		return body && scene.bodies->exists(ids[k]) && (*scene.bodies)[ids[k]] == body ? body.get() : nullptr;
	}

private:
	vector<boost::weak_ptr<Body>> bodies;
};

} // namespace yade
