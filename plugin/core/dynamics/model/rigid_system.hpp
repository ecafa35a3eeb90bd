#pragma once
// Rigid blocks in unilateral contact: model and state. localised_step.hpp moves them.
#include "contact/corner_normals.hpp"
#include "contact/solid_contact.hpp"
#include "dynamics/model/base_drive.hpp"
#include "dynamics/model/mortar_joint.hpp"
#include "dynamics/model/tie.hpp"
#include "dynamics/model/version.hpp"
#include "impact/rocking_restitution.hpp"
#include "joints/joint_table.hpp"
#include "laws/contact_problem.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace masonry {

template <class K>
struct ContactPoint {
	Feature feature;
	bool closed {false}; // in touch: may carry force
	bool sliding {false};
	double gap {0}; // m, at the end of the last step
	Eigen::Matrix<double, K::rows, 1> force {
	    Eigen::Matrix<double, K::rows, 1>::Zero()}; // N, mean of the last smooth step; on body 2, normal then tangents
	Eigen::Matrix<double, K::rows - 1, 1> grip {
	    Eigen::Matrix<double, K::rows - 1, 1>::Zero()}; // from the point to where its friction acts, along the tangents, m (grip.hpp)
	ContactFrame<K> frame;                              // at the end of the last step

	// Gaps are measured anew. By its place a point is known again that goes to other features.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(feature, closed, sliding, force, frame.position);
	}

	// From the point to where its friction acts, global: the part along its tangents.
	void setGrip(const typename K::Vector& offset)
	{
		grip = frame.axes.template bottomRows<K::rows - 1>() * offset;
		frame.grip = frame.axes.template bottomRows<K::rows - 1>().transpose() * grip;
	}
};

// The frame of a point when the bodies have these poses.
template <class K>
ContactFrame<K> frameOf(const ContactPoint<K>& point, const RigidBody<K>& body1, const typename K::Pose& pose1, const RigidBody<K>& body2,
                        const typename K::Pose& pose2)
{
	ContactFrame<K> frame = frameOf(point.feature, *body1.shape, pose1, *body2.shape, pose2);
	frame.grip = frame.axes.template bottomRows<K::rows - 1>().transpose() * point.grip;
	return frame;
}

template <class K>
struct ContactPair {
	int body1 {-1}, body2 {-1};
	int part1 {0}, part2 {0}; // convex parts of the bodies
	double friction {noSlip};
	double restitution {NAN}; // NaN: natural
	typename K::Memory memory;
	int face1 {-1}, face2 {-1};
	bool isUpright {false}; // when the pair was found (joint_table.hpp)
	PerPoint<ContactPoint<K>, K::usualPoints> points;

	int size() const { return int(points.size()); }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(body1, body2, part1, part2, face1, face2, friction, restitution, isUpright, memory, points);
	}
};

// Relative velocity (body 2 minus body 1) at a point of a frame, along its axes.
template <class K>
Eigen::Matrix<double, K::rows, 1> relativeVelocity(const ContactFrame<K>& frame, const typename K::Vector& center1,
                                                   const typename K::Velocity& v1, const typename K::Vector& center2,
                                                   const typename K::Velocity& v2)
{
	const auto at = [&](const typename K::Vector& center, const typename K::Velocity& v) {
		return typename K::Vector(v.template head<K::dimension>() + K::cross(v.template tail<K::spins>(), frame.position - center));
	};
	Eigen::Matrix<double, K::rows, 1> u = frame.axes * (at(center2, v2) - at(center1, v1));
	if constexpr (K::dimension == 3)
		u.template tail<2>() += frame.axes.template bottomRows<2>() * K::cross(v2.template tail<3>() - v1.template tail<3>(), frame.grip);
	return u;
}

// Sets frame and gap of a point from its features on these bodies.
template <class K>
void locate(ContactPoint<K>& point, const RigidBody<K>& body1, const RigidBody<K>& body2)
{
	point.frame = frameOf(point, body1, body1.pose, body2, body2.pose);
	point.gap = point.frame.gap;
}

// The state of an old point into one of the same feature, or of the same place. False: it is neither.
template <class K>
bool takeState(const ContactPoint<K>& old, double samePlace, ContactPoint<K>& point)
{
	if (!(old.feature == point.feature) && !((old.frame.position - point.frame.position).norm() <= samePlace))
		return false;
	point.closed = old.closed;
	point.sliding = old.sliding;
	point.force = old.force;
	return true;
}

// The state of the points before into one of those found. One that was there keeps its own, with the load of those at its place that have
// gone; another takes over from what was at its place.
template <class K>
void takeStates(const ContactPair<K>& before, const FoundPoints<K>& found, double samePlace, ContactPoint<K>& point)
{
	const auto begin = before.points.begin(), end = before.points.end();
	const auto same = std::find_if(begin, end, [&](const ContactPoint<K>& old) { return old.feature == point.feature; });
	if (same == end) {
		for (auto old = begin; old != end; ++old)
			takeState(*old, samePlace, point);
		return;
	}
	takeState(*same, samePlace, point);
	for (auto old = begin; old != end; ++old)
		if ((old->frame.position - point.frame.position).norm() <= samePlace && !found.has(old->feature)) {
			point.closed |= old->closed;
			point.force += old->force;
		}
}

template <class K>
bool touches(const ContactPair<K>& pair)
{
	return std::any_of(pair.points.begin(), pair.points.end(), [](const ContactPoint<K>& point) { return point.closed; });
}

template <class K>
bool sameFeatures(const ContactPair<K>& pair, const FoundPoints<K>& found)
{
	const auto same = [](const auto& feature, const ContactPoint<K>& point) { return feature == point.feature; };
	return std::equal(found.features.begin(), found.features.end(), pair.points.begin(), pair.points.end(), same);
}

