#pragma once
// Rigid blocks of a scene in the core's form, and back after each step. No physics here.

#include "BlockMat.hpp"
#include "MoreauJeanIntegrator.hpp"
#include "impact_lists.hpp"
#include "motion_drive.hpp"
#include "shown_contacts.hpp"

#include "dynamics/rigid/islands.hpp"
#include "dynamics/rigid/neighbours.hpp"
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/step_by_size.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <core/Scene.hpp>
#include <utility>

namespace yade {

/// What the integrator handles.
inline bool isBlock(const Body& body)
{
	return dynamic_cast<const BlockMat*>(body.material.get()) && dynamic_cast<const Box*>(body.shape.get());
}

/// What a script may change between steps and the core has taken over.
struct Properties {
	Vector3r extents, inertia;
	Real mass;
	unsigned blockedDOFs;

	explicit Properties(const Body& body)
	    : extents(static_cast<const Box&>(*body.shape).extents), inertia(body.state->inertia), mass(body.state->mass),
	      blockedDOFs(body.state->blockedDOFs)
	{
	}
	bool operator==(const Properties& o) const
	{
		return extents == o.extents && inertia == o.inertia && mass == o.mass && blockedDOFs == o.blockedDOFs;
	}
};

/// A body of the scene, or a place without one, as the core has taken it over.
struct Seen {
	shared_ptr<Body> body;
	shared_ptr<Material> material;
	shared_ptr<Shape> shape;

	explicit Seen(const shared_ptr<Body>& b) : body(b)
	{
		if (!body)
			return;
		material = body->material;
		shape = body->shape;
	}
	bool isStill(const shared_ptr<Body>& now) const { return now == body && (!now || (now->material == material && now->shape == shape)); }
};

class AnyRigidScene : public RigidRun {
public:
	/// Blocks have come, gone or changed: build it anew, with what this one remembers.
	virtual bool outdated() const = 0;
	/// Throws LeavesPlane before anything has moved.
	virtual masonry::rigid::StepReport step() = 0;
	/// O.interactions as they are after the last step: they are left behind while nobody looks.
	virtual void writeContacts() = 0;
	virtual vector<int> touching() = 0;
	virtual void setInstant(Real) = 0;
	/// Takes the interactions of erased bodies out of O.interactions.
	virtual void dropErased() = 0;
};

template <class K>
class RigidScene final : public AnyRigidScene {
	using System = masonry::rigid::RigidSystem<K>;
	using Pair = masonry::rigid::ContactPair<K>;

