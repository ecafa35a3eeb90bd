#include "joints/pivot.hpp"
#include <algorithm>

namespace masonry {

Pivot::Pivot(const std::vector<Vector3>& loaded, double narrow, bool mayBeEdge) : narrow(narrow)
{
	if (loaded.empty())
		return;
	place = loaded.front();
	for (const Vector3& p : loaded)
		if (mayBeEdge && (p - place).norm() > direction.norm())
			direction = p - place;
	direction = direction.norm() > narrow ? Vector3(direction.normalized()) : Vector3(Vector3::Zero());
	exists = std::all_of(loaded.begin(), loaded.end(), [this](const Vector3& p) { return has(p); });
}

} // namespace masonry
