#pragma once
// The interactions of rigid blocks: one for each pair of bodies, whose pairs of convex parts the core has, in O.interactions as soon as the
// blocks are near, until they are clearly apart.

#include "BlockGeom.hpp"
#include "BlockPhys.hpp"
#include "Ip2_BlockMat_BlockMat_BlockPhys.hpp"
#include "rigid_memory.hpp"
#include "still_functors.hpp"
#include <core/Scene.hpp>
#include <unordered_set>

namespace yade {

template <class K>
class ShownContacts {
	using System = masonry::RigidSystem<K>;
	using Pair = masonry::ContactPair<K>;
	using PairLaw = shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>;

public:
	ShownContacts(Scene& s, const Coordinates<K>& c, const PairLaw& law) : scene(s), coordinates(c), pairLaw(law) {}

	/// The law of a pair, which scripts may change through its interaction.
	const BlockPhys& law(size_t pair) const { return *contacts[contactOfPair[pair]].phys; }

	void setFriction(size_t pair, Real tangent)
	{
		BlockPhys& phys = *contacts[contactOfPair[pair]].phys;
		phys.noSlip = false;
		phys.tangensOfFrictionAngle = tangent;
	}

	/// Force of a pair's mortar beside that of its points.
	void setLoad(size_t pair, const masonry::BondLoad& load) { contacts[contactOfPair[pair]].phys->load = load; }

	/// The pairs of a run that goes on: what no interaction shows yet has the law that it had.
	void recall(const vector<Pair>& pairs, const vector<Body::id_t>& ids)
	{
		renew(pairs, ids);
		for (size_t c = 0; c < pairs.size(); ++c)
			if (const Contact& contact = contacts[contactOfPair[c]]; !isListed(contact))
				contact.phys->takeLaw(pairs[c].friction, pairs[c].restitution);
	}

	/// Erases interactions of blocks that another engine had near each other.
	void dropStrangers()
	{
		std::unordered_set<const Interaction*> own;
		for (const Contact& contact : contacts)
			own.insert(contact.interaction.get());
		vector<shared_ptr<Interaction>> strangers;
		for (const auto& interaction : *scene.interactions)
			if (dynamic_cast<const BlockGeom*>(interaction->geom.get()) && own.count(interaction.get()) == 0)
				strangers.push_back(interaction);
		for (const auto& interaction : strangers)
			scene.interactions->erase(interaction->id1, interaction->id2, interaction->linIx);
	}

	/// Both lists are in the order of the ids. Contacts that are no longer near leave the scene.
	void renew(const vector<Pair>& pairs, const vector<Body::id_t>& ids)
	{
		const auto idsOf = [](const Contact& contact) { return std::pair(contact.interaction->id1, contact.interaction->id2); };
		vector<Contact> old;
		old.swap(contacts);
		auto before = old.begin();
		const auto drop = [&] {
			if (isListed(*before))
				erase(*before);
			++before;
		};
		contactOfPair.clear();
		for (const Pair& pair : pairs) {
			const std::pair wanted(ids[pair.body1], ids[pair.body2]);
			if (!contacts.empty() && idsOf(contacts.back()) == wanted) { // other parts of the same bodies
				contactOfPair.push_back(contacts.size() - 1);
				continue;
			}
			contactOfPair.push_back(contacts.size());
			while (before != old.end() && idsOf(*before) < wanted)
				drop();
			contacts.push_back(before != old.end() && idsOf(*before) == wanted ? *before++ : contactOf(wanted, pair));
		}
		while (before != old.end())
			drop();
	}

	/// O.interactions as the system is.
	void write(const System& system, const Remembered<K>& kept)
	{
		const auto& all = system.pairs;
		for (size_t first = 0, last = 0; first < all.size(); first = last) {
			for (last = first + 1; last < all.size() && contactOfPair[last] == contactOfPair[first];)
				++last;
			Contact& contact = contacts[contactOfPair[first]];
			const auto isApart = [&](const Pair& pair) { return apart(system, pair); };
			const bool listed = isListed(contact) && contact.interaction->isReal();
			if (std::all_of(all.begin() + first, all.begin() + last,
			                isApart)) { // not whether they have touched: what nobody saw must not decide
				if (listed)
					erase(contact);
				continue;
			}
			if (!listed)
				list(contact);
			if (last > first + 1)
				joined = together(all, first, last);
			const Pair& pair = last > first + 1 ? joined : all[first];
			writePhys(*contact.phys, pair);
			writeGeom(*contact.geom, pair, kept.seats[pair.body2].depth, contact.phys->normalForce);
		}
	}

	/// Takes the interactions of erased bodies out of O.interactions.
	void dropErased()
	{
		for (const Contact& contact : contacts)
			if (!(scene.bodies->exists(contact.interaction->id1) && scene.bodies->exists(contact.interaction->id2)) && isListed(contact))
				erase(contact);
	}

private:
	struct Contact {
		shared_ptr<Interaction> interaction;
		shared_ptr<BlockGeom> geom;
		shared_ptr<BlockPhys> phys;
	};

	Contact contactOf(std::pair<Body::id_t, Body::id_t> ids, const Pair& pair)
	{
		Contact contact;
		contact.interaction = scene.interactions->find(ids.first, ids.second);
		if (contact.interaction) {
			contact.geom = boost::dynamic_pointer_cast<BlockGeom>(contact.interaction->geom);
			contact.phys = boost::dynamic_pointer_cast<BlockPhys>(contact.interaction->phys);
			if (contact.geom && contact.phys) {
				keepStill(*contact.interaction, pairLaw);
				return contact;
			}
		}
		return newContact(ids.first, ids.second, pair.points.empty() ? Vector3r(Vector3r::UnitZ()) : normalOf(pair.points[0]));
	}