// A rocking impact as it came out.
struct Impact {
	double time; // s
	int block, support;
	double asked;  // restitution; NaN: natural
	bool switched; // the pivot was handed over; false: the joint came to rest
	JointResult joint;
	double energyLost; // J; of all joints that closed at this instant, kept with the first
	bool capped;
	double residual; // m/s
};

struct StepReport {
	int substeps {0}, events {0}, sweeps {0}, factorisations {0};
	int unlocalised {0};     // points that closed beyond mostEvents
	int unsettled {0};       // joints whose mortar may have given way, which the solves of the step have not settled
	double residual {0};     // largest of the solves, m/s
	double created {0};      // J, more than round-off and the error of a sound step can make of nothing
	double deepest {0};      // m, of a block in another, where no sound step leaves it so deep
	double turn {0};         // rad, of a block in the step, where it is more than a wall's step resolves
	std::vector<int> jammed; // bodies that press each other as much as they may: prescribed ones, and blocks between them
	bool converged {true};
	bool diverged {false}; // the state is no longer finite

	// Adds the report of a structure that is stepped apart.
	StepReport& operator+=(const StepReport& other)
	{
		substeps = std::max(substeps, other.substeps);
		events += other.events;
		sweeps += other.sweeps;
		factorisations += other.factorisations;
		unlocalised += other.unlocalised;
		unsettled += other.unsettled;
		residual = std::max(residual, other.residual);
		created += other.created;
		deepest = std::max(deepest, other.deepest);
		turn = std::max(turn, other.turn);
		jammed.insert(jammed.end(), other.jammed.begin(), other.jammed.end());
		converged &= other.converged;
		diverged |= other.diverged;
		return *this;
	}
};

template <class K>
struct RigidSystem {
	double time {0}; // s
	std::vector<RigidBody<K>> bodies;
	std::vector<ContactPair<K>> pairs;              // of blocks that are near each other, in a fixed order
	std::vector<Tie<K>> ties;                       // in the scene's order
	std::vector<MortarJoint<K>> mortar;             // joints that have been bonded, sorted by their bodies
	Version list;                                   // of the list of pairs: which bodies they have, in which order
	Version laws;                                   // of the pairs' friction and restitution, where the list stays
	typename K::Vector gravity {K::Vector::Zero()}; // which way is down, and the scale of tolerances; the weight itself is in `force`
	std::vector<Drive<K>> drives;                   // of the bases
	bool moved {true};                              // poses were set from outside: gaps are to be measured anew

	std::vector<Impact> impacts; // of the last step
	// Since the start of the run.
	double frictDissip {0}, impactDissip {0}, tieDissip {0}, crackDissip {0}, baseWork {0}; // J

	// Position of a body that a drive moves, at a time of the step.
	typename K::Vector driven(const RigidBody<K>& body, double t) const { return body.origin + drives[body.drive].displacement(t); }

	// Velocities have jumped, or forces: the last accelerations predict nothing.
	void startAnew()
	{
		setFresh(true);
		for (auto& body : bodies)
			body.increment.setZero();
	}

	bool isFresh() const
	{
		return std::any_of(bodies.begin(), bodies.end(), [](const auto& body) { return body.fresh && !body.prescribed; });
	}
	void setFresh(bool fresh)
	{
		for (auto& body : bodies)
			body.fresh = fresh;
	}

	double kineticEnergy() const
	{
		double sum = 0;
		for (const auto& body : bodies)
			sum += body.kineticEnergy();
		return sum;
	}
	// Velocities and places.
	bool isFinite() const
	{
		double sum = kineticEnergy();
		for (const auto& body : bodies)
			sum += body.pose.position.sum();
		return std::isfinite(sum);
	}
};

// kg
template <class K>
double freeMass(const RigidSystem<K>& s)
{
	double sum = 0;
	for (const RigidBody<K>& body : s.bodies)
		if (!body.prescribed)
			sum += body.mass;
	return sum;
}

// The points of the two parts when the bodies are there, none if there are none; without a margin, since lists of pairs hold only bodies
// that are near.
template <class K>
FoundPoints<K> findPoints(const RigidSystem<K>& s, const ContactPair<K>& pair, typename K::Memory& memory)
{
	const RigidBody<K>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	return findPoints<K>({*body1.shape, body1.pose, pair.part1, *body2.shape, body2.pose, pair.part2}, false, memory);
}

// And the second normals of corners that meet corners.
template <class K>
FoundPoints<K> findRows(const RigidSystem<K>& s, const ContactPair<K>& pair, const typename K::Pose& pose1, const typename K::Pose& pose2,
                        typename K::Memory& memory)
{
	return findPoints<K>({*s.bodies[pair.body1].shape, pose1, pair.part1, *s.bodies[pair.body2].shape, pose2, pair.part2}, true, memory);
}
// As they move: a corner that moves over a face of the other body faster than `rest` (m/s) has that face's normal alone.
template <class K>
FoundPoints<K> findRows(const RigidSystem<K>& s, const ContactPair<K>& pair, double rest, typename K::Memory& memory)
{
	const RigidBody<K>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	FoundPoints<K> found = findRows(s, pair, body1.pose, body2.pose, memory);
	const auto rate = [&](const Feature& feature) {
		const auto frame = frameOf(feature, *body1.shape, body1.pose, *body2.shape, body2.pose);
		return relativeVelocity<K>(frame, body1.pose.position, body1.velocity, body2.pose.position, body2.velocity)[0];
	};
	dropPassed(found, rate, rest);
	return found;
}

} // namespace masonry
