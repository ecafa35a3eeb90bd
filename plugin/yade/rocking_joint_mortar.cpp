// The mortar of a scene: which joints are bonded, and what becomes of them.

#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "RockingJointEngine.hpp"
#include "bonded_state.hpp"
#include "sentence.hpp"

#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace yade {

namespace {

constexpr size_t asked = 9; // numbers of a row of bondsAsked

/// Gap up to which blocks touch, relative to the smaller thickness of the two.
constexpr Real touching = 1e-4;

void checkLaw(const masonry::MortarLaw& law, int id1, int id2)
{
	if (!std::isfinite(law.friction))
		throw std::runtime_error(jointName(id1, id2) +
		                         " has mortar and noSlip = True: mortar that breaks in shear slips; give a frictionAngle.");
	const std::string fault = law.fault();
	if (!fault.empty())
		throw std::runtime_error(jointName(id1, id2) + " has mortar with " + fault + ".");
}

Real largestGap(const masonry::ContactPatch& patch)
{
	Real gap = 0;
	for (const masonry::PatchPoint& point : patch.points)
		gap = std::max(gap, point.gap);
	return gap;
}

masonry::MortarLaw lawAt(const Real* row)
{
	masonry::MortarLaw law;
	law.normalStiffness = row[0];
	law.shearStiffness = row[1];
	law.tensileStrength = row[2];
	law.fractureEnergy = row[3];
	law.cohesion = row[4];
	law.shearFractureEnergy = row[5];
	law.friction = row[6];
	return law;
}

} // namespace

int RockingJointEngine::bond(const vector<int>& of, const shared_ptr<JointMat>& mortar, const string& joints)
{
	if (!mortar || std::isnan(mortar->directStrength()))
		throw std::invalid_argument("material is not allowed: it must be a JointMat with strengths and fracture energies.");
	const std::set<int> members(of.begin(), of.end());
	std::set<std::pair<int, int>> named;
	for (size_t k = 0; joints == "pairs" && k + 1 < of.size(); k += 2)
		named.insert(std::minmax(of[k], of[k + 1]));
	const auto isMeant = [&](int id1, int id2, bool isHead) {
		if (joints == "pairs")
			return named.count(std::minmax(id1, id2)) > 0;
		return (of.empty() || (members.count(id1) && members.count(id2))) && (joints == "all" || isHead == (joints == "head"));
	};
	int count = 0;
	presentContacts(); // reads the blocks
	for (const masonry::JointContact& contact : blocks.blocksInTouch(*scene, dampingRatio, step)) {
		const int id1 = blocks.ids[contact.body1], id2 = blocks.ids[contact.body2];
		const Real thickness =
		    std::min(step.system.bodies[contact.body1].shape->thickness(), step.system.bodies[contact.body2].shape->thickness());
		if (!isMeant(id1, id2, isHeadJoint(contact.patch.normal)) || contact.size() < 3 || largestGap(contact.patch) > touching * thickness)
			continue;
		const masonry::MortarLaw law = mortar->law(contact.law.normalStiffness, contact.law.shearStiffness, contact.law.friction, id1, id2);
		checkLaw(law, id1, id2);
		bondsAsked.insert(bondsAsked.end(), {Real(id1), Real(id2), law.normalStiffness, law.shearStiffness, law.tensileStrength,
		                                     law.fractureEnergy, law.cohesion, law.shearFractureEnergy, law.friction});
		++count;
	}
	return count;
}

/// Calls use(contact, law) for each joint that dem.bond has asked for.
template <class Use>
void RockingJointEngine::forBondsAsked(const vector<masonry::JointContact>& contacts, Use use) const
{
	std::map<std::pair<int, int>, size_t> rows; // the last one of a pair counts
	for (size_t row = 0; row + asked <= bondsAsked.size(); row += asked)
		rows[std::minmax(int(bondsAsked[row]), int(bondsAsked[row + 1]))] = row;
	for (size_t c = 0; !rows.empty() && c < contacts.size(); ++c)
		if (const auto found = rows.find(std::minmax(blocks.ids[contacts[c].body1], blocks.ids[contacts[c].body2])); found != rows.end())
			use(c, lawAt(&bondsAsked[found->second + 2]));
}

