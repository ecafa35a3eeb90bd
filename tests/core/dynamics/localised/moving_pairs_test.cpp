// Random pairs of boxes that fly towards each other, step by step, against an independent distance: no impulse where they are apart, no
// overlap. A long run: MASONRY_MOVING_PAIRS=1000000.
#include "dynamics/localised/localised_step.hpp"
#include "oracle/polyhedra.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cstdlib>
#include <random>

using namespace masonry;
using namespace masonry::localised;

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
	return separation<K>(bodies[0].shape->halfSize(), bodies[0].pose, bodies[1].shape->halfSize(), bodies[1].pose);
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

	// Frictionless. The moments of inertia of a sphere: in free flight a body keeps its spin.
	MovingPair(const std::array<RigidBody<K>, 2>& boxes, double restitution)
	{
		system.bodies.assign(boxes.begin(), boxes.end());
		for (auto& body : system.bodies) {
			body.mass = 1;
			body.inertia.setConstant(body.shape->halfSize().squaredNorm() / 6);
		}
		length = std::min(boxes[0].shape->thickness(), boxes[1].shape->thickness());
		travel = (boxes[1].velocity - boxes[0].velocity).norm();
		ContactPair<K> pair;
		pair.body1 = 0;
		pair.body2 = 1;
		pair.friction = 0;
		pair.restitution = restitution;
		system.pairs.push_back(pair);
	}

	// Nearly in touch, half sizes from 0.2 to 1 m, elastic or not, without gravity.
	explicit MovingPair(std::mt19937& random) : MovingPair(boxes(random), 0)
	{
		std::uniform_real_distribution<double> unit;
		std::normal_distribution<double> normal;
		const auto vector = [&](auto v) {
			for (int i = 0; i < v.size(); ++i)
				v[i] = normal(random);
			return v;
		};
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
			body.velocity.template tail<K::spins>() = travel / 2 / body.shape->radius() * vector(typename K::Spin());
		}
		system.bodies[1].velocity.template head<K::dimension>() -= travel * unit(random) * direction;
		system.pairs[0].restitution = unit(random);
	}

private:
	static std::array<RigidBody<K>, 2> boxes(std::mt19937& random)
	{
		std::uniform_real_distribution<double> unit;
		std::array<RigidBody<K>, 2> boxes;
		for (auto& body : boxes) {
			typename K::Vector half;
			for (int i = 0; i < K::dimension; ++i)
				half[i] = 0.2 + 0.8 * unit(random);
			body.setBox(half);
			setOrientation(body.pose, random);
		}
		return boxes;
	}
};

// The least separation in free flight of one step.
template <class K>
double minSeparation(std::vector<RigidBody<K>> bodies, int samples)
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

// Steps of 1 s until the boxes of the pair have struck each other, have been `most` of them, or are farther apart than at the start.
template <class K>
void fly(MovingPair<K>& pair, LocalisedStep<K>& step, int most, Worst& worst)
{
	RigidSystem<K>& s = pair.system;
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
		double apart = minSeparation<K>(before, 20) / pair.length;
		if (apart > 0) // a corner may only just pass through the other box
			apart = minSeparation<K>(before, 2000) / pair.length;
		worst.apart = std::max(worst.apart, apart);
	}
}

template <class K>
Worst fly(int pairs, unsigned seed)
{
	std::mt19937 random(seed);
	LocalisedStep<K> step;
	Worst worst;
	for (int n = 0; n < pairs; ++n) {
		MovingPair<K> pair(random);
		fly(pair, step, int(0.3 * pair.length / pair.travel) + 10, worst);
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
		const auto truth = oracle::slabOfDifferences(bodies[0].shape->part(0), bodies[0].pose, bodies[1].shape->part(0), bodies[1].pose);
		CHECK(separation<Space>(bodies) == Approx(truth.width).margin(1e-9));
	}
}

// Features are those of the patch within tolerance::contact::vertexReach of their ends, 1e-4 of the smallest half size, and a feature that
// a pair does not have yet may be as deep. A corner moves by 0.2 of the half size in a step at most: half of what it moves between two of
// 2000 samples is 5e-5.
TEMPLATE_TEST_CASE("Boxes in free flight strike each other only where they touch, and do not overlap", "[long]", Plane, Space)
{
	const Worst worst = fly<TestType>(pairsFor(10000), 17);
	CAPTURE(worst.apart, worst.overlap, worst.impulses);
	CHECK(worst.impulses > 1000);
	CHECK(worst.apart < 2e-4);
	CHECK(worst.overlap < 2e-4);
}