	struct Link {
		shared_ptr<Body> body;
		shared_ptr<State> state; // the body's
		Properties properties;
		Motion written;
	};

public:
	RigidScene(MoreauJeanIntegrator& engine, const vector<BaseMotionEngine*>& motions, const Remembered<K>& before)
	    : integrator(engine), scene(*engine.scene), home(Omega::instance().getScene()), coordinates(engine.along),
	      contacts(scene, coordinates, engine.pairLaw)
	{
		system.frictDissip = engine.frictDissip;
		system.impactDissip = engine.impactDissip;
		system.baseWork = engine.baseWork;
		const vector<int> inBefore = addBlocks(before);
		addDrives(motions, inBefore);
		addPairs(before, inBefore);
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

	vector<Real> pack() override
	{
		showPoints();
		readLaws();
		Packer packer(K::dimension);
		kept.bodies = system.bodies;
		kept.pairs = system.pairs;
		Remembered<K> told = kept;
		for (size_t b = 0; b < links.size(); ++b)
			if (!isThere(b))
				told.ids[b] = -1;
		told.pass(packer);
		packer(byWalls);
		packer(lawsChanged);
		if (byWalls) {
			neighbours->pass(packer);
			bySize.pass(packer, system);
		}
		return packer.values;
	}

	/// What the step itself remembers, if the blocks are still those of `before` and move as they did.
	void unpackStepper(Unpacker& unpacker, const Remembered<K>& before)
	{
		unpacker(byWalls);
		bool laws = false;
		unpacker(laws);
		if (!byWalls || changed || before.ids != kept.ids || before.pairs.size() != system.pairs.size())
			return;
		renewContacts();
		neighbours->pass(unpacker);
		bySize.pass(unpacker, system);
		unpacker.end();
		system.moved = false;
		lawsChanged = laws;
	}

	bool isPresent() const override { return home.lock() == Omega::instance().getScene(); }

	bool outdated() const override
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

	masonry::rigid::StepReport step() override
	{
		try {
			if (mayHaveChanged()) {
				system.gravity = coordinates.gravity(integrator.gravity);
				readLoads();
			}
			readStates();
			readLaws();
			if (!neighbours->isValid(system, scene.dt)) {
				showPoints();
				neighbours->update(system, scene.dt);
				renewContacts();
			}
		} catch (...) {
			forgetStates();
			throw;
		}
		system.time = scene.time;
		system.settings.tolerance = integrator.tolerance;
		system.settings.merged = integrator.mergedClosing;
		system.settings.mostEvents = integrator.mostEvents;
		system.settings.order = integrator.sequential ? masonry::ImpactOrder::sequential : masonry::ImpactOrder::simultaneous;
		if (integrator.isWall() != byWalls) {
			system.moved = true;
			system.startAnew();
		}
		if (integrator.isWall() && lawsChanged)
			system.moved = true;
		lawsChanged = false;
		byWalls = integrator.isWall();
		const auto report = byWalls ? advanceWall() : islands.advance(system, scene.dt);
		writeStates();
		if (++unshown >= mostUnshown || integrator.isWatched())
			writeContacts();
		for (const auto& impact : system.impacts)
			record(impact);
		integrator.frictDissip = system.frictDissip;
		integrator.impactDissip = system.impactDissip;
		integrator.baseWork = system.baseWork;
		return report;
	}

	void writeContacts() override
	{
		if (unshown == 0)
			return;
		showPoints();
		contacts.write(system, kept);
		unshown = 0;
	}

	vector<int> touching() override
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

	void setInstant(Real instant) override
	{
		for (MotionDrive& motion : motions)
			motion.instant = instant;
	}

	void dropErased() override { contacts.dropErased(); }

private:
	masonry::rigid::StepReport advanceWall()
	{
		masonry::rigid::WallStep<K>& walls = bySize.walls;
		walls.settings = {integrator.tolerance, integrator.strictForces, std::max(1, integrator.ompThreads)};
		const auto report = bySize.advance(system, scene.dt);
		const masonry::rigid::WallReport& ofWalls = walls.report;
		const bool still = ofWalls.mode == masonry::rigid::WallMode::still;
		integrator.mode = still ? "still" : "moving";
		integrator.movingBlocks = ofWalls.moved;
		integrator.localisedBlocks = bySize.localised();
		++(still ? integrator.stillSteps : integrator.movingSteps);
		integrator.velocityResidual = ofWalls.velocityResidual;
		integrator.forceResidual = ofWalls.forceResidual;
		if (!still && ofWalls.courses > mostCourses && !integrator.warnedOf.courses) {
			integrator.warnedOf.courses = true;
			LOG_WARN("blocks of a wall of "
			         << ofWalls.courses << " courses move from t = " << scene.time << " s on: walls of more than " << mostCourses
			         << " courses may go some tenths too far; see what a smaller MoreauJeanIntegrator.tolerance or O.dt changes.");
		}
		if (ofWalls.partBases && !integrator.warnedOf.bases) {
			integrator.warnedOf.bases = true;
			LOG_WARN(
			    "t = "
			    << scene.time
			    << " s: blocks of a structure stand on bodies that move in different ways. Friction leaves open how much each of these "
			       "carries, and "
			       "method='wall' may let one take along what should slide on both: compare with method='localised' or compliant joints.");
		}
		return report;
	}

	// --- building ---

	/// Returns each block's number in `before`, or -1.
	vector<int> addBlocks(const Remembered<K>& before)
	{
		vector<int> inBefore;
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

			masonry::rigid::RigidBody<K> block = k < 0 ? masonry::rigid::RigidBody<K>() : before.bodies[k];
			block.halfSize = seat.halfSize(properties.extents);
			block.mass = properties.mass;
			block.inertia = seat.inertia(properties.inertia);
			block.prescribed = !body->isDynamic();
			block.drive = -1;
			if (k < 0)
				seat.read(coordinates, state, properties.extents.minCoeff(), body->id, block);
			links.push_back({body, body->state, properties, {state.pos, state.vel, state.angVel, state.ori}});
			if (k >= 0)
				seat.tell(coordinates, block, links.back().written);
			kept.ids.push_back(body->id);
			kept.seats.push_back(seat);
			system.bodies.push_back(block);
		}
		return inBefore;
	}

	/// Motions of the same bodies are one drive.
	void addDrives(const vector<BaseMotionEngine*>& engines, const vector<int>& inBefore)
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