/// The contacts with the stiffness of the mortar that dem.bond has asked for.
vector<masonry::JointContact> RockingJointEngine::withBondsAsked(vector<masonry::JointContact> contacts) const
{
	forBondsAsked(contacts, [&](size_t c, const masonry::MortarLaw& law) {
		contacts[c].law.normalStiffness = law.normalStiffness;
		contacts[c].law.shearStiffness = law.shearStiffness;
		contacts[c].law.hasMortar = true;
	});
	return contacts;
}

void RockingJointEngine::goOnFrom(const RockingJointEngine& other)
{
	started = other.started;
	elastPotential = other.elastPotential;
	crackDissip = other.crackDissip;
	bondedIds = other.bondedIds;
	bondedState = other.bondedState;
	bondsAsked.insert(bondsAsked.end(), other.bondsAsked.begin(), other.bondsAsked.end());
}

/// Before the first step: blocks that both have the same mortar. At any time: what dem.bond has asked for.
void RockingJointEngine::askForMortar()
{
	step.requests.clear(); // a step that was refused has left them
	for (size_t c = 0; !started && c < blocks.pairs.size(); ++c) {
		const auto [geom, phys] = blocks.pairs[c];
		const masonry::JointContact& contact = step.system.contacts[c];
		if (!(phys->mortar || contact.bond) || contact.size() < 3)
			continue;
		const int id1 = blocks.ids[contact.body1], id2 = blocks.ids[contact.body2];
		if (contact.bond)
			throw std::runtime_error(
			    jointName(id1, id2) +
			    " has mortar that another RockingJointEngine has bonded: O.engines must keep that engine, or be made by "
			    "dem.engines() while it is there, which goes on with its damage.");
		const Real gap = largestGap(contact.patch);
		if (gap > touching * std::min(geom->refR1, geom->refR2))
			throw std::runtime_error(
			    sentence(jointName(id1, id2), " has mortar and a gap of ", gap,
			             " m: blocks with mortar must touch; the mortar's thickness belongs to their sizes, half a joint to either."));
		askForBond(c, phys->mortar->law(phys->normalStiffness, phys->shearStiffness, contact.law.friction, id1, id2));
	}
	forBondsAsked(step.system.contacts, [this](size_t c, const masonry::MortarLaw& law) { askForBond(c, law); });
}

void RockingJointEngine::askForBond(size_t c, const masonry::MortarLaw& law)
{
	BlockPhys& phys = *blocks.pairs[c].phys;
	masonry::JointContact& contact = step.system.contacts[c];
	checkLaw(law, blocks.ids[contact.body1], blocks.ids[contact.body2]);
	phys.noSlip = false;
	phys.normalStiffness = contact.law.normalStiffness = law.normalStiffness;
	phys.shearStiffness = contact.law.shearStiffness = law.shearStiffness;
	phys.tangensOfFrictionAngle = contact.law.friction = law.friction;
	contact.law.hasMortar = true;
	step.requests.push_back({int(c), law});
}

/// Keeps the rows of dem.damage() up to date, beyond the end of a contact.
void RockingJointEngine::writeMortar()
{
	for (size_t c = 0; c < blocks.pairs.size(); ++c) {
		const masonry::JointContact& contact = step.system.contacts[c];
		BlockPhys& phys = *blocks.pairs[c].phys;
		const bool isListed = phys.jointRow >= 0 && phys.jointRow < int(bondedIds.size() / 2);
		if (!contact.bond || (isListed && contact.energy.crack == 0))
			continue;
		if (!isListed) {
			phys.jointRow = int(bondedIds.size() / 2);
			bondedIds.insert(bondedIds.end(), {blocks.ids[contact.body1], blocks.ids[contact.body2]});
			const Vector3r& at = contact.load.place;
			bondedState.insert(bondedState.end(), {at.x(), at.y(), at.z(), contact.bond->area, 0, 0, 0, 0, 0, 0, 0, NaN, NaN});
		}
		Real* row = &bondedState.at(phys.jointRow * bondedRow);
		const masonry::MortarState state = stateOf(*contact.bond);
		const Real all[] {state.damage, state.worst, state.byTension, state.opening, state.slip, state.opened, state.sheared};
		std::copy(std::begin(all), std::end(all), row + 4);
		if (std::isnan(row[11]) && state.worst >= firstCrack)
			row[11] = scene->time;
		if (std::isnan(row[12]) && contact.bond->isBroken)
			row[12] = scene->time;
	}
}

} // namespace yade
