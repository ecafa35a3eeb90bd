#pragma once
// A joint is all that touches one face of a block. Which of two bodies is the block, and which one bears it, follows from the graph of the
// pairs that are near each other: it stays as it is while the bodies turn, and is the same in every frame.
//
// The level of a body is the number of pairs between it and the nearest prescribed body. Pairs whose normals were level when they were
// found (upright pairs) lead on only to bodies that no other pairs lead to: what stands beside a block does not bear it. The body of the
// higher level is the block, and the other one its support. Bodies of one level are equals: two voussoirs at the crown of an arch, two
// blocks in flight. The law takes the relative spin of the two (rocking_restitution.hpp), which prefers neither; body 2 is called the
// block.
//
// Head joints do not rock. A pair is a head joint if it is upright, or its bodies are equals, and if both bodies are borne across it: by
// faces perpendicular to those that meet here. The bricks of a wall are borne by their bed faces, and their head faces stand beside these.
// A voussoir is borne by the face opposite to that which meets the next one, so the crown joint of an arch rocks although it is upright.
// An upright pair bears no body that has no other: that body flies past.
#include "tolerances.hpp"
#include <algorithm>
#include <vector>

namespace masonry {

template <class Vector>
bool isUpright(const Vector& normal, const Vector& gravity)
{
	return std::abs(normal.dot(gravity)) < tolerance::uprightJoint * gravity.norm();
}

// A pair as the graph has it. Other pairs have these members too.
struct NearPair {
	int body1, body2, face1, face2; // face -1: they have not met
	bool isUpright;                 // when the pair was found
};

// The face under which a joint is; -1: it does not rock.
struct JointFace {
	int block {-1}, face {-1};
	bool operator==(const JointFace& o) const { return block == o.block && face == o.face; }
};

class JointTable {
public:
	// Anew where the list of pairs has changed, or which bodies are prescribed.
	template <class Bodies, class Pairs>
	void find(const Bodies& bodies, const Pairs& pairs)
	{
		pairsOf.resize(bodies.size());
		for (std::vector<int>& of : pairsOf)
			of.clear();
		for (size_t c = 0; c < pairs.size(); ++c)
			for (const int b : {pairs[c].body1, pairs[c].body2})
				pairsOf[b].push_back(int(c));
		level.assign(bodies.size(), -1);
		for (size_t b = 0; b < bodies.size(); ++b)
			if (bodies[b].prescribed)
				level[b] = 0;
		int most = 0; // of the levels
		for (const bool all : {false, true})
			for (int reached = 0; reached <= most; ++reached)
				for (int from = 0; from < int(level.size()); ++from) {
					if (level[from] != reached)
						continue;
					for (const int c : pairsOf[from])
						if (const int to = pairs[c].body1 == from ? pairs[c].body2 : pairs[c].body1;
						    (all || !pairs[c].isUpright) && level[to] < 0)
							most = std::max(most, level[to] = reached + 1);
				}
	}

	// By body; -1: no chain of pairs leads to a prescribed body.
	const std::vector<int>& levels() const { return level; }

	// The joint of pair c. The faces of the pairs may have changed since find(). faceNormal(body, face) is the outward normal of a face in
	// the axes of its body.
	template <class Bodies, class Pairs>
	JointFace of(const Bodies& bodies, const Pairs& pairs, int c) const
	{
		const auto& pair = pairs[c];
		const int level1 = level[pair.body1], level2 = level[pair.body2];
		const auto isLike = [&](int other) { // another part of the same two bodies
			return pairs[other].isUpright && pairs[other].body1 == pair.body1 && pairs[other].body2 == pair.body2;
		};
		const auto flies = [&](int body) {
			return level[body] > 0 && (pairsOf[body].size() == 1 || std::all_of(pairsOf[body].begin(), pairsOf[body].end(), isLike));
		};
		if (pair.isUpright && (flies(pair.body1) || flies(pair.body2)))
			return {};
		if ((pair.isUpright || level1 == level2) && isBorneAcross(bodies, pairs, pair.body1, pair.face1) &&
		    isBorneAcross(bodies, pairs, pair.body2, pair.face2))
			return {};
		return level1 > level2 ? JointFace {pair.body1, pair.face1} : JointFace {pair.body2, pair.face2};
	}

private:
	// Whether what bears the body, if anything, touches faces that are perpendicular to this one, within tolerance::uprightJoint. Upright
	// pairs bear where no others do.
	template <class Bodies, class Pairs>
	bool isBorneAcross(const Bodies& bodies, const Pairs& pairs, int body, int face) const
	{
		bool isBorne = level[body] == 0; // prescribed
		for (const bool upright : {false, true})
			for (const int c : pairsOf[body]) {
				if (isBorne && upright)
					return true;
				const auto& pair = pairs[c];
				const bool first = pair.body1 == body;
				const int under = first ? pair.face1 : pair.face2, support = first ? pair.body2 : pair.body1;
				if (pair.isUpright != upright || under < 0 || level[support] != level[body] - 1)
					continue;
				if (!isUpright(faceNormal(bodies[body], under), faceNormal(bodies[body], face)))
					return false;
				isBorne = true;
			}
		return isBorne;
	}

	std::vector<std::vector<int>> pairsOf; // of a body
	std::vector<int> level;
};

} // namespace masonry
