// One block on a base with compliant joints, against the exact rigid block.
#include "leapfrog_rig.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

using namespace masonry;

namespace {

struct RockingRun {
	double              peakError;
	std::vector<double> peaks;
	LeapfrogRig         rig;
};

// 2b x 2a block let go at 0.9 critical angle.
RockingRun rock(double b, double slenderness, double C, double penetration, int halfCycles, double stepFraction = 0.2, double start = 0.9)
{
	const double a = slenderness * b, alpha = std::atan(1 / slenderness), g = 9.81, density = 2000, depth = 1.0;
	RockingRun   run;
	LeapfrogRig& rig = run.rig;
	rig.system.gravity = { 0, 0, -g };
	rig.addBox({ 6 * a, 2 * depth, 1 }, { 0, 0, -0.5 }, density, true);
	const int block = rig.addBox({ 2 * b, depth, 2 * a }, { 0, 0, a }, density, false);
	Body&     body = rig.system.bodies[block];
	const double theta = start * alpha;
	body.pose.orientation = Eigen::AngleAxisd(theta, Vector3::UnitY());
	body.pose.position = Vector3(b, 0, 0) + body.pose.orientation * Vector3(-b, 0, a);
	const double pressure = density * g * 2 * a;
	rig.law.normalStiffness = pressure / (penetration * 2 * b);
	rig.law.shearStiffness = rig.law.normalStiffness;
	rig.law.dampingRatio = 0.5;
	rig.law.friction = noSlip;
	rig.law.restitution = C;
	const double omega2 = rig.law.normalStiffness * 2 * b * depth / body.mass * 4;
	rig.system.dt = stepFraction * 2 / std::sqrt(omega2);
	const double E0 = std::cos(alpha - theta) - std::cos(alpha);
	double       previous = theta, before = theta;
	run.peakError = 0;
	while (int(run.peaks.size()) < halfCycles && rig.time < 60) {
		rig.step();
		const Quaternion& q = body.pose.orientation;
		const double      angle = 2 * std::atan2(q.y(), q.w());
		if (std::abs(previous) >= std::abs(angle) && std::abs(previous) > std::abs(before) && rig.impacts.size() > run.peaks.size()) {
			// parabola through three samples
			const double l = std::abs(before), m = std::abs(previous), r = std::abs(angle);
			const double peak = m + (r - l) * (r - l) / (16 * m - 8 * l - 8 * r);
			run.peaks.push_back(peak);
			const double exact = alpha - std::acos(std::cos(alpha) + std::pow(C, 2. * run.peaks.size()) * E0);
			run.peakError = std::max(run.peakError, std::abs(peak / exact - 1));
		}
		before = previous;
		previous = angle;
	}
	return run;
}

} // namespace

TEST_CASE("A block rocks with the peaks of the rigid block")
{
	for (double penetration : { 1e-4, 1e-5, 1e-6 })
		for (double fraction : {0.4, 0.2, 0.1 }) {
			const auto run = rock(0.3, 5, 0.9, penetration, 15, fraction);
			std::printf("pen %g frac %g: n=%zu err=%g time=%g impacts=%zu\n", penetration, fraction, run.peaks.size(), run.peakError, run.rig.time,
			            run.rig.impacts.size());
		}
}
