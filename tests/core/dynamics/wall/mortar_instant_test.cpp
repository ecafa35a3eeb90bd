// Mortar at instants: Dirac pulses of the base, and restitution of joints whose mortar is gone.
#include "core/dynamics/wall/mortar_rig.hpp"
#include <catch.hpp>

using namespace masonry;
using namespace rig;

namespace {

// A base that jumps; blocks without weight, so that energies are those of the jump alone.
template <class K>
struct Struck : BondedOf<K> {
	using BondedOf<K>::BondedOf;
	using BondedOf<K>::system;
	ScheduledMotion motion;

	void weightless()
	{
		for (RigidBody<K>& body : system.bodies)
			body.force.setZero();
	}
	// A brick on the base, bonded to it.
	MortarLaw addBrick(double width, double height)
	{
		this->add(width, height, 0, height / 2);
		const MortarLaw law = lawOf(0.25e6);
		this->bond(law);
		weightless();
		return law;
	}
	double mass() const
	{
		double sum = 0;
		for (const RigidBody<K>& body : system.bodies)
			sum += body.prescribed ? 0 : body.mass;
		return sum;
	}
	// The base jumps so that the blocks have this energy relative to it.
	void strike(double of, const typename K::Vector& direction, double after)
	{
		motion.append({system.time + after, std::sqrt(2 * of / mass())});
		this->drive(motion, direction);
	}
	// By impacts. The ledger counts the weight that blocks would have, h W v/2.
	double lost() const { return system.impactDissip + this->step.potentialShift(); }
	// Relative to the base, J.
	double left() const
	{
		double sum = 0;
		const auto base = system.bodies[0].velocity;
		for (const RigidBody<K>& body : system.bodies) {
			RigidBody<K> relative = body;
			relative.velocity -= base;
			sum += body.prescribed ? 0 : relative.kineticEnergy();
		}
		return sum;
	}
};

} // namespace

TEMPLATE_TEST_CASE("a brick on a base that jumps away keeps what its joint does not take, at any step", "", Plane, Space)
{
	using K = TestType;
	const double share = GENERATE(0.5, 0.9, 1.1, 1.5, 3., 10.), step = GENERATE(1e-4, 1e-3, 4e-3);
	CAPTURE(share, step);
	Struck<K> s;
	const MortarLaw law = s.addBrick(0.2, 0.1);
	const double energy = law.fractureEnergy * 0.2 * depth, lost = s.lost();
	s.strike(share * energy, -K::Vector::Unit(Struck<K>::up), 2.5 * step);
	const double bound = 2e-3 * std::max(1., share); // velocities miss the laws by 1e-3; a point breaks at D = 0.999
	double made = 0;
	for (int k = 0; k < 12; ++k) {
		s.advance(step);
		made += s.step.lastErrors().made;
	}
	CHECK(s.left() / energy == Approx(std::max(0., share - 1)).margin(bound));
	CHECK(s.damage() == Approx(std::min(1., share)).margin(1e-3));
	CHECK(s.system.crackDissip == Approx(s.spent()).epsilon(1e-12));
	CHECK((s.lost() - lost) / energy == Approx(0).margin(bound));
	CHECK(made / energy == Approx(0).margin(1e-3));
}

TEMPLATE_TEST_CASE("a brick that is pulled flies on under its load when a jump has broken its joint", "", Plane, Space)
{
	using K = TestType;
	Struck<K> s;
	const MortarLaw law = s.addBrick(0.2, 0.1);
	RigidBody<K>& brick = s.system.bodies[1];
	const double pull = 1000, energy = law.fractureEnergy * 0.2 * depth; // N, J; a fifth of the strength
	brick.force[Struck<K>::up] = pull;
	s.run(0.02, 1e-3);
	const double begin = s.system.time + 2.5e-3;
	s.strike(3 * energy, -K::Vector::Unit(Struck<K>::up), 2.5e-3);
	s.run(0.006, 1e-3);
	CHECK(s.damage() == 1);
	const double speed = brick.velocity[Struck<K>::up] - s.system.bodies[0].velocity[Struck<K>::up];
	CHECK(speed == Approx(std::sqrt(4 * energy / brick.mass) + pull / brick.mass * (s.system.time - begin)).epsilon(2e-3));
}

