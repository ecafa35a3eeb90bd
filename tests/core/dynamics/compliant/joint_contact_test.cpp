// Forces of one compliant joint.
#include "contact/collide.hpp"
#include "dynamics/compliant/joint_system.hpp"
#include "impact/impulse_problem.hpp"
#include <algorithm>
#include <catch.hpp>
#include <cmath>

using namespace masonry;

namespace {

// A block of 1 x 1 x 1 m on another, turned by `yaw`, pressed in by `depth`; moved by `step` in the last dt = 1e-3 s.
struct PressedBlocks {
	RigidBody<Space> lower, upper;
	JointContact contact;
	ContactPatch patch;
	ConvexPolyhedron box;

	PressedBlocks(double yaw, double depth, const JointLaw& law, const Vector3& half = Vector3::Constant(0.5))
	    : box(ConvexPolyhedron::box(half))
	{
		lower.prescribed = true;
		upper.mass = 1000;
		upper.inertia = {160, 160, 160};
		upper.pose.position = {0, 0, 2 * half.z() - depth};
		upper.pose.orientation = Eigen::AngleAxisd(yaw, Vector3::UnitZ());
		contact.body1 = 0;
		contact.body2 = 1;
		contact.law = law;
		look();
	}
	void look()
	{
		REQUIRE(collide(box, lower.pose, box, upper.pose, 1e-3, contact.patch.feature, patch));
		renewPatch(contact, patch);
	}
	void move(const Vector3& step, double dt = 1e-3)
	{
		upper.linear() = step / dt;
		upper.pose.position += step;
		look();
		updateForces(contact, lower, upper, dt);
	}
	void turn(double angle, double dt = 1e-3)
	{
		upper.linear().setZero();
		upper.spin() = Vector3(0, 0, angle / dt);
		upper.pose.orientation = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * upper.pose.orientation;
		look();
		updateForces(contact, lower, upper, dt);
	}
	double torque() const
	{
		double sum = 0;
		for (int i = 0; i < contact.size(); ++i)
			sum += contact.moment(i, upper.pose.position).z();
		return sum;
	}
	Vector3 total() const
	{
		Vector3 sum = Vector3::Zero();
		for (int i = 0; i < contact.size(); ++i)
			sum += contact.force(i);
		return sum;
	}
};

const JointLaw law {1e9, 5e8, 0, 0.5, 1};

} // namespace

TEST_CASE("The stiffness of a joint does not depend on the number of its points")
{
	for (double yaw : {0., 0.1, 0.5, 0.785}) {
		PressedBlocks blocks(yaw, 1e-6, law);
		blocks.move(Vector3::Zero());
		INFO("yaw " << yaw << ", " << blocks.contact.size() << " points");
		CHECK(blocks.total().z() == Approx(law.normalStiffness * blocks.patch.area * 1e-6).epsilon(1e-9));
		CHECK(blocks.total().head<2>().norm() < 1e-9 * blocks.total().z());
	}
}

namespace {

// Moment about the axis through the centroid of the upper block's lower face, of unit direction `axis`.
double momentAbout(const PressedBlocks& blocks, const Vector3& axis)
{
	const Vector3 centroid = blocks.upper.pose.toGlobal({0, 0, -blocks.box.halfSize().z()});
	double sum = 0;
	for (int i = 0; i < blocks.contact.size(); ++i)
		sum += axis.dot((blocks.contact.position(i) - centroid).cross(blocks.contact.force(i)));
	return sum;
}

// Turned about the axis through that centroid.
void lean(PressedBlocks& blocks, const Vector3& axis, double angle)
{
	const Vector3 arm(0, 0, blocks.box.halfSize().z()), centroid = blocks.upper.pose.toGlobal(-arm);
	blocks.upper.pose.orientation = Eigen::AngleAxisd(angle, axis) * blocks.upper.pose.orientation;
	blocks.upper.pose.position = centroid + blocks.upper.pose.orientation * arm;
	blocks.look();
	holdForces(blocks.contact);
}

} // namespace

// Against the second moment b d^3/12 of the area.
TEST_CASE("A closed face turns with the stiffness of an even bed")
{
	for (const Vector3& half : {Vector3(0.5, 0.5, 0.5), Vector3(0.8, 0.2, 0.3), Vector3(0.2, 0.8, 0.3)})
		for (int axis : {0, 1}) {
			CAPTURE(half.transpose(), axis);
			PressedBlocks blocks(0, 1e-6, law, half);
			const double across = half[1 - axis], along = half[axis], angle = 5e-7 / across;
			lean(blocks, Vector3::Unit(axis), angle);
			const double second = 2 * along * std::pow(2 * across, 3) / 12;
			CHECK(momentAbout(blocks, Vector3::Unit(axis)) == Approx(-law.normalStiffness * second * angle).epsilon(1e-5));
			CHECK(blocks.total().z() == Approx(law.normalStiffness * blocks.patch.area * 1e-6).epsilon(1e-5));
		}
}

