#pragma once
// What the module exposes, one function an area. Arguments that differ between cases are one-dimensional float64 arrays of
// equal length; the Python package broadcasts before it calls.

#include "arrays.hpp"
#include "motion/base_motion.hpp"
#include "rocking/history.hpp"
#include "rocking/rocking_block.hpp"
#include <functional>

namespace masonry::python {

// Many blocks, one a case.
struct Blocks {
	std::vector<double> halfWidth, halfHeight, gravity;

	size_t size() const { return halfWidth.size(); }
	RockingBlock operator[](size_t i) const { return RockingBlock(halfWidth[i], halfHeight[i], gravity[i]); }
};
Blocks toBlocks(const py::object& tuple); // (half_width, half_height, gravity)

// One base motion a case, or one for all; either known in time or a resonant train.
struct Motions {
	size_t size;
	std::function<BaseMotion(size_t)> motion;
	std::function<PulseTrain(size_t)> train; // empty unless resonant

	size_t place(size_t i) const { return size == 1 ? 0 : i; }
};

void exposeBoxes();
void exposeClosedForm();
void exposeMotion();
void exposeShapes();
void exposeHistory();

} // namespace masonry::python
