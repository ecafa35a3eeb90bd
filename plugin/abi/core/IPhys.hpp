#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class IPhys : public Serializable, public Indexable {
	YADE_ABI_CLASS(IPhys)
	YADE_ABI_TOP_INDEX
	IPhys() = default;
};

} // namespace yade

YADE_ABI_ARCHIVED(IPhys)
