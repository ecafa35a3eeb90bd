#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "BlockGeom.hpp"
#include "BlockMat.hpp"
#include "BlockPhys.hpp"
#include <algorithm>
#include <cmath>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Ip2_BlockMat_BlockMat_BlockPhys));

namespace {
Real given(Real a, Real b, Real both) { return std::isnan(a) ? b : std::isnan(b) ? a : both; }

/// A surface without friction, against which nothing sticks.
bool isSmooth(const BlockMat& material) { return !material.noSlip && material.frictionAngle == 0; }
} // namespace

void Ip2_BlockMat_BlockMat_BlockPhys::go(const shared_ptr<Material>& material1, const shared_ptr<Material>& material2,
                                         const shared_ptr<Interaction>& interaction)
{
	if (interaction->phys)
		return;
	const auto& a = static_cast<const BlockMat&>(*material1);
	const auto& b = static_cast<const BlockMat&>(*material2);
	const auto matched = [&](const shared_ptr<MatchMaker>& maker, Real va, Real vb, Real rule) {
		return maker ? (*maker)(a.id, b.id, va, vb) : given(va, vb, rule);
	};
	const auto harmonic = [](Real x, Real y) { return 2 * x * y / (x + y); };

	shared_ptr<BlockPhys> phys(new BlockPhys);
	phys->restitution = matched(restitution, a.restitution, b.restitution, 0.5 * (a.restitution + b.restitution));
	const Real angle = matched(frictionAngle, a.frictionAngle, b.frictionAngle, std::min(a.frictionAngle, b.frictionAngle));
	phys->tangensOfFrictionAngle =
	    angle >= 0 && angle < M_PI / 2 ? std::tan(angle) : NaN; // who reads it refuses NaN; no error may leave the loop of the functors
	phys->normalStiffness = matched(normalStiffness, a.normalStiffness, b.normalStiffness, harmonic(a.normalStiffness, b.normalStiffness));
	phys->shearStiffness = matched(shearStiffness, a.shearStiffness, b.shearStiffness, harmonic(a.shearStiffness, b.shearStiffness));
	phys->noSlip = (a.noSlip || b.noSlip) && !isSmooth(a) && !isSmooth(b);
	const bool isHead = isHeadJoint(static_cast<const BlockGeom&>(*interaction->geom).normal);
	const shared_ptr<JointMat> ofA = a.mortarOf(isHead), ofB = b.mortarOf(isHead);
	if (ofA && ofB && ofA->isLike(*ofB))
		phys->takeMortar(ofA);
	interaction->phys = phys;
}

} // namespace yade
