// The frames of contact points against closed forms: a corner over a face, in the plane and in space, and two bars whose edges cross.
#include "contact/features.hpp"
#include "contact/point_geometry.hpp"
#include <catch.hpp>

using namespace masonry;

namespace {

constexpr double b = 0.5, a = 1.5, angle = 0.2, height = 1.7, roundOff = 2e-15; // m, rad; ten units of the last digit of 1 m

} // namespace

// A block of half width b and half height a leans by `angle`: its lower left corner lies at height - b sin - a cos (angle clockwise).
TEST_CASE("a corner over a face in the plane")
{
	const bool first = GENERATE(false, true); // the block is body 1
	PlanePose block, bed;
	block.position = {0.3, height};
	block.setAngle(-angle);
	const Feature feature = Feature::ofVertex(first ? 1 : 2, 0, 3);
	const Vector2 ofBlock(b, a), ofBed(2, 0.25);
	const auto geometry = first ? geometryOf(feature, ofBlock, ofBed) : geometryOf(feature, ofBed, ofBlock);
	const auto frame = first ? frameOf(geometry, block, bed) : frameOf(geometry, bed, block);
	CHECK(std::abs(frame.gap - (height + b * std::sin(angle) - a * std::cos(angle) - 0.25)) < roundOff);
	CHECK(std::abs(frame.position.x() - (0.3 - b * std::cos(angle) - a * std::sin(angle))) < roundOff);
	CHECK(frame.axes.row(0) == Eigen::RowVector2d(0, first ? -1 : 1));
	CHECK(frame.axes.row(1) == Eigen::RowVector2d(first ? 1 : -1, 0));
	CHECK(geometry.halfWidth == 2);
}

// The same with a depth of 2 c, which stands across y.
TEST_CASE("a corner over a face in space")
{
	constexpr double c = 0.4;
	const bool first = GENERATE(false, true);
	const Pose bed, block {{0.3, 0, height}, Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitY()))};
	const Feature feature = Feature::ofVertex(first ? 1 : 2, 0, 5);
	const Vector3 ofBlock(b, c, a), ofBed(2, 3, 0.25);
	const auto geometry = first ? geometryOf(feature, ofBlock, ofBed) : geometryOf(feature, ofBed, ofBlock);
	const auto frame = first ? frameOf(geometry, block, bed) : frameOf(geometry, bed, block);
	CHECK(std::abs(frame.gap - (height + b * std::sin(angle) - a * std::cos(angle) - 0.25)) < roundOff);
	const Vector3 corner(0.3 - b * std::cos(angle) - a * std::sin(angle), -c, height + b * std::sin(angle) - a * std::cos(angle));
	CHECK((frame.position - corner).norm() < roundOff);
	CHECK(frame.axes.row(0) == Eigen::RowVector3d(0, 0, first ? -1 : 1));
	CHECK((frame.axes * frame.axes.transpose() - Matrix3::Identity()).norm() == 0);
	CHECK(frame.axes.determinant() == 1);
	CHECK(geometry.halfWidths == Vector2(2, 3));
}

// Bars of 0.2 m along x and y, each turned by 45 degrees about its own length: the edges between are sqrt(2)/10 m from the centres.
TEST_CASE("edges that cross")
{
	constexpr double apart = 0.4;
	const Vector3 half1(1, 0.1, 0.1), half2(0.1, 1, 0.1);
	const Pose bar1 {{0, 0, 0}, Quaternion(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitX()))},
	    bar2 {{0.2, 0.1, apart}, Quaternion(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitY()))};
	const Feature feature {Feature::Edges, feature::edgeNumber(0, {0, 1, 1}), feature::edgeNumber(1, {1, 0, -1})};
	const auto frame = frameOf(geometryOf(feature, half1, half2), bar1, bar2);
	CHECK(std::abs(frame.gap - (apart - 0.2 * std::sqrt(2))) < roundOff);
	CHECK((frame.position - Vector3(0.2, 0, apart / 2)).norm() < roundOff);
	CHECK((Vector3(frame.axes.row(0)) - Vector3::UnitZ()).norm() < roundOff);
	CHECK(std::abs(std::abs(frame.axes.row(1).dot(Eigen::RowVector3d::UnitX())) - 1) < roundOff);
}
