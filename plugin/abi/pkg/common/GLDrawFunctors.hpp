// These functors draw bodies and contacts in YADE's Qt viewer.
#pragma once

#include <core/Body.hpp>
#include <core/Functor.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>
#include <core/Interaction.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

struct GLViewInfo {
	Vector3r sceneCenter = Vector3r::Zero();
	Real sceneRadius = 1;
};

/// Gl1_*: draws a shape, in the axes of its body.
class GlShapeFunctor
    : public Functor1D<Shape, void, boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<State>&, bool, const GLViewInfo&>> {
	YADE_ABI_CLASS(GlShapeFunctor)
	GlShapeFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

/// Gl1_*: draws the geometry of a contact, in the axes of the world.
class GlIGeomFunctor : public Functor1D<IGeom, void,
                                        boost::mpl::vector<const shared_ptr<IGeom>&, const shared_ptr<Interaction>&,
                                                           const shared_ptr<Body>&, const shared_ptr<Body>&, bool>> {
	YADE_ABI_CLASS(GlIGeomFunctor)
	GlIGeomFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

/// Gl1_*: draws what acts in a contact, in the axes of the world.
class GlIPhysFunctor : public Functor1D<IPhys, void,
                                        boost::mpl::vector<const shared_ptr<IPhys>&, const shared_ptr<Interaction>&,
                                                           const shared_ptr<Body>&, const shared_ptr<Body>&, bool>> {
	YADE_ABI_CLASS(GlIPhysFunctor)
	GlIPhysFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

} // namespace yade

/// The class that a functor draws; stands in its body.
#define RENDERS(Class)                                                                                                                     \
public:                                                                                                                                    \
	string renders() const override { return #Class; }                                                                                     \
	FUNCTOR1D(Class)

YADE_ABI_ARCHIVED(GlShapeFunctor)
YADE_ABI_ARCHIVED(GlIGeomFunctor)
YADE_ABI_ARCHIVED(GlIPhysFunctor)