	Contact newContact(Body::id_t id1, Body::id_t id2, const Vector3r& normal)
	{
		const Body &body1 = *scene.bodies->body[id1], &body2 = *scene.bodies->body[id2];
		Contact contact;
		contact.interaction.reset(new Interaction(id1, id2));
		contact.geom.reset(new BlockGeom);
		contact.geom->normal = normal;
		contact.geom->refR1 = BlockShape(*body1.shape).thickness();
		contact.geom->refR2 = BlockShape(*body2.shape).thickness();
		contact.interaction->geom = contact.geom;
		pairLaw->go(body1.material, body2.material, contact.interaction); // reads the normal: head joints may have mortar of their own
		contact.phys = boost::static_pointer_cast<BlockPhys>(contact.interaction->phys);
		keepStill(*contact.interaction, pairLaw);
		return contact;
	}

	/// All points of the pairs of parts of two bodies, under the faces of the first pair that is loaded.
	static Pair together(const vector<Pair>& all, size_t first, size_t last)
	{
		const auto isLoaded = [](const Pair& pair) {
			return std::any_of(pair.points.begin(), pair.points.end(), [](const auto& point) { return point.force[0] > 0; });
		};
		const auto loaded = std::find_if(all.begin() + first, all.begin() + last, isLoaded);
		Pair pair = loaded == all.begin() + last ? all[first] : *loaded;
		pair.points.clear();
		for (size_t c = first; c < last; ++c)
			pair.points.insert(pair.points.end(), all[c].points.begin(), all[c].points.end());
		return pair;
	}

	static bool apart(const System& system, const Pair& pair)
	{
		const Real far =
		    clearlyApart * std::min(system.bodies[pair.body1].shape->thickness(), system.bodies[pair.body2].shape->thickness());
		return std::none_of(pair.points.begin(), pair.points.end(), [&](const auto& point) { return point.gap <= far; });
	}

	/// Not so before the blocks are near, and when a script or the end of a body has erased it.
	bool isListed(const Contact& contact) const
	{
		const int place = contact.interaction->linIx;
		return place >= 0 && size_t(place) < scene.interactions->size() && (*scene.interactions)[place] == contact.interaction;
	}

	void list(Contact& contact)
	{
		if (!contact.interaction->isReal())
			contact = newContact(contact.interaction->id1, contact.interaction->id2, contact.geom->normal);
		const auto other = scene.interactions->find(contact.interaction->id1, contact.interaction->id2); // a collider's
		if (other)
			scene.interactions->erase(other->id1, other->id2, other->linIx);
		contact.interaction->iterMadeReal = contact.interaction->iterBorn = scene.iter;
		scene.interactions->insert(contact.interaction);
	}

	void erase(const Contact& contact)
	{
		scene.interactions->erase(contact.interaction->id1, contact.interaction->id2, contact.interaction->linIx);
	}

	Vector3r normalOf(const masonry::ContactPoint<K>& point) const { return coordinates.out(point.frame.axes.row(0).transpose()); }

	/// The points of one pair can have normals in different directions: their common one is that of the resultant of their forces or,
	/// without load, that of the point which is nearest to touching.
	void writeGeom(BlockGeom& geom, const Pair& pair, Real depth, const Vector3r& normalForce) const
	{
		geom.feature1 = pair.face1;
		geom.feature2 = pair.face2;
		geom.patch.points.resize(pair.size());
		geom.pointNormals.resize(pair.size());
		geom.contactPoint.setZero();
		int nearest = 0;
		for (int i = 0; i < pair.size(); ++i) {
			const auto& point = pair.points[i];
			auto& to = geom.patch.points[i];
			to.position1 = to.position2 = pointInScene(coordinates, point.frame.position, depth);
			to.gap = point.gap;
			geom.contactPoint += to.position1 / pair.size();
			geom.pointNormals[i] = normalOf(point);
			if (point.gap < pair.points[nearest].gap)
				nearest = i;
		}
		const Vector3r& normal = geom.pointNormals[nearest];
		geom.normal = normalForce.isZero(0) ? normal : Vector3r((normalForce.dot(normal) < 0 ? -1 : 1) * normalForce.normalized());
	}

	void writePhys(BlockPhys& phys, const Pair& pair) const
	{
		phys.forces.resize(pair.size());
		phys.normalForces.resize(pair.size());
		phys.frictionOffsets.resize(pair.size());
		phys.normalForce.setZero();
		phys.shearForce.setZero();
		for (int i = 0; i < pair.size(); ++i) {
			const auto& point = pair.points[i];
			const Vector3r normal = normalOf(point) * point.force[0];
			phys.normalForces[i] = point.force[0];
			phys.frictionOffsets[i] = coordinates.out(point.frame.grip);
			phys.forces[i] = coordinates.out(point.frame.axes.transpose() * point.force);
			phys.normalForce += normal;
			phys.shearForce += phys.forces[i] - normal;
		}
	}

	/// Gap, relative to the smaller block, at which an interaction ends; as for compliant joints.
	static constexpr Real clearlyApart = 2e-2;

	Scene& scene;
	const Coordinates<K>& coordinates;
	const PairLaw& pairLaw;       // the integrator's: a script may give another
	vector<Contact> contacts;     // of pairs of bodies
	vector<size_t> contactOfPair; // by pair of the core
	Pair joined;                  // of several pairs of parts, while it is written
};

} // namespace yade
