#pragma once
// Which bodies are near each other.
#include "dynamics/model/rigid_system.hpp"
#include <array>
#include <functional>
#include <vector>

namespace masonry {

// Box with sides along the axes of a frame.
template <class K>
struct Bounds {
	typename K::Vector low {K::Vector::Zero()}, high {K::Vector::Zero()};

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(low, high);
	}
};

// Keeps the system's list of pairs of parts of bodies, sorted by body1 < body2, then by their parts. A pair stays with all its state as
// long as it is near; two prescribed bodies are no pair, nor are free bodies of different structures. A structure is a set of free bodies
// that a chain of pairs joins in which the boxes around them (along their own axes), not their bounds, are less than twice the margin
// apart. Pairs with less than `margin` (m) between them are always in the list, farther ones may be.
//
// Bounds are enlarged by the margin, and pairs are those whose enlarged bounds overlap. The list holds until a body comes nearer
// than half the margin to the end of its enlarged bounds, which move with what moves all bodies alike: a base that shakes its wall; or
// until two boxes whose bounds overlap and that belong to different structures come nearer to each other than the margin. Bodies
// that move by more than that in a step (s) have a margin of four steps, and half of it is one.
//
// Bounds lie along the axes that the first body has when the first list is made, so that a scene has the same lists however it is turned.
template <class K>
class Neighbours {
public:
	using NewPair = std::function<void(ContactPair<K>&)>; // sets friction and restitution

	Neighbours(double margin, NewPair newPair) : margin(margin), newPair(std::move(newPair)) {}

	// The bounds tell how long the list of the system's pairs holds.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(frame, enlarged, apart);
	}

	// True if the list was made anew.
	bool update(RigidSystem<K>& system, double step = 0);

	bool isValid(const RigidSystem<K>& system, double step = 0) const; // update() would change nothing

private:
	using Frame = Eigen::Matrix<double, K::dimension, K::dimension>;
	using Parts = std::array<int, 4>; // two bodies, and a part of each

	Bounds<K> bounds(const RigidBody<K>& body, int part, double enlargement) const;
	void findPairs(const RigidSystem<K>& system, double step);
	void leaveOutPairsOfStructures(const RigidSystem<K>& system, double step);
	void keepStates(const std::vector<ContactPair<K>>& old);

	double margin;
	NewPair newPair;
	Frame frame {Frame::Identity()}; // rows: the axes of the bounds
	std::vector<Bounds<K>> enlarged; // of all parts of all bodies
	std::vector<int> order;          // of parts along the axis of the sweep
	std::vector<Parts> near;         // parts of the pairs
	std::vector<Parts> apart;        // parts of different structures whose enlarged bounds overlap
	std::vector<ContactPair<K>> pairs;
};

} // namespace masonry
