#pragma once

#include "laws/mortar_law.hpp"
#include <lib/serialization/Serializable.hpp>

namespace yade {

/// Mortar of joints (laws/mortar_law.hpp). NaN stands for "not given".
class JointMat : public Serializable {
public:
	/// Throws std::invalid_argument naming attribute, value and allowed range.
	void postLoad(JointMat&);

	/// Tensile strength, from whichever of the two strengths is given, Pa.
	Real directStrength() const;
	/// The law of the joint of two bodies, with these values where none is given: stiffness in Pa/m, tangent of the friction angle.
	masonry::MortarLaw law(Real normal, Real shear, Real friction, int id1, int id2) const;
	/// Strengths and energies of the joint over the mean: 1 without scatter.
	Real factor(int id1, int id2) const;
	bool isLike(const JointMat& other) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(JointMat, Serializable,
		"Mortar of joints, with model='compliant' or method='wall'. A joint is elastic up to its strengths, or rigid with method='wall'; then it cracks and spends its fracture energies; then it is a dry joint. Give it to the BlockMat of both blocks (mortar=), or to dem.bond().",
		((Real, tensileStrength, NaN, Attr::triggerPostLoad, "Direct tensile strength [Pa], 0 or positive."))
		((Real, flexuralStrength, NaN, Attr::triggerPostLoad, "Strength that a bond wrench reports, 6 M / (b h^2) [Pa], instead of tensileStrength, with model='compliant'; it needs normalStiffness. directStrength tells the tensile strength it stands for."))
		((Real, fractureEnergy, NaN, Attr::triggerPostLoad, "Energy that a crack in tension spends [J/m^2 = N/m], positive."))
		((Real, cohesion, NaN, Attr::triggerPostLoad, "Shear strength without pressure [Pa], at least tan(frictionAngle) times the tensile strength."))
		((Real, shearFractureEnergy, NaN, Attr::triggerPostLoad, "Energy that a crack in shear spends beside friction [J/m^2 = N/m], positive."))
		((Real, frictionAngle, NaN, Attr::triggerPostLoad, "Friction angle [rad], from 0 to below pi/2, of the joint before and after it cracks. NaN (default): that of the BlockMats."))
		((Real, normalStiffness, NaN, Attr::triggerPostLoad, "Normal stiffness of the joint per unit of area [Pa/m] with model='compliant', above tensileStrength^2/fractureEnergy. NaN (default): that of the BlockMats."))
		((Real, shearStiffness, NaN, Attr::triggerPostLoad, "Shear stiffness of the joint per unit of area [Pa/m] with model='compliant', above cohesion^2/shearFractureEnergy. NaN (default): that of the BlockMats."))
		((Real, scatter, 0, Attr::triggerPostLoad, "Standard deviation over mean of the strengths of joints, 0 to 1 (dem.scatter). Each joint has one lognormal factor for both strengths and both energies."))
		((int, seed, 0, , "Number that chooses the factors of the joints.")),
		/* ctor */,
		.add_property("directStrength", &JointMat::directStrength, "Tensile strength [Pa]: tensileStrength, or what flexuralStrength stands for.")
		.def("factor", &JointMat::factor, "Factor of the strengths and energies of the joint of two bodies, by their ids: 1 without scatter.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(JointMat);

} // namespace yade
