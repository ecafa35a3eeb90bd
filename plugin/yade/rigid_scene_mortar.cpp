// Mortar of a scene with method='wall': which joints it bonds, what is left of it, and its forces.

#include "bonded_state.hpp"
#include "rigid_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace yade {

namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();
constexpr Real closeBy = 1e-4; // gap up to which blocks touch, and length of a joint from which on it is one, relative to their thickness

/// Rigid joints have no stiffness. `friction`: of the joint.
masonry::MortarLaw checked(masonry::MortarLaw law, Real friction, int id1, int id2)
{
	const std::string joint = jointName(id1, id2);
	if (std::isnan(law.friction))
		law.friction = friction;
	law.normalStiffness = law.shearStiffness = infinite;
	if (!(law.friction > 0) || !std::isfinite(law.friction))
		throw std::invalid_argument(sentence(joint, " has mortar and the tangent of friction ", law.friction,
		                                     ": method='wall' needs a positive frictionAngle there, and no noSlip."));
	if (!(law.tensileStrength > 0))
		throw std::invalid_argument(
		    sentence(joint, " has mortar with tensileStrength = ", law.tensileStrength, " Pa: method='wall' needs a positive one."));
	if (const std::string fault = law.fault(); !fault.empty())
		throw std::invalid_argument(joint + " has mortar with " + fault + ".");
	law.normalStiffness = law.shearStiffness = 0;
	return law;
}

masonry::MortarLaw lawOf(const JointMat& mortar, Real friction, int id1, int id2)
{
	checkRigid(mortar, id1, id2);
	return checked(mortar.law(infinite, infinite, NaN, id1, id2), friction, id1, id2);
}

} // namespace

void checkRigid(const JointMat& mortar, int id1, int id2)
{
	if (!std::isnan(mortar.flexuralStrength))
		throw std::invalid_argument(sentence(jointName(id1, id2), " has mortar with flexuralStrength = ", mortar.flexuralStrength,
		                                     " Pa: a rigid joint bears three times the moment at which its edge reaches its strength: "
		                                     "give tensileStrength = ",
		                                     mortar.flexuralStrength / 3, " with method='wall'."));
}

/// Joints of the run that goes on, but those of blocks that are gone.
template <class K>
void RigidScene<K>::addMortar(const Remembered<K>& before, const vector<int>& inBefore)
{
	const vector<int> now = placesNow(inBefore, before.bodies.size());
	for (masonry::MortarJoint<K> joint : before.mortar) {
		joint.body1 = now[joint.body1];
		joint.body2 = now[joint.body2];
		if (std::min(joint.body1, joint.body2) >= 0)
			system.mortar.push_back(joint);
	}
	std::sort(system.mortar.begin(), system.mortar.end(),
	          [](const auto& a, const auto& b) { return std::pair(a.body1, a.body2) < std::pair(b.body1, b.body2); });
	bonds = before.ids.empty() || (settings.begins && before.mortar.empty());
}

template <>
masonry::MortarJoint<Space> RigidScene<Space>::jointOf(const Pair& pair, const masonry::MortarLaw& law) const
{
	return masonry::wall::mortarJoint(system, pair, law);
}

/// Blocks touch along a face.
template <class K>
bool RigidScene<K>::isJoint(const Pair& pair) const
{
	const Real thickness = std::min(links[pair.body1].properties.shape.thickness(), links[pair.body2].properties.shape.thickness());
	const auto isClosed = [&](const auto& point) { return point.gap <= closeBy * thickness; };
	return pair.size() >= K::dimension && std::all_of(pair.points.begin(), pair.points.end(), isClosed);
}

template <class K>
vector<BlockJoint> RigidScene<K>::jointsInTouch()
{
	takeScene();
	vector<BlockJoint> result;
	for (const Pair& pair : system.pairs)
		if (isJoint(pair))
			result.push_back(
			    {kept.ids[pair.body1], kept.ids[pair.body2], isHeadJoint(coordinates.out(pair.points[0].frame.axes.row(0).transpose()))});
	return result;
}

