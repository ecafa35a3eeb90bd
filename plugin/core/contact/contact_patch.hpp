#pragma once
// The contact patch is where two faces, or two edges, of a pair of bodies meet.
#include "contact/features.hpp"
#include <algorithm>

namespace masonry {

// One corner of the patch, with a point on each body; position2 - position1 = gap * normal. A vertex is a material point of
// its body, its partner and the crossings of two edges move over theirs.
struct PatchPoint {
	Vector3 position1 {Vector3::Zero()}, position2 {Vector3::Zero()}; // global, m: on body 1 and on body 2
	double gap {0};                                                   // m, along the normal; negative = penetration
	double weight {0}; // share of the patch; the weights sum to 1, sum of weight * position = centroid of the patch
	Feature feature;   // independent of the reference; a vertex without the face that it is on
};

enum class PatchKind { None = 0, Face1 = 1, Face2 = 2, Edges = 3 };

// The features of the patch are all that `collide` remembers from one step to the next: small integers, fit to be saved.
struct PatchFeature {
	PatchKind kind {PatchKind::None}; // Face1, Face2: face on face, the number names the reference body; Edges: edge across edge
	int feature1 {-1};                // face (kind Face1, Face2) or edge (kind Edges) of body 1
	int feature2 {-1};                // the same of body 2
	PerPoint<Feature> vertices;       // the vertices that are corners of the patch, sorted

	bool has(const Feature& vertex) const { return std::binary_search(vertices.begin(), vertices.end(), vertex); }
	void add(const Feature& vertex)
	{
		const auto place = std::lower_bound(vertices.begin(), vertices.end(), vertex);
		if (place == vertices.end() || *place != vertex)
			vertices.insert(place, vertex);
	}
	void drop(const Feature& vertex) { vertices.erase(std::remove(vertices.begin(), vertices.end(), vertex), vertices.end()); }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(kind, feature1, feature2, vertices);
	}
};

inline bool operator==(const PatchFeature& a, const PatchFeature& b)
{
	return a.kind == b.kind && a.feature1 == b.feature1 && a.feature2 == b.feature2 && a.vertices == b.vertices;
}

// Face on face: the incident face, projected along the reference face's normal and clipped by the reference face. All
// corners are there, those with an open gap too: the far edge of a rocking block keeps its points while it is up.
// Edge across edge: one point.
struct ContactPatch {
	Vector3 normal {Vector3::Zero()}; // unit, from body 1 to body 2; of the reference face, or normal to both edges
	double area {0};                  // of the overlap in the reference plane, m^2; 0 for edge across edge
	double nominalArea {0};           // the smaller of the two faces' areas, m^2; for edges, of the faces nearest to the normal
	PerPoint<PatchPoint> points;      // counter-clockwise about the normal
	PatchFeature feature;

	int size() const { return int(points.size()); }
};

} // namespace masonry
