#include "dynamics/compliant/base_jump.hpp"
#include "dynamics/compliant/instant.hpp"
#include "dynamics/compliant/pivots.hpp"
#include "dynamics/compliant/settling.hpp"
#include "impact/caught_slip.hpp"
#include "tolerances.hpp"

namespace masonry {

namespace {

// The impulses of a base whose velocity has just jumped. Points that part are muted where their joint keeps a pivot (it
// rocks from this instant on); those that stay are returned.
std::vector<HeldPoint> respondToJump(JointSystem& s, const BaseJump& jump, ImpulseResponse& response)
{
	const auto touching = selectPoints(s.contacts, [](const JointContact& contact, int i) {
		return !contact.points[i].muted && (contact.patch.points[i].gap <= 0 || contact.springs[i] > 0);
	});
	auto rows = impulsePoints(s.contacts, touching);
	const auto sideOf = [](const ImpulsePoint<Space>& row, int b) { return row.body1 == b ? 1 : row.body2 == b ? -1 : 0; };
	std::vector<Vector3> before;
	for (const ImpulsePoint<Space>& row : rows) {
		before.push_back(relativeVelocity(s.bodies, row));
		for (int b : jump.moved)
			before.back() += sideOf(row, b) * jump.velocity;
	}
	CoupleRows<Space> none;
	const ImpulseReport report = solveSparsely(s.bodies, rows, none);
	s.note(report.residual, report.solved);
	for (size_t k = 0; k < rows.size(); ++k)
		for (int b : jump.moved) // impulse times the mean of the base's velocities before and after, but where it catches what slides
			if (const int side = sideOf(rows[k], b))
				response.work += workOfCatch(rows[k], before[k], relativeVelocity(s.bodies, rows[k])) +
				                 side * rows[k].impulse.dot(s.bodies[b].linear() - 0.5 * jump.velocity);

	std::vector<HeldPoint> held;
	for (const HeldPoint& p : touching) {
		if (s.gapRate({p.contact, p.point}) > tolerance::parting * jump.velocity.norm())
			s.contacts[p.contact].points[p.point].muted = true;
		else
			held.push_back(p);
	}
	return held;
}

} // namespace

ImpulseResponse applyBaseJump(JointSystem& s, const BaseJump& jump)
{
	const double energy = mechanicalEnergy(s), stored = storedEnergy(s), power = supportPower(s);
	goBack(s, accelerations(s, loadedPoints(s)), jump.before);
	for (int b : jump.moved)
		s.bodies[b].linear() += jump.velocity;
	ImpulseResponse response;
	const auto held = respondToJump(s, jump, response);
	const auto joints = groupJoints(s);
	unmuteUpright(s, joints);
	const RigidAcceleration rates = accelerations(s, held);
	goForth(s, rates, jump.before);
	settle(s, rates.points, tolerance::settlingGain * stored);
	response.work += jump.before * (supportPower(s) - power);
	response.dissipated = energy + response.work - mechanicalEnergy(s);
	for (const Joint& joint : joints)
		unmuteInFlight(s, joint);
	return response;
}

} // namespace masonry
