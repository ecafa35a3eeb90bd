// Joints of rigid blocks that dem.bond asks for, and runs with mortar that new engines go on with.

#include "MoreauJeanIntegrator.hpp"
#include "rigid_scene.hpp"

#include <algorithm>
#include <limits>
#include <set>

namespace yade {

int MoreauJeanIntegrator::bond(const vector<int>& of, const shared_ptr<JointMat>& mortar, const string& joints)
{
	if (!mortar || std::isnan(mortar->directStrength()))
		throw std::invalid_argument("material is not allowed: it must be a JointMat with strengths and fracture energies.");
	const size_t asked = bondsAsked.size();
	const auto ask = [&](int id1, int id2) {
		checkRigid(*mortar, id1, id2);
		constexpr Real infinite = std::numeric_limits<Real>::infinity();
		const masonry::MortarLaw law = mortar->law(infinite, infinite, NaN, id1, id2);
		bondsAsked.insert(bondsAsked.end(), {Real(id1), Real(id2), law.tensileStrength, law.fractureEnergy, law.cohesion,
		                                     law.shearFractureEnergy, law.friction});
	};
	if (joints == "pairs") {
		for (size_t k = 0; k + 1 < of.size(); k += 2)
			ask(of[k], of[k + 1]);
		return int(of.size() / 2);
	}
	scene = Omega::instance().getScene().get();
	if (!memory.run)
		start();
	else if (outdated())
		renew();
	if (!wall)
		throw std::invalid_argument("material is not allowed here: of rigid blocks, those of method='wall' have mortar; "
		                            "take dem.engines(method='wall') or dem.engines(model='compliant').");
	const std::set<int> members(of.begin(), of.end());
	for (const auto& [id1, id2, isHead] : sceneOf(memory).jointsInTouch())
		if ((of.empty() || (members.count(id1) && members.count(id2))) && (joints == "all" || isHead == (joints == "head")))
			ask(id1, id2);
	try {
		checkMortar();
	} catch (...) {
		bondsAsked.resize(asked);
		throw;
	}
	mortared = hasMortar();
	return int((bondsAsked.size() - asked) / sizeOfAskedBond);
}

void MoreauJeanIntegrator::goOnWith(MoreauJeanIntegrator& other)
{
	bondsAsked.insert(bondsAsked.end(), other.bondsAsked.begin(), other.bondsAsked.end());
	if (other.substeps == 0)
		return;
	memory.run.reset();
	memory.values = other.remembered();
	chosenModel = other.chosenModel;
	reason = other.reason;
	along = other.along;
	bondedIds = other.bondedIds;
	bondedState = other.bondedState;
	crackDissip = other.crackDissip;
	potentialShift = other.potentialShift;
}

} // namespace yade