template <class K>
masonry::MortarLaw RigidScene<K>::askedLaw(const Real* row, size_t c) const
{
	const Pair& pair = system.pairs[c];
	masonry::MortarLaw law;
	law.tensileStrength = row[2];
	law.fractureEnergy = row[3];
	law.cohesion = row[4];
	law.shearFractureEnergy = row[5];
	law.friction = row[6];
	return checked(law, contacts.law(c).noSlip ? infinite : contacts.law(c).tangensOfFrictionAngle, kept.ids[pair.body1],
	               kept.ids[pair.body2]);
}

template <>
masonry::MortarJoint<Plane> RigidScene<Plane>::jointOf(const Pair& pair, const masonry::MortarLaw& law) const
{
	const auto depthOf = [&](int b) { return 2 * links[b].properties.shape.reach(links[b].state->ori.conjugate() * coordinates.normal); };
	return masonry::wall::mortarJoint(system, pair, law, std::min(depthOf(pair.body1), depthOf(pair.body2)));
}

/// Joints of blocks that touch and both have the same mortar.
template <class K>
void RigidScene<K>::bond()
{
	std::map<std::pair<int, int>, const Real*> rows; // the last one of a pair counts
	for (size_t row = 0; row + sizeOfAskedBond <= asked.size(); row += sizeOfAskedBond)
		rows[std::minmax(int(asked[row]), int(asked[row + 1]))] = &asked[row];
	std::map<std::pair<int, int>, masonry::MortarJoint<K>> made;
	for (size_t c = 0; c < system.pairs.size(); ++c) {
		const Pair& pair = system.pairs[c];
		const int id1 = kept.ids[pair.body1], id2 = kept.ids[pair.body2];
		const auto row = rows.find(std::minmax(id1, id2));
		const shared_ptr<JointMat>& mortar = contacts.law(c).mortar;
		if (!(row != rows.end() || (bonds && mortar)) || !isJoint(pair))
			continue;
		const masonry::MortarLaw law =
		    row != rows.end() ? askedLaw(row->second, c) : lawOf(*mortar, contacts.law(c).tangensOfFrictionAngle, id1, id2);
		const masonry::MortarJoint<K> joint = jointOf(pair, law);
		const Real thickness = std::min(links[pair.body1].properties.shape.thickness(), links[pair.body2].properties.shape.thickness());
		if (!(joint.area > closeBy * thickness * thickness))
			continue;
		if (!made.emplace(std::pair(joint.body1, joint.body2), joint).second)
			throw std::invalid_argument(jointName(id1, id2) +
			                            " has mortar on two faces: method='wall' bonds one face of a pair; take model='compliant'.");
		contacts.setFriction(c, law.friction);
	}
	if (!bonds && system.mortar.empty()) { // a structure of few blocks has been stepped by its impacts until now: the walls begin
		showPoints();
		byWalls = false;
	}
	for (const masonry::MortarJoint<K>& old : system.mortar)
		if (!bonds)
			made.emplace(std::pair(old.body1, old.body2), old);
	system.mortar.clear();
	for (const auto& [bodies, joint] : made)
		system.mortar.push_back(joint);
	takeLaws();
	rowOf.clear();
	asked.clear();
	bonds = false;
}

/// Joints that are not listed yet come last: who records the rows counts on it.
template <class K>
void RigidScene<K>::findRows(vector<int>& ids, vector<Real>& rows)
{
	std::map<std::pair<int, int>, size_t> listed;
	for (size_t row = 0; 2 * row < ids.size(); ++row)
		listed[{ids[2 * row], ids[2 * row + 1]}] = row;
	rowOf.clear();
	for (const masonry::MortarJoint<K>& joint : system.mortar) {
		const int id1 = kept.ids[joint.body1], id2 = kept.ids[joint.body2];
		const auto [row, isNew] = listed.emplace(std::pair(id1, id2), ids.size() / 2);
		rowOf.push_back(row->second);
		if (!isNew)
			continue;
		ids.insert(ids.end(), {id1, id2});
		const auto& pose = system.bodies[joint.body2].pose;
		typename K::Vector middle = K::Vector::Zero();
		for (const auto& point : joint.points)
			middle += pose.toGlobal(point.place2) / double(joint.points.size());
		const Vector3r at = pointInScene(coordinates, middle, kept.seats[joint.body2].depth);
		rows.insert(rows.end(), {at.x(), at.y(), at.z(), joint.area, 0, 0, 0, 0, 0, 0, 0, NaN, NaN});
	}
}

