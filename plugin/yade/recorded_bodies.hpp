#pragma once
// Which bodies a recorder began with.

#include <core/Scene.hpp>

namespace yade {

/// Another body that has come in the place of an erased one is not recorded for it.
class RecordedBodies {
public:
	/// Those of `ids` that are there now; `isGone(k)`: the k-th had been erased before, in what a file had. Does nothing a second time.
	template <class IsGone> void begin(const Scene& scene, const vector<int>& ids, IsGone isGone)
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