// Squares turned against each other overlap in an octagon of unit inradius: the sum over its triangles has the polar second moment
// A R^2 (2 + cos 45)/6 with the circumradius R, half of it about each axis.
TEST_CASE("An octagonal face turns with the stiffness of its area")
{
	PressedBlocks blocks(0.25 * 3.14159265358979324, 1e-6, law);
	const double radius = 0.5 / std::cos(3.14159265358979324 / 8),
	             second = blocks.patch.area * radius * radius * (2 + std::cos(0.78539816)) / 12;
	REQUIRE(blocks.contact.size() == 8);
	lean(blocks, Vector3::UnitX(), 5e-7);
	CHECK(momentAbout(blocks, Vector3::UnitX()) == Approx(-law.normalStiffness * second * 5e-7).epsilon(1e-5));
}

// A face under a constant force that leans until its edge carries all. A pressure without tension opens from N b/6 on:
// M = N b (1/2 - sqrt(2 p / angle) / 3), p the compression at rest over the width b. The law is linear up to N b/2 at 6 p, where it is
// 1/2 / (1/2 - 1/sqrt(27)) = 1.63 times as stiff; the edge then bears the force at four times the compression. Springs give back what
// they take: the work on the way is what they store.
TEST_CASE("A face that leans opens between the pressure without tension and its edge, and stores the work")
{
	const double width = 1, p = 1e-6, k = law.normalStiffness, N = k * p * width * width;
	PressedBlocks blocks(0, p * width, law);
	double work = 0, before = 0;
	const double stored = blocks.contact.normalEnergy();
	for (int step = 1; step <= 1200; ++step) {
		const double angle = step * 1e-2 * p, depth = blocks.upper.pose.position.z();
		blocks.upper.pose.orientation = Eigen::AngleAxisd(angle, Vector3::UnitY());
		for (int turn = 0; turn < 30; ++turn) { // until the face carries N
			blocks.look();
			holdForces(blocks.contact);
			blocks.upper.pose.position.z() += (blocks.total().z() - N) / (k * width * width);
		}
		const double moment = -momentAbout(blocks, Vector3::UnitY());
		work += 0.5 * (before + moment) * 1e-2 * p - N * (blocks.upper.pose.position.z() - depth);
		before = moment;
		INFO("angle over penetration " << angle / p);
		const double exact = angle < 2 * p ? N * angle / (12 * p) : N * (0.5 - std::sqrt(2 * p / angle) / 3);
		CHECK(moment == Approx(N * std::min(angle / (12 * p), 0.5)).epsilon(2e-3)); // of the arms, which lean by the compression
		CHECK(moment > 0.998 * exact);
		CHECK(moment < 1.64 * exact);
	}
	CHECK(blocks.contact.normalEnergy() - stored == Approx(work).epsilon(1e-2));
	CHECK(-blocks.patch.points[0].gap + -blocks.patch.points[1].gap + -blocks.patch.points[2].gap + -blocks.patch.points[3].gap ==
	      Approx(4 * (4 * p - 0.5 * 12 * p)).epsilon(1e-2));
}

TEST_CASE("Shear is elastic up to mu N and slips beyond, and the work done goes where the energies say")
{
	PressedBlocks blocks(0, 1e-6, law);
	blocks.move(Vector3::Zero());
	const double N = 1e9 * 1e-6, k = 5e8; // area 1 m^2
	blocks.move({5e-7, 0, 0});
	CHECK(blocks.total().x() == Approx(-k * 5e-7).epsilon(1e-9)); // 250 N of 500 N
	CHECK(blocks.contact.energy.friction == 0);
	blocks.move({2e-6, 0, 0});
	CHECK(blocks.total().x() == Approx(-0.5 * N).epsilon(1e-9));
	// Elastic limit 1e-6 m: 1.5e-6 of the 2.5e-6 m has slipped, under the limit force.
	CHECK(blocks.contact.energy.friction == Approx(0.5 * N * 1.5e-6).epsilon(1e-9));
}