	/// Pairs of blocks that are still there, and as large as they were: others meet anew.
	void addPairs(const Remembered<K>& before, const vector<int>& inBefore)
	{
		const auto now = [&](int k) { return int(std::find(inBefore.begin(), inBefore.end(), k) - inBefore.begin()); };
		const auto stays = [&](int b, int k) { return b < int(links.size()) && system.bodies[b].halfSize == before.bodies[k].halfSize; };
		for (Pair pair : before.pairs) {
			const int then1 = std::exchange(pair.body1, now(pair.body1)), then2 = std::exchange(pair.body2, now(pair.body2));
			if (stays(pair.body1, then1) && stays(pair.body2, then2))
				system.pairs.push_back(pair);
		}
	}

	void forgetNeighbours()
	{
		length = masonry::rigid::scale::length(system);
		neighbours = std::make_unique<masonry::rigid::Neighbours<K>>(searchMargin * length, [this](Pair& pair) { meet(pair, true); });
	}

	/// After a scene has been refused: all is read again when a script has put it right.
	void forgetStates()
	{
		for (Link& link : links)
			link.written.pos.setConstant(NaN);
		forgetNeighbours();
	}

	void renewContacts()
	{
		contacts.renew(system.pairs, kept.ids);
		takeLaws();
	}

	// --- scene to core ---

	/// Neither erased nor replaced by another of the same id. An erased body has lost its own.
	bool isThere(size_t b) const
	{
		const auto& all = scene.bodies->body;
		return size_t(kept.ids[b]) < all.size() && all[kept.ids[b]] == links[b].body;
	}

	/// Other engines act in steps that are watched, before or after the blocks move; their loads are taken back in the step after. What
	/// another thread changes meanwhile is met some steps late.
	bool mayHaveChanged() const { return unshown <= 1; }

	void readLoads()
	{
		scene.forces.sync();
		for (size_t b = 0; b < links.size(); ++b) {
			auto& block = system.bodies[b];
			if (block.prescribed)
				continue;
			const int id = kept.ids[b];
			block.force = coordinates.load(scene.forces.getForce(id), scene.forces.getTorque(id), id);
			block.force.template head<K::dimension>() += block.mass * system.gravity;
		}
	}

