#pragma once
// Sentences of errors.

#include <sstream>
#include <stdexcept>
#include <string>

namespace yade {

/// The parts, one after the other.
template <class... Parts>
std::string sentence(const Parts&... parts)
{
	std::ostringstream text;
	(text << ... << parts);
	return text.str();
}

/// An object of YADE whose attribute has a value that is not allowed: throws std::invalid_argument, which Python raises as ValueError.
template <class Object, class Value>
[[noreturn]] void reject(const Object& object, const char* attribute, const Value& value, const std::string& allowed)
{
	throw std::invalid_argument(
	    sentence(object.getClassName(), '.', attribute, " = ", value, " is not allowed: it must be ", allowed, '.'));
}

} // namespace yade
