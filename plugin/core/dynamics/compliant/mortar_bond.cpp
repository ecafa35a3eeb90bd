#include "dynamics/compliant/mortar_bond.hpp"
#include "impact/impulse_problem.hpp" // axesAlong
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace masonry {

namespace {

constexpr int fibresAcross = 4; // in either direction

using Polygon = std::vector<Vector2>;

// The part of a convex polygon in which direction.x >= least.
Polygon clipped(const Polygon& polygon, const Vector2& direction, double least)
{
	Polygon result;
	for (size_t i = 0; i < polygon.size(); ++i) {
		const Vector2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
		const double atA = direction.dot(a) - least, atB = direction.dot(b) - least;
		if (atA >= 0)
			result.push_back(a);
		if ((atA > 0 && atB < 0) || (atA < 0 && atB > 0))
			result.push_back(a + atA / (atA - atB) * (b - a));
	}
	return result;
}

struct Cell {
	Vector2 centroid;
	double area;
};

Cell cellOf(const Polygon& polygon)
{
	Cell cell {Vector2::Zero(), 0};
	for (size_t i = 2; i < polygon.size(); ++i) {
		const Vector2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
		const double triangle = 0.5 * std::abs(cross(a, b));
		cell.area += triangle;
		cell.centroid += triangle * (polygon[0] + (a + b) / 3);
	}
	if (cell.area > 0)
		cell.centroid /= cell.area;
	return cell;
}

std::vector<Cell> cellsOf(const Polygon& polygon)
{
	constexpr double sliver = 1e-9; // of the area of the polygon
	const double whole = cellOf(polygon).area;
	Vector2 low = polygon.front(), high = polygon.front();
	for (const Vector2& corner : polygon) {
		low = low.cwiseMin(corner);
		high = high.cwiseMax(corner);
	}
	const Vector2 size = (high - low) / fibresAcross;
	std::vector<Cell> cells;
	for (int i = 0; i < fibresAcross; ++i)
		for (int j = 0; j < fibresAcross; ++j) {
			const Vector2 from = low + Vector2(i * size.x(), j * size.y()), to = from + size;
			const Polygon strip = clipped(clipped(polygon, Vector2::UnitX(), from.x()), -Vector2::UnitX(), -to.x());
			const Cell cell = cellOf(clipped(clipped(strip, Vector2::UnitY(), from.y()), -Vector2::UnitY(), -to.y()));
			if (cell.area > sliver * whole)
				cells.push_back(cell);
		}
	return cells;
}

// Along the longest side of the patch.
Vector3 tangentOf(const JointContact& contact)
{
	Vector3 longest = Vector3::Zero();
	for (int i = 0; i < contact.size(); ++i) {
		const Vector3 side = contact.position((i + 1) % contact.size()) - contact.position(i);
		constexpr double longer = 1 + 1e-6; // of two sides that are alike the first
		if (side.norm() > longer * longest.norm())
			longest = side;
	}
	const Vector3& n = contact.patch.normal;
	return (longest - n * n.dot(longest)).normalized();
}

struct Axes {
	Vector3 normal, along, across;
};

// Either body as much as the other.
Axes axesOf(const MortarBond& bond, const Matrix3& turn1, const Matrix3& turn2)
{
	Axes axes;
	axes.normal = (turn1 * bond.normal1 + turn2 * bond.normal2).normalized();
	const Vector3 tangent = turn1 * bond.tangent1 + turn2 * bond.tangent2;
	axes.along = (tangent - axes.normal * axes.normal.dot(tangent)).normalized();
	axes.across = axes.normal.cross(axes.along);
	return axes;
}

// The plane gap(x) = mean + slope.x through the gaps of the corners, by least squares.
struct GapPlane {
	double mean {0};
	Vector2 slope {Vector2::Zero()};
};

GapPlane planeOf(const JointContact& contact, const Polygon& corners, const Vector2& centroid)
{
	GapPlane plane;
	Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
	Vector2 first = Vector2::Zero();
	for (int i = 0; i < contact.size(); ++i) {
		const PatchPoint& point = contact.patch.points[i];
		const Vector2 arm = corners[i] - centroid;
		plane.mean += point.weight * point.gap;
		second += point.weight * arm * arm.transpose();
		first += point.weight * point.gap * arm;
	}
	plane.slope = second.inverse() * first;
	return plane;
}

// Returns the pressure on each fibre, Pa: a linear one that has the resultant of the corners' normal forces and does not pull.
std::vector<double> pressuresOn(const JointContact& contact, const Axes& axes, const Vector3& centroid)
{
	const MortarBond& bond = *contact.bond;
	std::vector<double> pressures(bond.fibres.size(), 0);
	double force = 0;
	Vector2 moment = Vector2::Zero();
	for (int i = 0; i < contact.size(); ++i) {
		const double normal = contact.points[i].normalForce;
		const Vector3 arm = contact.position(i) - centroid;
		force += normal;
		moment += normal * Vector2(axes.along.dot(arm), axes.across.dot(arm));
	}
	if (!(force > 0))
		return pressures;
	const Vector2 slope = bond.spread * moment / force;
	double sum = 0;
	for (size_t k = 0; k < pressures.size(); ++k) {
		pressures[k] = std::max(0., 1 + slope.dot(bond.fibres[k].place));
		sum += bond.fibres[k].area * pressures[k];
	}
	for (double& pressure : pressures)
		pressure *= sum > 0 ? force / sum : 0;
	return pressures;
}

// Adds the force of a fibre on body 2 at the place where it acts.
void addForce(BondLoad& load, const MortarFibre& fibre, const Axes& axes, const Vector3& place)
{
	const Vector3 force =
	    -fibre.area * (fibre.now.pull * axes.normal + fibre.now.shear.x() * axes.along + fibre.now.shear.y() * axes.across);
	load.force += force;
	load.moment += (place - load.place).cross(force);
}

double storedIn(const MortarFibre& fibre, const MortarLaw& law)
{
	return 0.5 * fibre.area * (fibre.spring * fibre.spring / law.normalStiffness + fibre.shearSpring.squaredNorm() / law.shearStiffness);
}

// Adds dashpots to the springs of a fibre: where it is elastic, and no more than its strength.
void addDashpots(MortarFibre& fibre, const MortarLaw& law, double opens, const Vector2& slides)
{
	MortarTraction& now = fibre.now;
	fibre.spring = now.pull;
	fibre.shearSpring = now.shear;
	if (now.pull > 0 && !now.opens)
		now.pull = std::clamp(now.pull + opens, 0., std::max(now.pull, law.tensileStrength * fibre.point.strength()));
	if (now.slips)
		return;
	const Vector2 shear = now.shear + slides;
	const double size = shear.norm(), most = std::max(now.bound, now.shear.norm());
	now.shear = size > most ? Vector2(shear * (most / size)) : shear;
}

// The corners take over; the friction of the step in which they do takes up what they cannot store.
void giveUp(JointContact& contact, const Axes& axes)
{
	MortarBond& bond = *contact.bond;
	double stored = 0;
	Vector2 mean = Vector2::Zero();
	for (MortarFibre& fibre : bond.fibres) {
		mean += fibre.area / bond.area * fibre.shearSpring / bond.law.shearStiffness;
		stored += storedIn(fibre, bond.law);
		fibre.spring = fibre.now.pull = 0;
		fibre.shearSpring = fibre.now.shear = Vector2::Zero();
	}
	bond.isBroken = true;
	contact.load = {};
	const double kept = restartShear(contact, mean.x() * axes.along + mean.y() * axes.across);
	contact.energy.elastic += kept - stored;
	contact.energy.taken += kept - stored;
	contact.energy.friction += stored - kept;
}

} // namespace

bool JointContact::isSound(const MortarBond& bond) { return !bond.isBroken; }

MortarState stateOf(const MortarBond& bond)
{
	MortarState state;
	for (const MortarFibre& fibre : bond.fibres) {
		const double damage = 1 - fibre.point.strength();
		state.damage += damage * fibre.area / bond.area;
		state.worst = std::max(state.worst, damage);
		state.opening = std::max(state.opening, fibre.point.crack);
		state.slip = std::max(state.slip, fibre.point.slid);
		state.opened += fibre.area * fibre.point.opened;
		state.sheared += fibre.area * fibre.point.sheared;
	}
	const double tension = state.opened > 0 ? state.opened / bond.law.fractureEnergy : 0;
	const double shear = state.sheared > 0 ? state.sheared / bond.law.shearFractureEnergy : 0;
	state.byTension = tension + shear > 0 ? tension / (tension + shear) : 0;
	if (bond.isBroken)
		state.damage = state.worst = 1;
	return state;
}

void makeBond(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, const MortarLaw& law)
{
	if (contact.size() < 3)
		return;
	auto bond = std::make_shared<MortarBond>();
	bond->law = law;
	const Vector3 &n = contact.patch.normal, along = tangentOf(contact), across = n.cross(along), origin = contact.position(0);
	Polygon corners;
	double weight = 0;
	Vector2 shear = Vector2::Zero(); // mean displacement of the corners' springs, m
	for (int i = 0; i < contact.size(); ++i) {
		const Vector3 arm = contact.position(i) - origin;
		corners.push_back({along.dot(arm), across.dot(arm)});
		const double share = contact.patch.points[i].weight;
		weight += share;
		shear += share * Vector2(along.dot(contact.points[i].shear), across.dot(contact.points[i].shear));
	}
	const Cell whole = cellOf(corners);
	const GapPlane plane = planeOf(contact, corners, whole.centroid);
	bond->normal1 = body1.pose.orientation.conjugate() * n;
	bond->normal2 = body2.pose.orientation.conjugate() * n;
	bond->tangent1 = body1.pose.orientation.conjugate() * along;
	bond->tangent2 = body2.pose.orientation.conjugate() * along;
	Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
	contact.load = {};
	contact.load.place = origin + whole.centroid.x() * along + whole.centroid.y() * across;
	const Axes axes {n, along, across};
	for (const Cell& cell : cellsOf(corners)) {
		MortarFibre fibre;
		fibre.place = cell.centroid - whole.centroid;
		fibre.area = cell.area;
		const double gap = plane.mean + plane.slope.dot(fibre.place);
		const Vector3 place = contact.load.place + fibre.place.x() * along + fibre.place.y() * across;
		fibre.place1 = body1.pose.toLocal(place - 0.5 * gap * n);
		fibre.place2 = body2.pose.toLocal(place + 0.5 * gap * n);
		fibre.rest = std::max(0., gap);
		fibre.shift = shear / weight;
		fibre.shearSpring = fibre.now.shear = law.shearStiffness * fibre.shift;
		addForce(contact.load, fibre, axes, place);
		bond->area += fibre.area;
		second += fibre.area * fibre.place * fibre.place.transpose();
		bond->fibres.push_back(fibre);
	}
	bond->spread = (second / bond->area).inverse();
	contact.bond = bond;
	restartShear(contact, Vector3::Zero());
	contact.energy.elastic = contact.normalEnergy();
	for (const MortarFibre& fibre : bond->fibres)
		contact.energy.elastic += storedIn(fibre, law);
}

void updateBond(JointContact& contact, const RigidBody<Space>& body1, const RigidBody<Space>& body2, double dt)
{
	MortarBond& bond = *contact.bond;
	RigidBody<Space> start1 = body1, start2 = body2;
	start1.advance(-dt);
	start2.advance(-dt);
	const Matrix3 turn1 = body1.pose.orientation.toRotationMatrix(), turn2 = body2.pose.orientation.toRotationMatrix();
	const Matrix3 from1 = start1.pose.orientation.toRotationMatrix(), from2 = start2.pose.orientation.toRotationMatrix();
	const Axes axes = axesOf(bond, turn1, turn2);
	const double mass = reducedMass(body1, body2);
	const double damping = contact.dampingNormal(mass) / bond.area, dampingShear = contact.dampingShear(mass) / bond.area;
	Vector3 middle = Vector3::Zero();
	for (const MortarFibre& fibre : bond.fibres)
		middle += 0.5 * fibre.area / bond.area * (body1.pose.position + turn1 * fibre.place1 + body2.pose.position + turn2 * fibre.place2);
	const std::vector<double> pressures = pressuresOn(contact, axes, middle);
	contact.load = {middle};
	bool isBroken = true;
	for (size_t k = 0; k < bond.fibres.size(); ++k) {
		MortarFibre& fibre = bond.fibres[k];
		const MortarFibre old = fibre;
		const Vector3 at1 = body1.pose.position + turn1 * fibre.place1, at2 = body2.pose.position + turn2 * fibre.place2;
		const Vector3 apart = at2 - at1,
		              moved = apart - (start2.pose.position - start1.pose.position + from2 * fibre.place2 - from1 * fibre.place1);
		const auto acrossOf = [&](const Vector3& x) { return Vector2(axes.along.dot(x), axes.across.dot(x)); };
		const double way = axes.normal.dot(moved);
		const Vector2 slide = acrossOf(moved);
		fibre.now = advance(bond.law, fibre.point, axes.normal.dot(apart) - fibre.rest, acrossOf(apart) + fibre.shift, pressures[k]);
		addDashpots(fibre, bond.law, damping * way / dt, dampingShear * slide / dt);
		addForce(contact.load, fibre, axes, 0.5 * (at1 + at2));
		isBroken &= fibre.point.isBroken;
		// As in updateForces(): the leapfrog work of a force is that of the mean of its values at the two ends.
		const double springs = 0.5 * (old.spring + fibre.spring) * way + 0.5 * (old.shearSpring + fibre.shearSpring).dot(slide);
		const double all = 0.5 * (old.now.pull + fibre.now.pull) * way + 0.5 * (old.now.shear + fibre.now.shear).dot(slide);
		contact.energy.damping += fibre.area * (all - springs);
		contact.energy.crack += fibre.area * fibre.now.crack;
		contact.energy.friction += fibre.area * fibre.now.friction;
		contact.energy.taken += fibre.area * (springs - fibre.now.crack - fibre.now.friction);
		contact.energy.elastic += storedIn(fibre, bond.law);
	}
	if (isBroken)
		giveUp(contact, axes);
}

MortarAside::MortarAside(JointSystem& system) : system(system)
{
	for (size_t c = 0; c < system.contacts.size(); ++c) {
		JointContact& contact = system.contacts[c];
		if (!contact.isBonded())
			continue;
		aside.emplace_back(c, contact);
		contact.points.clear();
		contact.springs.clear();
		contact.patch.points.clear();
		contact.load = {};
		contact.energy.elastic = 0;
	}
	addLoads(1);
}

MortarAside::~MortarAside()
{
	addLoads(-1);
	for (auto& [c, contact] : aside)
		system.contacts[c] = std::move(contact);
}

void MortarAside::addLoads(double sign)
{
	for (const auto& [c, contact] : aside)
		for (const auto& [b, side] : {std::pair(contact.body1, -sign), std::pair(contact.body2, sign)}) {
			RigidBody<Space>& body = system.bodies[b];
			if (body.prescribed)
				continue;
			body.force.head<3>() += side * contact.load.force;
			body.force.tail<3>() += side * contact.bondMoment(body.pose.position);
			for (int i = 0; i < contact.size(); ++i) {
				body.force.head<3>() += side * contact.force(i);
				body.force.tail<3>() += side * contact.moment(i, body.pose.position);
			}
		}
}

} // namespace masonry
