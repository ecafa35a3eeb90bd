#pragma once
// Boxes on compliant joints that go by masonry::CompliantStep, with what a scene does around it: the search for patches before, and the
// motion of the bodies after. Test use only.
#include "contact/collide.hpp"
#include "dynamics/compliant/compliant_step.hpp"
#include "dynamics/compliant/time_step.hpp"
#include "joints/joint_table.hpp"
#include <algorithm>
#include <functional>
#include <vector>

struct CompliantBlocks {
	masonry::CompliantStep step;
	masonry::CompliantReport report; // of the last step
	bool fits {true};                // the last step was stable
	masonry::JointLaw law;
	std::vector<masonry::ImpactRecord> impacts;
	std::vector<double> impactTimes;
	double time {0};
	std::function<void()> load = [] {}; // sets forces and torques of bodies before a step
	masonry::JumpsOfBase jumpsOfBase = [](const auto&) { return std::vector<masonry::BaseJump>(); };

	masonry::Bodies<masonry::Space>& bodies() { return step.system.bodies; }
	const masonry::Bodies<masonry::Space>& bodies() const { return step.system.bodies; }

	int addBox(const masonry::Vector3& size, const masonry::Vector3& centre, double density, bool prescribed)
	{
		masonry::RigidBody<masonry::Space> body;
		body.pose.position = centre;
		body.mass = density * size.prod();
		const masonry::Vector3 s = size.cwiseAbs2();
		body.inertia = body.mass / 12 * masonry::Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
		body.prescribed = prescribed;
		body.setBox(size / 2);
		bodies().push_back(body);
		return int(bodies().size()) - 1;
	}

	void findPatches()
	{
		const std::vector<masonry::JointContact> known = std::move(step.system.contacts);
		step.system.contacts.clear();
		for (int a = 0; a < int(bodies().size()); ++a)
			for (int b = a + 1; b < int(bodies().size()); ++b) {
				if (bodies()[a].prescribed && bodies()[b].prescribed)
					continue;
				const auto old = std::find_if(known.begin(), known.end(), [&](const auto& c) { return c.body1 == a && c.body2 == b; });
				masonry::JointContact contact = old == known.end() ? masonry::JointContact() : *old;
				masonry::ContactPatch patch;
				const bool isHeld = old != known.end() && old->isBonded(); // however wide its crack
				const double margin = isHeld ? 1 : 1e-3 * bodies()[b].shape->thickness();
				if (!masonry::collide(bodies()[a].shape->part(0), bodies()[a].pose, bodies()[b].shape->part(0), bodies()[b].pose, margin,
				                      contact.patch.feature, patch))
					continue;
				contact.body1 = a;
				contact.body2 = b;
				contact.law = law;
				if (old == known.end())
					contact.isUpright = masonry::isUpright(patch.normal, step.system.gravity);
				renewPatch(contact, patch);
				step.system.contacts.push_back(contact);
			}
	}

	void advance()
	{
		using namespace masonry;
		for (RigidBody<Space>& body : bodies())
			body.force.setZero();
		load();
		findPatches();
		for (JointContact& contact : step.system.contacts)
			updateForces(contact, bodies()[contact.body1], bodies()[contact.body2], step.system.dt);
		fits = step.fitTimeStep();
		report = step.apply(jumpsOfBase);
		step.system.dt -= step.lowered;
		for (const ImpactRecord& record : report.impacts) {
			impacts.push_back(record);
			impactTimes.push_back(time - record.before);
		}
		for (size_t b = 0; b < bodies().size(); ++b)
			move(bodies()[b], step.loads[b], step.system.dt);
		time += step.system.dt;
	}

	static void move(masonry::RigidBody<masonry::Space>& body, const masonry::JointLoad& joints, double dt)
	{
		using namespace masonry;
		if (!body.prescribed) {
			const Quaternion& q = body.pose.orientation;
			// Planar tests and small spins: the gyroscopic term is left to the momentum form.
			Vector3 L = q * body.inertia.cwiseProduct(q.conjugate() * body.spin());
			body.linear() += (body.force.head<3>() + joints.force) / body.mass * dt;
			L += (body.force.tail<3>() + joints.moment) * dt;
			body.spin() = q * (q.conjugate() * L).cwiseQuotient(body.inertia);
		}
		body.advance(dt);
	}
};
