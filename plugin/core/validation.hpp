#pragma once
// Refusals of bad input: std::invalid_argument (ValueError in Python) naming attribute, value and allowed range.
// Every comparison is written so that NaN is refused.

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace masonry {

inline void require(const std::string& attribute, double value, bool allowed, const std::string& range)
{
	if (allowed)
		return;
	std::ostringstream text;
	text.precision(12);
	text << attribute << " = " << value << ": " << range;
	throw std::invalid_argument(text.str());
}

inline void requirePositive(const std::string& attribute, double value)
{
	require(attribute, value, value > 0 && std::isfinite(value), "must be > 0 and finite");
}

inline void requireFinite(const std::string& attribute, double value) { require(attribute, value, std::isfinite(value), "must be finite"); }

} // namespace masonry
