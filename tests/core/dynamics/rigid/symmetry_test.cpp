// Scenes that are their own mirror images in the vertical plane along which their base moves: so must be their motion.
#include "core/dynamics/rigid/space_rig.hpp"
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

using namespace rig;
using Random = std::mt19937;

namespace {

// The whole scene, turned by `yaw` about the vertical.
void turnScene(System& s, double yaw)
{
	const Quaternion about = turn(yaw, Vector3::UnitZ());
	for (RigidBody<Space>& body : s.bodies) {
		body.pose.position = about * body.pose.position;
		body.pose.orientation = about * body.pose.orientation;
		body.origin = body.pose.position;
	}
}

// Blocks by size and place of their centres, from below; each pair that touches.
struct Box {
	Vector3 half, centre;
};

System sceneOf(const std::vector<Box>& boxes, double yaw, double friction, double restitution = 0.5)
{
	System s = emptyScene<Space>();
	for (const Box& box : boxes) {
		Pose pose;
		pose.position = box.centre;
		addBox(s, box.half, pose);
	}
	for (int b = 1; b < int(s.bodies.size()); ++b)
		for (int a = 0; a < b; ++a) {
			const Vector3 apart =
			    (s.bodies[a].pose.position - s.bodies[b].pose.position).cwiseAbs() - s.bodies[a].halfSize - s.bodies[b].halfSize;
			if (apart.maxCoeff() < 1e-9)
				addPair(s, a, b, restitution, friction);
		}
	turnScene(s, yaw);
	return s;
}

// How far each body is from the mirror image of its twin: its centre, m, and its axes.
class Mirror {
public:
	Mirror(const System& s, double yaw) : across(turn(yaw, Vector3::UnitZ()) * Vector3::UnitY())
	{
		for (const auto& body : s.bodies) {
			int twin = -1;
			for (size_t b = 0; b < s.bodies.size(); ++b)
				if ((s.bodies[b].pose.position - image(body.pose.position)).norm() < 1e-9)
					twin = int(b);
			twins.push_back(twin);
		}
	}
	double miss(const System& s) const
	{
		double worst = 0;
		for (size_t b = 0; b < twins.size(); ++b) {
			const Pose &pose = s.bodies[b].pose, &twin = s.bodies[twins[b]].pose;
			const Matrix3 I = Matrix3::Identity() - 2 * across * across.transpose();
			Matrix3 mirrored = I * pose.orientation.toRotationMatrix() * Vector3(1, -1, 1).asDiagonal(),
			        other = twin.orientation.toRotationMatrix();
			worst = std::max({worst, (image(pose.position) - twin.position).norm(), (mirrored - other).norm()});
		}
		return worst;
	}

private:
	Vector3 image(const Vector3& v) const { return v - 2 * across * across.dot(v); }
	Vector3 across;
	std::vector<int> twins;
};

std::vector<Box> column(int blocks, const Vector3& half)
{
	std::vector<Box> boxes;
	for (int k = 0; k < blocks; ++k)
		boxes.push_back({half, {0, 0, (2 * k + 1) * half.z()}});
	return boxes;
}
std::vector<Box> table()
{
	std::vector<Box> boxes;
	for (double x : {-.7, .7})
		for (double y : {-.5, .5})
			boxes.push_back({{.1, .1, .5}, {x, y, .5}});
	boxes.push_back({{.8, .6, .1}, {0, 0, 1.1}});
	return boxes;
}
std::vector<Box> portal() { return {{{.15, .2, .7}, {-.6, 0, .7}}, {{.15, .2, .7}, {.6, 0, .7}}, {{.75, .2, .15}, {0, 0, 1.55}}}; }

// One step of the base's acceleration and of gravity, from rest: speeds in g h.
ContactSolver<Space> stepOf(const std::vector<Box>& boxes, double friction, double jerk)
{
	ContactSolver<Space> solver;
	std::vector<Vector3> centres {Vector3(0, 0, -1)}, halves {Vector3(5, 5, 1)};
	for (const Box& box : boxes) {
		const double mass = density * 8 * box.half.prod();
		const Vector3 squares = box.half.cwiseAbs2();
		FreeBody<Space>& body = solver.bodies.emplace_back();
		body.inverseMass.linear = 1 / mass;
		body.inverseMass.angular = (mass / 3 * (squares.sum() * Vector3::Ones() - squares)).cwiseInverse().asDiagonal();
		body.free << -jerk, 0, -1, 0, 0, 0;
		centres.push_back(box.centre);
		halves.push_back(box.half);
	}
	for (int b = 1; b < int(centres.size()); ++b)
		for (int a = 0; a < b; ++a) {
			const Vector3 low = (centres[a] - halves[a]).cwiseMax(centres[b] - halves[b]),
			              high = (centres[a] + halves[a]).cwiseMin(centres[b] + halves[b]);
			if ((high - low).minCoeff() < -1e-9)
				continue;
			for (int corner = 0; corner < 4; ++corner) {
				const Vector3 place(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(), low.z());
				ContactRows<Space>& row = solver.points.emplace_back();
				row.body1 = a - 1;
				row.body2 = b - 1;
				row.friction = friction;
				for (int k = 0; k < 3; ++k) {
					const Vector3 axis = Vector3::Unit((k + 2) % 3);
					row.J1.row(k) << -axis.transpose(), -(place - centres[a]).cross(axis).transpose();
					row.J2.row(k) << axis.transpose(), (place - centres[b]).cross(axis).transpose();
				}
			}
		}
	return solver;
}

} // namespace

