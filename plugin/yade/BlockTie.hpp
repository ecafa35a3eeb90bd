#pragma once

#include <core/GlobalEngine.hpp>

namespace yade {

class Body;

/// A tie between two blocks, or a block and its base, in the `ties` of the engine of the joints (dynamics/model/tie.hpp).
class BlockTie : public GlobalEngine {
public:
	/// Throws std::logic_error: it acts from the engine of the joints.
	void action() override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(BlockTie&);
	/// The same for what only the finished scene can tell: its bodies and their places.
	void check(const Scene&) const;
	/// Places of the two points now, in the scene.
	static Vector3r placeOf(const Body& body, const Vector3r& point);
	vector<Vector3r> places() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BlockTie, GlobalEngine,
		"A tie or an anchor: a straight elastic bar without mass between a point of one block and a point of another block, or of a base. dem.tie() makes it. It belongs in MoreauJeanIntegrator.ties or RockingJointEngine.ties and not in O.engines; one that is `dead` does not act. Its force is pretension + stiffness * extension, with tensionOnly at least 0. stiffness, pretension, strength and tensionOnly may be changed during a run.",
		((int, body1, -1, Attr::triggerPostLoad, "Id of the first body."))
		((int, body2, -1, Attr::triggerPostLoad, "Id of the second body."))
		((Vector3r, point1, Vector3r::Zero(), Attr::triggerPostLoad, "Where it is fixed to body 1, from the centre, in the body's own axes [m]."))
		((Vector3r, point2, Vector3r::Zero(), Attr::triggerPostLoad, "Where it is fixed to body 2, from the centre, in the body's own axes [m]."))
		((Real, length, NaN, Attr::triggerPostLoad, "Length at which its force is the pretension [m]; NaN: the distance of the points before the first step. Where compliant joints settle under the weight before the first step, it follows, and the force stays."))
		((Real, stiffness, NaN, Attr::triggerPostLoad, "Force per extension, E A / L of a bar [N/m]."))
		((Real, pretension, 0, Attr::triggerPostLoad, "Force at the given length [N]."))
		((Real, strength, std::numeric_limits<Real>::infinity(), Attr::triggerPostLoad, "Tensile force at which it breaks for good [N]."))
		((bool, tensionOnly, true, , "Whether it goes slack (true) or also presses (false)."))
		((bool, broken, false, Attr::readonly, "Whether it has reached its strength."))
		((Real, brokenAt, NaN, Attr::readonly, "End of the step in which it has broken [s]."))
		((Real, force, 0, Attr::readonly, "Force in it, tension positive: the mean of the last step, with compliant joints that at its beginning [N]."))
		((Real, extension, 0, Attr::readonly, "Change of its length after the last step [m]."))
		((Real, energy, NaN, Attr::readonly, "Its elastic energy after the last step [J].")),
		/* ctor */,
		.add_property("places", &BlockTie::places, "Places of its two points now, in the world [m].")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(BlockTie);

} // namespace yade
