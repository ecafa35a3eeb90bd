#include "dynamics/scheduler/scheduler.hpp"
#include "dynamics/rigid/island_numbers.hpp"
#include <algorithm>

namespace masonry::rigid {

template <class K>
StepReport Scheduler<K>::advance(RigidSystem<K>& s, double dt)
{
	if (s.lists != list || s.bodies.size() != ofWall.size())
		divide(s);
	if (localisedBodies.empty())
		return walls.advance(s, dt);
	const Settings ofWalls = s.settings;
	const bool moved = s.moved;
	s.settings.tolerance = Settings().tolerance;
	s.settings.order = Settings().order;
	s.moved |= gapsAreOutdated;
	islands.take(s);
	s.settings = ofWalls;
	s.moved = moved;
	gapsAreOutdated = false;
	hideLocalised(s);
	StepReport report = walls.advance(s, dt);
	restoreLocalised(s);
	report += islands.advanceTaken(s, dt);
	return report;
}

template <class K>
void Scheduler<K>::divide(const RigidSystem<K>& s)
{
	list = s.lists;
	ofWall.resize(s.bodies.size(), 0);
	const std::vector<int> structure = islandNumbers(s);
	std::vector<int> blocks(s.bodies.size(), 0);  // of a structure
	std::vector<char> isWall(s.bodies.size(), 0); // of a structure
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0)
			isWall[structure[b]] |= ++blocks[structure[b]] > maxBlocks || ofWall[b];
	localisedBodies.clear();
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0) {
			ofWall[b] = isWall[structure[b]];
			if (!ofWall[b])
				localisedBodies.push_back(int(b));
		}
	const bool noWalls = std::none_of(ofWall.begin(), ofWall.end(), [](char is) { return is; });
	if (noWalls || areOrdered(s.drives))
		localisedBodies.clear();
	std::vector<char> isLocalised(s.bodies.size(), 0);
	for (const int b : localisedBodies)
		isLocalised[b] = 1;
	islands.divide(s, isLocalised);
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

} // namespace masonry::rigid
