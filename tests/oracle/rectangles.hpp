#pragma once
// Contact points of two rectangles in the plane by their half sizes and signs: no list of vertices, faces or neighbours is used. A point
// has a vertex (bits 0, 1 set where x, y is positive) of body `vertexBody` (0: none) on a face (2 axis + (1 if it looks along +axis)).
#include "contact/kinematics.hpp"
#include <array>

namespace oracle {

struct RectangleFeature {
	int vertexBody {0}, vertex {0}, face {0};
	bool operator==(const RectangleFeature& o) const { return vertexBody == o.vertexBody && vertex == o.vertex && face == o.face; }
};

struct RectangleMemory {
	int reference {0}, face1 {-1}, face2 {-1};
	std::array<RectangleFeature, 2> features;
};

struct RectanglePoints {
	int size {0}, places {0}; // from `places` on: second normals
	std::array<RectangleFeature, 3> features;
	std::array<int, 3> corner {}; // the point whose place a second normal shares
	int face1 {-1}, face2 {-1};

	void addSecondNormal(const RectangleFeature& feature, int place)
	{
		const auto last = features.begin() + size;
		if (size == int(features.size()) || std::find(features.begin(), last, feature) != last)
			return;
		corner[size] = place;
		features[size++] = feature;
	}
};

bool findPoints(const masonry::Vector2& half1, const masonry::PlanePose& pose1, const masonry::Vector2& half2,
                const masonry::PlanePose& pose2, double margin, RectangleMemory&, RectanglePoints&);
void addSecondNormals(const masonry::Vector2& half1, const masonry::PlanePose& pose1, const masonry::Vector2& half2,
                      const masonry::PlanePose& pose2, RectanglePoints&);

} // namespace oracle
