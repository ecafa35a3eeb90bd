#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Bound : public Serializable, public Indexable {
	YADE_ABI_CLASS(Bound)
	YADE_ABI_TOP_INDEX
	Bound() = default;

	int lastUpdateIter = 0;
	Vector3r refPos = Vector3r(NaN, NaN, NaN);
	Real sweepLength = 0;
	Vector3r color = Vector3r(1, 1, 1);
	Vector3r min = Vector3r(NaN, NaN, NaN);
	Vector3r max = Vector3r(NaN, NaN, NaN);
};

} // namespace yade

YADE_ABI_ARCHIVED(Bound)
