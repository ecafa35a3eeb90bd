#pragma once

#include <core/Bound.hpp>
#include <core/Interaction.hpp>
#include <core/Material.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

class Scene;

class Body : public Serializable {
	YADE_ABI_CLASS(Body)
	Body();
	virtual void userForcedDisplacementRedrawHook();

	using id_t = int;
	static const id_t ID_NONE; // -1
	enum { FLAG_BOUNDED = 1, FLAG_ASPHERICAL = 2, FLAG_SUBDOMAIN = 4, FLAG_FLUIDDOMAINBBOX = 8 };

	/// Null scene: the current one. The id is not checked.
	static const shared_ptr<Body>& byId(id_t, Scene* scene = nullptr);
	static const shared_ptr<Body>& byId(id_t, shared_ptr<Scene>);

	id_t getId() const { return id; }
	bool isDynamic() const { return state->blockedDOFs != State::DOF_ALL; }
	bool isClump() const { return clumpId != -1 && id == clumpId; }
	bool isClumpMember() const { return clumpId != -1 && id != clumpId; }
	bool isStandalone() const { return clumpId == -1; }
	bool maskOk(int mask) const;
	bool maskCompatible(int mask) const;

	id_t id;
	int groupMask;
	int flags;
	int subdomain;
	shared_ptr<Material> material;
	shared_ptr<State> state;
	shared_ptr<Shape> shape;
	shared_ptr<Bound> bound;
	std::map<id_t, shared_ptr<Interaction>> intrs;
	id_t clumpId;
	long iterBorn;
	Real timeBorn;
};

} // namespace yade

YADE_ABI_ARCHIVED(Body)
