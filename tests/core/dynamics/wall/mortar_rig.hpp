#pragma once
// Blocks with mortar for the tests, 0.1 m deep in the plane.
#include "core/dynamics/wall/wall_rig.hpp"
#include "number_archive.hpp"
#include <catch.hpp>

namespace rig {

constexpr double depth = 0.1, heavy = 1900; // m, kg/m^3

inline MortarLaw lawOf(double tensileStrength)
{
	MortarLaw law;
	law.tensileStrength = tensileStrength;
	law.fractureEnergy = 7e-5 * tensileStrength;
	law.cohesion = 1.4 * tensileStrength;
	law.shearFractureEnergy = 7 * law.fractureEnergy;
	law.friction = 0.75;
	return law;
}

// The acceleration of the base grows evenly.
struct Ramp : Harmonic {
	double slope; // m/s^3

	Ramp(double slope, double begin) : Harmonic(0, 1, begin), slope(slope) {}
	double displacement(double t) const override { return slope * std::pow(since(t), 3) / 6; }
	double velocity(double t) const override { return slope * std::pow(since(t), 2) / 2; }
};

inline MortarJoint<Plane> bonded(const RigidSystem<Plane>& s, const ContactPair<Plane>& pair, const MortarLaw& law)
{
	return wall::mortarJoint(s, pair, law, depth);
}
inline MortarJoint<Space> bonded(const RigidSystem<Space>& s, const ContactPair<Space>& pair, const MortarLaw& law)
{
	return wall::mortarJoint(s, pair, law);
}

template <class K>
struct BondedOf : SceneOf<K> {
	using SceneOf<K>::system;
	using SceneOf<K>::up;

	explicit BondedOf(double restitution = NAN) : SceneOf<K>(0.75, restitution) {}

	void setMass(double volume)
	{
		RigidBody<K>& body = system.bodies.back();
		const double factor = heavy * volume / body.mass;
		body.mass *= factor;
		body.inertia *= factor;
		body.force[up] = -body.mass * g;
	}
	// A block of these sizes in the plane of the wall; its middle.
	void add(double length, double height, double x, double z)
	{
		if constexpr (K::dimension == 2) {
			addBlock(system, length / 2, height / 2, {x, z}, 0, heavy * length * height * depth);
			system.bodies.back().force[1] = -system.bodies.back().mass * g;
		} else
			add({length, depth, height}, {x, 0, z});
	}
	void add(const Vector3& size, const Vector3& place, double angle = 0)
	{
		addBox(system, size / 2, {place, Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitZ()))});
		setMass(size.prod());
	}
	void addStack(int blocks, double length, double height)
	{
		for (int k = 0; k < blocks; ++k)
			add(length, height, 0, height * (k + 0.5));
	}
	void addRunningBond(int courses, int bricks, double length, double height)
	{
		for (int c = 0; c < courses; ++c) {
			const double z = height * (c + 0.5);
			if (c % 2 == 1) {
				add(length / 2, height, length / 4, z);
				add(length / 2, height, (bricks - 0.25) * length, z);
			}
			for (int i = 0; i < bricks - c % 2; ++i)
				add(length, height, (i + 0.5 + 0.5 * (c % 2)) * length, z);
		}
	}
	// In the equilibrium of the dry blocks.
	void bond(const MortarLaw& law)
	{
		this->run(0.3, 1e-3);
		for (const ContactPair<K>& pair : system.pairs) {
			const auto opens = [](const ContactPoint<K>& point) { return point.gap > 1e-6; };
			if (pair.size() < K::dimension || std::any_of(pair.points.begin(), pair.points.end(), opens))
				continue;
			if (const MortarJoint<K> joint = bonded(system, pair, law); joint.area > 0)
				system.mortar.push_back(joint);
		}
	}
	double damage() const // of all fracture energies, J/J
	{
		double sum = 0, area = 0;
		for (const MortarJoint<K>& joint : system.mortar) {
			sum += joint.area * joint.damage();
			area += joint.area;
		}
		return sum / area;
	}
	// The joint with the largest damage.
	const MortarJoint<K>& worst() const
	{
		return *std::max_element(system.mortar.begin(), system.mortar.end(),
		                         [](const auto& a, const auto& b) { return a.damage() < b.damage(); });
	}
	double spent() const // by all points, J
	{
		double sum = 0;
		for (const MortarJoint<K>& joint : system.mortar)
			for (const auto& point : joint.points)
				sum += point.area * (point.state.opened + point.state.sheared);
		return sum;
	}
};

// The scene is saved, and goes on as that which is loaded.
template <class K>
void goesOnWithItsBits(BondedOf<K>& s, int steps)
{
	NumberWriter saved;
	saved(s.system.mortar);
	s.step.serialize(saved, s.system);
	RigidSystem<K> system = s.system;
	system.mortar.clear();
	auto near = s.near;
	wall::WallStep<K> other;
	NumberReader loaded(saved.numbers);
	loaded(system.mortar);
	other.serialize(loaded, system);
	CHECK(loaded.isAtEnd());
	for (int k = 0; k < steps; ++k) {
		s.advance(1e-3);
		near.update(system);
		other.advance(system, 1e-3);
	}
	CHECK(s.system.crackDissip == system.crackDissip);
	for (size_t j = 0; j < system.mortar.size(); ++j)
		CHECK(s.system.mortar[j].damage() == system.mortar[j].damage());
	for (size_t b = 0; b < system.bodies.size(); ++b) {
		CAPTURE(b);
		CHECK(s.system.bodies[b].velocity == system.bodies[b].velocity);
		CHECK(s.system.bodies[b].pose.position == system.bodies[b].pose.position);
	}
}

} // namespace rig