// Against the pressure, integrated over the face. Bound of the energy: the elastic part of the turn, by even springs 2 % of it.
TEST_CASE("A face that turns on its bed is held with the torque of an even pressure")
{
	for (const Vector3& half : {Vector3(0.5, 0.5, 0.5), Vector3(0.8, 0.2, 0.3), Vector3(0.2, 0.8, 0.3)}) {
		CAPTURE(half.transpose());
		constexpr int n = 200;
		double distance = 0; // mean, from the centre
		for (int i = 0; i < n; ++i)
			for (int j = 0; j < n; ++j)
				distance += std::hypot(half.x() * (2 * i + 1. - n) / n, half.y() * (2 * j + 1. - n) / n) / (n * n);
		PressedBlocks blocks(0, 1e-6, law, half);
		blocks.move(Vector3::Zero());
		const double N = blocks.total().z(), angle = 2e-4;
		blocks.turn(angle);
		CHECK(blocks.torque() == Approx(-0.5 * N * distance).epsilon(1e-3));
		CHECK(blocks.total().head<2>().norm() < 1e-6 * N);
		CHECK(blocks.contact.energy.friction == Approx(0.5 * N * distance * angle).epsilon(0.03));
	}
}

// The motion takes from the bodies what the springs are given and what is dissipated, wherever the friction points go while the load moves
// over the face, and the springs hold no more than they were given. Bound: a step's work is that of the mean force on its motion, but for
// arms that change by the motion of 1e-8 m in 0.2 m.
TEST_CASE("Friction points that move give no energy")
{
	PressedBlocks blocks(0, 1e-6, law, {0.8, 0.2, 0.3});
	blocks.move(Vector3::Zero());
	using Load = Eigen::Matrix<double, 6, 1>;
	const auto load = [&] {
		Load sum = Load::Zero();
		for (int i = 0; i < blocks.contact.size(); ++i) {
			sum.head<3>() += blocks.contact.force(i);
			sum.tail<3>() += blocks.contact.moment(i, blocks.upper.pose.position);
		}
		return sum;
	};
	const double stored = blocks.contact.energy.elastic;
	double taken = 0, given = 0, dissipated = 0;
	for (int k = 0; k < 400; ++k) {
		Load step;
		step << 2e-8 * std::cos(0.05 * k), 1e-8, 0, 0, 3e-8 * std::sin(0.1 * k), 3e-8;
		const Load before = load();
		blocks.upper.linear() = step.head<3>() / 1e-3;
		blocks.upper.spin() = step.tail<3>() / 1e-3;
		blocks.upper.advance(1e-3);
		blocks.look();
		updateForces(blocks.contact, blocks.lower, blocks.upper, 1e-3);
		taken -= 0.5 * (before + load()).dot(step);
		CHECK(blocks.contact.energy.friction >= 0);
		given += blocks.contact.energy.taken;
		dissipated += blocks.contact.energy.friction + blocks.contact.energy.damping;
	}
	CHECK(dissipated > stored);
	CHECK(given + dissipated == Approx(taken).epsilon(1e-5));
	CHECK(blocks.contact.energy.elastic - stored <= given + 1e-5 * taken);
}

TEST_CASE("Forces of a position that a hand-off has set obey Coulomb's law")
{
	PressedBlocks blocks(0, 1e-6, law);
	blocks.move({4e-7, 0, 0});
	for (int i = 0; i < blocks.contact.size(); ++i)
		blocks.contact.points[i].shear.x() *= i < 2 ? 1 : 10; // of 500 N that friction bears: 200 N and 2000 N
	holdForces(blocks.contact);
	double stored = 0;
	for (int i = 0; i < blocks.contact.size(); ++i) {
		const JointPoint& point = blocks.contact.points[i];
		CHECK(point.normalForce == Approx(250).epsilon(1e-9));
		CHECK(point.shearForce.norm() == Approx(i < 2 ? 50 : 125).epsilon(1e-9));
		stored += 0.5 * point.normalForce * 1e-6 + 0.5 * point.shearForce.squaredNorm() / blocks.contact.shearStiffness(i);
	}
	CHECK(blocks.contact.energy.elastic == Approx(stored).epsilon(1e-9));
}

TEST_CASE("No slip is a law of its own")
{
	JointLaw stuck = law;
	stuck.friction = noSlip;
	PressedBlocks blocks(0, 1e-6, stuck);
	blocks.move({1e-4, 0, 0});
	CHECK(blocks.total().x() == Approx(-5e8 * blocks.patch.area * 1e-4).epsilon(1e-9));
}

