#pragma once
// Energy that the steps of a run make or lose and nothing accounts for. Gains and losses are summed apart: a run that gives in one step and
// takes in another is wrong in both.
#include "tolerances.hpp"
#include <algorithm>

namespace masonry {

// Returns the bound of either sum, J. `turnedOver` is the largest kinetic and elastic energy so far plus all that has been dissipated.
// `lift` is the energy that lifts all blocks by their size.
inline double maxUnexplained(double turnedOver, double lift, double share = tolerance::madeShare)
{
	return share * turnedOver + tolerance::madeLift * lift;
}

// Returns whether a run has to tell of a sum, J, above its bound: the first time, and each time that it has grown tenfold since.
// `told` is the sum of which it has told last, or 0.
inline bool isWorthTelling(double sum, double bound, double& told)
{
	constexpr double growth = 10;
	if (!(sum > std::max(bound, growth * told)))
		return false;
	told = sum;
	return true;
}

// The errors of one step of rigid blocks, J. `kinetic` belongs to its start.
struct StepErrors {
	double made {0}, lost {0}, kinetic {0}, lift {0};

	// Adds the errors of a structure that is stepped apart.
	StepErrors& operator+=(const StepErrors& other)
	{
		made += other.made;
		lost += other.lost;
		kinetic += other.kinetic;
		lift += other.lift;
		return *this;
	}
};

} // namespace masonry
