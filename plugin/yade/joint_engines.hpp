#pragma once
// MoreauJeanIntegrator and RockingJointEngine have these attributes in common, besides the columns of impact_columns.hpp: the order of
// impacts, ties and energies.

#include "BlockTie.hpp"
#include "sentence.hpp"
#include <core/EnergyTracker.hpp>
#include <core/Scene.hpp>
#include <initializer_list>
#include <utility>

namespace yade {

template <class Engine>
void checkOrderAndTies(const Engine& engine)
{
	if (engine.impactOrder != "simultaneous" && engine.impactOrder != "sequential")
		reject(engine, "impactOrder", "'" + engine.impactOrder + "'", "'simultaneous' or 'sequential'");
	for (const auto& tie : engine.ties)
		if (!dynamic_cast<BlockTie*>(tie.get()))
			reject(engine, "ties", tie ? tie->getClassName() : "None", "a list of ties (BlockTie)");
}

/// Those that are not dead, of a list that has been checked.
inline vector<shared_ptr<BlockTie>> livingTiesOf(const vector<shared_ptr<Engine>>& ties)
{
	vector<shared_ptr<BlockTie>> result;
	for (const auto& tie : ties)
		if (!tie->dead)
			result.push_back(boost::static_pointer_cast<BlockTie>(tie));
	return result;
}

/// Shows these energies (J) in O.energy, and those that both engines have.
template <class Engine>
void showEnergies(Scene& scene, const Engine& engine, std::initializer_list<std::pair<const char*, Real>> others)
{
	for (const auto& [key, value] : others)
		scene.energy->setItem_py(key, value);
	scene.energy->setItem_py("frictDissip", engine.frictDissip);
	scene.energy->setItem_py("impactDissip", engine.impactDissip);
	scene.energy->setItem_py("baseWork", -engine.baseWork);
	if (!engine.bondedIds.empty())
		scene.energy->setItem_py("crackDissip", engine.crackDissip);
}

} // namespace yade
