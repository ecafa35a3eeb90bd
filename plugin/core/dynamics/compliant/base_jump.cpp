#include "dynamics/compliant/base_jump.hpp"
#include "dynamics/compliant/instant.hpp"
#include "dynamics/compliant/pivots.hpp"
#include "dynamics/compliant/settling.hpp"
#include "impact/jump_work.hpp"
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
	const JumpWork<Space> ofJump(s.bodies, rows, jump.velocity,
	                             [&](int b) { return std::find(jump.moved.begin(), jump.moved.end(), b) != jump.moved.end(); });
	CoupleRows<Space> none;
	const ImpulseReport report = solveSparsely(s.bodies, rows, none);
	s.note(report.residual, report.solved);
	for (const ImpulsePoint<Space>& row : rows)
		for (int b : jump.moved)
			response.work += (row.body1 == b ? 1 : row.body2 == b ? -1 : 0) * row.impulse.dot(s.bodies[b].linear());
	response.work += ofJump.beyond(s.bodies, rows);

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
