#include "dynamics/compliant/tie_springs.hpp"

namespace masonry {

namespace {

Tie<Space>::Line lineOf(const JointSystem& s, const Tie<Space>& tie)
{
	return Tie<Space>::line(tie, s.bodies[tie.body1].pose, s.bodies[tie.body2].pose);
}

} // namespace

double stretchTies(JointSystem& s)
{
	double dissipated = 0;
	for (Tie<Space>& tie : s.ties) {
		tie.extension = lineOf(s, tie).length - tie.length;
		if (!tie.broken && tie.forceAt(tie.extension) > tie.strength) {
			tie.broken = true;
			dissipated += tie.energyAt(tie.extension);
		}
		tie.force = tie.broken ? 0 : tie.forceAt(tie.extension);
		tie.energy = tie.broken ? 0 : tie.energyAt(tie.extension);
	}
	return dissipated;
}

std::vector<BodyLoad> tieLoads(const JointSystem& s)
{
	std::vector<BodyLoad> loads(s.bodies.size());
	for (const Tie<Space>& tie : s.ties) {
		const auto line = lineOf(s, tie);
		const Vector3 pull = tie.force * line.direction; // on body 2
		loads[tie.body1].force -= pull;
		loads[tie.body1].moment -= (line.end1 - s.bodies[tie.body1].pose.position).cross(pull);
		loads[tie.body2].force += pull;
		loads[tie.body2].moment += (line.end2 - s.bodies[tie.body2].pose.position).cross(pull);
	}
	return loads;
}

void retensionTies(JointSystem& s)
{
	for (Tie<Space>& tie : s.ties)
		tie.length = lineOf(s, tie).length - tie.extension;
}

double tieEnergy(const JointSystem& s)
{
	double sum = 0;
	for (const Tie<Space>& tie : s.ties)
		sum += tie.energy;
	return sum;
}

} // namespace masonry
