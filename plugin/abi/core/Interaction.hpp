#pragma once

#include <core/IGeom.hpp>
#include <core/IPhys.hpp>

namespace yade {

class IGeomFunctor;
class IPhysFunctor;
class LawFunctor;
class Scene;

/// A pair of bodies; `real` once both geometry and physics are set.
class Interaction : public Serializable {
	YADE_ABI_CLASS(Interaction)
	Interaction();
	Interaction(int id1, int id2);
	boost::python::dict pyDictCustom() const override;

	bool isReal() const { return geom && phys; }
	bool isFresh(Scene*); // made real in this step
	void reset();
	void swapOrder();
	int getId1() const { return id1; }
	int getId2() const { return id2; }

	bool isActive;
	struct {
		bool geomExists;
		shared_ptr<IGeomFunctor> geom;
		shared_ptr<IPhysFunctor> phys;
		shared_ptr<LawFunctor> constLaw;
	} functorCache;
	int id1;
	int id2;
	long iterMadeReal;
	long iterLastSeen;
	shared_ptr<IGeom> geom;
	shared_ptr<IPhys> phys;
	Vector3i cellDist;
	int linIx;
	long iterBorn;
};

} // namespace yade

YADE_ABI_ARCHIVED(Interaction)