// The brick is flat, so that little of its energy goes into turns.
TEMPLATE_TEST_CASE("a brick on a base that jumps aside keeps what the shear of its joint does not take", "", Plane, Space)
{
	using K = TestType;
	const double share = GENERATE(0.5, 1.5, 3.), step = GENERATE(1e-4, 1e-3);
	CAPTURE(share, step);
	Struck<K> s;
	const MortarLaw law = s.addBrick(0.4, 0.02);
	const double energy = law.shearFractureEnergy * 0.4 * depth;
	s.strike(share * energy, K::Vector::Unit(0), 2.5 * step);
	for (int k = 0; k < 5; ++k)
		s.advance(step);
	CHECK(s.left() / energy == Approx(std::max(0., share - 1)).margin(2e-3 * share));
	CHECK(s.damage() == Approx(std::min(1., share)).margin(5e-3)); // the brick turns a little
}

TEMPLATE_TEST_CASE("a stack that its base can hold takes the damage of its energy, and stays", "", Plane, Space)
{
	using K = TestType;
	const double step = GENERATE(1e-4, 1e-3, 4e-3);
	CAPTURE(step);
	Struck<K> s;
	s.addStack(8, 0.2, 0.1);
	const MortarLaw law = lawOf(0.25e6);
	s.bond(law);
	s.weightless();
	const double energy = law.fractureEnergy * 0.2 * depth;
	s.strike(0.7 * energy, -K::Vector::Unit(Struck<K>::up), 2.5 * step);
	for (int k = 0; k < 20; ++k)
		s.advance(step);
	for (const MortarJoint<K>& joint : s.system.mortar)
		CHECK(joint.damage() == Approx(std::min(joint.body1, joint.body2) == 0 ? 0.7 : 0).margin(2e-3));
	CHECK(s.left() / energy == Approx(0).margin(1e-4));
}

// Both sides of a base that jumps, and a run that is saved while it cracks.
TEMPLATE_TEST_CASE("a wall that a jump of its base cracks has a mirror image and goes on after loading", "", Plane, Space)
{
	using K = TestType;
	double damage[2], crack[2];
	for (const int side : {0, 1}) {
		Struck<K> s;
		s.addStack(4, 0.1, 0.1);
		const MortarLaw law = lawOf(0.25e6);
		s.bond(law);
		const double before = s.energy() + s.system.frictDissip + s.system.impactDissip - s.system.baseWork;
		s.strike(2 * law.shearFractureEnergy * 0.1 * depth, (side ? 1 : -1) * K::Vector::Unit(0), 0.02);
		s.run(0.022, 1e-3);
		goesOnWithItsBits(s, 30);
		damage[side] = s.damage();
		crack[side] = s.system.crackDissip;
		const double after = s.energy() + s.system.frictDissip + s.system.impactDissip + s.system.crackDissip - s.system.baseWork;
		CHECK(after == Approx(before).margin(1e-6 * s.system.baseWork));
		CHECK(crack[side] == Approx(s.spent()).epsilon(1e-12));
	}
	CHECK(damage[0] > 0.1);
	CHECK(damage[0] == Approx(damage[1]).epsilon(1e-6));
}

namespace {

// All blocks turn about an edge at this place.
template <class K>
void turn(BondedOf<K>& s, double spin, double edge, double height = 0)
{
	for (size_t b = 1; b < s.system.bodies.size(); ++b) {
		RigidBody<K>& body = s.system.bodies[b];
		const typename K::Vector arm = body.pose.position - edge * K::Vector::Unit(0) - height * K::Vector::Unit(BondedOf<K>::up);
		body.velocity.setZero();
		body.velocity[0] = -spin * arm[K::dimension - 1];
		body.velocity[K::dimension - 1] = spin * arm[0];
		body.velocity[K::dimension == 2 ? 2 : 4] = K::dimension == 2 ? spin : -spin;
	}
}

template <class K>
auto impactsOf(BondedOf<K>& s, double time, double step)
{
	decltype(s.system.impacts) found;
	for (double end = s.system.time + time; s.system.time < end;) {
		s.advance(step);
		found.insert(found.end(), s.system.impacts.begin(), s.system.impacts.end());
	}
	return found;
}

template <class K>
void breakJoint(MortarJoint<K>& joint)
{
	for (CohesivePoint<K>& point : joint.points)
		addDamage(joint.law, point.state, 1, 0);
	joint.isRigid = false;
}

} // namespace

