#include "compliant_scene.hpp"
#include "BlockGeom.hpp"
#include "BlockMat.hpp"
#include "BlockPhys.hpp"
#include "BlockTie.hpp"
#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "checked_body.hpp"
#include "core_state.hpp"
#include "sentence.hpp"
#include "tie_attributes.hpp"

#include "contact/collide.hpp"
#include "joints/joint_table.hpp"
#include <algorithm>
#include <cmath>

namespace yade {

namespace {

/// O.bodies.clear() leaves the interactions of its bodies in O.interactions.
void checkBodies(const Scene& scene, const Interaction& interaction)
{
	for (const auto& [id, other] : {std::pair(interaction.id1, interaction.id2), std::pair(interaction.id2, interaction.id1)}) {
		if (scene.bodies->exists(id)) {
			const auto& present = (*scene.bodies)[id]->intrs;
			if (const auto found = present.find(other); found != present.end() && found->second.get() == &interaction)
				continue;
		}
		throw std::runtime_error(
		    sentence("O.interactions has a joint of bodies ", interaction.id1, " and ", interaction.id2,
		             " that are no longer there (O.bodies.clear() leaves it): build the scene and its engines anew after "
		             "O.reset()."));
	}
}

} // namespace

void CompliantScene::read(const Scene& scene, Real dampingRatio, masonry::CompliantStep& step)
{
	try {
		readBodies(scene, step);
		readJoints(scene, dampingRatio, step.system);
	} catch (...) {
		step.system.contacts.clear(); // they are of other bodies
		throw;
	}
}

void CompliantScene::readBodies(const Scene& scene, masonry::CompliantStep& step)
{
	ids.clear();
	step.system.bodies.clear();
	index.assign(scene.bodies->size(), -1);
	for (const auto& body : scene.bodies->body) {
		if (!body || !dynamic_cast<BlockMat*>(body->material.get()))
			continue;
		if (!isBlock(*body))
			throw std::invalid_argument(sentence(
			    "O.bodies[", body->id, "] has a BlockMat, but its shape is neither a Box nor a ConvexBlock: blocks do not touch it."));
		checkBody(*body);
		if (BlockShape(*body->shape).isUnion())
			throw std::invalid_argument(sentence("O.bodies[", body->id,
			                                     "] is a union of convex parts, which compliant joints do not take: give dem.engines() "
			                                     "model='auto', or the parts as blocks of their own."));
		index[body->id] = int(ids.size());
		ids.push_back(body->id);
		step.system.bodies.push_back(coreBody(*body));
		step.system.bodies.back().shape = shapes.of(body->id, *body->shape);
	}
}

void CompliantScene::readJoints(const Scene& scene, Real dampingRatio, masonry::JointSystem& system)
{
	pairs.clear();
	vector<Interaction*> found;
	for (const auto& interaction : *scene.interactions) {
		if (!interaction->isReal() || !dynamic_cast<BlockPhys*>(interaction->phys.get()))
			continue;
		checkBodies(scene, *interaction);
		found.push_back(interaction.get());
	}
	std::sort(found.begin(), found.end(),
	          [](const Interaction* a, const Interaction* b) { return std::minmax(a->id1, a->id2) < std::minmax(b->id1, b->id2); });
	system.contacts.resize(found.size()); // contacts keep their memory, and all of them is read anew
	const auto isPrescribed = [&](int id) { return system.bodies[index[id]].prescribed; };
	for (const Interaction* interaction : found) {
		if (isPrescribed(interaction->id1) && isPrescribed(interaction->id2))
			continue; // bases that touch do not push each other
		auto& geom = static_cast<BlockGeom&>(*interaction->geom);
		auto& phys = static_cast<BlockPhys&>(*interaction->phys);
		if (!(phys.normalStiffness > 0 && phys.shearStiffness > 0))
			throw std::runtime_error(
			    sentence("The joint of bodies ", interaction->id1, " and ", interaction->id2,
			             " has normalStiffness = ", phys.normalStiffness, ", shearStiffness = ", phys.shearStiffness,
			             ": both must be positive, in Pa/m. Give them to BlockMat, or let dem.engines(model='compliant') choose."));
		phys.check(interaction->id1, interaction->id2);
		masonry::JointContact& contact = system.contacts[pairs.size()];
		readContact(*interaction, geom, phys, dampingRatio, contact);
		if (geom.upright < 0)
			geom.upright = masonry::isUpright(geom.normal, system.gravity);
		contact.isUpright = geom.upright == 1;
		contact.body1 = index[contact.body1];
		contact.body2 = index[contact.body2];
		pairs.push_back({&geom, &phys});
	}
	system.contacts.resize(pairs.size());
}

void CompliantScene::readTies(const Scene& scene, const vector<shared_ptr<BlockTie>>& ties, masonry::JointSystem& system) const
{
	system.ties.clear();
	for (const auto& of : ties) {
		of->check(scene);
		masonry::Tie<masonry::Space> tie;
		tie.body1 = indexOf(of->body1);
		tie.body2 = indexOf(of->body2);
		tie.point1 = of->point1;
		tie.point2 = of->point2;
		if (std::isnan(of->length))
			of->length = masonry::Tie<masonry::Space>::line(tie, system.bodies[tie.body1].pose, system.bodies[tie.body2].pose).length;
		takeAttributes(*of, tie);
		tie.broken = of->broken;
		tie.force = of->force;
		system.ties.push_back(tie);
	}
}

vector<masonry::JointContact> CompliantScene::blocksInTouch(const Scene& scene, Real dampingRatio, const masonry::CompliantStep& step) const
{
	const masonry::Bodies<masonry::Space>& bodies = step.system.bodies;
	vector<masonry::JointContact> contacts;
	Ip2_BlockMat_BlockMat_BlockPhys law;
	for (size_t a = 0; a < ids.size(); ++a)
		for (size_t b = a + 1; b < ids.size(); ++b) {
			if (bodies[a].prescribed && bodies[b].prescribed)
				continue;
			const Body &body1 = *(*scene.bodies)[ids[a]], &body2 = *(*scene.bodies)[ids[b]];
			const masonry::ConvexPolyhedron &shape1 = bodies[a].shape->part(0), &shape2 = bodies[b].shape->part(0);
			if ((body1.state->pos - body2.state->pos).norm() > shape1.radius() + shape2.radius())
				continue;
			masonry::ContactPatch patch;
			const Real near = 1e-2 * std::min(shape1.thickness(), shape2.thickness());
			if (!masonry::collide(shape1, bodies[a].pose, shape2, bodies[b].pose, near, {}, patch))
				continue;
			const shared_ptr<Interaction> interaction(new Interaction(ids[a], ids[b]));
			const shared_ptr<BlockGeom> geom(new BlockGeom);
			geom->normal = patch.normal;
			interaction->geom = geom;
			law.go(body1.material, body2.material, interaction);
			masonry::JointContact& contact = contacts.emplace_back();
			contact.body1 = int(a);
			contact.body2 = int(b);
			contact.isUpright = masonry::isUpright(patch.normal, step.system.gravity);
			contact.law = static_cast<BlockPhys&>(*interaction->phys).law(dampingRatio);
			renewPatch(contact, patch);
		}
	return contacts;
}

} // namespace yade
