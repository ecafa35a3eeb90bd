#pragma once
// A rigid body in the plane or in space as all methods see it.
#include "contact/kinematics.hpp"
#include "shape/solid.hpp"
#include <memory>
#include <vector>

namespace masonry {

template <class K>
struct RigidBody {
	std::shared_ptr<const Solid<typename K::Shape>> shape; // equal blocks may share one
	double mass {0};                                       // kg; not used when prescribed
	typename K::Inertia inertia {K::Inertia::Zero()};      // about the centre, kg m^2
	bool prescribed {false};                               // moved by the user: an infinite mass
	typename K::Pose pose;
	typename K::Velocity velocity {K::Velocity::Zero()}; // linear, then spin
	typename K::Velocity force {K::Velocity::Zero()};    // external force (weight included) and moment about the centre
	// Change of velocity per second: of a base its acceleration; of a block that in the last smooth step, which predicts the middle of the
	// next.
	typename K::Velocity increment {K::Velocity::Zero()};
	bool fresh {true};                             // the velocity has just jumped, or a stray one is left: the next step looks for those
	int drive {-1};                                // index of the drive that moves it; -1: it keeps its velocity
	typename K::Vector origin {K::Vector::Zero()}; // position at zero displacement of its drive

	// Masses, forces and shapes belong to the scene.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(pose, velocity, increment, fresh, prescribed, drive, origin);
	}

	void setBox(const typename K::Vector& half) { shape = std::make_shared<const Solid<typename K::Shape>>(K::Shape::box(half)); }

	auto linear() { return velocity.template head<K::dimension>(); } // of the centre, m/s
	typename K::Vector linear() const { return velocity.template head<K::dimension>(); }
	auto spin() { return velocity.template tail<K::spins>(); } // rad/s
	typename K::Spin spin() const { return velocity.template tail<K::spins>(); }
	typename K::Vector velocityAt(const typename K::Vector& point) const { return linear() + K::cross(spin(), point - pose.position); }

	void advance(double t); // rigid motion with constant velocity and spin, t in s

	double inverseMass() const { return prescribed ? 0. : 1. / mass; }
	typename K::InverseInertia inverseInertia() const // global axes
	{
		return prescribed ? typename K::InverseInertia(K::InverseInertia::Zero()) : K::inverseInertia(inertia, pose);
	}

	double kineticEnergy() const // of a free body, J
	{
		const auto w = velocity.template tail<K::spins>();
		return prescribed
		           ? 0
		           : 0.5 * (mass * velocity.template head<K::dimension>().squaredNorm() + w.dot(K::angularMomentum(inertia, pose, w)));
	}
};

// By an axis and an angle. Space::advance, by a half angle, differs from it in the last digit.
template <>
void RigidBody<Space>::advance(double t);

template <class K>
const typename K::Vector& faceNormal(const RigidBody<K>& body, int face) // in the body's axes
{
	return body.shape->face(face).normal;
}

template <class K>
using Bodies = std::vector<RigidBody<K>>;

template <class K>
double kineticEnergy(const Bodies<K>& bodies)
{
	double sum = 0;
	for (const RigidBody<K>& body : bodies)
		sum += body.kineticEnergy();
	return sum;
}

} // namespace masonry