TEST_CASE("A muted point carries nothing, an open one neither, and no joint pulls")
{
	JointLaw damped = law;
	damped.dampingRatio = 1;
	PressedBlocks blocks(0, 1e-6, damped);
	blocks.contact.points[0].muted = true;
	blocks.move(Vector3::Zero());
	CHECK(blocks.contact.force(0).norm() == 0);
	// Three corners with the share w = 3/4 of a rectangle, r = 1/3: r w / (1 - (1 - r) w) of the face.
	CHECK(blocks.total().z() == Approx(0.5 * 1e9 * 1e-6).epsilon(1e-9));
	blocks.move({0, 0, 0.9e-6}); // leaves fast: the dashpot would pull
	for (int i = 0; i < blocks.contact.size(); ++i)
		CHECK(blocks.contact.points[i].normalForce >= 0);
}

TEST_CASE("A point that stays keeps its shear when the patch is renewed")
{
	PressedBlocks blocks(0, 1e-6, law);
	blocks.move({3e-7, 0, 0});
	const auto before = blocks.contact.points[2];
	blocks.look();
	CHECK(blocks.contact.points[2].feature == before.feature);
	CHECK((blocks.contact.points[2].shear - before.shear).norm() < 1e-20);
}

// Blocks that are flush turn by so little that force and area are the same, but two points take the place of each corner of the patch and
// one appears on each side.
TEST_CASE("Corners of a patch that come and go make and lose no energy")
{
	const double turn = 3e-4;
	PressedBlocks blocks(0, 1e-6, law);
	blocks.move({3e-7, 0, 0});
	const double before = blocks.contact.energy.elastic;
	const Vector3 force = blocks.total();
	for (const double angle : {turn, 0.}) {
		blocks.upper.pose.orientation = Eigen::AngleAxisd(angle, Vector3::UnitZ());
		blocks.move(Vector3::Zero());
		CHECK(blocks.contact.size() == (angle > 0 ? 8 : 4));
		CHECK(std::abs(blocks.contact.energy.elastic - before) < turn * before);
		CHECK((blocks.total() - force).norm() < turn * force.norm());
	}
}

TEST_CASE("The shear of a joint that turns with its blocks turns with it, at its length")
{
	PressedBlocks blocks(0, 1e-6, law);
	blocks.move({3e-7, 0, 0});
	const Vector3 before = blocks.contact.points[2].shear;
	const Quaternion turn(Eigen::AngleAxisd(0.3, Vector3::UnitY()));
	for (RigidBody<Space>* body : {&blocks.lower, &blocks.upper})
		body->pose = {turn * body->pose.position, turn * body->pose.orientation};
	blocks.look();
	CHECK((blocks.contact.points[2].shear - turn * before).norm() < 1e-12 * before.norm()); // round-off
}

// Blocks of 1 m, the lower turned by 0.03 and the upper by 0.07, which leans beside the lower's edge. What moves along the upper's face
// leaves the gaps at the lower's vertices as they are (along the lower's normal it moves by 4e-6). Gaps that are looked up anew tell, up to
// the turn of 1e-5 times the widest gap, 0.04, times the angle between the faces, 0.04. Pyramids on two sides leave the faces that meet as
// they are, and number them otherwise.
TEST_CASE("Contacts that move with their bodies have the gaps that are looked up")
{
	std::vector<Vector3> corners;
	for (int number = 0; number < 8; ++number)
		corners.push_back({number & 1 ? 0.5 : -0.5, number & 2 ? 0.5 : -0.5, number & 4 ? 0.5 : -0.5});
	const int pyramids = GENERATE(0, 1, 2); // on how many sides
	for (int k = 0; k < pyramids; ++k)
		corners.push_back({0, k ? -0.8 : 0.8, 0});
	const auto shape = std::make_shared<const Solid<ConvexPolyhedron>>(ConvexPolyhedron::hull(corners));
	CAPTURE(pyramids);
	for (const bool swapped : {false, true}) {
		JointSystem s;
		s.bodies.resize(2);
		const int lower = swapped ? 1 : 0, upper = 1 - lower;
		const auto turn = [](double angle) { return Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitY())); };
		for (RigidBody<Space>& body : s.bodies)
			body.shape = shape;
		s.bodies[lower].pose.orientation = turn(0.03);
		s.bodies[upper].pose.orientation = turn(0.07);
		s.bodies[upper].pose.position = turn(0.03) * Vector3(0.5, 0, 0.5) + turn(0.07) * Vector3(-0.49, 0, 0.5 - 1e-5);
		JointContact contact;
		contact.body1 = 0;
		contact.body2 = 1;
		const auto look = [&](ContactPatch& patch) {
			PatchFeature feature = contact.patch.feature;
			REQUIRE(collide(shape->part(0), s.bodies[0].pose, shape->part(0), s.bodies[1].pose, 1e-3, feature, patch));
		};
		ContactPatch found;
		look(found);
		renewPatch(contact, found);
		s.contacts = {contact};
		const Bodies<Space> before = s.bodies;
		s.bodies[upper].pose.position += turn(0.07) * Vector3(1e-4, 0, 2e-6);
		s.bodies[upper].pose.orientation = turn(0.07 + 1e-5);
		moveContacts(s, before);
		look(found);
		int vertices = 0;
		for (int i = 0; i < found.size(); ++i)
			for (int k = 0; k < contact.size(); ++k)
				if (s.contacts[0].patch.points[k].feature == found.points[i].feature) {
					++vertices;
					CHECK(std::abs(s.contacts[0].patch.points[k].gap - found.points[i].gap) < 2e-8);
				}
		CHECK(vertices == 4);
	}
}

