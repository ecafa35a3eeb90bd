#pragma once
// The shape of a block, a Box of YADE or a ConvexBlock, as the core takes it.

#include "ConvexBlock.hpp"
#include "tolerances.hpp"
#include <core/Body.hpp>
#include <optional>
#include <pkg/common/Box.hpp>

namespace yade {

class BlockShape {
	using Solid = masonry::Solid<masonry::ConvexPolyhedron>;

public:
	static bool isOne(const Shape& shape) { return dynamic_cast<const Box*>(&shape) || dynamic_cast<const ConvexBlock*>(&shape); }

	/// Whether a polyhedron can be made of it.
	static bool isWhole(const Shape& shape)
	{
		const BlockShape block(shape);
		return block.whole || ((block.half.array() > 0).all() && block.half.allFinite());
	}

	explicit BlockShape(const Shape& shape)
	{
		if (const auto* box = dynamic_cast<const Box*>(&shape))
			half = box->extents;
		else
			whole = static_cast<const ConvexBlock&>(shape).solid;
	}
	/// A script that gives a ConvexBlock other vertices makes another solid.
	bool operator==(const BlockShape& o) const { return half == o.half && whole == o.whole; }

	bool isBox() const { return !whole; }
	bool isUnion() const { return whole && whole->size() > 1; }
	const Vector3r& extents() const { return half; }                    ///< Half sizes of a Box [m].
	const std::shared_ptr<const Solid>& solid() const { return whole; } ///< Of a ConvexBlock.

	Real thickness() const { return whole ? whole->thickness() : half.minCoeff(); }
	Real radius() const { return whole ? whole->radius() : half.norm(); }
	/// Largest coordinate along `direction`, a unit vector in the axes of the body.
	Real reach(const Vector3r& direction) const
	{
		if (!whole)
			return direction.cwiseAbs().dot(half);
		Real most = 0;
		for (int part = 0; part < whole->size(); ++part)
			for (const Vector3r& vertex : whole->part(part).vertices())
				most = std::max(most, direction.dot(vertex));
		return most;
	}
	/// Whether its faces are parallel or perpendicular to an axis of the body, and all parts reach from its front to its back.
	bool isRightPrism(int axis) const
	{
		for (int part = 0; whole && part < whole->size(); ++part) {
			const masonry::ConvexPolyhedron& one = whole->part(part);
			const Real rounding = masonry::tolerance::shape::plane * radius();
			if (!one.isRightPrism(Vector3r::Unit(axis)) || one.low()[axis] > whole->low()[axis] + rounding ||
			    one.high()[axis] < whole->high()[axis] - rounding)
				return false;
		}
		return true;
	}
	/// Least distance of a vertex from the axis through the centre along `across`, or from the centre where that is zero, squared; of the
	/// vertices of the convex hull, about which a body can rock on a plane.
	Real leastRadiusSquared(const Vector3r& across) const
	{
		const auto squared = [&](const Vector3r& vertex) {
			const Real depth = across.cwiseAbs().dot(vertex.cwiseAbs());
			return vertex.squaredNorm() - depth * depth;
		};
		if (!whole)
			return squared(half);
		Real least = std::numeric_limits<Real>::infinity();
		const vector<Vector3r> vertices =
		    isUnion() ? masonry::ConvexPolyhedron::hull(whole->vertices()).vertices() : whole->part(0).vertices();
		for (const Vector3r& vertex : vertices)
			least = std::min(least, squared(vertex));
		return least;
	}

private:
	Vector3r half = Vector3r::Zero();
	std::shared_ptr<const Solid> whole;
};

/// The shapes of the bodies of a scene, made once as long as they stay the same.
class KeptShapes {
public:
	using Solid = masonry::Solid<masonry::ConvexPolyhedron>;

	const std::shared_ptr<const Solid>& of(int id, const Shape& shape)
	{
		if (size_t(id) >= kept.size())
			kept.resize(id + 1);
		auto& [seen, solid] = kept[id];
		if (const BlockShape now(shape); !solid || !(*seen == now)) {
			seen = now;
			solid = now.isBox() ? std::make_shared<const Solid>(masonry::ConvexPolyhedron::box(now.extents())) : now.solid();
		}
		return solid;
	}

private:
	vector<std::pair<std::optional<BlockShape>, std::shared_ptr<const Solid>>> kept; // by id
};

} // namespace yade
