#include "dynamics/wall/mortar_rows.hpp"
#include "impact/impulse_problem.hpp" // axesAlong
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
	const double load = (std::abs(p[0]) + tangential(p)) / (massN * step.fall);
	return std::max(step.softness / (1 + load), step.minSoftness) / massN;
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

template <class K>
bool MortarRow<K>::slides() const
{
	constexpr double roundOff = 1e-9;
	return tangential(p) >= (1 - roundOff) * slipBound();
}

// The mean of the velocities, less the way to the largest opening so far, on which a crack opens freely.
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
	return slides() ? h * tangential(mean) : 0;
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

template <class K>
void Mortar<K>::find(const RigidSystem<K>& s, const ContactSet<K>& c)
{
	std::vector<std::pair<std::array<int, 2>, int>> joints;
	for (size_t j = 0; j < s.mortar.size(); ++j)
		joints.push_back({{s.mortar[j].body1, s.mortar[j].body2}, int(j)});
	std::sort(joints.begin(), joints.end());
	slots.assign(s.mortar.size(), {-1, -1});
	for (int g = 0; g < int(c.layout().groups().size()); ++g)
		for (int i = 0; i < c.layout().groups()[g].count; ++i) {
			if (c.layout().groups()[g].number[i] > 0)
				continue;
			const ContactPair<K>& pair = s.pairs[c.layout().groups()[g].pair[i]];
			const std::array<int, 2> bodies {pair.body1, pair.body2};
			const auto at = std::lower_bound(joints.begin(), joints.end(), std::pair(bodies, 0));
			if (at != joints.end() && at->first == bodies)
				slots[at->second] = {g, i};
		}
}

template <class K>
void Mortar<K>::begin(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& before, double h)
{
	rows.clear();
	strength.clear();
	if (s.mortar.empty())
		return;
	find(s, c);
	strength.resize(c.layout().groups().size());
	const double time = h > 0 ? h : 1 / std::numeric_limits<float>::epsilon(); // s
	for (int j = 0; j < int(s.mortar.size()); ++j) {
		const MortarJoint<K>& joint = s.mortar[j];
		const auto [g, i] = slots[j];
		if (g < 0 || joint.isBroken())
			continue;
		if (joint.isRigid) {
			strength[g].pull[i] = time * joint.law.tensileStrength * joint.area / 2;
			strength[g].shift[i] = time * joint.law.cohesion * joint.area / 2 / joint.law.friction;
		} else if (h > 0)
			addRows(s, c, before, j, h);
	}
}