// Box at a place, with its orientation (w, x, y, z), velocity and spin.
RigidBody<Space> box(const Vector3& halfSize, const Vector3& position, const std::array<double, 4>& q, const Vector3& velocity,
                     const Vector3& spin)
{
	RigidBody<Space> body;
	body.setBox(halfSize);
	body.pose = {position, Quaternion(q[0], q[1], q[2], q[3]).normalized()};
	body.velocity << velocity, spin;
	return body;
}

// Pairs 188339, 425007 and 983053 of the random ones. In the first and third the patch was that of a face which looks to the side, for that
// which looks at the other box lies beyond it; in the second a face in touch kept its patch, without the deepest vertex.
TEST_CASE("Boxes whose edges cross near the end of a face strike each other there and nowhere else")
{
	LocalisedStep<Space> step;
	for (MovingPair<Space> pair :
	     {MovingPair<Space>({{box({0.342972, 0.512431, 0.40522}, {0, 0, 0}, {-0.765591, -0.203773, 0.487661, -0.366788},
	                              {0.00258704, -0.00241112, 0.00340348}, {0.000667032, -0.00469524, 0.00267666}),
	                          box({0.720778, 0.478205, 0.736978}, {0.022847, -0.950622, 1.30278}, {0.55084, -0.726929, -0.127194, 0.389835},
	                              {-0.000107884, 0.00105902, -0.00529578}, {-0.00210924, -0.00288809, 0.000225858})}},
	                        0.906),
	      MovingPair<Space>(
	          {{box({0.722588, 0.51567, 0.562495}, {0, 0, 0}, {0.828764, 0.304062, -0.469194, -0.0235218},
	                {-0.00799966, -0.00651254, 0.00270448}, {-0.00535341, 0.00525393, 0.00242064}),
	            box({0.242194, 0.347967, 0.635219}, {-1.33194, -0.593547, -0.328141}, {0.214992, 0.821393, 0.374581, 0.372533},
	                {0.00734644, 0.0034801, -0.00264882}, {-0.000909164, -0.0154519, 0.0130904})}},
	          0.0709),
	      MovingPair<Space>(
	          {{box({0.615823, 0.63634, 0.524756}, {0, 0, 0}, {0.183954, 0.570758, -0.576176, 0.555353},
	                {-0.00454292, 1.46078e-05, 0.0044803}, {-0.0029131, 0.0192067, -0.000481984}),
	            box({0.986976, 0.446422, 0.884242}, {-0.808514, 0.952418, -1.51733}, {0.252764, -0.58849, 0.762868, 0.0884433},
	                {0.00609041, -0.00334327, 0.00207208}, {0.00564844, -0.0046216, -0.00350917})}},
	          0.0516)}) {
		Worst worst;
		fly(pair, step, 30, worst);
		CAPTURE(pair.length, worst.apart, worst.overlap, worst.impulses);
		CHECK(worst.apart < 2e-4);
		CHECK(worst.overlap < 2e-4);
	}
}

// Sizes and velocities scaled by a power of two, spins and times as they are: every tolerance is relative, so that the speeds scale too, up
// to the solver's tolerance and the round-off of squares and roots.
TEMPLATE_TEST_CASE("Without gravity a pair of boxes and the same a thousand times larger or smaller move alike", "", Plane, Space)
{
	using K = TestType;
	std::mt19937 random(5);
	for (int n = 0; n < 100; ++n) {
		const MovingPair<K> pair(random);
		const auto run = [&pair](double size) {
			RigidSystem<K> s = pair.system;
			for (auto& body : s.bodies) {
				body.setBox(size * body.shape->halfSize());
				body.inertia *= size * size;
				body.pose.position *= size;
				body.velocity.template head<K::dimension>() *= size;
			}
			LocalisedStep<K> step;
			for (int k = 0; k < 40; ++k)
				step.advance(s, 1);
			return s.bodies;
		};
		const auto one = run(1);
		for (double size : {1. / 1024, 1024.}) {
			const auto other = run(size);
			for (int b = 0; b < 2; ++b) {
				typename K::Velocity velocity = other[b].velocity;
				velocity.template head<K::dimension>() /= size;
				CHECK((velocity - one[b].velocity).norm() < 1e-8 * pair.travel / pair.length);
				CHECK((other[b].pose.position / size - one[b].pose.position).norm() < 1e-6 * pair.length);
			}
		}
	}
}
