// NormPhys and NormShearPhys share a header in YADE.
#pragma once

#include <core/IPhys.hpp>

namespace yade {

class NormPhys : public IPhys {
	YADE_ABI_CLASS(NormPhys)
	YADE_ABI_INDEX
	NormPhys();

	Real kn;
	Vector3r normalForce;
};

class NormShearPhys : public NormPhys {
	YADE_ABI_CLASS(NormShearPhys)
	YADE_ABI_INDEX
	NormShearPhys();

	Real ks;
	Vector3r shearForce;
};

} // namespace yade

YADE_ABI_ARCHIVED(NormPhys)
YADE_ABI_ARCHIVED(NormShearPhys)
