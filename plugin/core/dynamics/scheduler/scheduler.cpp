#include "dynamics/scheduler/scheduler.hpp"
#include "dynamics/model/island_numbers.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace masonry {

template <class K>
StepReport Scheduler<K>::advance(RigidSystem<K>& s, double dt)
{
	const bool isNew = !list.isUpToDate(s.list) || s.bodies.size() != ofWall.size();
	if (isNew)
		divide(s);
	errors = {};
	if (localisedBodies.empty())
		return advanceWalls(s, dt);
	report = {};
	islands.settings() = settings.localised;
	const bool moved = s.moved;
	s.moved |= std::exchange(gapsAreOutdated, false);
	if (!areWalls) {
		const StepReport sum = islands.advance(s, dt);
		errors = islands.lastErrors();
		s.impactDissip += walls.potentialShift();
		walls.setPotentialShift(0);
		return sum;
	}
	islands.take(s);
	s.moved = moved;
	hideLocalised(s);
	StepReport sum = advanceWalls(s, dt);
	restoreLocalised(s);
	sum += islands.advanceTaken(s, dt);
	errors += islands.lastErrors();
	return sum;
}

template <class K>
StepReport Scheduler<K>::advanceWalls(RigidSystem<K>& s, double dt)
{
	const wall::AdmmSettings usual;
	wall::AdmmSettings& solver = walls.settings.solver;
	solver.tolerance = settings.tolerance;
	solver.strictForces = settings.strictForces;
	solver.iterations = int(std::lround(usual.iterations * std::max(1., std::sqrt(usual.tolerance / settings.tolerance))));
	walls.settings.threads = settings.threads;
	const StepReport sum = walls.advance(s, dt);
	report = walls.report;
	errors += walls.lastErrors();
	return sum;
}

template <class K>
void Scheduler<K>::divide(const RigidSystem<K>& s)
{
	list.follow(s.list);
	ofWall.resize(s.bodies.size(), 0);
	const std::vector<int> structure = islandNumbers(s);
	std::vector<int> blocks(s.bodies.size(), 0);  // of a structure
	std::vector<char> isWall(s.bodies.size(), 0); // of a structure
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0)
			isWall[structure[b]] |= settings.ofAnySize || ++blocks[structure[b]] > maxBlocks || ofWall[b];
	const bool areTogether = areOrdered(s.drives);
	areWalls = areTogether && std::accumulate(blocks.begin(), blocks.end(), 0) > maxBlocks;
	localisedBodies.clear();
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0) {
			ofWall[b] = isWall[structure[b]];
			areWalls |= ofWall[b];
			if (!ofWall[b])
				localisedBodies.push_back(int(b));
		}
	if (areWalls && areTogether)
		localisedBodies.clear();
	partBases = areOnSeveral(s, structure);
	std::vector<char> isLocalised(s.bodies.size(), 0);
	for (const int b : localisedBodies)
		isLocalised[b] = 1;
	if (areWalls)
		islands.divide(s, isLocalised);
}

// Whether blocks of one wall are near prescribed bodies of which each has a motion of its own, and may be taken along by each: without
// friction a body takes none along.
template <class K>
bool Scheduler<K>::areOnSeveral(const RigidSystem<K>& s, const std::vector<int>& structure) const
{
	std::vector<const RigidBody<K>*> firstOf(s.bodies.size(), nullptr); // by structure
	for (const ContactPair<K>& pair : s.pairs)
		for (const auto& [block, base] : {std::pair(pair.body1, pair.body2), std::pair(pair.body2, pair.body1)}) {
			if (structure[block] < 0 || !s.bodies[base].prescribed || !ofWall[block] || pair.friction == 0)
				continue;
			const RigidBody<K>& here = s.bodies[base];
			const RigidBody<K>*& first = firstOf[structure[block]];
			if (!first)
				first = &here;
			if (here.drive != first->drive || here.velocity != first->velocity)
				return true;
		}
	return false;
}

// To the walls, localised bodies are bodies at rest that nothing moves.
template <class K>
void Scheduler<K>::hideLocalised(RigidSystem<K>& s)
{
	hidden.clear();
	for (const int b : localisedBodies) {
		RigidBody<K>& body = s.bodies[b];
		hidden.push_back(body);
		body.prescribed = true;
		body.drive = -1;
		body.velocity.setZero();
		body.pose = {};
	}
}

template <class K>
void Scheduler<K>::restoreLocalised(RigidSystem<K>& s) const
{
	for (size_t k = 0; k < localisedBodies.size(); ++k)
		s.bodies[localisedBodies[k]] = hidden[k];
}

template class Scheduler<Plane>;
template class Scheduler<Space>;

} // namespace masonry
