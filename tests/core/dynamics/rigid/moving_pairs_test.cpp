// Random pairs of boxes that fly towards each other, step by step, against an independent distance: no impulse where they are apart, no
// overlap. A long run: MASONRY_MOVING_PAIRS=1000000.
#include "dynamics/rigid/rigid_step.hpp"
#include "oracle/minkowski.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cstdlib>
#include <random>

using namespace masonry;
using namespace masonry::rigid;

namespace {

Matrix3 axesOf(const Pose& pose) { return pose.orientation.toRotationMatrix(); }
Eigen::Matrix2d axesOf(const PlanePose& pose) { return Eigen::Rotation2Dd(pose.angle).toRotationMatrix(); }

// Width of the widest slab between two boxes, negative where they overlap: along the normals of their faces and of pairs of edges.
template <class K>
double separation(const typename K::Vector& half1, const typename K::Pose& pose1, const typename K::Vector& half2,
                  const typename K::Pose& pose2)
{
	const auto axes1 = axesOf(pose1), axes2 = axesOf(pose2);
	double widest = -INFINITY;
	const auto tryNormal = [&](typename K::Vector n) {
		constexpr double parallel = 1e-6;
		if (n.norm() < parallel)
			return;
		n.normalize();
		const double reach = (axes1.transpose() * n).cwiseAbs().dot(half1) + (axes2.transpose() * n).cwiseAbs().dot(half2);
		widest = std::max(widest, std::abs(n.dot(pose2.position - pose1.position)) - reach);
	};
	for (int i = 0; i < K::dimension; ++i) {
		tryNormal(axes1.col(i));
		tryNormal(axes2.col(i));
		if constexpr (K::dimension == 3)
			for (int j = 0; j < 3; ++j)
				tryNormal(axes1.col(i).cross(axes2.col(j)));
	}
	return widest;
}

template <class K>
double separation(const std::vector<RigidBody<K>>& bodies)
{
	return separation<K>(bodies[0].halfSize, bodies[0].pose, bodies[1].halfSize, bodies[1].pose);
}

void setOrientation(Pose& pose, std::mt19937& random)
{
	std::normal_distribution<double> normal;
	pose.orientation = Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized();
}
void setOrientation(PlanePose& pose, std::mt19937& random) { pose.setAngle(std::uniform_real_distribution<double>(0, 2 * M_PI)(random)); }

template <class K>
struct MovingPair {
	RigidSystem<K> system;
	double length, travel; // smallest half size; what the boxes move relative to each other in a step of 1 s, about

	// Nearly in touch, half sizes from 0.2 to 1 m, frictionless, elastic or not, without gravity. The moments of inertia of a sphere: in
	// free flight a body keeps its spin.
	explicit MovingPair(std::mt19937& random)
	{
		std::uniform_real_distribution<double> unit;
		std::normal_distribution<double> normal;
		const auto vector = [&](auto v) {
			for (int i = 0; i < v.size(); ++i)
				v[i] = normal(random);
			return v;
		};
		system.bodies.resize(2);
		for (auto& body : system.bodies) {
			for (int i = 0; i < K::dimension; ++i)
				body.halfSize[i] = 0.2 + 0.8 * unit(random);
			body.mass = 1;
			body.inertia.setConstant(body.halfSize.squaredNorm() / 6);
			setOrientation(body.pose, random);
		}
		length = std::min(system.bodies[0].halfSize.minCoeff(), system.bodies[1].halfSize.minCoeff());
		const typename K::Vector direction = vector(typename K::Vector()).normalized();
		double near = 0, far = 10;
		for (int k = 0; k < 40; ++k) {
			const double middle = (near + far) / 2;
			system.bodies[1].pose.position = middle * direction;
			(separation<K>(system.bodies) < 0.03 * length ? near : far) = middle;
		}
		travel = 0.05 * length * std::pow(10, -1.5 * unit(random));
		for (auto& body : system.bodies) {
			body.velocity.template head<K::dimension>() = travel / 2 * vector(typename K::Vector());
			body.velocity.template tail<K::spins>() = travel / 2 / body.halfSize.norm() * vector(typename K::Spin());
		}
		system.bodies[1].velocity.template head<K::dimension>() -= travel * unit(random) * direction;
		ContactPair<K> pair;
		pair.body1 = 0;
		pair.body2 = 1;
		pair.friction = 0;
		pair.restitution = unit(random);
		system.pairs.push_back(pair);
	}
};

// The least separation in free flight of one step.
template <class K>
double leastSeparation(std::vector<RigidBody<K>> bodies, int samples)
{
	double least = separation<K>(bodies);
	for (int k = 0; k < samples; ++k) {
		for (auto& body : bodies)
			K::advance(body.pose, body.velocity, 1. / samples);
		least = std::min(least, separation<K>(bodies));
	}
	return least;
}

struct Worst {
	double apart {-INFINITY}, overlap {-INFINITY}; // relative to the smallest half size
	int impulses {0};
};

template <class K>
Worst fly(int pairs, unsigned seed)
{
	std::mt19937 random(seed);
	RigidStep<K> step;
	Worst worst;
	for (int n = 0; n < pairs; ++n) {
		MovingPair<K> pair(random);
		RigidSystem<K>& s = pair.system;
		const int most = int(0.3 * pair.length / pair.travel) + 10;
		bool struck = false;
		for (int k = 0; k < most && !struck && separation<K>(s.bodies) < 0.05 * pair.length; ++k) {
			const auto before = s.bodies;
			step.advance(s, 1);
			worst.overlap = std::max(worst.overlap, -separation<K>(s.bodies) / pair.length);
			for (int b = 0; b < 2; ++b)
				struck |= (s.bodies[b].velocity - before[b].velocity).norm() > 1e-9 * pair.travel;
			if (!struck)
				continue;
			++worst.impulses;
			double apart = leastSeparation<K>(before, 20) / pair.length;
			if (apart > 0) // a corner may only just pass through the other box
				apart = leastSeparation<K>(before, 2000) / pair.length;
			worst.apart = std::max(worst.apart, apart);
		}
	}
	return worst;
}

int pairsFor(int few)
{
	const char* asked = std::getenv("MASONRY_MOVING_PAIRS");
	return asked ? std::atoi(asked) : few;
}

} // namespace

TEST_CASE("The widest slab over faces and edges is that of the Minkowski difference")
{
	std::mt19937 random(3);
	for (int n = 0; n < 20; ++n) {
		const auto bodies = MovingPair<Space>(random).system.bodies;
		const auto truth = oracle::separation({bodies[0].halfSize}, bodies[0].pose, {bodies[1].halfSize}, bodies[1].pose);
		CHECK(separation<Space>(bodies) == Approx(truth.value).margin(1e-9));
	}
}

// Features are those of the patch within tolerance::contact::vertexReach of their ends, 1e-4 of the smallest half size, and a feature that
// a pair does not have yet may be as deep. A corner moves by 0.2 of the half size in a step at most: half of what it moves between two of
// 2000 samples is 5e-5.
TEMPLATE_TEST_CASE("Boxes in free flight strike each other only where they touch, and do not overlap", "", Plane, Space)
{
	const Worst worst = fly<TestType>(pairsFor(10000), 17);
	CAPTURE(worst.apart, worst.overlap, worst.impulses);
	CHECK(worst.impulses > 1000);
	CHECK(worst.apart < 2e-4);
	CHECK(worst.overlap < 2e-4);
}
