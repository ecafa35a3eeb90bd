#pragma once

#include "BaseMotionEngine.hpp"
#include "motion/base_motion.hpp"

namespace yade {

/// An accelerogram as base motion: linear between its samples, integrated exactly.
class RecordMotionEngine : public BaseMotionEngine {
public:
	void check() const override;
	Real displacement(Real t) const override { return motion.displacement(t); }
	Real velocity(Real t) const override { return motion.velocity(t); }
	Real acceleration(Real t) const override { return motion.acceleration(t); }
	Real end() const override;
	Real nextKink(Real after, Real until) const override;
	Real nextBend(Real after, Real until) const override;
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(RecordMotionEngine&);

	masonry::BaseMotion motion;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(RecordMotionEngine, BaseMotionEngine,
		"Accelerogram as base motion: linear between its samples, zero after the last, integrated exactly. The constructor also takes displacement=[...] (m) or velocity=[...] (m/s) instead of samples, and unit='g', 'mm', ...: a smooth motion that ends exactly where they end, as masonry.Record makes it.",
		((vector<Real>, samples, , Attr::triggerPostLoad, "Accelerations [m/s^2], the first at `start`."))
		((Real, interval, 0.01, Attr::triggerPostLoad, "Time between samples [s]."))
		((Real, scale, 1, Attr::triggerPostLoad, "Factor on the samples."))
		((string, baseline, "none", Attr::triggerPostLoad, "What is subtracted so that the base does not drift: 'none'; 'constant' (the mean acceleration: the last velocity is zero); 'linear' (the slope of the line through the origin that fits the velocity best)."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(RecordMotionEngine);

} // namespace yade
