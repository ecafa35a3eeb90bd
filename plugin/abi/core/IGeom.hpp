#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IGeom : public Serializable, public Indexable {
	YADE_ABI_CLASS(IGeom)
	YADE_ABI_TOP_INDEX
	IGeom() = default;
};

} // namespace yade

YADE_ABI_ARCHIVED(IGeom)