	/// Bodies that a script has moved or pushed since the last step. The base goes where its motion says.
	void readStates()
	{
		others.resize(links.size());
		bySize.walls.eachShare(links.size(), [&](size_t begin, size_t end) {
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
			if (block.prescribed && scene.time > 0 && state.vel == Vector3r::Zero() && (state.pos - link.written.pos).norm() > 0)
				warnOfPlace(b);
			kept.seats[b].read(coordinates, state, link.properties.extents.minCoeff(), kept.ids[b], block);
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

	void warnOfMotion(size_t b)
	{
		if (integrator.warnedOf.motion)
			return;
		integrator.warnedOf.motion = true;
		LOG_WARN("a script has changed the state of body "
		         << kept.ids[b] << " at t = " << scene.time
		         << " s: it goes where its motion says all the same. A motion in another direction may move it besides.");
	}

	void warnOfPlace(size_t b)
	{
		if (integrator.warnedOf.place)
			return;
		integrator.warnedOf.place = true;
		LOG_WARN("a script has moved body " << kept.ids[b] << " by its state.pos at t = " << scene.time
		                                    << " s, with state.vel = 0: blocks on it do not feel that it moves. Set state.vel, by which it "
		                                       "goes on, or give it a RecordMotionEngine.");
	}

	/// What walls know of a pair is of places alone.
	bool isOfWall(const Pair& pair) const { return byWalls && !bySize.isLocalised(pair.body1) && !bySize.isLocalised(pair.body2); }

	/// The points of a pair that nothing is known of: in touch where they are, and do not approach each other. `placed`: by a script, not
	/// by a step.
	void meet(Pair& pair, bool placed)
	{
		const auto &body1 = system.bodies[pair.body1], &body2 = system.bodies[pair.body2];
		const Real rest = masonry::tolerance::restSpeed * std::sqrt(integrator.gravity.norm() * length);
		pair.memory = {};
		const auto found = masonry::rigid::findPoints(body1, body2, pair.memory);
		pair.size = found.size;
		pair.beside = found.size > 0;
		if (found.size == 0)
			return;
		pair.face1 = found.face1;
		pair.face2 = found.face2;
		for (int i = 0; i < found.size; ++i) {
			auto& point = pair.points[i];
			point = {};
			point.feature = found.features[i];
			masonry::rigid::locate(point, body1, body2);
			const auto speed =
			    masonry::rigid::relativeVelocity(point.frame, body1.pose.position, body1.velocity, body2.pose.position, body2.velocity);
			point.closed = point.gap <= integrator.mergedClosing * length && speed[0] >= -rest;
			pair.beside &= std::abs(point.frame.axes.row(0).dot(system.gravity)) < masonry::tolerance::uprightJoint * system.gravity.norm();
			if (placed && point.gap < -mostOverlap * length)
				refuseOverlap(pair, -point.gap);
		}
	}

	[[noreturn]] void refuseOverlap(const Pair& pair, Real depth) const
	{
		throw std::runtime_error(sentence("Blocks ", kept.ids[pair.body1], " and ", kept.ids[pair.body2], " overlap by ", depth,
		                                  " m: rigid blocks must be apart or just touch when the run starts or a script moves them."));
	}

	void takeLaws()
	{
		for (size_t c = 0; c < contacts.size(); ++c) {
			const BlockPhys& law = contacts.law(c);
			Pair& pair = system.pairs[c];
			const Real friction = law.noSlip ? masonry::noSlip : law.tangensOfFrictionAngle, restitution = law.restitution;
			if (pair.friction == friction && (pair.restitution == restitution || (std::isnan(pair.restitution) && std::isnan(restitution))))
				continue;
			law.check(kept.ids[pair.body1], kept.ids[pair.body2]);
			pair.friction = friction;
			pair.restitution = restitution;
			lawsChanged = true;
		}
	}

	/// The laws may be changed by scripts through the interactions, after they have been shown.
	void readLaws()
	{
		if (unshown == 0)
			takeLaws();
	}

	// --- core to scene ---

	void showPoints()
	{
		if (byWalls)
			bySize.walls.showPoints(system);
	}

	/// YADE's states lie scattered in memory.
	void fetch(size_t b) const
	{
		if (b >= links.size())
			return;
		const char* state = reinterpret_cast<const char*>(links[b].state.get());
		for (size_t line = 0; line < sizeof(State); line += 64)
			__builtin_prefetch(state + line);
	}

	/// Bodies that stand still by prescription are as they were.
	void writeStates()
	{
		bySize.walls.eachShare(links.size(), [&](size_t begin, size_t end) {
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

	void record(const masonry::rigid::Impact& impact)
	{
		addImpact(integrator, impact.time, kept.ids[impact.block], kept.ids[impact.support], impact.asked, impact.joint, impact.energyLost,
		          impact.switched, impact.capped);
	}

	/// Overlap, relative to the smallest half size, that is no rounding of coordinates and nothing that a wall has left (some 1e-5), but a
	/// mistake. Larger: blocks are lifted by as much, with energy of nothing.
	static constexpr Real mostOverlap = 1e-4;
	/// Margin of the list of pairs, relative to the smallest half size. Larger: more pairs; smaller: the list is made anew more often.
	static constexpr Real searchMargin = 0.1;
	/// Courses of a wall above which a warning tells that it may go too far, or not far enough, as it moves (validation/walls/shaking).
	static constexpr int mostCourses = 24;
	/// Steps after which O.interactions are written even if nobody seems to look.
	static constexpr int mostUnshown = 64;

	MoreauJeanIntegrator& integrator;
	Scene& scene;
	const boost::weak_ptr<Scene> home; // the same; another may come to lie in its place
	const Coordinates<K> coordinates;
	System system;
	masonry::rigid::Islands<K> islands;
	masonry::rigid::StepBySize<K> bySize; // method='wall'
	bool changed = false;                 // what is moved, and how, is not as it was
	bool byWalls = false, lawsChanged = false;
	int unshown = 1; // steps since the interactions were written
	std::unique_ptr<masonry::rigid::Neighbours<K>> neighbours;
	vector<MotionDrive> motions;
	vector<Link> links;
	vector<char> others; // by link, 1: somebody else has written the state since the last step; elsewhere: and has moved the body; driven:
	                     // it goes where its motion says
	static constexpr char elsewhere = 2, driven = 3;
	ShownContacts<K> contacts;
	Remembered<K> kept; // ids and seats; bodies and pairs are filled in when it is packed
	vector<Seen> seen;  // by id
	Real length = 0;    // smallest half size, m
};

} // namespace yade
