#include "rigid_scene.hpp"

#include <algorithm>
#include <set>

namespace yade {

namespace {

/// Steps after which O.interactions are written even if nobody seems to look.
constexpr int maxUnshown = 64;

void checkFinite(const State& state, int id)
{
	const auto check = [id](const char* attribute, const auto& value) {
		if (!value.allFinite())
			throw std::invalid_argument(
			    sentence("O.bodies[", id, "].state.", attribute, " = (", value.transpose(), ") is not allowed: it must be finite."));
	};
	check("pos", state.pos);
	check("ori", state.ori.coeffs());
	check("vel", state.vel);
	check("angVel", state.angVel);
}

} // namespace

template <class K>
bool RigidScene<K>::outdated() const
{
	const auto& all = scene.bodies->body;
	if (all.size() != seen.size())
		return true;
	if (!mayHaveChanged())
		return false;
	for (size_t id = 0; id < seen.size(); ++id)
		if (!seen[id].isStill(all[id]))
			return true;
	return std::any_of(links.begin(), links.end(),
	                   [](const Link& link) { return link.body->state != link.state || !(Properties(*link.body) == link.properties); });
}

template <class K>
RigidResults RigidScene<K>::step(const RigidSettings& given)
{
	settings = given;
	if (!settings.walls && !system.mortar.empty())
		throw std::invalid_argument("MoreauJeanIntegrator.method = 'localised' is not allowed: blocks have been bonded with mortar, which "
		                            "method='wall' knows.");
	takeScene();
	if (bonds || !asked.empty())
		bond();
	if (settings.walls != byWalls) {
		system.moved = true;
		system.startAnew();
		showPoints();
		system.impactDissip += scheduler->potentialShift();
		scheduler.emplace(); // what it remembers would be of steps long ago
	}
	byWalls = settings.walls;
	takeSettings();
	const masonry::StepReport report = advance();
	writeStates();
	writeTies();
	if (++unshown >= maxUnshown || settings.watched)
		writeContacts();
	return results(report);
}

template <class K>
void RigidScene<K>::takeScene()
{
	try {
		if (mayHaveChanged()) {
			system.gravity = coordinates.gravity(settings.gravity);
			readLoads();
		}
		readStates();
		readLaws();
		readTies();
		if (!neighbours->isValid(system, scene.dt)) {
			showPoints();
			neighbours->update(system, scene.dt);
			renewContacts();
		}
	} catch (...) {
		forgetStates();
		throw;
	}
}

template <class K>
void RigidScene<K>::takeSettings()
{
	system.time = scene.time;
	islands.settings() = settings.ofImpacts;
	scheduler->settings = settings.ofWalls;
	scheduler->settings.localised.merged = settings.ofImpacts.merged;
	scheduler->settings.localised.mostEvents = settings.ofImpacts.mostEvents;
}

template <class K>
masonry::StepReport RigidScene<K>::advance()
{
	if (!byWalls)
		return islands.advance(system, scene.dt);
	const auto report = scheduler->advance(system, scene.dt);
	if (scheduler->partBases && !warned.bases) {
		warned.bases = true;
		LOG_WARN(
		    "t = " << scene.time
		           << " s: blocks of a structure stand on bodies that different engines move, or whose velocities differ (those that move "
		              "alike belong in the ids of one engine). Friction leaves open how much each of these carries, and method='wall' may "
		              "let one take along what should slide on both: compare with dem.engines(method='localised') or "
		              "dem.engines(model='compliant').");
	}
	return report;
}

template <class K>
RigidResults RigidScene<K>::results(const masonry::StepReport& report) const
{
	RigidResults result;
	result.report = report;
	result.errors = byWalls ? scheduler->lastErrors() : islands.lastErrors();
	result.energies = {system.frictDissip, system.impactDissip, system.tieDissip,
	                   system.crackDissip, system.baseWork,     scheduler->potentialShift()};
	result.impacts = system.impacts;
	for (masonry::Impact& impact : result.impacts) {
		impact.block = kept.ids[impact.block];
		impact.support = kept.ids[impact.support];
	}
	if (byWalls) {
		result.walls = scheduler->report;
		result.localisedBlocks = scheduler->localised();
	}
	return result;
}

template <class K>
bool RigidScene<K>::isThere(size_t b) const
{
	const auto& all = scene.bodies->body;
	return size_t(kept.ids[b]) < all.size() && all[kept.ids[b]] == links[b].body;
}

template <class K>
void RigidScene<K>::readLoads()
{
	addUp(scene.forces, kept.ids.front());
	for (size_t b = 0; b < links.size(); ++b) {
		auto& block = system.bodies[b];
		if (block.prescribed)
			continue;
		const int id = kept.ids[b];
		block.force = coordinates.load(scene.forces.getForce(id), scene.forces.getTorque(id), id);
		block.force.template head<K::dimension>() += block.mass * system.gravity;
		if (!block.force.allFinite())
			throw std::invalid_argument(sentence("O.forces of body ", id,
			                                     " are no finite numbers: f = ", scene.forces.getForce(id).transpose(),
			                                     ", t = ", scene.forces.getTorque(id).transpose(), '.'));
	}
}

template <class K>
void RigidScene<K>::readStates()
{
	others.resize(links.size());
	scheduler->eachShare(links.size(), [&](size_t begin, size_t end) {
		for (size_t b = begin; b < end; ++b) {
			fetch(b + 6);
			others[b] = links[b].written.isOf(*links[b].state) ? 0 : system.bodies[b].drive < 0 ? 1 : driven;
		}
	});
	bool touched = false, placed = false;
	const auto isTouched = [](char other) { return other != 0; };
	for (size_t b = size_t(std::find_if(others.begin(), others.end(), isTouched) - others.begin()); b < links.size(); ++b) {
		if (others[b] == driven) {
			others[b] = 0;
			if (links[b].written.pos.allFinite())
				warnOfMotion(b);
		}
		if (!others[b])
			continue;
		Link& link = links[b];
		auto& block = system.bodies[b];
		const State& state = *link.state;
		checkFinite(state, kept.ids[b]);
		if (block.prescribed && scene.time > 0 && state.vel == Vector3r::Zero() && (state.pos - link.written.pos).norm() > 0)
			warnOfPlace(b);
		kept.seats[b].read(coordinates, state, link.properties.shape.thickness(), kept.ids[b], block);
		block.increment.setZero();
		if (!link.written.isPlaceOf(state)) {
			others[b] = elsewhere;
			placed = true;
		}
		link.written = {state.pos, state.vel, state.angVel, state.ori};
		touched = true;
	}
	if (!touched)
		return;
	for (Pair& pair : system.pairs) {
		const auto is = std::max(others[pair.body1], others[pair.body2]);
		if (is == elsewhere || (is && !isOfWall(pair)))
			meet(pair, is == elsewhere);
	}
	system.moved |= placed;
	system.startAnew();
}

template <class K>
void RigidScene<K>::warnOfMotion(size_t b)
{
	if (warned.motion)
		return;
	warned.motion = true;
	LOG_WARN("a script has changed the state of body "
	         << kept.ids[b] << " at t = " << scene.time
	         << " s: it goes where its motion says all the same. A motion in another direction may move it besides.");
}

template <class K>
void RigidScene<K>::warnOfPlace(size_t b)
{
	if (warned.place)
		return;
	warned.place = true;
	LOG_WARN("a script has moved body " << kept.ids[b] << " by its state.pos at t = " << scene.time
	                                    << " s, with state.vel = 0: blocks on it do not feel that it moves. Set state.vel, by which it "
	                                       "goes on, or give it a RecordMotionEngine.");
}

template <class K>
void RigidScene<K>::takeLaws()
{
	for (size_t c = 0; c < system.pairs.size(); ++c) {
		const BlockPhys& law = contacts.law(c);
		Pair& pair = system.pairs[c];
		const Real friction = law.noSlip ? masonry::noSlip : law.tangensOfFrictionAngle, restitution = law.restitution;
		if (pair.friction == friction && (pair.restitution == restitution || (std::isnan(pair.restitution) && std::isnan(restitution))))
			continue;
		law.check(kept.ids[pair.body1], kept.ids[pair.body2]);
		pair.friction = friction;
		pair.restitution = restitution;
		system.laws.changed();
	}
}

template <class K>
void RigidScene<K>::readLaws()
{
	if (unshown == 0)
		takeLaws();
}

template <class K>
void RigidScene<K>::showPoints()
{
	if (byWalls)
		scheduler->showPoints(system);
}

template <class K>
void RigidScene<K>::fetch(size_t b) const
{
	if (b >= links.size())
		return;
	const char* state = reinterpret_cast<const char*>(links[b].state.get());
	for (size_t line = 0; line < sizeof(State); line += 64)
		__builtin_prefetch(state + line);
}

template <class K>
void RigidScene<K>::writeStates()
{
	scheduler->eachShare(links.size(), [&](size_t begin, size_t end) {
		for (size_t b = begin; b < end; ++b) {
			const auto& block = system.bodies[b];
			if (block.prescribed && block.drive < 0 && block.velocity.isZero(0))
				continue;
			State& state = *links[b].state;
			fetch(b + 6);
			kept.seats[b].tell(coordinates, block, links[b].written, state);
			state.angMom = kept.seats[b].spin(coordinates, block);
		}
	});
}

template <class K>
void RigidScene<K>::writeContacts()
{
	if (unshown == 0)
		return;
	showPoints();
	contacts.write(system, kept);
	showMortar();
	unshown = 0;
}

template <class K>
vector<int> RigidScene<K>::touching()
{
	showPoints();
	vector<int> result;
	for (const Pair& pair : system.pairs)
		if (touches(pair)) {
			result.push_back(kept.ids[pair.body1]);
			result.push_back(kept.ids[pair.body2]);
		}
	std::sort(result.begin(), result.end());
	result.erase(std::unique(result.begin(), result.end()), result.end());
	return result;
}

template <class K>
bool RigidScene<K>::neverSlips() const
{
	return std::any_of(system.pairs.begin(), system.pairs.end(),
	                   [](const Pair& pair) { return touches(pair) && pair.friction == masonry::noSlip; });
}

template <class K>
std::pair<vector<int>, vector<int>> RigidScene<K>::blocksAndPrescribed(const vector<int>& bodies) const
{
	std::set<int> blocks, prescribed;
	for (const int b : bodies)
		(system.bodies[b].prescribed ? prescribed : blocks).insert(kept.ids[b]);
	return {{blocks.begin(), blocks.end()}, {prescribed.begin(), prescribed.end()}};
}

template <class K>
void RigidScene<K>::setInstant(Real instant)
{
	for (MotionDrive& motion : motions)
		motion.instant = instant;
}

template <class K>
vector<Real> RigidScene<K>::pack()
{
	showPoints();
	readLaws();
	masonry::NumberWriter archive;
	Real first = layout, dimension = K::dimension;
	archive(first, dimension);
	kept.bodies = system.bodies;
	kept.pairs = system.pairs;
	kept.ties = system.ties;
	kept.mortar = system.mortar;
	kept.takeShapes();
	Remembered<K> told = kept;
	for (size_t b = 0; b < links.size(); ++b)
		if (!isThere(b))
			told.ids[b] = -1;
	archive(told, byWalls, *neighbours);
	if (byWalls)
		scheduler->serialize(archive, system);
	return archive.numbers;
}

template <class K>
void RigidScene<K>::unpackStepper(masonry::NumberReader& archive, const Remembered<K>& before)
{
	readMemory([&] { archive(byWalls); });
	if (changed || before.ids != kept.ids || before.pairs.size() != system.pairs.size())
		return;
	renewContacts();
	readMemory([&] {
		archive(*neighbours);
		if (byWalls)
			scheduler->serialize(archive, system);
		if (!archive.isAtEnd())
			throw std::out_of_range("end");
	});
	if (byWalls)
		system.moved = false;
}

template class RigidScene<Plane>;
template class RigidScene<Space>;

} // namespace yade
