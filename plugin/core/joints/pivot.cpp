#include "joints/pivot.hpp"
#include <algorithm>

namespace masonry {

template <class K>
Pivot<K>::Pivot(const std::vector<Vector>& loaded, double narrow) : narrow(narrow)
{
	if (loaded.empty())
		return;
	place = loaded.front();
	for (const Vector& p : loaded)
		if (K::dimension == 3 && (p - place).norm() > direction.norm())
			direction = p - place;
	direction = direction.norm() > narrow ? Vector(direction.normalized()) : Vector(Vector::Zero());
	exists = std::all_of(loaded.begin(), loaded.end(), [this](const Vector& p) { return has(p); });
}

template class Pivot<Plane>;
template class Pivot<Space>;

} // namespace masonry
