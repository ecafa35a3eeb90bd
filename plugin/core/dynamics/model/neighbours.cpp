#include "dynamics/model/neighbours.hpp"
#include "dynamics/model/island_numbers.hpp"
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace masonry {

namespace {

Eigen::Matrix2d axesOf(const PlanePose& pose)
{
	Eigen::Matrix2d axes; // in columns
	axes << pose.cosine, -pose.sine, pose.sine, pose.cosine;
	return axes;
}

Matrix3 axesOf(const Pose& pose) { return pose.orientation.toRotationMatrix(); }

// The box around a part of a body along the axes of that; of a box, the box itself.
template <class K>
struct Around {
	Eigen::Matrix<double, K::dimension, K::dimension> axes; // in columns
	typename K::Vector center, halfSize;                    // m

	Around(const RigidBody<K>& body, int part) : axes(axesOf(body.pose))
	{
		const typename K::Vector &low = body.shape->part(part).low(), &high = body.shape->part(part).high();
		center = body.pose.position + axes * ((low + high) / 2);
		halfSize = (high - low) / 2;
	}
};

// The largest gap of the boxes around two parts along an axis of either: it is at most their distance, and negative where they overlap.
template <class K>
double separation(const RigidBody<K>& body1, int part1, const RigidBody<K>& body2, int part2)
{
	const Around<K> a(body1, part1), b(body2, part2);
	const typename K::Vector between = b.center - a.center;
	const auto turn = (a.axes.transpose() * b.axes).cwiseAbs().eval();
	const typename K::Vector alongA = (a.axes.transpose() * between).cwiseAbs() - a.halfSize - turn * b.halfSize,
	                         alongB = (b.axes.transpose() * between).cwiseAbs() - b.halfSize - turn.transpose() * a.halfSize;
	return std::max(alongA.maxCoeff(), alongB.maxCoeff());
}

// How far a point of a body may go in a step.
template <class K>
double travel(const RigidBody<K>& body, double step)
{
	return step *
	       (body.velocity.template head<K::dimension>().norm() + body.velocity.template tail<K::spins>().norm() * body.shape->radius());
}

template <class K>
bool overlap(const Bounds<K>& a, const Bounds<K>& b)
{
	return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

// Along which the centres are spread most: fewest bounds overlap along it.
template <class K>
int widestAxis(const std::vector<Bounds<K>>& all)
{
	typename K::Vector mean = K::Vector::Zero(), spread = K::Vector::Zero();
	for (const auto& box : all)
		mean += (box.low + box.high) / all.size();
	for (const auto& box : all)
		spread += (box.low + box.high - mean).cwiseAbs2();
	int axis;
	spread.maxCoeff(&axis);
	return axis;
}

template <class K>
std::array<int, 4> partsOf(const ContactPair<K>& pair)
{
	return {pair.body1, pair.body2, pair.part1, pair.part2};
}

} // namespace

template <class K>
Bounds<K> Neighbours<K>::bounds(const RigidBody<K>& body, int part, double enlargement) const
{
	Around<K> around(body, part);
	if (!frame.isIdentity(0)) {
		around.center = frame * around.center;
		around.axes = frame * around.axes;
	}
	const typename K::Vector half = around.axes.cwiseAbs() * around.halfSize + K::Vector::Constant(enlargement);
	return {around.center - half, around.center + half};
}

template <class K>
bool Neighbours<K>::isValid(const RigidSystem<K>& system, double step) const
{
	std::size_t count = 0;
	for (const auto& body : system.bodies)
		count += std::size_t(body.shape->size());
	if (enlarged.size() != count)
		return false;
	typename K::Vector least = K::Vector::Constant(-INFINITY), most = K::Vector::Constant(INFINITY); // that all may have moved together
	size_t i = 0;
	for (const auto& body : system.bodies) {
		const double enlargement = std::max(margin / 2, travel(body, step));
		for (int part = 0; part < body.shape->size(); ++part, ++i) {
			const Bounds<K> now = bounds(body, part, enlargement);
			least = least.cwiseMax(now.high - enlarged[i].high);
			most = most.cwiseMin(now.low - enlarged[i].low);
		}
	}
	return (least.array() <= most.array()).all() && std::all_of(apart.begin(), apart.end(), [&](const Parts& parts) {
		       const RigidBody<K>&a = system.bodies[parts[0]], &b = system.bodies[parts[1]];
		       return separation(a, parts[2], b, parts[3]) > std::max(margin / 2, travel(a, step)) + std::max(margin / 2, travel(b, step));
	       });
}

// Sweep: of the parts in the order of their lower ends, each one meets those that begin before it ends.
template <class K>
void Neighbours<K>::findPairs(const RigidSystem<K>& system, double step)
{
	if (enlarged.empty() && !system.bodies.empty())
		frame = axesOf(system.bodies.front().pose).transpose();
	enlarged.clear();
	std::vector<std::array<int, 2>> places; // body and part
	for (int b = 0; b < int(system.bodies.size()); ++b) {
		const double enlargement = std::max(margin, 4 * travel(system.bodies[b], step));
		for (int part = 0; part < system.bodies[b].shape->size(); ++part) {
			enlarged.push_back(bounds(system.bodies[b], part, enlargement));
			places.push_back({b, part});
		}
	}
	order.resize(enlarged.size());
	std::iota(order.begin(), order.end(), 0);
	const int axis = widestAxis(enlarged);
	std::sort(order.begin(), order.end(), [&](int a, int b) { return enlarged[a].low[axis] < enlarged[b].low[axis]; });

	near.clear();
	for (auto first = order.begin(); first != order.end(); ++first)
		for (auto second = first + 1; second != order.end() && enlarged[*second].low[axis] <= enlarged[*first].high[axis]; ++second) {
			const auto [one, other] = std::minmax(*first, *second);
			const auto [body1, part1] = places[one];
			const auto [body2, part2] = places[other];
			if (body1 != body2 && overlap(enlarged[one], enlarged[other]) &&
			    !(system.bodies[body1].prescribed && system.bodies[body2].prescribed))
				near.push_back({body1, body2, part1, part2});
		}
	std::sort(near.begin(), near.end());
	leaveOutPairsOfStructures(system, step);
}

template <class K>
void Neighbours<K>::leaveOutPairsOfStructures(const RigidSystem<K>& system, double step)
{
	const auto join = [&](const Parts& parts) {
		const RigidBody<K>&a = system.bodies[parts[0]], &b = system.bodies[parts[1]];
		return separation(a, parts[2], b, parts[3]) <= std::max(margin, 4 * travel(a, step)) + std::max(margin, 4 * travel(b, step));
	};
	std::vector<std::array<int, 2>> joined; // bodies
	for (const Parts& parts : near)
		if (join(parts))
			joined.push_back({parts[0], parts[1]});
	const std::vector<int> structure = islandNumbers(system.bodies, joined);
	const auto areTogether = [&](const Parts& parts) {
		const int a = structure[parts[0]], b = structure[parts[1]];
		return a < 0 || b < 0 || a == b;
	};
	const auto last = std::stable_partition(near.begin(), near.end(), areTogether);
	apart.assign(last, near.end());
	near.erase(last, near.end());
}

template <class K>
void Neighbours<K>::keepStates(const std::vector<ContactPair<K>>& old)
{
	pairs.clear();
	auto before = old.begin();
	for (const auto& parts : near) {
		while (before != old.end() && partsOf(*before) < parts)
			++before;
		if (before != old.end() && partsOf(*before) == parts) {
			pairs.push_back(*before);
			continue;
		}
		ContactPair<K>& pair = pairs.emplace_back();
		pair.body1 = parts[0];
		pair.body2 = parts[1];
		pair.part1 = parts[2];
		pair.part2 = parts[3];
		newPair(pair);
	}
}

template <class K>
bool Neighbours<K>::update(RigidSystem<K>& system, double step)
{
	if (isValid(system, step))
		return false;
	findPairs(system, step);
	keepStates(system.pairs);
	system.pairs.swap(pairs);
	system.list.changed();
	return true;
}

template class Neighbours<Plane>;
template class Neighbours<Space>;

} // namespace masonry
