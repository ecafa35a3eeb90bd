#pragma once

#include "BaseMotionEngine.hpp"
#include "motion/pulse_train.hpp"

namespace yade {

/// Casapulla and Maione's pulse train: velocity jumps I, -2I, +2I, ... of the base.
class PulseTrainEngine : public BaseMotionEngine {
public:
	void check() const override;
	void forget() override;
	Real displacement(Real) const override;
	Real velocity(Real) const override;
	Real acceleration(Real) const override;
	Real meanVelocity(Real from, Real to) const override;
	Real end() const override;
	Real nextKink(Real after, Real until) const override;
	vector<BaseJump> takeJumps(Real now, const vector<StepImpact>& impacts) override;
	bool ordered() const override { return true; }
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(PulseTrainEngine&);

	Real residualDisplacement() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(PulseTrainEngine, BaseMotionEngine,
		"Pulse train of the base (Casapulla and Maione): jumps of the base velocity by I, -2I, +2I, ..., so that the base moves at +I, -I, +I, ... Scheduled (times) or resonant (resonantBlock: each pulse right after an impact of that block). A Dirac pulse acts at its instant inside the step.",
		((Real, impulse, NaN, Attr::triggerPostLoad, "Pulse impulse I: jump of the base velocity [m/s]."))
		((vector<Real>, times, , Attr::triggerPostLoad, "Scheduled pulses: their times after start [s], increasing."))
		((int, resonantBlock, -1, Attr::triggerPostLoad, "Resonant pulses: the block whose impacts release them. The first pulse comes at start."))
		((int, halfCycles, -1, Attr::triggerPostLoad, "Resonant pulses: number of half cycles after which a last pulse of size I brings the base to rest; -1: the train does not end."))
		((bool, assembly, false, Attr::triggerPostLoad, "Scheduled pulses: the last one has the size I and brings the base to rest (assembly units I, -2I, I)."))
		((string, shape, "dirac", Attr::triggerPostLoad, "How a jump is spread over `duration`: 'dirac', 'rectangular' (constant acceleration) or 'half-sine'."))
		((Real, duration, 0, Attr::triggerPostLoad, "Duration of a pulse of 2I [s]; positive unless shape is 'dirac'."))
		((string, singleKeeps, "amplitude", Attr::triggerPostLoad, "What pulses of size I (the first; the last, if it brings the base to rest) have in common with those of size 2I: 'amplitude' (they take half the duration) or 'duration' (they have half the amplitude)."))
		((vector<Real>, pulseTimes, , Attr::readonly, "Times of the pulses so far, after start [s]."))
		((vector<Real>, pulseJumps, , Attr::readonly, "Velocity jumps of the pulses so far [m/s].")),
		/* ctor */,
		.add_property("residualDisplacement", &PulseTrainEngine::residualDisplacement, "Displacement of the base along `direction` [m]; after the last pulse of a train that ends, the displacement that remains.")
	);
	// clang-format on
private:
	bool resonant() const { return resonantBlock >= 0; }
	bool dirac() const { return released.train.pulse.shape == masonry::PulseShape::Dirac; }
	void release(Real time, vector<BaseJump>& jumps, Real now);

	masonry::ReleasedPulses released; // as attributes and pulseTimes say
};
REGISTER_SERIALIZABLE(PulseTrainEngine);

} // namespace yade