template <class K>
void Mortar<K>::addRows(const RigidSystem<K>& s, const ContactSet<K>& c, const LaneArray& before, int j, double h)
{
	constexpr double pullBack = 0.2; // share of an opening beyond the crack that a step takes back. Larger: shivering; smaller: drift
	const MortarJoint<K>& joint = s.mortar[j];
	const typename K::Pose &pose1 = s.bodies[joint.body1].pose, &pose2 = s.bodies[joint.body2].pose;
	const auto turned = [](const typename K::Pose& pose, const typename K::Vector& v) {
		return typename K::Vector(pose.toGlobal(v) - pose.position);
	};
	const typename K::Vector normal = (turned(pose1, joint.normal1) + turned(pose2, joint.normal2)).normalized();
	const auto axes = axesAlong(normal);
	for (int k = 0; k < int(joint.points.size()); ++k) {
		const CohesivePoint<K>& point = joint.points[k];
		if (point.state.isBroken)
			continue;
		const typename K::Vector at1 = pose1.toGlobal(point.place1), at2 = pose2.toGlobal(point.place2);
		MortarRow<K> row;
		row.joint = j;
		row.point = k;
		row.group = slots[j].group;
		row.lane = slots[j].lane;
		for (int r = 0; r < K::rows; ++r) {
			const typename K::Vector axis = axes.row(r);
			row.arms[r].body = {joint.body1, joint.body2};
			row.arms[r].arm[0] = speedArm(c.bodies(), joint.body1, -axis, at1 - pose1.position);
			row.arms[r].arm[1] = speedArm(c.bodies(), joint.body2, axis, at2 - pose2.position);
			row.before[r] = row.arms[r].rate(before);
			row.p[r] = h * point.force[r];
			row.z[r] = row.u[r] = 0;
		}
		row.massN = 1 / row.arms[0].perMass(c.bodies().velocity());
		row.friction = joint.law.friction;
		row.openingRate = joint.law.openingRate();
		row.slipRate = joint.law.slipRate();
		const double beyond = axes.row(0).dot(at2 - at1) - point.state.crack, most = h * point.area * point.state.strength();
		row.bias = (beyond > 0 ? pullBack : 1) * beyond / h;
		row.bound = row.strength = {most * joint.law.tensileStrength, most * joint.law.cohesion};
		row.tension = row.p[0];
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
		const auto [g, i] = slots[j];
		if (!joint.isRigid || g < 0)
			continue;
		double most = 0;
		for (int k = 0; k < c.points().groups()[g].count; ++k) {
			const PointLanes<K>& at = c.points().groups()[g].point[k];
			const auto rate = [&, lane = i](int row, const LaneArray& v) {
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
		const auto [g, i] = slots[j];
		joint.isRigid = false;
		// A first guess of the forces: the tension is that of a corner, and half of the shear is at each point.
		typename CohesivePoint<K>::Force force = CohesivePoint<K>::Force::Zero();
		for (int k = 0; k < c.points().groups()[g].count; ++k) {
			const PointState<K>& p = c.points().states()[g][k];
			force[0] = std::min(force[0], p.pn[i] / h);
			for (int row = 1; row < K::rows; ++row)
				force[row] += component(p.pt, row - 1, i) / (h * joint.points.size());
		}
		for (CohesivePoint<K>& point : joint.points)
			point.force = force;
	}
}

template <class K>
MortarWork Mortar<K>::finish(RigidSystem<K>& s, ContactSet<K>& c, const std::vector<MortarRow<K>>& done, double h, double missed) const
{
	constexpr double counts =
	    0.01; // damage from which on a crack counts. Larger: damage comes in jumps; smaller: unfinished iterations add up
	constexpr double forgets = 0.2; // share of a crack that does not count, in a step in which it does not grow
	constexpr double clear = 3;     // times the velocities that may be wrong, which an opening must be faster than
	MortarWork work;
	std::vector<std::vector<const MortarRow<K>*>> still(s.mortar.size());
	std::vector<char> grows(s.mortar.size(), 0);
	for (const MortarRow<K>& row : done) {
		MortarJoint<K>& joint = s.mortar[row.joint];
		CohesivePoint<K>& point = joint.points[row.point];
		still[row.joint].push_back(&row);
		for (int k = 0; k < K::rows; ++k)
			point.force[k] = row.p[k] / h;
		const auto counted = [&](double way) { return way > clear * missed * h ? way : 0; };
		const double opening = counted(row.opening(h)), slip = counted(row.slip(h));
		if (!(opening + slip > 0)) {
			point.forgetCrack(forgets);
			continue;
		}
		grows[row.joint] = 1;
		point.opening += opening;
		point.slip += slip;
		// Corners that are pressed while a crack is stopped take their part of the pull.
		double pull = -row.p[0];
		if (row.z[0] <= clear * missed)
			for (int corner = 0; corner < c.points().groups()[row.group].count; ++corner)
				pull -= point.area / joint.area * std::max(0., c.points().states()[row.group][corner].pn[row.lane]);
		point.openingDamage += std::max(0., pull) * opening / (h * point.area * joint.law.fractureEnergy);
		point.slipDamage += row.bound[1] * slip / (h * point.area * joint.law.shearFractureEnergy);
		const double damage = point.openingDamage + point.slipDamage;
		if (!(damage > 0) || (point.state.spent == 0 && damage < counts))
			continue;
		point.state.crack += point.opening;
		point.state.slid += point.slip;
		work.crack += point.area * addDamage(joint.law, point.state, point.openingDamage, point.slipDamage);
		point.forgetCrack(1);
		work.friction += joint.law.friction * std::min(0., row.tension) * slip / h;
	}
	for (size_t j = 0; j < s.mortar.size(); ++j)
		if (!s.mortar[j].isRigid && !grows[j] && slots[j].group >= 0 && s.mortar[j].isSound())
			hold(s.mortar[j], slots[j], c, still[j], h);
	return work;
}

// The joint is rigid again if its corners could bear its forces and it is closed.
template <>
void Mortar<Plane>::hold(MortarJoint<Plane>& joint, const Slot& slot, ContactSet<Plane>& c, const std::vector<const MortarRow<Plane>*>& of,
                         double h) const
{
	constexpr double within = 0.95; // share of the strength. Larger: joints yield again at once
	const auto [g, i] = slot;
	const PointLanes<Plane>* corners[2] = {&c.points().groups()[g].point[0], &c.points().groups()[g].point[1]};
	const int pair = c.layout().groups()[g].pair[i];
	OneState<Plane> states[2] = {c.points().state(pair, 0), c.points().state(pair, 1)};
	const int side = c.bodies().isFree(joint.body2) ? 1 : 0;
	const auto armOf = [&](int k) { return side == 1 ? corners[k]->a2n[i] : corners[k]->a1n[i]; };
	double normal[2] = {states[0].pn, states[1].pn}, shear = states[0].pt[0] + states[1].pt[0];
	for (const MortarRow<Plane>* row : of) {
		const double arm = (side == 1 ? 1 : -1) * row->arms[0].arm[side][0][2], share = (arm - armOf(0)) / (armOf(1) - armOf(0));
		normal[0] += (1 - share) * row->p[0];
		normal[1] += share * row->p[0];
		shear += row->p[1];
	}
	const double pull = h * joint.law.tensileStrength * joint.area / 2,
	             most = h * joint.law.cohesion * joint.area + joint.law.friction * (normal[0] + normal[1]),
	             open = std::max(corners[0]->gap[i], corners[1]->gap[i]) * joint.law.openingRate();
	if (open > deadZone / 2 || std::min(normal[0], normal[1]) < -within * pull || std::abs(shear) > within * most)
		return;
	joint.isRigid = true;
	for (CohesivePoint<Plane>& point : joint.points) {
		point.forgetCrack(1);
		point.force.setZero();
	}
	for (int k = 0; k < 2; ++k) {
		states[k].pn = normal[k];
		states[k].pt[0] = shear / 2;
		c.setState(states[k], pair, k);
	}
}

template <>
void Mortar<Space>::hold(MortarJoint<Space>&, const Slot&, ContactSet<Space>&, const std::vector<const MortarRow<Space>*>&, double) const
{
}

MortarJoint<Plane> mortarJoint(const RigidSystem<Plane>& s, const ContactPair<Plane>& pair, const MortarLaw& law, double width)
{
	const RigidBody<Plane>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const ContactFrame<Plane> first = frameOf(pair.points[0], body1, body1.pose, body2, body2.pose),
	                          last = frameOf(pair.points[1], body1, body1.pose, body2, body2.pose);
	const Vector2 normal = first.axes.row(0), middle = (first.position + last.position) / 2, half = (last.position - first.position) / 2;
	MortarJoint<Plane> joint;
	joint.body1 = pair.body1;
	joint.body2 = pair.body2;
	joint.law = law;
	joint.normal1 = body1.pose.rotateBack(normal);
	joint.normal2 = body2.pose.rotateBack(normal);
	joint.area = width * 2 * half.norm();
	for (const double side : {-1., 1.}) {
		const Vector2 at = middle + side / std::sqrt(3.) * half;
		CohesivePoint<Plane> point;
		point.area = joint.area / 2;
		point.place1 = body1.pose.toLocal(at);
		point.place2 = body2.pose.toLocal(at);
		joint.points.push_back(point);
	}
	return joint;
}

template struct MortarRow<Plane>;
template struct MortarRow<Space>;
template class Mortar<Plane>;
template class Mortar<Space>;

} // namespace masonry::wall
