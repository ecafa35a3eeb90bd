#pragma once
// The impacts of a run (dem.impacts()): MoreauJeanIntegrator and RockingJointEngine have one attribute for each column.

#include <core/GlobalEngine.hpp>

// clang-format off
/// Stands among the attributes of an engine.
#define MASONRY_IMPACT_COLUMNS \
	((vector<Real>, impactTimes, , Attr::readonly, "Time of each impact [s], inside the step.")) \
	((vector<int>, impactBlocks, , Attr::readonly, "Block that rocks, at each impact.")) \
	((vector<int>, impactSupports, , Attr::readonly, "Body on which it rocks, at each impact.")) \
	((vector<Real>, impactAsked, , Attr::readonly, "Restitution that was asked for; NaN: natural.")) \
	((vector<Real>, impactBefore, , Attr::readonly, "Relative angular velocity before the impact [rad/s].")) \
	((vector<Real>, impactAfter, , Attr::readonly, "Relative angular velocity after the impact [rad/s].")) \
	((vector<Real>, impactEnergy, , Attr::readonly, "Kinetic energy lost at the impact [J].")) \
	((vector<Real>, impactApplication, , Attr::readonly, "Distance of the resultant impulse from the new pivot, inward positive [m].")) \
	((vector<Real>, impactFriction, , Attr::readonly, "Friction coefficient that the impact uses: tangential over normal impulse. If it equals that of the joint, the pivot has slipped; an impact without slip would need more.")) \
	((vector<int>, impactSwitched, , Attr::readonly, "1: the block rocks on about the other pivot; 0: the joint came to rest.")) \
	((vector<int>, impactCapped, , Attr::readonly, "1: the restitution that was asked for was not reached. It was lowered so that energy does not grow, or no value satisfies the laws."))
// clang-format on

namespace yade {

/// `ofJoint`: result of the law. energy: lost, J.
template <class Engine, class JointResult>
void addImpact(Engine& engine, Real time, int block, int support, Real asked, const JointResult& ofJoint, Real energy, bool switched,
               bool capped)
{
	engine.impactTimes.push_back(time);
	engine.impactBlocks.push_back(block);
	engine.impactSupports.push_back(support);
	engine.impactAsked.push_back(asked);
	engine.impactBefore.push_back(ofJoint.before);
	engine.impactAfter.push_back(ofJoint.after);
	engine.impactEnergy.push_back(energy);
	engine.impactApplication.push_back(ofJoint.application);
	engine.impactFriction.push_back(ofJoint.frictionDemand);
	engine.impactSwitched.push_back(switched);
	engine.impactCapped.push_back(capped);
}

template <class... Results>
void forget(Results&... results)
{
	((results = {}), ...);
}

template <class Engine>
void forgetImpacts(Engine& engine)
{
	forget(engine.impactTimes, engine.impactBlocks, engine.impactSupports, engine.impactAsked, engine.impactBefore, engine.impactAfter,
	       engine.impactEnergy, engine.impactApplication, engine.impactFriction, engine.impactSwitched, engine.impactCapped);
}

} // namespace yade
