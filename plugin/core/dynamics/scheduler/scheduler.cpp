#include "dynamics/scheduler/scheduler.hpp"
#include "dynamics/rigid/island_numbers.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace masonry::rigid {

namespace {

// By body: blocks from the nearest prescribed body on, one upon another; -1: of no wall. What stands beside a block does not bear it.
template <class K>
std::vector<int> coursesOf(const RigidSystem<K>& s, const std::vector<char>& isWall)
{
	std::vector<int> course(s.bodies.size(), -1);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed)
			course[b] = 0;
	int most = 0;
	for (int reached = 0; reached <= most; ++reached)
		for (const ContactPair<K>& pair : s.pairs)
			for (const auto& [from, to] : {std::pair(pair.body1, pair.body2), std::pair(pair.body2, pair.body1)})
				if (!pair.beside && isWall[to] && course[from] == reached && course[to] < 0)
					most = course[to] = reached + 1;
	return course;
}

// Largest course of a block times the ratio of its mass to that of one that it is upon.
template <class K>
double burdenOf(const RigidSystem<K>& s, const std::vector<int>& course)
{
	double most = 0;
	for (const ContactPair<K>& pair : s.pairs) {
		const auto [low, high] = std::minmax({pair.body1, pair.body2}, [&](int a, int b) { return course[a] < course[b]; });
		if (course[low] > 0 && course[low] < course[high])
			most = std::max(most, course[high] * s.bodies[high].mass / s.bodies[low].mass);
	}
	return most;
}

// Whether a block of a wall is held by what stands beside it alone.
template <class K>
bool hangs(const RigidSystem<K>& s, const std::vector<char>& isWall)
{
	std::vector<char> isBorne(s.bodies.size(), 0), isHeld(s.bodies.size(), 0);
	for (const ContactPair<K>& pair : s.pairs)
		for (const int b : {pair.body1, pair.body2})
			(pair.beside ? isHeld : isBorne)[b] = 1;
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (isWall[b] && isHeld[b] && !isBorne[b])
			return true;
	return false;
}

} // namespace

template <class K>
StepReport Scheduler<K>::advance(RigidSystem<K>& s, double dt)
{
	const bool isNew = s.lists != list || s.bodies.size() != ofWall.size();
	if (isNew)
		divide(s);
	if (localisedBodies.empty())
		return advanceWalls(s, dt);
	report = {};
	const Settings ofWalls = s.settings;
	const bool moved = s.moved;
	s.settings.tolerance = Settings().tolerance;
	s.settings.order = Settings().order;
	s.moved |= gapsAreOutdated;
	gapsAreOutdated = false;
	if (!areWalls) {
		const StepReport sum = islands.advance(s, dt);
		s.settings = ofWalls;
		return sum;
	}
	islands.take(s);
	s.settings = ofWalls;
	s.moved = moved;
	hideLocalised(s);
	StepReport sum = advanceWalls(s, dt);
	restoreLocalised(s);
	sum += islands.advanceTaken(s, dt);
	return sum;
}

template <class K>
StepReport Scheduler<K>::advanceWalls(RigidSystem<K>& s, double dt)
{
	if (oneMethod && !byAssembly)
		takeAssembly(s);
	if (!byAssembly) {
		walls->settings = settings;
		const StepReport sum = walls->advance(s, dt);
		const WallReport& of = walls->report;
		report = {of.moved, of.partBases, of.velocityResidual, of.forceResidual};
		oneMethod |= oneInMotion && of.moved > 0;
		return sum;
	}
	assembly::AssemblySettings& of = assembly->settings;
	const assembly::AdmmSettings usual;
	of.solver.tolerance = settings.tolerance;
	of.solver.strictForces = settings.strictForces;
	of.solver.iterations = int(std::lround(usual.iterations * std::max(1., std::sqrt(usual.tolerance / settings.tolerance))));
	of.threads = settings.threads;
	const StepReport sum = assembly->advance(s, dt);
	report = {assembly->report.moved, false, assembly->report.velocityResidual, assembly->report.forceResidual};
	return sum;
}

// Starts from the impulses that the two modes have left in the pairs.
template <class K>
void Scheduler<K>::takeAssembly(RigidSystem<K>& s)
{
	walls->showPoints(s);
	walls.emplace();
	s.moved = true;
	byAssembly = true;
}

template <class K>
void Scheduler<K>::divide(const RigidSystem<K>& s)
{
	const bool begins = ofWall.empty();
	list = s.lists;
	ofWall.resize(s.bodies.size(), 0);
	const std::vector<int> structure = islandNumbers(s);
	std::vector<int> blocks(s.bodies.size(), 0);  // of a structure
	std::vector<char> isWall(s.bodies.size(), 0); // of a structure
	for (size_t b = 0; b < structure.size(); ++b)
		if (structure[b] >= 0)
			isWall[structure[b]] |= ++blocks[structure[b]] > maxBlocks || ofWall[b];
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
	std::vector<char> isLocalised(s.bodies.size(), 0);
	for (const int b : localisedBodies)
		isLocalised[b] = 1;
	if (areWalls)
		islands.divide(s, isLocalised);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		isWall[b] = !s.bodies[b].prescribed && !isLocalised[b];
	choose(s, isWall, begins);
}

template <class K>
void Scheduler<K>::choose(const RigidSystem<K>& s, const std::vector<char>& isWall, bool begins)
{
	const std::vector<int> course = coursesOf(s, isWall);
	const bool isHigh = std::any_of(course.begin(), course.end(), [](int of) { return of > coursesOfTwoModes; });
	const bool hasLaw = std::any_of(s.pairs.begin(), s.pairs.end(), [&](const ContactPair<K>& pair) {
		return !std::isnan(pair.restitution) && (isWall[pair.body1] || isWall[pair.body2]);
	});
	oneInMotion = isHigh || hasLaw;
	oneMethod |= burdenOf(s, course) > burdenOfTwoModes || (isHigh && areOrdered(s.drives)) || (begins && hangs(s, isWall));
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
