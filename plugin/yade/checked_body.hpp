#pragma once
// Checks of a block's parts, for rigid and compliant joints alike.

#include "BlockMat.hpp"
#include "block_shape.hpp"
#include "sentence.hpp"
#include <core/Body.hpp>

namespace yade {

/// Whether MoreauJeanIntegrator handles the body.
inline bool isBlock(const Body& body)
{
	return dynamic_cast<const BlockMat*>(body.material.get()) && body.shape && BlockShape::isOne(*body.shape);
}

/// Throws for a member of a clump, and unless half sizes, mass and moments of inertia are numbers whose squares, and those of their
/// inverses, single precision holds.
inline void checkBody(const Body& body)
{
	constexpr Real least = 1e-18, most = 1e18;
	const auto check = [&](const char* attribute, const auto& values, const char* unit) {
		for (int k = 0; k < int(values.size()); ++k) {
			if (values[k] >= least && values[k] <= most)
				continue;
			const std::string place = values.size() > 1 ? sentence('[', k, ']') : "";
			throw std::invalid_argument(sentence("O.bodies[", body.id, "].", attribute, place, " = ", values[k],
			                                     " is not allowed for a block: it must be from ", least, " to ", most, ' ', unit, '.'));
		}
	};
	if (body.isClumpMember())
		throw std::invalid_argument(sentence("O.bodies[", body.id, "] is a member of a clump: blocks cannot be clumped."));
	if (const auto* box = dynamic_cast<const Box*>(body.shape.get()))
		check("shape.extents", box->extents, "m");
	else if (!BlockShape(*body.shape).solid())
		throw std::invalid_argument(
		    sentence("O.bodies[", body.id, "].shape.vertices = [] is not allowed for a block: dem.convex() makes one."));
	if (!body.isDynamic())
		return;
	check("state.mass", Eigen::Matrix<Real, 1, 1>(body.state->mass), "kg");
	check("state.inertia", body.state->inertia, "kg m^2");
}

} // namespace yade
