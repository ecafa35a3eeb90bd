#include "dynamics/compliant/instant.hpp"
#include <utility>

namespace masonry {

RigidAcceleration accelerations(JointSystem& s, std::vector<HeldPoint> points, const ImpulseSolver<Space>& solve)
{
	RigidAcceleration rates = rigidAcceleration(s.bodies, s.contacts, std::move(points), solve);
	s.note(rates.report.residual * s.dt, rates.report.solved);
	return rates;
}

std::vector<HeldPoint> loadedPoints(const JointSystem& s)
{
	return selectPoints(s.contacts, [](const JointContact& contact, int i) { return contact.springs[i] > 0; });
}

void goBack(JointSystem& s, const RigidAcceleration& rates, double before)
{
	const Bodies<Space> end = s.bodies;
	for (size_t i = 0; i < s.bodies.size(); ++i) {
		RigidBody<Space>& body = s.bodies[i];
		body.advance(-before);
		if (body.prescribed)
			continue;
		body.linear() += rates.linear[i] * (0.5 * s.dt - before);
		body.spin() += rates.angular[i] * (0.5 * s.dt - before);
	}
	moveContacts(s, end);
}

void goForth(JointSystem& s, const RigidAcceleration& rates, double before)
{
	const Bodies<Space> instant = s.bodies;
	for (size_t i = 0; i < s.bodies.size(); ++i) {
		RigidBody<Space>& body = s.bodies[i];
		if (!body.prescribed) { // mean velocity of the rest of the step
			body.linear() += 0.5 * before * rates.linear[i];
			body.spin() += 0.5 * before * rates.angular[i];
		}
		body.advance(before);
		if (body.prescribed)
			continue;
		body.linear() += 0.5 * (before - s.dt) * rates.linear[i];
		body.spin() += 0.5 * (before - s.dt) * rates.angular[i];
	}
	moveContacts(s, instant);
}

} // namespace masonry
