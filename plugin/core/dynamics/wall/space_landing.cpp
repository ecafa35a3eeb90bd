// The impact of a joint that rocks, in space: of the law of impact/rocking_restitution.hpp its own points alone.
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/rocking_contact.hpp"
#include "dynamics/wall/rocking_joints.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

// The corners of an edge that the sweeps land one after the other are one landing: the second is about another axis than the block's.
constexpr double mostly = 0.5;

struct Landing {
	const RigidSystem<Space>& s;
	WallContacts<Space>& c;
	std::vector<masonry::Body> bodies;
	std::vector<int> numbers;         // of the bodies, in the system
	std::vector<ImpulsePoint> points; // new support, then old
	ClosingJoint law {};

	int number(int b)
	{
		const auto known = std::find(numbers.begin(), numbers.end(), b);
		if (known != numbers.end())
			return int(known - numbers.begin());
		const auto& from = s.bodies[b];
		const Space::Velocity v = c.inGlobal(c.velocity, b);
		masonry::Body& body = bodies.emplace_back();
		body.pose = from.pose;
		body.velocity = v.head<3>();
		body.angularVelocity = v.tail<3>();
		body.mass = from.mass;
		body.inertia = from.inertia;
		body.prescribed = !c.own[b];
		numbers.push_back(b);
		return int(numbers.size()) - 1;
	}

	template <class JointPoint>
	void add(const JointPoint& point)
	{
		const Group<Space>& group = c.groups[point.group];
		points.push_back({number(group.body1[point.lane]), number(group.body2[point.lane]), position(c, point),
		                  normal(group.point[point.point], point.lane), s.pairs[c.features[point.group].pair[point.lane]].friction});
	}

	Vector3 turning() const { return bodies[law.block].angularVelocity - bodies[law.support].angularVelocity; }

	void writeVelocities() const
	{
		for (size_t i = 0; i < numbers.size(); ++i)
			if (!bodies[i].prescribed) {
				Space::Velocity v;
				v << bodies[i].velocity, bodies[i].angularVelocity;
				c.setVelocity(numbers[i], v);
			}
	}

	// On the supports that move: returns the work that they have been given, J.
	double pressSupports(double couple) const
	{
		double work = 0;
		for (const ImpulsePoint& point : points)
			for (const auto& [k, sign] : {std::pair(point.body1, -1.), std::pair(point.body2, 1.)}) {
				Space::Velocity impulse;
				impulse << sign * point.impulse, sign * (point.position - bodies[k].pose.position).cross(point.impulse);
				work += press(c, numbers[k], impulse);
			}
		Space::Velocity back;
		back << Vector3::Zero(), -couple * law.result.axis;
		return work + press(c, numbers[law.support], back);
	}
};

} // namespace

template <>
void RockingJoints<Space>::answer(RigidSystem<Space>& s, WallContacts<Space>& c, const Joint& joint, const JointPoint& where, double time,
                                  double& baseWork)
{
	const Contact<Space> at = contact(c, where);
	const double restitution = s.pairs[c.features[where.group].pair[where.lane]].restitution;
	const double narrow = tolerance::wall::pivot * c.length, leastSpin = scale::leastSpin(s, at.block);
	Landing landing {s, c, {}, {}, {}};
	ClosingJoint& law = landing.law;
	law.block = landing.number(at.block);
	law.support = landing.number(at.support);
	law.normal = (at.second ? 1 : -1) * normal(at.p, at.lane);
	law.restitution = restitution;
	for (int i = joint.begin; i < joint.end; ++i)
		if (closes(c, points[i], time) && away(c, points[i], joint.pivot) > narrow)
			landing.add(points[i]);
	law.oldBegin = int(landing.points.size());
	for (int i = joint.begin; i < joint.end; ++i)
		if (away(c, points[i], joint.pivot) <= narrow) // whether or not they carried in the last substep: a pivot parts for some at a time
			landing.add(points[i]);
	law.oldEnd = int(landing.points.size());

	const Vector3 turning = landing.turning();
	const double spin = rockingAxis(landing.bodies, law, landing.points).dot(turning);
	if (!(spin >= leastSpin))
		return;
	if (spin >= mostly * turning.norm())
		landed.push_back(at.block);
	if (std::isnan(restitution))
		return;
	double couple = 0;
	const RockingImpactResult result = applyToNewSupport(landing.bodies, law, landing.points, couple);
	if (!result.solved && result.residual > leastSpin * s.bodies[at.block].halfSize.norm())
		missed = std::max(missed, result.residual);
	const auto acts = [](const ImpulsePoint& point) { return !point.impulse.isZero(0); };
	if (std::none_of(landing.points.begin(), landing.points.end(), acts))
		return;
	landing.writeVelocities();
	baseWork += result.work;
	baseWork += landing.pressSupports(couple);
	s.impacts.push_back({s.time, at.block, at.support, restitution, law.result.after >= leastSpin, law.result, result.energyLost,
	                     result.capped, result.residual});
}

} // namespace masonry::rigid::wall
