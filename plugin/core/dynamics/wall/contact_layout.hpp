#pragma once
// The layout says where the pairs of a structure are, which lie in lanes, four lanes in a group, groups in parts; and in which order the
// groups go from the base upwards. It knows pairs by the numbers of their bodies, and nothing of points.
//
// A large structure is divided into parts of equally many blocks, and the pairs within a part are taken apart from those of other parts, by
// any thread; then those between two parts, which are the interface. The division is the structure's and not that of the threads.
//
// The lanes of a group share no free body, so that they can be taken at the same time: within a part lanes are coloured, and a group has
// lanes of one colour. A lane holds as many points as most pairs have; a pair with more takes further lanes, each of another colour.
#include "parallel/team.hpp"
#include "simd/lanes.hpp"
#include <array>
#include <boost/container/small_vector.hpp>
#include <vector>

namespace masonry::wall {

using parallel::Team;
using simd::width;

struct LaneGroup {
	int count {0};                  // lanes that are taken, from the first on
	int pair[width];                // of the system; -1: empty lane
	int number[width];              // among the lanes of its pair
	int body1[width], body2[width]; // of an empty lane: the body after the last
};

struct Part {
	int begin {0}, end {0};   // groups
	std::vector<int> members; // packs of the bodies that have no pair in another part; of the interface: of all others
};

struct Slot {
	int group, lane;
};
using Slots = boost::container::small_vector<Slot, 2>; // the lanes of a pair; in space two hold what rectangles have

class ContactLayout {
public:
	struct Pair { // two bodies, by a convex part of each
		int body1, body2, part1 {0}, part2 {0};

		bool operator==(const Pair& other) const
		{
			return body1 == other.body1 && body2 == other.body2 && part1 == other.part1 && part2 == other.part2;
		}
	};

	ContactLayout(Team& team, int packs) : team(&team), packs(packs) {} // packs of a body

	// Lays out these pairs, each in so many lanes; 0: it is not here. Bodies that are not `free` may be shared. `levels`: of the bodies.
	void make(std::vector<Pair> pairs, const std::vector<int>& lanes, std::vector<char> free, const std::vector<int>& levels);
	// Takes over other numbers of the pairs that are here, and levels. Returns false, without a change, if other pairs are here.
	bool renumber(std::vector<Pair> pairs, const std::vector<int>& lanes, const std::vector<int>& levels);

	const std::vector<Pair>& pairs() const { return pairs_; }    // all of the system
	const std::vector<int>& numbers() const { return numbers_; } // of the pairs that are here
	const std::vector<char>& free() const { return free_; }      // by body
	const std::vector<int>& levels() const { return levels_; }   // by body: pairs to the nearest prescribed one; -1: no way there
	const Slots& slots(int pair) const { return slots_[pair]; }  // empty: it is not here
	const std::vector<LaneGroup>& groups() const { return groups_; }
	const std::vector<Part>& parts() const { return parts_; }    // the last is the interface between them
	const std::vector<Slot>& onBase() const { return onBase_; }  // lanes of pairs with a body that is not free
	const std::vector<int>& upwards() const { return upwards_; } // groups by level, those of a part from its begin to its end

	// work(part, number) for each part but the interface, the last number.
	template <class Work>
	void eachPart(const Work& work) const
	{
		team->each(int(parts_.size()) - 1, [&](int part) { work(parts_[part], part); });
	}
	// For each part, the interface included, where their order does not matter.
	template <class Work>
	void allParts(const Work& work) const
	{
		eachPart(work);
		work(parts_.back(), int(parts_.size()) - 1);
	}

private:
	std::vector<int> divide() const;
	void addGroups(const std::vector<int>& pairsOfPart);
	void order(const std::vector<int>& levels);

	Team* team;
	int packs;
	std::vector<Pair> pairs_;
	std::vector<int> numbers_, levels_, upwards_;
	std::vector<char> free_;
	std::vector<Slots> slots_;
	std::vector<LaneGroup> groups_;
	std::vector<Part> parts_;
	std::vector<Slot> onBase_;
};

} // namespace masonry::wall
