#pragma once

#include <core/PartialEngine.hpp>
#include <map>

namespace yade {

class Body;

/// A jump of the base velocity inside the step that ends now.
struct BaseJump {
	Vector3r velocity; // change of velocity, m/s
	Real size;         // the same along the direction of the motion
	Real before;       // the instant lies this long before the end of the step, s
};

/// An impact of this step, as a base motion may answer to it.
struct StepImpact {
	int block;
	Real before; // s before the end of the step
};

/// Base class of prescribed base motions along one direction. The bodies `ids` move by origin + direction displacement(t)
/// exactly at every step; between steps with the mean velocity, so that nothing drifts. Motions of the same bodies in perpendicular
/// directions add up. Goes after RockingJointEngine and before NewtonIntegrator in O.engines; MoreauJeanIntegrator has a list of its own.
class BaseMotionEngine : public PartialEngine {
public:
	void action() override;

	/// Motion along `direction` at a time of it, t = 0 at `start`.
	virtual Real displacement(Real) const { return 0; } // m
	virtual Real velocity(Real) const { return 0; }     // m/s
	virtual Real acceleration(Real) const { return 0; } // m/s^2, jumps left out

	/// Mean velocity over [from, to].
	virtual Real meanVelocity(Real from, Real to) const { return (displacement(to) - displacement(from)) / (to - from); }

	/// Instant of the scene at which the motion is over [s]; infinity where it goes on for ever, or its end is not known yet.
	virtual Real end() const;

	/// First instant in (after, until) at which velocity or acceleration jumps, as far as it is known by now; else infinity.
	virtual Real nextKink(Real after, Real until) const;

	using Motions = vector<BaseMotionEngine*>;
	/// Those of O.engines that are not dead.
	static Motions inEngines(const Scene&);
	/// Throws std::invalid_argument for motions of a body that do not have all their bodies in common or are not perpendicular.
	static void checkTogether(const Motions& all);
	/// Bodies of the other move with it.
	bool shares(const BaseMotionEngine& other) const;

	/// Finds where the bodies stand when the motion begins; called before every step, with all motions of the scene. Once its time has come
	/// it goes on as it is: changed attributes are refused, as they would put the bodies elsewhere at once.
	void begin(const Motions& all);
	/// Place of body number k of ids without any displacement. Each motion knows it along its own direction.
	Vector3r origin(size_t k, const Motions& all) const;
	/// begin() has nothing to do.
	bool goesOn() const;
	/// The bodies are where they are at the end of the present step. One that does not in each step of the scene (it was taken out of
	/// O.engines for a while, or O.resetTime() was called) begins anew: it would put them back.
	void haveStepped();
	/// It has begun with the present step.
	bool beginsNow() const;
	/// Begins anew in the next step that asks for it.
	virtual void forget();
	/// Throws std::invalid_argument for an attribute that a script has changed once the motion's time has come.
	void postLoad(BaseMotionEngine&);

	/// The velocity jumps up to the present time that were not asked for before, in order of time; impacts of this step
	/// may cause them. RockingJointEngine asks, so that blocks respond at the instant itself.
	virtual vector<BaseJump> takeJumps(Real now, const vector<StepImpact>& impacts);

	/// Whether takeJumps must be asked in order of time.
	virtual bool ordered() const { return false; }

	/// Throws std::invalid_argument for what only the finished scene can tell: ids that do not exist or are free to move, an
	/// attribute that is missing or contradicts another, a start that has passed. Called before the first step.
	virtual void check() const;

	/// First instant in (after, until) at which the slope of the acceleration jumps; else infinity.
	virtual Real nextBend(Real, Real) const { return std::numeric_limits<Real>::infinity(); }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BaseMotionEngine, PartialEngine,
		"Base class of prescribed motions of the base; it moves nothing by itself. Motions of the same bodies in perpendicular directions add up.",
		((Vector3r, direction, Vector3r(1, 0, 0), Attr::triggerPostLoad, "Unit vector along which the base moves."))
		((Real, start, 0, Attr::triggerPostLoad, "Time at which the motion begins [s]; from then on its attributes cannot be changed. Use start=O.time for a motion that is added during a run."))
		((vector<Vector3r>, origins, , Attr::readonly, "Positions of the bodies without the displacement of this motion [m].")),
		/* ctor */,
		.add_property("end", &BaseMotionEngine::end, "Time at which the motion is over [s]; infinite if it never ends or its end is not known yet (a resonant train).")
		.def("check", &BaseMotionEngine::checkNow, "Raises ValueError unless the attributes are complete and every body of ids exists and is prescribed. It is called before the first step.")
	);
	// clang-format on
protected:
	/// Now, in the present scene or in the one it was saved from.
	bool hasBegun() const;

private:
	using Settings = std::map<string, string>; // attributes that scripts may set, as Python prints them

	Settings settings() const;
	/// Its time has come in the present scene.
	bool underWay() const;
	bool wasLeftOut() const;
	/// As a script asks: in the present scene.
	void checkNow();
	void checkStart() const;
	void checkPlaces() const;
	/// The bodies are where `all` motions have brought them.
	bool isInPlace(const Motions& all) const;
	/// Bodies that would change their velocity at once. `others`: those that move the same bodies, itself included.
	void warnOfSpeeds(const Motions& others) const;
	/// Those of `all` that move the same bodies, itself included.
	Motions together(const Motions& all) const;
	void takeOrigins();
	[[noreturn]] void refuseChange(const string& attribute, const string& value, const string& before) const;

	// State of the motion that has begun; nothing yet after loading.
	boost::weak_ptr<Scene> home;
	Settings begun;
	vector<int> begunIds;
	Motions begunWith;               // to be compared only
	vector<const Body*> begunBodies; // the same
	Real begunStart = NaN, begunAt = NaN;
	long lastStep = -1; // not known
};
REGISTER_SERIALIZABLE(BaseMotionEngine);

} // namespace yade
