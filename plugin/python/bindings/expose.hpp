#pragma once
// The module is exposed by one function an area. Arguments that differ between cases are one-dimensional float64 arrays of
// equal length; the Python package broadcasts before it calls.

#include "arrays.hpp"
#include "motion/base_motion.hpp"
#include "rocking/history.hpp"
#include "rocking/rocking_block.hpp"
#include <functional>

namespace masonry::python {

// Many blocks, one a case: rectangles by (half width, half height, gravity), others by (lever about the right edge, about the left one,
// height of the centre of mass, radius of gyration squared, gravity).
struct Blocks {
	std::vector<std::vector<double>> columns;

	size_t size() const { return columns[0].size(); }
	RockingPrism operator[](size_t i) const
	{
		const auto of = [this, i](size_t column) { return columns[column][i]; };
		if (columns.size() == 3)
			return RockingBlock(of(0), of(1), of(2));
		return RockingPrism(of(0), of(1), of(2), of(3), of(4));
	}
	RockingBlock symmetric(size_t i) const; // std::invalid_argument if it is not
};
Blocks toBlocks(const py::object& tuple);

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
