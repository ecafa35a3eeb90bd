#pragma once

#include <core/IGeom.hpp>
#include <core/Interaction.hpp>
#include <core/State.hpp>
#include <pkg/dem/DemXDofGeom.hpp>

namespace yade {

class Scene;

class ScGeom : public GenericSpheresContact {
	YADE_ABI_CLASS(ScGeom)
	YADE_ABI_INDEX
	ScGeom();

	Vector3r& rotate(Vector3r& shear) const;
	Vector3r getIncidentVel(const State*, const State*, Real dt, bool avoidGranularRatcheting) const;
	Vector3r getRelAngVel(const State*, const State*, Real dt) const;
	void precompute(const State&, const State&, const Scene*, const shared_ptr<Interaction>&, const Vector3r& normal, bool isNew,
	                const Vector3r& shift2, bool avoidGranularRatcheting);

	Vector3r twist_axis;
	Vector3r orthonormal_axis;
	Real& radius1; // refR1
	Real& radius2; // refR2
	Real penetrationDepth;
	Vector3r shearInc;
};

} // namespace yade

YADE_ABI_ARCHIVED(ScGeom)
