#include "dynamics/wall/wall_matrix.hpp"
#include <algorithm>

namespace masonry::wall {

namespace {

template <class K>
using Points = std::array<PointLanes<K>, lanePoints<K>>;

// Arms of bodies that are not free do not matter.
MASONRY_INLINE Lanes difference(const PointLanes<Plane>& a, const PointLanes<Plane>& b, const Mask& free1, const Mask& free2)
{
	const Lanes none = all(0);
	const Lanes arm1 = larger(size(a.a1n - b.a1n), size(a.a1t - b.a1t)), arm2 = larger(size(a.a2n - b.a2n), size(a.a2t - b.a2t));
	return larger(larger(size(a.nx - b.nx), size(a.ny - b.ny)), larger(free1 ? arm1 : none, free2 ? arm2 : none));
}
MASONRY_INLINE Lanes largestOf(const Lanes3& a) { return larger(larger(size(a.x), size(a.y)), size(a.z)); }
MASONRY_INLINE Lanes difference(const PointLanes<Space>& a, const PointLanes<Space>& b, const Mask& free1, const Mask& free2)
{
	const Lanes none = all(0);
	Lanes result = none;
	const Row *rowsA[] = {&a.normal, &a.tangent[0], &a.tangent[1]}, *rowsB[] = {&b.normal, &b.tangent[0], &b.tangent[1]};
	for (int k = 0; k < 3; ++k) {
		result = larger(result, largestOf(rowsA[k]->axis - rowsB[k]->axis));
		result = larger(result, free1 ? largestOf(rowsA[k]->arm1 - rowsB[k]->arm1) : none);
		result = larger(result, free2 ? largestOf(rowsA[k]->arm2 - rowsB[k]->arm2) : none);
	}
	return result;
}

// The points of the groups begin .. end - 1, and those that A is of.
template <class K>
struct ComparePass {
	const Group<K>* groups;
	const Points<K>* points;
	const typename WallMatrix<K>::Stiffness* stiffness;
	int begin, end;
	const Lanes* velocity;
};

template <class K>
MASONRY_INLINE void compareGroups(const ComparePass<K>& pass, Lanes& worst)
{
	const auto [groups, points, stiffness, begin, end, velocity] = pass;
	worst = all(0);
	for (int g = begin; g < end; ++g) {
		const Bodies<K> v1(velocity, groups[g].body1), v2(velocity, groups[g].body2);
		for (int k = 0; k < lanePoints<K>; ++k) {
			const PointLanes<K>& p = groups[g].point[k];
			const Lanes change =
			    (p.massN > 0) & (all(groups[g].count - k) > 0) ? difference(p, points[g][k], v1.m > 0, v2.m > 0) : all(INFINITY);
			worst = larger(worst, stiffness[g][k] > 0 ? change : all(0));
		}
	}
}

// No template is compiled for several vector widths.
MASONRY_LANES void comparePass(const ComparePass<Plane>& pass, Lanes& worst) { compareGroups(pass, worst); }
MASONRY_LANES void comparePass(const ComparePass<Space>& pass, Lanes& worst) { compareGroups(pass, worst); }

} // namespace

template <class K>
void WallMatrix<K>::make(const ContactSet<K>& c, Array<Stiffness> stiffness, std::vector<MortarRow<K>> rows)
{
	stiffnesses = std::move(stiffness);
	mortar = std::move(rows);
	points.resize(c.points().groups().size());
	for (size_t g = 0; g < points.size(); ++g)
		std::copy_n(c.points().groups()[g].point, lanePoints<K>, points[g].begin());
	factorise(c);
}

template <class K>
bool WallMatrix<K>::isOf(const ContactSet<K>& c) const
{
	if (pairs.size() != c.layout().groups().size())
		return false;
	for (size_t g = 0; g < pairs.size(); ++g)
		if (!std::equal(pairs[g].begin(), pairs[g].end(), c.layout().groups()[g].pair))
			return false;
	return true;
}

template <class K>
bool WallMatrix<K>::hasMasses(const ContactSet<K>& c) const
{
	if (perMass.size() != c.bodies().size())
		return false;
	for (size_t b = 0; b < perMass.size(); ++b)
		if (perMass[b] != c.bodies().perMass(b))
			return false;
	return true;
}

template <class K>
double WallMatrix<K>::change(const ContactSet<K>& c) const
{
	Lanes worst[Team::maxParts + 1] {};
	const Group<K>* groups = c.points().groups().data();
	const Lanes* velocity = c.bodies().velocity().data();
	c.layout().allParts([&](const Part& part, int number) {
		comparePass(ComparePass<K> {groups, points.data(), stiffnesses.data(), part.begin, part.end, velocity}, worst[number]);
	});
	double most = 0;
	for (const Lanes& here : worst)
		most = std::max(most, largest(here));
	return most;
}

template <class K>
void WallMatrix<K>::factorise(const ContactSet<K>& c)
{
	pairs.resize(c.layout().groups().size());
	for (size_t g = 0; g < pairs.size(); ++g)
		std::copy_n(c.layout().groups()[g].pair, width, pairs[g].begin());
	perMass.resize(c.bodies().size());
	for (size_t b = 0; b < perMass.size(); ++b)
		perMass[b] = c.bodies().perMass(b);
	setGraph(c);
	for (size_t k = 0; k < places.size(); ++k)
		factor.addDiagonal(int(k), Block::Identity() / c.bodies().velocity()[places[k]][3]);
	int edge = packs<K> > 1 ? int(places.size()) / packs<K> : 0; // after those within bodies
	for (size_t g = 0; g < c.layout().groups().size(); ++g)
		for (int i = 0; i < width; ++i)
			addPair(c, int(g), i, edge);
	factor.factorise();
}

// A node for each pack of a body; edges between those of a body, then between those of a pair.
template <class K>
void WallMatrix<K>::setGraph(const ContactSet<K>& c)
{
	constexpr int n = packs<K>;
	node.assign(c.bodies().size(), -1);
	places.clear();
	edges.clear();
	for (int b = 0; b < int(c.bodies().size()); ++b)
		if (c.bodies().isFree(b)) {
			node[b] = int(places.size());
			for (int k = 0; k < n; ++k)
				places.push_back(n * b + k);
			if (n > 1)
				edges.push_back({node[b], node[b] + 1});
		}
	for (const LaneGroup& group : c.layout().groups())
		for (int i = 0; i < width; ++i)
			if (c.bodies().isFree(group.body1[i]) && c.bodies().isFree(group.body2[i]))
				for (int k = 0; k < n * n; ++k)
					edges.push_back({node[group.body1[i]] + k / n, node[group.body2[i]] + k % n});
	factor.setGraph(int(places.size()), edges);
}

// J^T J / R of a lane's pair; its edges begin at `edge`, which goes on to the next pair's.
template <class K>
void WallMatrix<K>::addPair(const ContactSet<K>& c, int g, int i, int& edge)
{
	constexpr int n = packs<K>;
	Block own[2][n][n], across[n][n]; // rows and columns by pack
	for (int k = 0; k < n * n; ++k)
		own[0][k / n][k % n] = own[1][k / n][k % n] = across[k / n][k % n] = Block::Zero();
	for (int k = 0; k < lanePoints<K>; ++k) {
		const double stiffness = stiffnesses[g][k][i];
		if (!(stiffness > 0))
			continue;
		for (int row = 0; row < K::rows; ++row) {
			Vector3 a1[n], a2[n];
			for (int a = 0; a < n; ++a) {
				a1[a] = -partOf(points[g][k], row, i, 1, a);
				a2[a] = partOf(points[g][k], row, i, 2, a);
			}
			for (int a = 0; a < n; ++a)
				for (int b = 0; b < n; ++b) {
					own[0][a][b] += stiffness * a1[a] * a1[b].transpose();
					own[1][a][b] += stiffness * a2[a] * a2[b].transpose();
					across[a][b] += stiffness * a1[a] * a2[b].transpose();
				}
		}
	}
	for (const MortarRow<K>& ofMortar : mortar) {
		if (!isOfRow(ofMortar, g, i))
			continue;
		for (const TieArms<K>& arms : ofMortar.arms)
			for (int a = 0; a < n; ++a)
				for (int b = 0; b < n; ++b) {
					const auto vector = [&](int end, int pack) {
						return Vector3(arms.arm[end][pack][0], arms.arm[end][pack][1], arms.arm[end][pack][2]);
					};
					own[0][a][b] += vector(0, a) * vector(0, b).transpose() / ofMortar.resistance;
					own[1][a][b] += vector(1, a) * vector(1, b).transpose() / ofMortar.resistance;
					across[a][b] += vector(0, a) * vector(1, b).transpose() / ofMortar.resistance;
				}
	}
	const int body[2] = {c.layout().groups()[g].body1[i], c.layout().groups()[g].body2[i]};
	for (int side = 0; side < 2; ++side) {
		if (!c.bodies().isFree(body[side]))
			continue;
		for (int a = 0; a < n; ++a)
			factor.addDiagonal(node[body[side]] + a, own[side][a][a]);
		if (n > 1)
			factor.addEdge(node[body[side]] / n, own[side][0][n - 1]);
	}
	if (c.bodies().isFree(body[0]) && c.bodies().isFree(body[1]))
		for (int k = 0; k < n * n; ++k)
			factor.addEdge(edge++, across[k / n][k % n]);
}

template class WallMatrix<Plane>;
template class WallMatrix<Space>;

} // namespace masonry::wall
