#pragma once
// Which boxes are near each other.
#include "dynamics/rigid/rigid_system.hpp"
#include <array>
#include <functional>
#include <vector>

namespace masonry::rigid {

// Box with sides along the global axes.
template <class K>
struct Bounds {
	typename K::Vector low {K::Vector::Zero()}, high {K::Vector::Zero()};

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(low, high);
	}
};

// Keeps the system's list of pairs: those with less than `margin` (m) between their bounds are always in it, farther ones may be.
// Sorted by body1 < body2; a pair stays with all its state as long as it is near; two prescribed bodies are no pair.
//
// Bounds are enlarged by the margin, and pairs are those whose enlarged bounds overlap. The list holds until a body comes nearer
// than half the margin to the end of its enlarged bounds, which move with what moves all bodies alike: a base that shakes its wall. Bodies
// that move by more than that in a step (s) have a margin of four steps, and half of it is one.
template <class K>
class Neighbours {
public:
	using NewPair = std::function<void(ContactPair<K>&)>; // sets friction and restitution

	Neighbours(double margin, NewPair newPair) : margin(margin), newPair(std::move(newPair)) {}

	// The bounds tell how long the list of the system's pairs holds.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(enlarged);
	}

	// True if the list was made anew.
	bool update(RigidSystem<K>& system, double step = 0);

	bool isValid(const RigidSystem<K>& system, double step = 0) const; // update() would change nothing

private:
	void findPairs(const RigidSystem<K>& system, double step);
	void keepStates(const std::vector<ContactPair<K>>& old);

	double margin;
	NewPair newPair;
	std::vector<Bounds<K>> enlarged;
	std::vector<int> order;               // of bodies along the axis of the sweep
	std::vector<std::array<int, 2>> near; // bodies of the pairs
	std::vector<ContactPair<K>> pairs;
};

} // namespace masonry::rigid
