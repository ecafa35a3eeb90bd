#pragma once
// The numbers that the passes of a solve need follow from the context of the step and from the settings.
#include "dynamics/wall/admm_solver.hpp"
#include "tolerances.hpp"
#include <cmath>

namespace masonry::wall {

// For rows of mortar.
inline RowStep rowStepOf(const StepContext& c, const AdmmSettings& a)
{
	return {mortarTime(c), c.instant ? c.speed : c.fall, a.softness, a.minSoftness, a.relaxation, a.boundShare};
}

// For contact points; `atRest`: the structure is at rest.
inline Step stepOf(const StepContext& c, const AdmmSettings& a, bool atRest)
{
	const double filter = a.filterTime * c.rocking;
	return {c.h,
	        1 / c.h,
	        c.fall,
	        c.instant    ? 0
	        : filter > 0 ? -std::expm1(-c.h / filter)
	                     : 1,
	        a.reach * c.length,
	        a.leftPenetration * c.length,
	        atRest ? a.restSoftness : a.softness,
	        atRest ? a.restFollows : a.follows,
	        a.minSoftness,
	        a.relaxation,
	        a.boundShare,
	        c.instant ? 0 : a.pullBack,
	        a.soundSoftness,
	        a.tolerance * c.fall / a.soundShare,
	        c.instant ? tolerance::wall::touching * c.length : -farAway,
	        a.strictForces,
	        false,
	        false};
}

} // namespace masonry::wall
