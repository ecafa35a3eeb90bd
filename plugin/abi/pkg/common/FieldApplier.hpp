#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

class FieldApplier : public GlobalEngine {
	YADE_ABI_CLASS(FieldApplier)
	FieldApplier() = default;
	void action() override;

	int fieldWorkIx = -1; // energy id
};

} // namespace yade

YADE_ABI_ARCHIVED(FieldApplier)
