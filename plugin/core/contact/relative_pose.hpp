#pragma once
// One body seen from another.
#include "math.hpp"

namespace masonry {

struct RelativePose {
	Matrix3 rotation; // columns: the other body's axes in the frame of the first
	Vector3 offset;   // m, the other body's centre in that frame

	RelativePose reversed() const { return {rotation.transpose(), -(rotation.transpose() * offset)}; }
};

} // namespace masonry
