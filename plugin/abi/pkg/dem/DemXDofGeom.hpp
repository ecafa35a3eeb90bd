#pragma once

#include <core/IGeom.hpp>

namespace yade {

/// What YADE's time stepper casts geometries to. YADE leaves both vectors unset: the derived class must set them.
class GenericSpheresContact : public IGeom {
	YADE_ABI_CLASS(GenericSpheresContact)
	YADE_ABI_INDEX
	GenericSpheresContact() { createIndex(); }

	Vector3r normal;
	Vector3r contactPoint;
	Real refR1 = 0;
	Real refR2 = 0;
};

} // namespace yade

YADE_ABI_ARCHIVED(GenericSpheresContact)
