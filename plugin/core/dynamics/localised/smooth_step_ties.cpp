// Ties (tie.hpp) in a step: rows of the contact laws after those of the points, energies, and what breaks.
#include "dynamics/localised/smooth_step.hpp"
#include <algorithm>

namespace masonry::localised {

namespace {

template <class K>
Eigen::Matrix<double, 1, K::dof> rateRow(const typename K::Vector& axis, const typename K::Vector& arm)
{
	Eigen::Matrix<double, 1, K::dof> row;
	row.template head<K::dimension>() = axis.transpose();
	row.template tail<K::spins>() = K::moment(arm, axis).transpose();
	return row;
}

// 1/m of the two bodies along the row, 1/kg.
template <class K>
double perMass(const std::vector<FreeBody<K>>& bodies, const ContactRows<K>& rows)
{
	double sum = 0;
	if (rows.body1 >= 0)
		sum += rows.J1.row(0).dot(bodies[rows.body1].inverseMass * rows.J1.row(0).transpose());
	if (rows.body2 >= 0)
		sum += rows.J2.row(0).dot(bodies[rows.body2].inverseMass * rows.J2.row(0).transpose());
	return sum;
}

} // namespace

// A tie pulls the second body along the direction to the first: u = -dL/dt, and
//
//     u+ + (a/b) u - (pretension + k e)/(k h b) + p/(k h^2 b) = 0
template <class K>
ContactRows<K> SmoothStep<K>::rowsOf(const RigidSystem<K>& s, const Tie<K>& tie, double h) const
{
	const RigidBody<K>&body1 = s.bodies[tie.body1], &body2 = s.bodies[tie.body2];
	const auto &next1 = last.bodies[tie.body1], &next2 = last.bodies[tie.body2];
	const auto line = Tie<K>::line(tie, next1.middle, next2.middle);
	const size_t row = solver.points.size();
	ContactRows<K> rows;
	rows.body1 = next1.unknown;
	rows.body2 = next2.unknown;
	rows.J1.setZero();
	rows.J2.setZero();
	rows.law = tie.tensionOnly || tie.broken ? PointLaw::OneWay : PointLaw::Bilateral;
	rows.law.compliance = 1;
	if (tie.broken || !(line.length > 0))
		return rows;
	rows.J1.row(0) = -rateRow<K>(line.direction, chord<K>(next1.mean, h) * (line.end1 - next1.middle.position));
	rows.J2.row(0) = rateRow<K>(line.direction, chord<K>(next2.mean, h) * (line.end2 - next2.middle.position));
	const double stiff = tie.stiffness * h;
	const TieShares share = TieShares::ofMean(stiff * h * perMass(solver.bodies, rows));
	const double stretched = Tie<K>::line(tie, body1.pose, body2.pose).length - tie.length;
	rows.law.compliance = 1 / (stiff * h * share.after);
	rows.offset[0] = share.before / share.after * (rows.J1.row(0).dot(body1.velocity) + rows.J2.row(0).dot(body2.velocity)) -
	                 (tie.pretension + tie.stiffness * stretched) / (stiff * share.after);
	if (body1.prescribed)
		rows.offset[0] += rows.J1.row(0).dot(next1.velocity);
	if (body2.prescribed)
		rows.offset[0] += rows.J2.row(0).dot(next2.velocity);
	rows.impulse[0] = guesses.empty() ? h * tie.force : guesses[row][0];
	return rows;
}

template <class K>
void SmoothStep<K>::addTies(const RigidSystem<K>& s, double h)
{
	breaking.resize(s.ties.size(), 0);
	for (size_t t = 0; t < s.ties.size(); ++t) {
		const Tie<K>& tie = s.ties[t];
		const int unknown1 = last.bodies[tie.body1].unknown, unknown2 = last.bodies[tie.body2].unknown;
		if (unknown1 >= 0 && unknown2 >= 0)
			solver.near.push_back({unknown1, unknown2});
		solver.points.push_back(rowsOf(s, tie, h));
		if (breaking[t] && !tie.broken)
			holdAtStrength(tie, h, solver.points.back());
	}
}

// The tie pulls with its strength, as one that is very long and soft.
template <class K>
void SmoothStep<K>::holdAtStrength(const Tie<K>& tie, double h, ContactRows<K>& rows) const
{
	constexpr double soft = 1e9; // times the compliance of the bodies. Larger: round-off
	rows.law.compliance = soft * perMass(solver.bodies, rows);
	rows.offset[0] = -rows.law.compliance * h * tie.strength;
	rows.impulse[0] = h * tie.strength;
}

// Ties that pull more than they may in the solution pull with their strength from now on. Returns whether there are any new ones.
template <class K>
bool SmoothStep<K>::holdTies(const RigidSystem<K>& s, double h)
{
	constexpr double roundOff = 1e-6;
	bool some = false;
	for (size_t t = 0; t < s.ties.size(); ++t) {
		ContactRows<K>& rows = solver.points[last.rows.size() + t];
		if (breaking[t] || !(rows.impulse[0] > (1 + roundOff) * h * s.ties[t].strength))
			continue;
		breaking[t] = 1;
		some = true;
		holdAtStrength(s.ties[t], h, rows);
	}
	return some;
}

// The work of the ties on the bodies. A tie's energy falls by that much; the rest, where it is not that of its state after the step, has
// been dissipated.
template <class K>
void SmoothStep<K>::bookTies(RigidSystem<K>& s)
{
	for (size_t t = 0; t < s.ties.size(); ++t) {
		Tie<K>& tie = s.ties[t];
		const ContactRows<K>& rows = solver.points[last.rows.size() + t];
		const auto &next1 = last.bodies[tie.body1], &next2 = last.bodies[tie.body2];
		const double impulse = rows.impulse[0], rate1 = rows.J1.row(0).dot(next1.mean), rate2 = rows.J2.row(0).dot(next2.mean);
		if (next1.unknown < 0)
			s.baseWork -= impulse * rate1;
		if (next2.unknown < 0)
			s.baseWork -= impulse * rate2;
		const double done = impulse * (rate1 + rate2);
		work += done;
		s.tieDissip += tie.energy - done;
		tie.force = impulse / last.h;
	}
}

// Sets the state of the ties from the bodies after the step.
template <class K>
void SmoothStep<K>::takeTies(RigidSystem<K>& s) const
{
	for (size_t t = 0; t < s.ties.size(); ++t) {
		Tie<K>& tie = s.ties[t];
		tie.broken |= breaking[t] != 0;
		tie.extension = Tie<K>::line(tie, s.bodies[tie.body1].pose, s.bodies[tie.body2].pose).length - tie.length;
		tie.energy = tie.broken ? 0 : tie.energyAt(tie.extension);
		s.tieDissip -= tie.energy;
	}
}

template void SmoothStep<Plane>::addTies(const RigidSystem<Plane>&, double);
template void SmoothStep<Space>::addTies(const RigidSystem<Space>&, double);
template bool SmoothStep<Plane>::holdTies(const RigidSystem<Plane>&, double);
template bool SmoothStep<Space>::holdTies(const RigidSystem<Space>&, double);
template void SmoothStep<Plane>::bookTies(RigidSystem<Plane>&);
template void SmoothStep<Space>::bookTies(RigidSystem<Space>&);
template void SmoothStep<Plane>::takeTies(RigidSystem<Plane>&) const;
template void SmoothStep<Space>::takeTies(RigidSystem<Space>&) const;

} // namespace masonry::localised
