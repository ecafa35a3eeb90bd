#pragma once
// Energy that the steps of a run make or lose and nothing accounts for. Gains and losses are summed apart: a run that gives in one step and
// takes in another is wrong in both.
#include "tolerances.hpp"

namespace masonry {

// What either sum may come to, J. `turnedOver`: the largest kinetic and elastic energy so far and all that has been dissipated; `lift`:
// what lifts all blocks by their size.
inline double mostUnexplained(double turnedOver, double lift) { return tolerance::madeShare * turnedOver + tolerance::madeLift * lift; }

// Of one step of rigid blocks, J: kinetic energy at its start; `lift` as above.
struct StepErrors {
	double made {0}, lost {0}, kinetic {0}, lift {0};

	// Of structures that are stepped apart.
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
