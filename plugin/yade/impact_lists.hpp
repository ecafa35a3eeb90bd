#pragma once
// The impacts of a run, as both engines that make them list them: one attribute a column (dem.impacts()).

#include <lib/base/Math.hpp>

namespace yade {

/// `ofJoint`: what the law says of it. energy: lost, J.
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
