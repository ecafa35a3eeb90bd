#include "BlockTie.hpp"
#include "checked_body.hpp"

#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((BlockTie));

void BlockTie::action()
{
	throw std::logic_error("BlockTie is in O.engines: a tie acts in MoreauJeanIntegrator.ties or RockingJointEngine.ties instead, where "
	                       "dem.engines() puts it.");
}

void BlockTie::postLoad(BlockTie&)
{
	for (const auto& [name, point] : {std::pair("point1", point1), std::pair("point2", point2)})
		if (!point.allFinite())
			reject(*this, name, point.transpose(), "three finite numbers in m");
	if (length <= 0)
		reject(*this, "length", length, "positive, in m");
	if (stiffness <= 0 || std::isinf(stiffness))
		reject(*this, "stiffness", stiffness, "positive and finite, in N/m");
	if (!std::isfinite(pretension))
		reject(*this, "pretension", pretension, "a finite number in N");
	if (!(strength > 0))
		reject(*this, "strength", strength, "positive, in N");
}

void BlockTie::check(const Scene& of) const
{
	for (const auto& [name, id] : {std::pair("body1", body1), std::pair("body2", body2)})
		if (!of.bodies->exists(id) || !isBlock(*(*of.bodies)[id]))
			reject(*this, name, id, "the id of a block or a base (a Box or a ConvexBlock with a BlockMat)");
	if (body1 == body2)
		reject(*this, "body2", body2, "another body than body1");
	const Body &first = *(*of.bodies)[body1], &second = *(*of.bodies)[body2];
	if (!first.isDynamic() && !second.isDynamic())
		reject(*this, "body2", body2, "a free block where body1 is prescribed");
	if (std::isnan(stiffness))
		reject(*this, "stiffness", stiffness, "given, in N/m");
	if (!((placeOf(first, point1) - placeOf(second, point2)).norm() > 0))
		reject(*this, "point2", point2.transpose(), "apart from point1");
}

Vector3r BlockTie::placeOf(const Body& body, const Vector3r& point) { return body.state->pos + body.state->ori * point; }

vector<Vector3r> BlockTie::places() const
{
	const auto& bodies = *Omega::instance().getScene()->bodies;
	vector<Vector3r> result;
	for (const auto& [id, point] : {std::pair(body1, point1), std::pair(body2, point2)})
		result.push_back(bodies.exists(id) ? placeOf(*bodies[id], point) : Vector3r(Vector3r::Constant(NaN)));
	return result;
}

} // namespace yade
