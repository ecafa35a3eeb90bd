#pragma once
// The matrix A = M + J^T J / R of a structure and its factorisation, which is kept over many steps: 1/M and the rows J are those of the
// contacts when it was made. It stays where the rows of a point have changed by less than a tolerance, whatever features the point is of.
#include "dynamics/wall/contact_set.hpp"
#include "dynamics/wall/mortar_rows.hpp"
#include "linalg/block_ldlt.hpp"

namespace masonry::wall {

// The rows J of a lane's point, number by number.
inline std::array<Lanes*, 6> rowsOf(PointLanes<Plane>& p) { return {&p.nx, &p.ny, &p.a1n, &p.a1t, &p.a2n, &p.a2t}; }
inline std::array<Lanes*, 27> rowsOf(PointLanes<Space>& p)
{
	std::array<Lanes*, 27> result;
	auto next = result.begin();
	for (auto* row : {&p.normal, &p.tangent[0], &p.tangent[1]})
		for (auto* three : {&row->axis, &row->arm1, &row->arm2})
			for (Lanes* lanes : {&three->x, &three->y, &three->z})
				*next++ = lanes;
	return result;
}

template <class K>
class WallMatrix {
public:
	using Stiffness = std::array<Lanes, lanePoints<K>>; // 1/R; zero: the point is not in A

	// Makes A of the contacts as they are, with these stiffnesses, by group, and of rows of mortar.
	void make(const ContactSet<K>& contacts, Array<Stiffness> stiffness, std::vector<MortarRow<K>> rows = {});
	bool isOf(const ContactSet<K>& contacts) const;      // of these pairs in these lanes
	bool hasMasses(const ContactSet<K>& contacts) const; // those of these bodies
	// The largest difference between the rows of a point in A and those that it has now; infinite where a point is gone. A must be of these
	// contacts.
	double change(const ContactSet<K>& contacts) const;
	// x = A^-1 x, by packs of the bodies.
	void solve(LaneArray& x) { factor.solve(x.data(), places); }
	const std::vector<MortarRow<K>>& rows() const { return mortar; } // that A is of
	const std::vector<int>& freePacks() const { return places; }     // of the free bodies

	// This passes the points that A is of; a new object makes A of them, for these contacts.
	template <class Archive>
	void serialize(Archive& archive, const ContactSet<K>& contacts)
	{
		const bool isNew = points.empty();
		archive(stiffnesses, mortar);
		points.resize(stiffnesses.size());
		for (auto& ofGroup : points)
			for (PointLanes<K>& point : ofGroup)
				for (Lanes* lanes : rowsOf(point))
					archive(*lanes);
		if (isNew && !points.empty())
			factorise(contacts);
	}

private:
	using Block = linalg::BlockLDLT::Block;
	void factorise(const ContactSet<K>& contacts);
	void setGraph(const ContactSet<K>& contacts);
	void addPair(const ContactSet<K>& contacts, int group, int lane, int& edge);
	bool isOfRow(const MortarRow<K>& row, int group, int lane) const { return row.group == group && row.lane == lane; }

	linalg::BlockLDLT factor; // a node for each pack of the free bodies
	std::vector<int> places;  // of the nodes
	std::vector<int> node;    // of a body, its first; -1: none
	std::vector<linalg::BlockLDLT::Edge> edges;
	std::vector<std::array<PointLanes<K>, lanePoints<K>>> points; // that A is of, by group; their rows alone
	Array<Stiffness> stiffnesses;
	std::vector<MortarRow<K>> mortar;
	std::vector<std::array<int, width>> pairs; // by group and lane
	std::vector<double> perMass;               // 1/m, by body
};

} // namespace masonry::wall
