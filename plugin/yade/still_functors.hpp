#pragma once
// An InteractionLoop for other bodies calls these for a pair of rigid blocks: nothing happens, the interaction stays.

#include <core/Dispatching.hpp>

namespace yade {

struct StillGeometry final : IGeomFunctor {
	bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&, const Vector3r&, const bool&,
	        const shared_ptr<Interaction>&) override
	{
		return true;
	}
};

struct StillLaw final : LawFunctor {
	bool go(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*) override { return true; }
};

/// The loop looks functors up once and keeps them with the interaction.
inline void keepStill(Interaction& interaction, const shared_ptr<IPhysFunctor>& physics)
{
	static const shared_ptr<IGeomFunctor> geometry(new StillGeometry);
	static const shared_ptr<LawFunctor> law(new StillLaw);
	interaction.functorCache.geomExists = true;
	interaction.functorCache.geom = geometry;
	interaction.functorCache.phys = physics;
	interaction.functorCache.constLaw = law;
}

} // namespace yade
