#pragma once
// A tie of the scene in the core's form, and back. No physics here.

#include "BlockTie.hpp"
#include "dynamics/model/tie.hpp"
#include <array>

namespace yade {

/// Returns whether any was another one.
template <class K>
bool takeAttributes(const BlockTie& from, masonry::Tie<K>& to)
{
	const auto values = [&] { return std::array<Real, 5> {to.length, to.stiffness, to.pretension, to.strength, Real(to.tensionOnly)}; };
	const auto before = values();
	to.length = from.length;
	to.stiffness = from.stiffness;
	to.pretension = from.pretension;
	to.strength = from.strength;
	to.tensionOnly = from.tensionOnly;
	return values() != before;
}

/// Its state at that time.
template <class K>
void writeTie(const masonry::Tie<K>& from, Real time, BlockTie& to)
{
	if (from.broken != to.broken)
		to.brokenAt = from.broken ? time : NaN;
	to.broken = from.broken;
	to.force = from.broken ? 0 : from.force;
	to.length = from.length;
	to.extension = from.extension;
	to.energy = from.energy;
}

} // namespace yade
