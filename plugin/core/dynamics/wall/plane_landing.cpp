// The impact of a joint that rocks, in the plane: one point and a couple, in closed form.
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/rocking_contact.hpp"
#include "dynamics/wall/rocking_joints.hpp"
#include <cmath>
#include <tuple>

namespace masonry::rigid::wall {

namespace {

using Rows = Eigen::Matrix<double, 3, 6>;

// Normal, tangent and relative spin, body 2 minus body 1.
Rows rowsOf(const WallContacts<Plane>& c, const Contact<Plane>& at)
{
	const PointLanes<Plane>& p = at.p;
	const int i = at.lane;
	Rows J;
	J << -p.nx[i], -p.ny[i], -p.a1n[i], p.nx[i], p.ny[i], p.a2n[i], //
	    p.ny[i], -p.nx[i], -p.a1t[i], -p.ny[i], p.nx[i], p.a2t[i],  //
	    0, 0, -1 / c.gyration[at.body1()][0], 0, 0, 1 / c.gyration[at.body2()][0];
	return J;
}

struct Landing {
	Matrix3 G; // velocity that an impulse gives
	Vector3 u; // before
	double friction;

	// Of kinetic energy, J.
	double gain(const Vector3& x) const { return x.dot(u) + 0.5 * x.dot(G * x); }
	double spinAfter(const Vector3& x) const { return (u + G * x)[2]; }

	// That leaves no velocity at the point but this relative spin; friction at its limit where sticking asks for more.
	Vector3 impulse(double spin) const
	{
		const Vector3 target(0, 0, spin);
		const Vector3 stick = G.inverse() * (target - u);
		if (std::abs(stick[1]) <= friction * stick[0])
			return stick;
		const double slope = std::copysign(friction, stick[1]);
		Matrix3 H = G;
		H.col(0) += slope * G.col(1);
		H.col(1) << 0, -1, 0;
		const Vector3 slip = H.inverse() * (target - u);
		return {slip[0], slope * slip[0], slip[2]};
	}

	// Without a couple.
	Vector3 plasticImpulse() const
	{
		const Eigen::Matrix2d G2 = G.topLeftCorner<2, 2>();
		Vector3 x;
		x << -G2.inverse() * u.head<2>(), 0;
		if (std::abs(x[1]) > friction * x[0]) {
			const double slope = std::copysign(friction, x[1]);
			x[0] = -u[0] / (G(0, 0) + slope * G(0, 1));
			x[1] = slope * x[0];
		}
		return x;
	}

	// Of the spins from the plastic one to the one asked for, the farthest that makes no energy: each of the impulses obeys Coulomb.
	Vector3 cappedImpulse(double asked) const
	{
		constexpr int bisections = 40;
		Vector3 x = plasticImpulse();
		const double plastic = spinAfter(x);
		double low = 0, high = 1;
		for (int k = 0; k < bisections; ++k) {
			const double middle = 0.5 * (low + high);
			const Vector3 tried = impulse(plastic + middle * (asked - plastic));
			if (gain(tried) > 0) {
				high = middle;
			} else {
				low = middle;
				x = tried;
			}
		}
		return x;
	}
};

} // namespace

template <>
void RockingJoints<Plane>::answer(RigidSystem<Plane>& s, WallContacts<Plane>& c, const Joint&, const JointPoint& where, double,
                                  double& baseWork)
{
	const Contact<Plane> at = contact(c, where);
	const ContactPair<Plane>& pair = s.pairs[c.features[where.group].pair[where.lane]];
	const int b1 = at.body1(), b2 = at.body2();
	Lanes &v1 = c.velocity[b1], &v2 = c.velocity[b2];
	const Rows J = rowsOf(c, at);
	Eigen::Matrix<double, 6, 1> velocity, inverseMass;
	velocity << v1[0], v1[1], v1[2], v2[0], v2[1], v2[2];
	inverseMass << v1[3], v1[3], v1[3], v2[3], v2[3], v2[3];
	const Eigen::Matrix<double, 6, 3> W = inverseMass.asDiagonal() * J.transpose();
	const Landing landing {J * W, J * velocity, c.groups[where.group].friction[at.lane]};

	const double before = landing.u[2], leastSpin = scale::leastSpin(s, at.block);
	if (!(std::abs(before) >= leastSpin))
		return;
	landed.push_back(at.block);
	if (std::isnan(pair.restitution))
		return;
	const double asked = pair.restitution * before;
	Vector3 x = landing.impulse(asked);
	const bool capped = landing.gain(x) > 0;
	if (capped)
		x = landing.cappedImpulse(asked);
	if (!(x[0] > 0) || landing.gain(x) > 0)
		return;

	const Eigen::Matrix<double, 6, 1> change = W * x;
	v1 += Lanes {change[0], change[1], change[2], 0};
	v2 += Lanes {change[3], change[4], change[5], 0};
	for (const auto& [b, impulse, speed] : {std::tuple(b1, Vector3(J.leftCols<3>().transpose() * x), Vector3(velocity.head<3>())),
	                                        std::tuple(b2, Vector3(J.rightCols<3>().transpose() * x), Vector3(velocity.tail<3>()))}) {
		if (s.bodies[b].prescribed)
			baseWork -= impulse.dot(speed);
		press(c, b, impulse);
	}
	const double side = std::copysign(1., before);
	JointResult result;
	result.axis = Vector3(0, 0, at.second ? side : -side);
	result.before = side * before;
	result.after = side * landing.spinAfter(x);
	result.application = side * x[2] / x[0];
	result.frictionDemand = std::abs(x[1]) / x[0];
	s.impacts.push_back({s.time, at.block, at.support, pair.restitution, result.after >= leastSpin, result, -landing.gain(x), capped, 0});
}

} // namespace masonry::rigid::wall
