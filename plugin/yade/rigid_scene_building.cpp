// A scene becomes the core's, and pairs of blocks meet in it.

#include "checked_body.hpp"
#include "rigid_scene.hpp"

#include "dynamics/model/scales.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <map>
#include <utility>

namespace yade {

namespace {

/// Overlap, relative to the smallest half size, that is no rounding of coordinates and nothing that a wall has left (some 1e-5), but a
/// mistake. Larger: blocks are lifted by as much, with energy of nothing.
constexpr Real maxOverlap = 1e-4;
/// Margin of the list of pairs, relative to the smallest half size. Larger: more pairs; smaller: the list is made anew more often.
constexpr Real searchMargin = 0.1;

/// Equal blocks share their shape.
template <class K>
class SharedShapes {
public:
	using Solid = masonry::Solid<typename K::Shape>;

	const std::shared_ptr<const Solid>& share(const Solid& shape)
	{
		vector<Real> coordinates;
		for (int part = 1; part < shape.size(); ++part)
			coordinates.push_back(shape.first(part).vertex);
		for (const auto& vertex : shape.vertices())
			coordinates.insert(coordinates.end(), vertex.data(), vertex.data() + vertex.size());
		auto& shared = made[coordinates];
		if (!shared)
			shared = std::make_shared<const Solid>(shape);
		return shared;
	}

private:
	std::map<vector<Real>, std::shared_ptr<const Solid>> made;
};

} // namespace

template <class K>
RigidScene<K>::RigidScene(Scene& of, const Vector3r& along, const RigidSettings& given, const RigidEnergies& energies,
                          const shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>& pairLaw, RigidWarnings& told,
                          const vector<BaseMotionEngine*>& motions, const vector<shared_ptr<BlockTie>>& tied, const Remembered<K>& before)
    : settings(given), warned(told), scene(of), home(Omega::instance().getScene()), coordinates(along), ties(tied),
      contacts(scene, coordinates, pairLaw)
{
	system.frictDissip = energies.frictDissip;
	system.impactDissip = energies.impactDissip;
	system.tieDissip = energies.tieDissip;
	system.crackDissip = energies.crackDissip;
	system.baseWork = energies.baseWork;
	scheduler->setPotentialShift(energies.potentialShift);
	const vector<int> inBefore = addBlocks(before);
	addDrives(motions, inBefore);
	addPairs(before, inBefore);
	addTies(before);
	addMortar(before, inBefore);
	contacts.recall(system.pairs, kept.ids);
	for (size_t b = 0; b < inBefore.size(); ++b) {
		if (inBefore[b] < 0)
			continue;
		const auto &now = system.bodies[b], &then = before.bodies[inBefore[b]];
		changed |= now.prescribed != then.prescribed || now.drive != then.drive;
	}
	if (changed)
		system.startAnew();
	forgetNeighbours();
}

/// Whether the state, which nobody has written, is still that of the block: a base that stands still keeps its own, which is not in all
/// bits what the plane gives back.
template <class K>
bool RigidScene<K>::says(const Seat<K>& seat, const State& state, const Properties& properties, int id,
                         const masonry::RigidBody<K>& block) const
{
	masonry::RigidBody<K> read = block;
	seat.read(coordinates, state, properties.shape.thickness(), id, read);
	return isSame(read.pose, block.pose) && read.velocity == block.velocity;
}

template <class K>
vector<int> RigidScene<K>::addBlocks(const Remembered<K>& before)
{
	vector<int> inBefore;
	SharedShapes<K> shapes;
	for (const auto& body : scene.bodies->body) {
		seen.emplace_back(body);
		if (!body || !isBlock(*body))
			continue;
		const auto old = std::find(before.ids.begin(), before.ids.end(), body->id);
		const int k = old == before.ids.end() ? -1 : int(old - before.ids.begin());
		inBefore.push_back(k);
		const State& state = *body->state;
		const Properties properties(*body);
		const Seat<K> seat = k < 0 ? Seat<K>(coordinates, state) : before.seats[k];

		masonry::RigidBody<K> block = k < 0 ? masonry::RigidBody<K>() : before.bodies[k];
		block.shape = shapes.share(seat.shape(coordinates, properties.shape));
		block.mass = properties.mass;
		block.inertia = seat.inertia(properties.inertia);
		block.prescribed = !body->isDynamic();
		block.drive = -1;
		if (k < 0)
			seat.read(coordinates, state, properties.shape.thickness(), body->id, block);
		links.push_back({body, body->state, properties, {state.pos, state.vel, state.angVel, state.ori}});
		if (k >= 0 && !(block.prescribed && says(seat, state, properties, body->id, block)))
			seat.tell(coordinates, block, links.back().written);
		kept.ids.push_back(body->id);
		kept.seats.push_back(seat);
		system.bodies.push_back(block);
	}
	return inBefore;
}

template <class K>
void RigidScene<K>::addDrives(const vector<BaseMotionEngine*>& engines, const vector<int>& inBefore)
{
	motions.reserve(engines.size());
	vector<const BaseMotionEngine*> first; // of each drive
	vector<char> begins;
	for (BaseMotionEngine* engine : engines) {
		const auto other = std::find_if(first.begin(), first.end(), [&](const auto* one) { return one->shares(*engine); });
		const size_t d = size_t(other - first.begin());
		if (other == first.end()) {
			first.push_back(engine);
			begins.push_back(0);
			system.drives.emplace_back();
		}
		motions.emplace_back(*engine, kept.ids);
		system.drives[d].components.push_back({&motions.back(), coordinates.direction(engine->direction)});
		begins[d] |= engine->beginsNow();
	}
	for (size_t d = 0; d < first.size(); ++d) {
		changed |= begins[d];
		for (size_t k = 0; k < first[d]->ids.size(); ++k) {
			const auto found = std::find(kept.ids.begin(), kept.ids.end(), first[d]->ids[k]);
			if (found == kept.ids.end())
				continue; // moved, but no block
			const size_t b = size_t(found - kept.ids.begin());
			auto& block = system.bodies[b];
			block.drive = int(d);
			const State& state = *links[b].state;
			links[b].written = {state.pos, state.vel, state.angVel, state.ori};
			block.origin = coordinates.in(first[d]->origin(k, engines));
			if (inBefore[b] < 0 || begins[d])
				block.velocity.template head<K::dimension>() = system.drives[d].velocity(scene.time);
		}
	}
}

template <class K>
void RigidScene<K>::addPairs(const Remembered<K>& before, const vector<int>& inBefore)
{
	const vector<int> now = placesNow(inBefore, before.bodies.size());
	const auto stays = [&](int b, int k) { return b >= 0 && before.hasShape(k, *system.bodies[b].shape); };
	for (Pair pair : before.pairs) {
		const int then1 = std::exchange(pair.body1, now[pair.body1]), then2 = std::exchange(pair.body2, now[pair.body2]);
		if (stays(pair.body1, then1) && stays(pair.body2, then2))
			system.pairs.push_back(pair);
	}
}

template <class K>
void RigidScene<K>::forgetNeighbours()
{
	length = masonry::scale::length(system);
	neighbours = std::make_unique<masonry::Neighbours<K>>(searchMargin * length, [this](Pair& pair) { meet(pair, true); });
}

template <class K>
void RigidScene<K>::forgetStates()
{
	for (Link& link : links)
		link.written.pos.setConstant(NaN);
	forgetNeighbours();
}

template <class K>
void RigidScene<K>::renewContacts()
{
	contacts.renew(system.pairs, kept.ids);
	if (!std::exchange(ownsContacts, true))
		contacts.dropStrangers();
	takeLaws();
}

template <class K>
void RigidScene<K>::meet(Pair& pair, bool placed)
{
	const auto &body1 = system.bodies[pair.body1], &body2 = system.bodies[pair.body2];
	const Real rest = masonry::tolerance::restSpeed * std::sqrt(settings.gravity.norm() * length);
	pair.memory = {};
	const auto found = masonry::findRows(system, pair, rest, pair.memory);
	pair.points.resize(found.size());
	pair.isUpright = found.size() > 0;
	if (found.size() == 0)
		return;
	pair.face1 = found.face1;
	pair.face2 = found.face2;
	for (int i = 0; i < found.size(); ++i) {
		auto& point = pair.points[i];
		point = {};
		point.feature = found.features[i];
		masonry::locate(point, body1, body2);
		const auto speed = masonry::relativeVelocity(point.frame, body1.pose.position, body1.velocity, body2.pose.position, body2.velocity);
		point.closed = point.gap <= settings.ofImpacts.merged * length && speed[0] >= -rest;
		pair.isUpright &= masonry::isUpright<typename K::Vector>(point.frame.axes.row(0).transpose(), system.gravity);
		if (placed && point.gap < -maxOverlap * length)
			refuseOverlap(pair, -point.gap);
	}
}

template <class K>
void RigidScene<K>::refuseOverlap(const Pair& pair, Real depth) const
{
	throw std::runtime_error(sentence(
	    "Blocks ", kept.ids[pair.body1], " and ", kept.ids[pair.body2], " overlap by ", depth, " m at t = ", scene.time, " s: ",
	    settings.begins
	        ? "rigid blocks must be apart or just touch when their engines begin; dem.check_blocks() lists all that do not."
	        : "they have come near each other only now. Either a script has put one into the other, or they move too far in a step: "
	          "give dem.engines() a smaller dt."));
}

template RigidScene<Plane>::RigidScene(Scene&, const Vector3r&, const RigidSettings&, const RigidEnergies&,
                                       const shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>&, RigidWarnings&, const vector<BaseMotionEngine*>&,
                                       const vector<shared_ptr<BlockTie>>&, const Remembered<Plane>&);
template RigidScene<Space>::RigidScene(Scene&, const Vector3r&, const RigidSettings&, const RigidEnergies&,
                                       const shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>&, RigidWarnings&, const vector<BaseMotionEngine*>&,
                                       const vector<shared_ptr<BlockTie>>&, const Remembered<Space>&);
template void RigidScene<Plane>::forgetStates();
template void RigidScene<Space>::forgetStates();
template void RigidScene<Plane>::renewContacts();
template void RigidScene<Space>::renewContacts();
template void RigidScene<Plane>::meet(Pair&, bool);
template void RigidScene<Space>::meet(Pair&, bool);

} // namespace yade