TEST_CASE("What springs take beyond what they store, where points land within a step, is no damping")
{
	for (double damping : {0., 0.5}) {
		JointLaw damped = law;
		damped.dampingRatio = damping;
		PressedBlocks blocks(0, -1e-6, damped);
		const double way = 3e-6, depth = 2e-6, k = law.normalStiffness, dt = 1e-3;
		blocks.move({0, 0, -way}, dt);
		const double c = 2 * damping * std::sqrt(k * blocks.upper.mass); // area 1 m^2, on a base
		INFO("damping ratio " << damping);
		// Leapfrog: the mean of the forces at the ends of the step, the first of them 0, on the way.
		CHECK(blocks.contact.energy.elastic == Approx(0.5 * k * depth * depth).epsilon(1e-9));
		CHECK(blocks.contact.energy.taken == Approx(0.5 * k * depth * way).epsilon(1e-9));
		CHECK(blocks.contact.energy.damping == Approx(0.5 * c * way / dt * way).epsilon(1e-9).margin(1e-15));
		// And as it parts: what the spring has stored comes back, and more.
		blocks.move({0, 0, way}, dt);
		const double last = std::max(0., k * depth - c * -way / dt); // the force at the start of this step
		CHECK(blocks.contact.energy.elastic == 0);
		CHECK(blocks.contact.energy.taken + blocks.contact.energy.damping == Approx(-0.5 * last * way).epsilon(1e-9));
		CHECK(blocks.contact.energy.damping >= 0);
	}
}

TEST_CASE("Slip and dashpots only dissipate, in joints that move to and fro")
{
	JointLaw damped = law;
	damped.dampingRatio = 0.5;
	PressedBlocks blocks(0.3, 1e-6, damped);
	blocks.move(Vector3::Zero());
	double elastic = blocks.contact.energy.elastic, unexplained = 0, dissipated = 0;
	for (int k = 0; k < 400; ++k) { // steps of a small part of the cycles: the points stay loaded, and slip
		blocks.move({2e-8 * std::cos(0.02 * k), 1e-8 * std::sin(0.03 * k), 4e-9 * std::cos(0.05 * k)});
		const JointEnergy& energy = blocks.contact.energy;
		CHECK(energy.friction >= 0);
		dissipated += energy.friction + energy.damping;
		unexplained += std::abs(energy.elastic - elastic - energy.taken);
		elastic = energy.elastic;
	}
	CHECK(dissipated > 0);
	CHECK(unexplained < 1e-6 * dissipated); // no point meets or parts
}

// Two equal boxes, flush: as the upper one goes to and fro across its bed, vertices of the patch become crossings of edges and back.
// Leapfrog: the work of a force over a step is that of the mean of its values at the two ends.
TEST_CASE("What a joint takes in a step is the work of its forces, whichever points they act at")
{
	JointLaw damped = law;
	damped.dampingRatio = 0.5;
	PressedBlocks blocks(0, 1e-6, damped);
	blocks.move(Vector3::Zero());
	int renewals = 0;
	double most = 0;
	for (int k = 0; k < 40; ++k) {
		const Vector3 before = blocks.total(), step(3e-3 * std::cos(0.7 * k), 2e-3 * std::sin(0.5 * k), 2e-8 * std::cos(0.3 * k));
		const PerPoint<JointPoint> old = blocks.contact.points;
		blocks.move(step);
		for (const JointPoint& point : old)
			renewals += std::none_of(blocks.contact.points.begin(), blocks.contact.points.end(),
			                         [&](const JointPoint& p) { return p.feature == point.feature; });
		const JointEnergy& energy = blocks.contact.energy;
		const double work = -0.5 * (before + blocks.total()).dot(step);
		most = std::max(most, std::abs(work));
		CAPTURE(k);
		CHECK(std::abs(energy.taken + energy.friction + energy.damping - work) < 1e-9 * most);
	}
	CHECK(renewals > 5);
}
