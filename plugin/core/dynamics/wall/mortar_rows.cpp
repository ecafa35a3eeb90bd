#include "dynamics/wall/mortar_rows.hpp"
#include "dynamics/wall/corner_forces.hpp"
#include "dynamics/wall/crack_limits.hpp"
#include <cmath>

namespace masonry::wall {

namespace {

// (1 - exp(-x))/x
double meanStrength(double x)
{
	constexpr double small = 1e-8; // below it the first two terms of the series are exact to round-off
	return x > small ? -std::expm1(-x) / x : 1 - x / 2;
}

// Along the tangents.
template <class Values>
double tangential(const Values& values)
{
	double square = 0;
	for (size_t k = 1; k < values.size(); ++k)
		square += values[k] * values[k];
	return std::sqrt(square);
}

} // namespace

template <class K>
double MortarRow<K>::wantedResistance(const RowStep& step) const
{
	const double load = (std::abs(p[0]) + tangential(p)) / (massN * step.fall), speed = (std::abs(z[0]) + tangential(z)) / step.fall;
	return std::clamp(step.softness * (1 + speed) / (1 + load), step.minSoftness, step.softness) / massN;
}

template <class K>
void MortarRow<K>::start(const LaneArray& velocity)
{
	constexpr double almost = 0.999; // share of the bound from which on a point counts as opening
	for (int k = 0; k < n; ++k)
		u[k] = arms[k].rate(velocity);
	const double wn = u[0] + bias;
	p[0] = std::clamp(p[0], -bound[0], 0.);
	tension = p[0];
	z[0] = p[0] == 0 ? std::min(wn, 0.) : p[0] <= -almost * bound[0] ? std::max(wn, 0.) : 0;
	for (int k = 1; k < n; ++k)
		z[k] = slides() ? u[k] : 0;
}

// Impulses begin at zero, and bounds with those of a point that is stopped.
template <class K>
void MortarRow<K>::toInstant(const LaneArray& velocity)
{
	constexpr double closed = 0.02; // opening that a crack has to go before it pulls, over G_I/f_t, which does not count
	for (int k = 0; k < n; ++k) {
		before[k] = arms[k].rate(velocity);
		baseJump[k] = arms[k].baseRate(velocity) - baseBefore[k];
		p[k] = z[k] = 0;
	}
	if (beyond * openingRate < -closed)
		strength[0] = 0;
	bias = tension = 0;
	const double mean = meanStrength(openingRate * opening(timeOfInstant) + slipRate * slip(timeOfInstant));
	bound = {mean * strength[0], mean * strength[1]};
}

template <class K>
bool MortarRow<K>::slides() const
{
	constexpr double roundOff = 1e-9;
	return tangential(p) >= (1 - roundOff) * slipBound();
}

// The mean of the velocities, less the way to the largest opening so far, on which a crack opens freely. z has the part of an opening that
// is pulled back: so the dead zone by which a rigid joint has opened is spent too, once its points bear.
template <class K>
double MortarRow<K>::opening(double h) const
{
	return z[0] < 0 ? 0 : h * std::max(0., (before[0] + z[0] + std::min(bias, 0.)) / 2);
}

template <class K>
double MortarRow<K>::slip(double h) const
{
	Values mean {};
	for (int k = 1; k < n; ++k)
		mean[k] = (before[k] + z[k]) / 2;
	return atInstant || tangential(z) > 0 ? h * tangential(mean) : 0; // the bounds of p are those of the next pass already
}

template <class K>
double MortarRow<K>::shearWork() const
{
	return (tangential(z) > 0 ? bound[1] : tangential(p)) * slip(1);
}

template <class K>
double MortarRow<K>::frictionWork() const
{
	return tangential(z) > 0 ? friction * std::min(0., tension) * slip(1) : 0;
}

template <class K>
double MortarRow<K>::jumpWork(double pull, bool slips) const
{
	double sum = pull * baseJump[0] / 2;
	for (int k = 1; k < n && slips; ++k)
		sum -= p[k] * baseJump[k] / 2;
	return sum;
}

template <class K>
double MortarRow<K>::pass(const LaneArray& velocity, const RowStep& step)
{
	constexpr double near = 0.99; // share of the tension bound from which on it must have settled
	Values y;
	double miss = 0;
	for (int k = 0; k < n; ++k) {
		u[k] = arms[k].rate(velocity);
		const double w = u[k] + (k == 0 ? bias : 0);
		miss = std::max(miss, std::abs(w - z[k]));
		y[k] = p[k] - (step.relaxation * w + (1 - step.relaxation) * z[k]) / resistance;
	}
	p[0] = std::clamp(y[0], -bound[0], 0.);
	tension += step.boundShare * (p[0] - tension);
	const double size = tangential(y), most = slipBound(), share = size > most ? most / size : 1;
	for (int k = 1; k < n; ++k)
		p[k] = share * y[k];
	for (int k = 0; k < n; ++k)
		z[k] = (p[k] - y[k]) * resistance;
	const double mean = meanStrength(openingRate * opening(step.h) + slipRate * slip(step.h));
	for (int k = 0; k < 2; ++k) {
		const double lag = mean * strength[k] - bound[k];
		bound[k] += step.boundShare * lag;
		if (k == 0 ? p[0] <= -near * bound[0] : share < 1)
			miss = std::max(miss, std::abs(lag) * resistance);
	}
	return share < 1 ? std::max(miss, friction * std::abs(p[0] - tension) * resistance) : miss;
}

template <class K>
void MortarRow<K>::push(const LaneArray& velocity, LaneArray& momentum) const
{
	for (int k = 0; k < n; ++k)
		arms[k].push(p[k] + (z[k] - u[k] - (k == 0 ? bias : 0)) / resistance, velocity, momentum);
}

// Takes the first pair of each joint that meets.
template <class K>
void Mortar<K>::find(const RigidSystem<K>& s, const ContactSet<K>& c)
{
	if (!known.follow(c.version()) && corners.size() == s.mortar.size())
		return;
	corners.assign(s.mortar.size(), {});
	for (const int pair : c.layout().numbers())
		if (const MortarJoint<K>* joint = mortarBetween(s.mortar, s.pairs[pair].body1, s.pairs[pair].body2)) {
			MortarCorners& of = corners[joint - s.mortar.data()];
			if (of.empty())
				of = cornersOf(c, pair);
		}
}

// A joint that an instant has broken comes with the tension of its corners in the step before, which a pass without strengths would keep.
template <class K>
bool arePulled(const ContactSet<K>& c, const MortarCorners& corners)
{
	return std::any_of(corners.begin(), corners.end(), [&](const MortarCorner& corner) {
		return c.points().states()[corner.slot.group][corner.point].pn[corner.slot.lane] < 0;
	});
}

template <class K>
void Mortar<K>::begin(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& before, const StepContext& step)
{
	rows.clear();
	strength.clear();
	if (s.mortar.empty())
		return;
	find(s, c);
	const double time = mortarTime(step);
	for (int j = 0; j < int(s.mortar.size()); ++j) {
		const MortarJoint<K>& joint = s.mortar[j];
		if (corners[j].empty() || (joint.isBroken() && !arePulled(c, corners[j])))
			continue;
		strength.resize(c.layout().groups().size());
		if (joint.isBroken())
			continue;
		if (joint.isRigid)
			for (const MortarCorner& corner : corners[j]) {
				Strength<K>& of = strength[corner.slot.group];
				of.pull[corner.point][corner.slot.lane] = time * joint.law.tensileStrength * joint.area * corner.share;
				of.shift[corner.point][corner.slot.lane] = time * joint.law.cohesion * joint.area * corner.share / joint.law.friction;
			}
		else
			addRows(s, c, before, j, step);
	}
}

template <class K>
void Mortar<K>::addRows(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& before, int j, const StepContext& step)
{
	constexpr double pullBack = 0.2; // share of an opening beyond the crack that a step takes back. Larger: shivering; smaller: drift
	constexpr double grows = 3e-3;   // of the fall of a step: the speed from which on a crack opens or slips before an instant
	const double h = mortarTime(step);
	const MortarJoint<K>& joint = s.mortar[j];
	const typename K::Pose &pose1 = s.bodies[joint.body1].pose, &pose2 = s.bodies[joint.body2].pose;
	const auto axes = axesOf(joint, pose1, pose2);
	for (int k = 0; k < int(joint.points.size()); ++k) {
		const CohesivePoint<K>& point = joint.points[k];
		if (point.state.isBroken)
			continue;
		const typename K::Vector at1 = pose1.toGlobal(point.place1), at2 = pose2.toGlobal(point.place2);
		MortarRow<K> row;
		row.joint = j;
		row.point = k;
		row.group = corners[j].front().slot.group;
		row.lane = corners[j].front().slot.lane;
		const typename K::Vector grip1 = pose1.toGlobal(point.place1 + point.grip1), grip2 = pose2.toGlobal(point.place2 + point.grip2);
		for (int r = 0; r < K::rows; ++r) {
			const typename K::Vector axis = axes.row(r);
			row.arms[r].body = {joint.body1, joint.body2};
			row.arms[r].arm[0] = speedArm(c.bodies(), joint.body1, -axis, (r == 0 ? at1 : grip1) - pose1.position);
			row.arms[r].arm[1] = speedArm(c.bodies(), joint.body2, axis, (r == 0 ? at2 : grip2) - pose2.position);
			row.before[r] = row.arms[r].rate(before);
			row.baseBefore[r] = row.arms[r].baseRate(before);
			row.p[r] = h * point.force[r];
			row.z[r] = row.before[r];
			row.u[r] = 0;
		}
		row.massN = 1 / row.arms[0].perMass(c.bodies().velocity());
		row.friction = joint.law.friction;
		row.openingRate = joint.law.openingRate();
		row.slipRate = joint.law.slipRate();
		const double most = h * point.area * point.state.strength();
		row.beyond = axes.row(0).dot(at2 - at1) - point.state.crack;
		row.bias = (row.beyond > 0 ? pullBack : 1) * row.beyond / h;
		row.bound = row.strength = {most * joint.law.tensileStrength, most * joint.law.cohesion};
		row.tension = row.p[0];
		row.atInstant = step.instant;
		if (step.instant) {
			if (std::abs(row.before[0]) + tangential(row.before) > grows * step.fall)
				continue;
			row.toInstant(c.bodies().velocity());
		}
		rows.push_back(row);
	}
}

template <class K>
std::vector<int> Mortar<K>::yielding(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& before, const LaneArray& after,
                                     double h, double least) const
{
	std::vector<int> result;
	for (int j = 0; j < int(s.mortar.size()); ++j) {
		const MortarJoint<K>& joint = s.mortar[j];
		if (!joint.isRigid)
			continue;
		double most = 0;
		for (const auto& [number, slot, k, share] : corners[j]) {
			const auto [g, i] = slot;
			const PointLanes<K>& at = c.points().groups()[g].point[k];
			const auto rate = [&, lane = slot.lane](int row, const LaneArray& v) {
				return rateOf(at, row, lane, 2, &v[packs<K> * joint.body2]) - rateOf(at, row, lane, 1, &v[packs<K> * joint.body1]);
			};
			// A point that moves before the step goes on for a part of it even if it is stopped.
			const double opens = at.gap[i] + h * std::max(rate(0, after), rate(0, before) / 2);
			double slides = 0;
			for (int row = 1; row < K::rows; ++row)
				slides = std::max(slides, std::abs(component(c.points().states()[g][k].slip, row - 1, i)) +
				                              h * std::max(std::abs(rate(row, after)), std::abs(rate(row, before)) / 2));
			most = std::max(most, joint.law.openingRate() * opens + joint.law.slipRate() * slides);
		}
		if (most >= least * deadZone)
			result.push_back(j);
	}
	return result;
}

template <class K>
void Mortar<K>::letGo(RigidSystem<K>& s, const ContactSet<K>& c, const std::vector<int>& joints, double h) const
{
	for (const int j : joints) {
		MortarJoint<K>& joint = s.mortar[j];
		joint.isRigid = false;
		const auto axes = axesOf(joint, s.bodies[joint.body1].pose, s.bodies[joint.body2].pose);
		// A first guess of the forces: the tension is that of a corner, and all points have as much shear.
		typename CohesivePoint<K>::Force force = CohesivePoint<K>::Force::Zero();
		for (const MortarCorner& corner : corners[j]) {
			const Shear<K> shear = shearOf(c, corner, axes);
			force[0] = std::min(force[0], c.points().states()[corner.slot.group][corner.point].pn[corner.slot.lane] / h);
			for (int row = 1; row < K::rows; ++row)
				force[row] += shear[row - 1] / (h * joint.points.size());
		}
		for (CohesivePoint<K>& point : joint.points)
			point.force = force;
	}
}

template <class K>
MortarWork Mortar<K>::finish(RigidSystem<K>& s, ContactSet<K>& c, const std::vector<MortarRow<K>>& done, double h, double missed) const
{
	constexpr double forgets = 0.2; // share of a crack that does not count, in a step in which it does not grow
	MortarWork work;
	std::vector<std::vector<const MortarRow<K>*>> still(s.mortar.size());
	std::vector<char> grows(s.mortar.size(), 0);
	for (const MortarRow<K>& row : done) {
		MortarJoint<K>& joint = s.mortar[row.joint];
		CohesivePoint<K>& point = joint.points[row.point];
		still[row.joint].push_back(&row);
		for (int k = 0; k < K::rows; ++k)
			point.force[k] = row.p[k] / h;
		const auto counted = [&](double way) { return way > crack::clear * missed * h ? way : 0; };
		const double opening = counted(row.opening(h)), slip = counted(row.slip(h));
		if (!(opening + slip > 0)) {
			point.forgetCrack(forgets);
			continue;
		}
		grows[row.joint] = 1;
		point.slip += slip;
		point.openingDamage += pullOf(s, c.points().states(), row, missed) * opening / (h * point.area * joint.law.fractureEnergy);
		point.slipDamage += row.bound[1] * slip / (h * point.area * joint.law.shearFractureEnergy);
		const double damage = point.openingDamage + point.slipDamage;
		if (!(damage > 0) || (point.state.spent == 0 && damage < crack::counts))
			continue;
		point.state.crack += std::max(0., row.beyond + h * row.u[0]);
		point.state.slid += point.slip;
		work.crack += point.area * addDamage(joint.law, point.state, point.openingDamage, point.slipDamage);
		point.forgetCrack(1);
		work.friction += joint.law.friction * std::min(0., row.tension) * slip / h;
	}
	for (size_t j = 0; j < s.mortar.size(); ++j)
		if (!s.mortar[j].isRigid && !grows[j] && !corners[j].empty() && s.mortar[j].isSound())
			hold(s, s.mortar[j], corners[j], c, still[j], h);
	return work;
}

// Returns the pull on a point's crack, N s.
template <class K>
double Mortar<K>::pullOf(const RigidSystem<K>& s, const PointStates<K>& states, const MortarRow<K>& row, double missed) const
{
	const MortarJoint<K>& joint = s.mortar[row.joint];
	double pull = -row.p[0];
	if (row.z[0] <= crack::clear * missed) // corners that are pressed while a crack is stopped take their part of the pull
		for (const MortarCorner& corner : corners[row.joint])
			pull -= joint.points[row.point].area / joint.area * std::max(0., states[corner.slot.group][corner.point].pn[corner.slot.lane]);
	return std::max(0., pull);
}

// The joint is rigid again if its corners could bear its forces and it is closed.
template <class K>
void Mortar<K>::hold(const RigidSystem<K>& s, MortarJoint<K>& joint, const MortarCorners& at, ContactSet<K>& c,
                     const std::vector<const MortarRow<K>*>& of, double h) const
{
	constexpr double within = 0.95; // share of the strength. Larger: joints yield again at once
	if (int(at.size()) < K::dimension)
		return;
	const CornerForces<K> forces(s, joint, at, c, of, h);
	double open = 0;
	for (size_t k = 0; k < at.size(); ++k) {
		open = std::max(open, c.points().groups()[at[k].slot.group].point[at[k].point].gap[at[k].slot.lane] * joint.law.openingRate());
		if (forces.normal[k] < -within * (h * joint.law.tensileStrength * joint.area * at[k].share))
			return;
	}
	if (open > deadZone / 2 || !(forces.shear <= within * forces.bound))
		return;
	joint.isRigid = true;
	for (CohesivePoint<K>& point : joint.points) {
		point.forgetCrack(1);
		point.force.setZero();
	}
	const int pair = c.layout().groups()[at[0].slot.group].pair[at[0].slot.lane];
	for (size_t k = 0; k < at.size(); ++k) {
		OneState<K> state = c.points().state(pair, at[k].number);
		state.pn = forces.normal[k];
		state.pt = forces.tangential[k];
		c.setState(state, pair, at[k].number);
	}
}

template struct MortarRow<Plane>;
template struct MortarRow<Space>;
template class Mortar<Plane>;
template class Mortar<Space>;

} // namespace masonry::wall