/// Rows of dem.damage(), beyond the end of a joint.
template <class K>
void RigidScene<K>::writeMortar(vector<int>& ids, vector<Real>& rows)
{
	if (rowOf.size() != system.mortar.size())
		findRows(ids, rows);
	for (size_t j = 0; j < system.mortar.size(); ++j) {
		const masonry::MortarJoint<K>& joint = system.mortar[j];
		Real* of = &rows.at(rowOf[j] * bondedRow + 4);
		if (joint.isSound() && of[1] == 0)
			continue;
		std::fill(of, of + 7, 0);
		if (joint.isSound()) { // new mortar, or a script has gone back to an earlier state
			of[7] = of[8] = NaN;
			continue;
		}
		of[0] = joint.damage();
		for (const auto& point : joint.points) {
			of[1] = std::max(of[1], 1 - point.state.strength());
			of[3] = std::max(of[3], point.state.crack);
			of[4] = std::max(of[4], point.state.slid);
			of[5] += point.area * point.state.opened;
			of[6] += point.area * point.state.sheared;
		}
		const Real tension = of[5] / joint.law.fractureEnergy, shear = of[6] / joint.law.shearFractureEnergy;
		of[2] = tension + shear > 0 ? tension / (tension + shear) : 0;
		if (std::isnan(of[7]) && of[1] >= firstCrack)
			of[7] = scene.time;
		if (std::isnan(of[8]) && joint.isBroken())
			of[8] = scene.time;
	}
}

/// Forces of cracking joints, beside those of the corners.
template <class K>
void RigidScene<K>::showMortar()
{
	using Vector = typename K::Vector;
	for (size_t c = 0; c < system.pairs.size() && !system.mortar.empty(); ++c) {
		const Pair& pair = system.pairs[c];
		const masonry::MortarJoint<K>* joint = masonry::mortarBetween(system.mortar, pair.body1, pair.body2);
		if (!joint)
			continue;
		const auto& pose2 = system.bodies[pair.body2].pose;
		const auto axes = masonry::axesOf(*joint, system.bodies[pair.body1].pose, pose2);
		const Real depth = kept.seats[pair.body2].depth;
		masonry::BondLoad load;
		load.place = pointInScene(coordinates, pose2.position, depth);
		for (const auto& point : joint->points) {
			if (point.state.isBroken)
				continue;
			for (int row = 0; row < K::rows; ++row) { // shear acts beside the pull
				const Vector along = axes.row(row).transpose() * point.force[row];
				const Vector at = pose2.toGlobal(row == 0 ? point.place2 : Vector(point.place2 + point.grip2));
				const Vector3r force = coordinates.out(along);
				load.force += force;
				load.moment += (pointInScene(coordinates, at, depth) - load.place).cross(force);
			}
		}
		contacts.setLoad(c, load);
	}
}

template void RigidScene<Plane>::addMortar(const Remembered<Plane>&, const vector<int>&);
template void RigidScene<Space>::addMortar(const Remembered<Space>&, const vector<int>&);
template void RigidScene<Plane>::bond();
template void RigidScene<Space>::bond();
template void RigidScene<Plane>::showMortar();
template void RigidScene<Space>::showMortar();
template void RigidScene<Plane>::writeMortar(vector<int>&, vector<Real>&);
template void RigidScene<Space>::writeMortar(vector<int>&, vector<Real>&);
template vector<BlockJoint> RigidScene<Plane>::jointsInTouch();
template vector<BlockJoint> RigidScene<Space>::jointsInTouch();

} // namespace yade