// Oracle: the block in the plane, in the same steps. Bound: the residual of 1e-9 g h in each of 500 steps moves a point by 1e-11 m; what is
// off grows with exp(p t) < 3, and by the angles of small arms.
TEST_CASE("jerked bases turn no scene that is its own mirror image")
{
	const std::vector<std::vector<Box>> scenes {column(1, {.15, .1, .75}), column(1, {.15, .25, .75}), column(2, {.2, .15, .4}), portal()};
	constexpr double bound = 1e-8, h = 5e-4, speed = 0.04 * g;
	for (size_t k = 0; k < scenes.size(); ++k)
		for (double friction : {noSlip, .7})
			for (double jerk : {1.7, 2., 5.})
				for (double yaw : {0., .7, M_PI / 2}) {
					CAPTURE(k, friction, jerk, yaw);
					System s = sceneOf(scenes[k], yaw, friction);
					ScheduledMotion motion;
					motion.append({0, 0, jerk * g});
					motion.append({speed / (jerk * g), 0, 0});
					moveBase(s, motion, turn(yaw, Vector3::UnitZ()) * Vector3::UnitX());
					auto flat = emptyScene<Plane>();
					const RigidBody<Space>& block = s.bodies[1];
					addBlock(flat, block.halfSize.x(), block.halfSize.z(), {0, block.halfSize.z()}, 0, block.mass);
					flat.bodies[1].inertia[0] = block.inertia.y();
					addPair(flat, 0, 1, 0.5, friction);
					moveBase(flat, motion);
					const Mirror mirror(s, yaw);
					RigidStep<Space> spatial;
					RigidStep<Plane> planar;
					double worst = 0, apart = 0;
					while (s.time < .25) {
						spatial.advance(s, h);
						planar.advance(flat, h);
						worst = std::max(worst, mirror.miss(s));
						apart = std::max(apart, std::abs(block.pose.position.z() - flat.bodies[1].pose.position.y()));
					}
					CHECK(worst < bound);
					if (scenes[k].size() == 1)
						CHECK(apart < bound);
				}
}

// The velocities are unique here but where points cannot slip, and so is what of all solutions the solver takes. Bound: residuals of 1e-11
// of the speed, divided by what the softest motion of a scene answers to an impulse, 1e-4 of that of a point.
TEST_CASE("contact problem: the order of the points decides nothing")
{
	const std::vector<std::vector<Box>> scenes {column(1, {.15, .1, .75}), column(2, {.2, .15, .4}), table(), portal()};
	Random random(1);
	for (size_t k = 0; k < scenes.size(); ++k)
		for (double friction : {noSlip, .7, .3})
			for (double jerk : {.2, .5, 1.7, 2., 5.}) {
				CAPTURE(k, friction, jerk);
				ContactSolver<Space> first = stepOf(scenes[k], friction, jerk);
				CHECK(first.solve(1e-11).converged);
				std::vector<int> order(first.points.size());
				std::iota(order.begin(), order.end(), 0);
				for (int again = 0; again < 5; ++again) {
					std::shuffle(order.begin(), order.end(), random);
					ContactSolver<Space> other = stepOf(scenes[k], friction, jerk);
					const auto points = other.points;
					for (size_t i = 0; i < order.size(); ++i)
						other.points[i] = points[order[i]];
					CHECK(other.solve(1e-11).converged);
					double apart = 0, most = 0;
					for (size_t i = 0; i < order.size(); ++i) {
						apart = std::max(apart, (other.points[i].impulse - first.points[order[i]].impulse).norm());
						most = std::max(most, first.points[i].impulse.norm());
					}
					CHECK(apart < 1e-6 * most);
				}
			}
}
