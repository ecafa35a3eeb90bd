#pragma once
// The shape of a block, a Box of YADE or a ConvexBlock, as the core takes it.

#include "ConvexBlock.hpp"
#include <core/Body.hpp>
#include <optional>
#include <pkg/common/Box.hpp>

namespace yade {

class BlockShape {
public:
	static bool isOne(const Shape& shape) { return dynamic_cast<const Box*>(&shape) || dynamic_cast<const ConvexBlock*>(&shape); }

	/// Whether a polyhedron can be made of it.
	static bool isWhole(const Shape& shape)
	{
		const BlockShape block(shape);
		return block.hull || ((block.half.array() > 0).all() && block.half.allFinite());
	}

	explicit BlockShape(const Shape& shape)
	{
		if (const auto* box = dynamic_cast<const Box*>(&shape))
			half = box->extents;
		else
			hull = static_cast<const ConvexBlock&>(shape).polyhedron;
	}
	/// A script that gives a ConvexBlock other vertices makes another polyhedron.
	bool operator==(const BlockShape& o) const { return half == o.half && hull == o.hull; }

	bool isBox() const { return !hull; }
	const Vector3r& extents() const { return half; }                                            ///< Half sizes of a Box [m].
	const std::shared_ptr<const masonry::ConvexPolyhedron>& polyhedron() const { return hull; } ///< Of a ConvexBlock.

	Real thickness() const { return hull ? hull->thickness() : half.minCoeff(); }
	Real radius() const { return hull ? hull->radius() : half.norm(); }
	/// Largest coordinate along `direction`, a unit vector in the axes of the body.
	Real reach(const Vector3r& direction) const
	{
		if (!hull)
			return direction.cwiseAbs().dot(half);
		Real most = 0;
		for (const Vector3r& vertex : hull->vertices())
			most = std::max(most, direction.dot(vertex));
		return most;
	}
	/// Whether its faces are parallel or perpendicular to an axis of the body.
	bool isRightPrism(int axis) const { return !hull || hull->isRightPrism(Vector3r::Unit(axis)); }
	/// Least distance of a vertex from the axis through the centre along `across`, or from the centre where that is zero, squared.
	Real leastRadiusSquared(const Vector3r& across) const
	{
		const auto squared = [&](const Vector3r& vertex) {
			const Real depth = across.cwiseAbs().dot(vertex.cwiseAbs());
			return vertex.squaredNorm() - depth * depth;
		};
		if (!hull)
			return squared(half);
		Real least = std::numeric_limits<Real>::infinity();
		for (const Vector3r& vertex : hull->vertices())
			least = std::min(least, squared(vertex));
		return least;
	}

private:
	Vector3r half = Vector3r::Zero();
	std::shared_ptr<const masonry::ConvexPolyhedron> hull;
};

/// The shapes of the bodies of a scene, made once as long as they stay the same.
class KeptShapes {
public:
	const std::shared_ptr<const masonry::ConvexPolyhedron>& of(int id, const Shape& shape)
	{
		if (size_t(id) >= kept.size())
			kept.resize(id + 1);
		auto& [seen, polyhedron] = kept[id];
		if (const BlockShape now(shape); !polyhedron || !(*seen == now)) {
			seen = now;
			polyhedron = now.isBox() ? std::make_shared<const masonry::ConvexPolyhedron>(masonry::ConvexPolyhedron::box(now.extents()))
			                         : now.polyhedron();
		}
		return polyhedron;
	}

private:
	vector<std::pair<std::optional<BlockShape>, std::shared_ptr<const masonry::ConvexPolyhedron>>> kept; // by id
};

} // namespace yade
