// Drawing functors of the viewer.
#pragma once

#include <core/Body.hpp>
#include <core/Functor.hpp>
#include <core/IGeom.hpp>
#include <core/IPhys.hpp>
#include <core/Shape.hpp>

namespace yade {

struct GLViewInfo {
	Vector3r sceneCenter;
	Real sceneRadius;
};

class GlShapeFunctor
    : public Functor1D<Shape, void, boost::mpl::vector<const shared_ptr<Shape>&, const shared_ptr<State>&, bool, const GLViewInfo&>> {
	YADE_ABI_CLASS(GlShapeFunctor)
	GlShapeFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

class GlIGeomFunctor : public Functor1D<IGeom, void,
                                        boost::mpl::vector<const shared_ptr<IGeom>&, const shared_ptr<Interaction>&,
                                                           const shared_ptr<Body>&, const shared_ptr<Body>&, bool>> {
	YADE_ABI_CLASS(GlIGeomFunctor)
	GlIGeomFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

class GlIPhysFunctor : public Functor1D<IPhys, void,
                                        boost::mpl::vector<const shared_ptr<IPhys>&, const shared_ptr<Interaction>&,
                                                           const shared_ptr<Body>&, const shared_ptr<Body>&, bool>> {
	YADE_ABI_CLASS(GlIPhysFunctor)
	GlIPhysFunctor() = default;
	virtual string renders() const;
	virtual void initgl();
};

} // namespace yade

/// The class that a drawing functor draws; stands in its body in place of FUNCTOR1D.
#define RENDERS(Class)                                                                                                                     \
public:                                                                                                                                    \
	string renders() const override { return #Class; }                                                                                     \
	FUNCTOR1D(Class)

YADE_ABI_ARCHIVED(GlShapeFunctor)
YADE_ABI_ARCHIVED(GlIGeomFunctor)
YADE_ABI_ARCHIVED(GlIPhysFunctor)
