// The four functor families of a time step, and the dispatchers that hold them.
#pragma once

#include <core/Aabb.hpp>
#include <core/Dispatcher.hpp>
#include <core/Functor.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>
#include <core/Interaction.hpp>
#include <core/Scene.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

/// Bo1_*: makes the bound of a shape.
class BoundFunctor
    : public Functor1D<Shape, void, boost::mpl::vector<const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*>> {
	YADE_ABI_CLASS(BoundFunctor)
	BoundFunctor() = default;
};

/// Ig2_*: geometry of a pair of shapes. True when they touch (or touched before); then I->geom must be set.
class IGeomFunctor : public Functor2D<Shape, Shape, bool,
                                      boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&,
                                                         const Vector3r&, const bool&, const shared_ptr<Interaction>&>> {
	YADE_ABI_CLASS(IGeomFunctor)
	IGeomFunctor() = default;
	virtual void preStep();
};

/// Ip2_*: physics of a pair of materials; called every step, must leave I->phys set.
class IPhysFunctor
    : public Functor2D<Material, Material, void,
                       boost::mpl::vector<const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&>> {
	YADE_ABI_CLASS(IPhysFunctor)
	IPhysFunctor() = default;
};

/// Law2_*: forces. False drops the contact.
class LawFunctor : public Functor2D<IGeom, IPhys, bool, boost::mpl::vector<shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*>> {
	YADE_ABI_CLASS(LawFunctor)
	LawFunctor() = default;

	void addForce(const int id, const Vector3r& force, Scene* in) { in->forces.addForce(id, force); }
	void addTorque(const int id, const Vector3r& torque, Scene* in) { in->forces.addTorque(id, torque); }
	/// Force on the first body, its opposite on the second, both acting at the point.
	void applyForceAtContactPoint(const Vector3r& force, const Vector3r& point, const int id1, const Vector3r& position1, const int id2,
	                              const Vector3r& position2)
	{
		addForce(id1, force, scene);
		addForce(id2, -force, scene);
		addTorque(id1, (point - position1).cross(force), scene);
		addTorque(id2, -(point - position2).cross(force), scene);
	}
};

/// The matrix of functors by class index; a base without virtual functions in YADE.
struct alignas(8) DispatchTable {
	unsigned char undeclared[48];
};

// The dispatchers are read, never derived from: not all of their virtual functions are declared.
class BoundDispatcher final : public Dispatcher {
	YADE_ABI_CLASS(BoundDispatcher)
	bool isActivated() override;
	void action() override;
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

	DispatchTable table;
	vector<shared_ptr<BoundFunctor>> functors;
	bool activated;
	Real sweepDist;
	Real minSweepDistFactor;
	Real updatingDispFactor;
	Real targetInterv;
};

class IGeomDispatcher final : public Dispatcher {
	YADE_ABI_CLASS(IGeomDispatcher)
	void action() override;
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

	DispatchTable table;
	bool alreadyWarned;
	vector<shared_ptr<IGeomFunctor>> functors;
};

class IPhysDispatcher final : public Dispatcher {
	YADE_ABI_CLASS(IPhysDispatcher)
	void action() override;
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

	DispatchTable table;
	vector<shared_ptr<IPhysFunctor>> functors;
};

class LawDispatcher final : public Dispatcher {
	YADE_ABI_CLASS(LawDispatcher)
	void action() override;
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

	DispatchTable table;
	vector<shared_ptr<LawFunctor>> functors;
};

} // namespace yade

YADE_ABI_ARCHIVED(BoundFunctor)
YADE_ABI_ARCHIVED(IGeomFunctor)
YADE_ABI_ARCHIVED(IPhysFunctor)
YADE_ABI_ARCHIVED(LawFunctor)
