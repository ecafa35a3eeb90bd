#pragma once
// The caller chooses these for the steps of `localised`.
#include "impact/rocking_restitution.hpp"

namespace masonry::localised {

struct Settings {
	double tolerance {1e-9}; // residual of a step's contact laws, as a share of the speed that gravity gives in it; its parts aim at theirs
	ImpactOrder order {ImpactOrder::simultaneous};
	double merged {1e-6}; // closings within this gap, relative to the smallest half size, are one impact: a model parameter
	int mostEvents {50};  // found inside one step; points that close later in it do so at its end, plastically
};

} // namespace masonry::localised
