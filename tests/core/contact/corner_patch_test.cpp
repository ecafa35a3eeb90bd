// The mean normal of a patch whose corners meet corners, against the plane's geometry in any orientation.
#include "contact/collide.hpp"
#include "contact/corner_patch.hpp"
#include <catch.hpp>
#include <utility>

using namespace masonry;

namespace {

Quaternion turn(double angle, const Vector3& axis) { return Quaternion(Eigen::AngleAxisd(angle, axis.normalized())); }

// Two boxes that lean on each other by th1 and th2 against the upright. Their upper inner edges are along y, at the height 0; that of the
// second one is at (gap, up). All turned about x = 0 by `turned`.
struct Frame {
	ConvexPolyhedron box1, box2;
	Pose pose1, pose2;

	Frame(double th1, double th2, double gap, double up, double depth2, double shift, const Quaternion& turned)
	    : box1(ConvexPolyhedron::box({0.05, 0.2, 0.5})), box2(ConvexPolyhedron::box({0.05, depth2, 0.5}))
	{
		const auto place = [&](Pose& pose, double lean, double side, const Vector3& corner) {
			const Quaternion own = turn(-side * lean, Vector3::UnitY());
			pose.orientation = turned * own;
			pose.position = turned * (corner - own * Vector3(-side * 0.05, 0, 0.5));
		};
		place(pose1, th1, -1, {0, 0, 0});
		place(pose2, th2, 1, {gap, shift, up});
	}
};

} // namespace

TEST_CASE("corner patches: the mean normal is midway between the faces', and gaps are along it")
{
	const Quaternion turned = turn(0.7, {1, -2, 0.5});
	for (const auto& [th1, th2] : {std::pair(0.3, 0.3), std::pair(0.2, 0.45), std::pair(0.6, 0.5)})
		for (const double gap : {1e-7, -1e-6, -1e-4})
			for (const double depth2 : {0.2, 0.15, 0.3})
				for (const double shift : {0., 0.1})
					for (const bool swapped : {false, true}) {
						CAPTURE(th1, th2, gap, depth2, shift, swapped);
						if (gap < -1e-5 && th1 + th2 > M_PI / 4) // deep enough for a patch of an upper face
							continue;
						Frame f(th1, th2, gap, 0, depth2, shift, turned);
						if (swapped) {
							std::swap(f.box1, f.box2);
							std::swap(f.pose1, f.pose2);
						}
						ContactPatch patch;
						REQUIRE(collide(f.box1, f.pose1, f.box2, f.pose2, 1, {}, patch));
						const CornerNormals corner = takeMeanNormal(f.box1, f.pose1, f.box2, f.pose2, patch);
						// The faces' normals are at -th1 and th2 to the horizontal.
						const double mean = (th2 - th1) / 2;
						const Vector3 normal = (swapped ? -1. : 1.) * (turned * Vector3(std::cos(mean), 0, std::sin(mean)));
						CHECK(corner.halfAngle == Approx((th1 + th2) / 2).epsilon(1e-12));
						CHECK((patch.normal - normal).norm() < 1e-12);
						CHECK(std::abs(corner.edge.dot(turned * Vector3::UnitY())) == Approx(1));
						int touching = 0;
						for (int i = 0; i < patch.size(); ++i) {
							const PatchPoint& point = patch.points[i];
							if (point.gap > 1e-3)
								continue;
							++touching;
							CHECK(point.gap == Approx(gap * std::cos(mean)).margin(1e-14));
							CHECK((point.position2 - point.position1 - point.gap * patch.normal).norm() < 1e-14);
						}
						CHECK(touching == 2);
					}
}

TEST_CASE("corner patches: a corner over a face, and faces that are parallel, keep the face's normal")
{
	for (const auto& [lean, up] : {std::pair(0.3, 1e-3), std::pair(0.3, -1e-3), std::pair(0., 0.)}) {
		const Frame f(lean, lean, -1e-6 - std::abs(up) * std::tan(lean), up, 0.2, 0, Quaternion::Identity());
		ContactPatch patch;
		REQUIRE(collide(f.box1, f.pose1, f.box2, f.pose2, 1, {}, patch));
		const Vector3 before = patch.normal;
		CHECK(takeMeanNormal(f.box1, f.pose1, f.box2, f.pose2, patch).halfAngle == 0);
		CHECK(patch.normal == before);
	}
}

TEST_CASE("corner patches: across the edge the reaction may turn by the half angle and the friction angle")
{
	const CornerNormals corner {0.3, Vector3::UnitY()};
	CHECK(corner.frictionAcross(0) == Approx(std::tan(0.3)));
	CHECK(corner.frictionAcross(0.5) == Approx(std::tan(0.3 + std::atan(0.5))));
	CHECK(std::isinf(corner.frictionAcross(5)));
	CHECK(std::isinf(corner.frictionAcross(std::numeric_limits<double>::infinity())));
}
