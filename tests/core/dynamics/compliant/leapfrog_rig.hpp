#pragma once
// Blocks stepped as YADE steps them: contacts at x_n, joint stage, then v_{n+1/2} += f/m dt, x_{n+1} += v dt. Test use only.
#include "contact/box_box.hpp"
#include "dynamics/compliant/joint_groups.hpp"
#include "dynamics/compliant/time_step.hpp"
#include <functional>
#include <vector>

struct LeapfrogRig {
	masonry::JointSystem system;
	std::vector<masonry::Box> boxes;
	std::vector<std::pair<int, int>> pairs;   // who may touch whom
	std::vector<masonry::JointContact> known; // per pair
	std::vector<masonry::PatchFeature> features;
	masonry::JointLaw law;
	std::vector<masonry::Vector3> angularMomentum;
	std::vector<masonry::ImpactRecord> impacts;
	std::vector<double> impactTimes;
	double time {0};
	double dissipated {0}; // by friction and dashpots, J
	bool started {false};
	std::function<void()> onStart = [] {};
	std::function<void(const masonry::ImpactRecord&)> onImpact = [](const masonry::ImpactRecord&) {};

	int addBox(const masonry::Vector3& size, const masonry::Vector3& centre, double density, bool prescribed)
	{
		masonry::Body body;
		body.pose.position = centre;
		body.mass = density * size.prod();
		const masonry::Vector3 s = size.cwiseAbs2();
		body.inertia = body.mass / 12 * masonry::Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
		body.prescribed = prescribed;
		boxes.push_back({size / 2});
		system.bodies.push_back(body);
		for (int other = 0; other + 1 < int(boxes.size()); ++other)
			if (!prescribed || !system.bodies[other].prescribed)
				pairs.push_back({other, int(boxes.size()) - 1});
		return int(boxes.size()) - 1;
	}

	void findContacts()
	{
		known.resize(pairs.size());
		features.resize(pairs.size());
		system.contacts.clear();
		index.clear();
		for (size_t k = 0; k < pairs.size(); ++k) {
			const auto [a, b] = pairs[k];
			masonry::ContactPatch patch;
			const double margin = 1e-3 * boxes[b].halfSize.minCoeff();
			if (!masonry::collide(boxes[a], system.bodies[a].pose, boxes[b], system.bodies[b].pose, margin, features[k], patch)) {
				known[k] = {};
				features[k] = {};
				continue;
			}
			features[k] = patch.feature;
			masonry::JointContact contact = known[k];
			contact.body1 = a;
			contact.body2 = b;
			contact.law = law;
			renewPatch(contact, patch);
			updateForces(contact, system.bodies[a], system.bodies[b], system.dt);
			system.contacts.push_back(contact);
			index.push_back(k);
		}
		if (started)
			releaseLandings(system);
		for (const masonry::JointContact& contact : system.contacts)
			dissipated += contact.energy.friction + contact.energy.damping;
	}

	void step()
	{
		using namespace masonry;
		for (Body& body : system.bodies) {
			body.force = body.prescribed ? Vector3(Vector3::Zero()) : Vector3(body.mass * system.gravity);
			body.torque.setZero();
		}
		findContacts();
		if (!started) {
			startAtEquilibrium(system);
			onStart();
		}
		started = true;
		for (const ImpactRecord& record : handOffPivots(system)) {
			impacts.push_back(record);
			impactTimes.push_back(time - record.before);
			onImpact(record);
		}
		finish();
	}

	void finish()
	{
		using namespace masonry;
		for (size_t c = 0; c < system.contacts.size(); ++c) {
			const JointContact& contact = system.contacts[c];
			known[index[c]] = contact;
			for (int i = 0; i < contact.size; ++i) {
				const Vector3 f = contact.force(i);
				Body &b1 = system.bodies[contact.body1], &b2 = system.bodies[contact.body2];
				b1.force -= f;
				b1.torque -= contact.moment(i, b1.pose.position);
				b2.force += f;
				b2.torque += contact.moment(i, b2.pose.position);
			}
		}
		for (Body& body : system.bodies) {
			if (!body.prescribed) {
				const Quaternion& q = body.pose.orientation;
				// Planar tests and small spins: the gyroscopic term is left to the momentum form.
				Vector3 L = q * body.inertia.cwiseProduct(q.conjugate() * body.angularVelocity);
				body.velocity += body.force / body.mass * system.dt;
				L += body.torque * system.dt;
				body.angularVelocity = q * (q.conjugate() * L).cwiseQuotient(body.inertia);
			}
			body.advance(system.dt);
		}
		time += system.dt;
	}

	std::vector<size_t> index; // contact -> pair
};