// Its mortar is weak and tough: it opens by half a millimetre before half of it is spent.
TEMPLATE_TEST_CASE("a joint lands with the restitution that is asked once its mortar is gone, and not before", "", Plane, Space)
{
	using K = TestType;
	const double C = 0.5, step = 1e-3;
	BondedOf<K> s(C);
	s.add(0.2, 0.6, 0, 0.3);
	MortarLaw law = lawOf(1e3);
	law.fractureEnergy = 1;
	law.shearFractureEnergy = 7;
	s.bond(law);
	turn(s, 0.15, -0.1);
	CHECK(impactsOf(s, 0.5, step).empty());
	CHECK(s.damage() > 0.05);
	CHECK(s.damage() < 0.95);
	breakJoint(s.system.mortar[0]);
	turn(s, 0.5, -0.1);
	const auto found = impactsOf(s, 0.6, step);
	REQUIRE(!found.empty());
	CHECK(found[0].joint.restitution() == Approx(C).epsilon(1e-6));
	CHECK_FALSE(found[0].capped);
}

// The block stands on two others, rocks on the one that it is bonded to, and lands on the other.
TEMPLATE_TEST_CASE("a block has no given restitution while one of its supports has mortar", "", Plane, Space)
{
	using K = TestType;
	const bool isBonded = GENERATE(false, true);
	CAPTURE(isBonded);
	BondedOf<K> s(0.5);
	s.add(0.2, 0.1, -0.1, 0.05);
	s.add(0.2, 0.1, 0.1, 0.05);
	s.add(0.2, 0.6, 0, 0.4);
	MortarLaw law = lawOf(1e3);
	law.fractureEnergy = 1;
	law.shearFractureEnergy = 7;
	s.bond(law);
	for (MortarJoint<K>& joint : s.system.mortar)
		if (const int other = std::min(joint.body1, joint.body2); std::max(joint.body1, joint.body2) == 3 && (other == 1 || !isBonded))
			breakJoint(joint);
	turn(s, -0.15, 0.1, 0.1);
	for (int b : {1, 2})
		s.system.bodies[b].velocity.setZero();
	const auto found = impactsOf(s, 0.5, 1e-3);
	CHECK(found.empty() == isBonded);
}

// The stack is one body whose lowest joint is dry.
TEMPLATE_TEST_CASE("a bonded stack on a broken joint lands as one block with the restitution that is asked", "", Plane, Space)
{
	using K = TestType;
	const double C = 0.6, step = GENERATE(2.5e-4, 1e-3);
	BondedOf<K> s(C);
	s.addStack(3, 0.2, 0.2);
	s.bond(lawOf(0.25e6));
	breakJoint(s.system.mortar[0]);
	turn(s, 0.5, -0.1);
	const auto found = impactsOf(s, 0.6, step);
	REQUIRE(!found.empty());
	for (const auto& impact : found)
		CHECK(impact.block == 1);
	CHECK(found[0].joint.restitution() == Approx(C).epsilon(1e-6));
	CHECK(s.damage() == Approx(1. / 3));
}

TEMPLATE_TEST_CASE("a scene whose mortar is gone is the dry scene with its restitution", "", Plane, Space)
{
	using K = TestType;
	std::vector<double> numbers[2];
	for (const bool isBroken : {false, true}) {
		BondedOf<K> s(0.7);
		s.addStack(2, 0.2, 0.3);
		s.bond(lawOf(0.25e6));
		if (isBroken)
			for (MortarJoint<K>& joint : s.system.mortar)
				breakJoint(joint);
		else
			s.system.mortar.clear();
		turn(s, 0.5, -0.1);
		CHECK_FALSE(impactsOf(s, 0.5, 1e-3).empty());
		for (const auto& body : s.system.bodies)
			for (int k = 0; k < K::dof; ++k)
				numbers[isBroken].push_back(body.velocity[k]);
	}
	CHECK(numbers[0] == numbers[1]);
}
