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

// The box around a body along its own axes; of a box, the box itself.
template <class K>
struct Around {
	Eigen::Matrix<double, K::dimension, K::dimension> axes; // in columns
	typename K::Vector center, halfSize;                    // m

	explicit Around(const RigidBody<K>& body) : axes(axesOf(body.pose))
	{
		const typename K::Vector &low = body.shape->low(), &high = body.shape->high();
		center = body.pose.position + axes * ((low + high) / 2);
		halfSize = (high - low) / 2;
	}
};

// The largest gap of the boxes around two bodies along an axis of either: it is at most their distance, and negative where they overlap.
template <class K>
double separation(const RigidBody<K>& body1, const RigidBody<K>& body2)
{
	const Around<K> a(body1), b(body2);
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
std::array<int, 2> bodiesOf(const ContactPair<K>& pair)
{
	return {pair.body1, pair.body2};
}

} // namespace

template <class K>
Bounds<K> Neighbours<K>::bounds(const RigidBody<K>& body, double enlargement) const
{
	Around<K> around(body);
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
	if (enlarged.size() != system.bodies.size())
		return false;
	typename K::Vector least = K::Vector::Constant(-INFINITY), most = K::Vector::Constant(INFINITY); // that all may have moved together
	for (size_t i = 0; i < enlarged.size(); ++i) {
		const Bounds<K> now = bounds(system.bodies[i], std::max(margin / 2, travel(system.bodies[i], step)));
		least = least.cwiseMax(now.high - enlarged[i].high);
		most = most.cwiseMin(now.low - enlarged[i].low);
	}
	return (least.array() <= most.array()).all() && std::all_of(apart.begin(), apart.end(), [&](const Bodies& bodies) {
		       const RigidBody<K>&a = system.bodies[bodies[0]], &b = system.bodies[bodies[1]];
		       return separation(a, b) > std::max(margin / 2, travel(a, step)) + std::max(margin / 2, travel(b, step));
	       });
}

// Sweep: of the bodies in the order of their lower ends, each one meets those that begin before it ends.
template <class K>
void Neighbours<K>::findPairs(const RigidSystem<K>& system, double step)
{
	if (enlarged.empty() && !system.bodies.empty())
		frame = axesOf(system.bodies.front().pose).transpose();
	enlarged.clear();
	for (const auto& body : system.bodies)
		enlarged.push_back(bounds(body, std::max(margin, 4 * travel(body, step))));
	order.resize(enlarged.size());
	std::iota(order.begin(), order.end(), 0);
	const int axis = widestAxis(enlarged);
	std::sort(order.begin(), order.end(), [&](int a, int b) { return enlarged[a].low[axis] < enlarged[b].low[axis]; });

	near.clear();
	for (auto first = order.begin(); first != order.end(); ++first)
		for (auto second = first + 1; second != order.end() && enlarged[*second].low[axis] <= enlarged[*first].high[axis]; ++second) {
			const auto [body1, body2] = std::minmax(*first, *second);
			if (overlap(enlarged[body1], enlarged[body2]) && !(system.bodies[body1].prescribed && system.bodies[body2].prescribed))
				near.push_back({body1, body2});
		}
	std::sort(near.begin(), near.end());
	leaveOutPairsOfStructures(system, step);
}

template <class K>
void Neighbours<K>::leaveOutPairsOfStructures(const RigidSystem<K>& system, double step)
{
	const auto join = [&](const Bodies& bodies) {
		const RigidBody<K>&a = system.bodies[bodies[0]], &b = system.bodies[bodies[1]];
		return separation(a, b) <= std::max(margin, 4 * travel(a, step)) + std::max(margin, 4 * travel(b, step));
	};
	std::vector<Bodies> joined;
	std::copy_if(near.begin(), near.end(), std::back_inserter(joined), join);
	const std::vector<int> structure = islandNumbers(system.bodies, joined);
	const auto areTogether = [&](const Bodies& bodies) {
		const int a = structure[bodies[0]], b = structure[bodies[1]];
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
	for (const auto& bodies : near) {
		while (before != old.end() && bodiesOf(*before) < bodies)
			++before;
		if (before != old.end() && bodiesOf(*before) == bodies) {
			pairs.push_back(*before);
			continue;
		}
		ContactPair<K>& pair = pairs.emplace_back();
		pair.body1 = bodies[0];
		pair.body2 = bodies[1];
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
