// ElastMat and FrictMat share a header in YADE.
#pragma once

#include <core/Material.hpp>

namespace yade {

class ElastMat : public Material {
	YADE_ABI_CLASS(ElastMat)
	YADE_ABI_INDEX
	ElastMat() { createIndex(); }

	Real young = 1e9;
	Real poisson = .25;
};

class FrictMat : public ElastMat {
	YADE_ABI_CLASS(FrictMat)
	YADE_ABI_INDEX
	FrictMat();

	Real frictionAngle;
};

} // namespace yade

YADE_ABI_ARCHIVED(ElastMat)
YADE_ABI_ARCHIVED(FrictMat)
