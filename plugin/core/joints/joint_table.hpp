#pragma once
// A joint is all that touches one face of a block. Which of two bodies is the block, and which one bears it, follows from the graph of the
// pairs that are near each other: it stays as it is while the bodies turn, and is the same in every frame.
//
// The body of the higher level (support_levels.hpp) is the block, and the other one its support. Bodies of one level are equals: two
// voussoirs at the crown of an arch, two blocks in flight. The law takes the relative spin of the two (rocking_restitution.hpp), which
// prefers neither; body 2 is called the block.
//
// Head joints do not rock. A pair is a head joint if its normals were level when it was found, or its bodies are equals, and if both bodies
// are borne across it: by faces beside those that meet here. The bricks of a wall are borne by their bed faces, and their head faces
// stand beside these. A voussoir is borne by the face opposite to that which meets the next one, so the crown joint of an arch rocks
// although it is upright.
#include "contact/features.hpp"
#include "joints/support_levels.hpp"
#include "tolerances.hpp"
#include <algorithm>

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
		pairsOf = pairsOfBodies(bodies.size(), pairs);
		level = supportLevels(bodies, pairs, pairsOf);
	}

	// The joint of pair c. The faces of the pairs may have changed since find().
	template <class Pairs>
	JointFace of(const Pairs& pairs, int c) const
	{
		const auto& pair = pairs[c];
		const int level1 = level[pair.body1], level2 = level[pair.body2];
		if ((pair.isUpright || level1 == level2) && isBorneAcross(pairs, pair.body1, pair.face1) &&
		    isBorneAcross(pairs, pair.body2, pair.face2))
			return {};
		return level1 > level2 ? JointFace {pair.body1, pair.face1} : JointFace {pair.body2, pair.face2};
	}

private:
	// Whether what bears the body, if anything, touches other faces than this one and that opposite to it. Upright pairs bear where no
	// others do.
	template <class Pairs>
	bool isBorneAcross(const Pairs& pairs, int body, int face) const
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
				if (feature::faceAxis(under) == feature::faceAxis(face))
					return false;
				isBorne = true;
			}
		return isBorne;
	}

	std::vector<std::vector<int>> pairsOf; // of a body
	std::vector<int> level;
};

} // namespace masonry
