#pragma once

#include <lib/serialization/Serializable.hpp>

namespace yade {

/// A value for a pair of materials: by their ids, else from the two values by a rule (`avg`, `min`, `val`, ...).
class MatchMaker : public Serializable {
	YADE_ABI_CLASS(MatchMaker)
	MatchMaker();

	Real operator()(const int id1, const int id2, const Real value1 = NaN, const Real value2 = NaN) const;

private:
	unsigned char undeclared[160 - sizeof(Serializable)];
};

} // namespace yade

YADE_ABI_ARCHIVED(MatchMaker)
