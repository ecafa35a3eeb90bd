#include "dynamics/wall/step_by_size.hpp"
#include "dynamics/rigid/island_numbers.hpp"
#include <algorithm>

namespace masonry::rigid {

template <class K>
StepReport StepBySize<K>::advance(RigidSystem<K>& s, double dt)
{
	if (s.lists != list || s.bodies.size() != ofWall.size())
		divide(s);
	if (few.empty())
		return walls.advance(s, dt);
	const Settings ofWalls = s.settings;
	const bool moved = s.moved;
	s.settings.tolerance = Settings().tolerance;
	s.settings.order = Settings().order;
	s.moved |= passed;
	islands.take(s);
	s.settings = ofWalls;
	s.moved = moved;
	passed = false;
	hide(s);
	StepReport report = walls.advance(s, dt);
	show(s);
	report += islands.advanceTaken(s, dt);
	return report;
}

template <class K>
void StepBySize<K>::divide(const RigidSystem<K>& s)
{
	list = s.lists;
	ofWall.resize(s.bodies.size(), 0);
	const std::vector<int> number = islandNumbers(s);
	std::vector<int> blocks(s.bodies.size(), 0);
	std::vector<char> isWall(s.bodies.size(), 0);
	for (size_t b = 0; b < number.size(); ++b)
		if (number[b] >= 0)
			isWall[number[b]] |= ++blocks[number[b]] > fewBlocks || ofWall[b];
	few.clear();
	std::vector<char> isFew(s.bodies.size(), 0);
	for (size_t b = 0; b < number.size(); ++b)
		if (number[b] >= 0) {
			ofWall[b] = isWall[number[b]];
			if (!ofWall[b])
				few.push_back(int(b));
		}
	const bool noWalls = std::none_of(ofWall.begin(), ofWall.end(), [](char is) { return is; });
	if (noWalls || areOrdered(s.drives))
		few.clear();
	for (const int b : few)
		isFew[b] = 1;
	islands.divide(s, isFew);
}

// As bodies that nothing moves.
template <class K>
void StepBySize<K>::hide(RigidSystem<K>& s)
{
	hidden.clear();
	for (const int b : few) {
		RigidBody<K>& body = s.bodies[b];
		hidden.push_back(body);
		body.prescribed = true;
		body.drive = -1;
		body.velocity.setZero();
		body.pose = {};
	}
}

template <class K>
void StepBySize<K>::show(RigidSystem<K>& s) const
{
	for (size_t k = 0; k < few.size(); ++k)
		s.bodies[few[k]] = hidden[k];
}

template class StepBySize<Plane>;
template class StepBySize<Space>;

} // namespace masonry::rigid
