#pragma once
// Rigid blocks of a scene in the core's form, and back after each step. No physics here.

#include "BlockTie.hpp"
#include "motion_drive.hpp"
#include "rigid_memory.hpp"
#include "shown_contacts.hpp"

#include "dynamics/localised/islands.hpp"
#include "dynamics/model/neighbours.hpp"
#include "dynamics/scheduler/scheduler.hpp"
#include <core/Scene.hpp>
#include <optional>

namespace yade {

/// Properties that a script may change between steps and the core has taken over.
struct Properties {
	BlockShape shape;
	Vector3r inertia;
	Real mass;
	unsigned blockedDOFs;

	explicit Properties(const Body& body)
	    : shape(*body.shape), inertia(body.state->inertia), mass(body.state->mass), blockedDOFs(body.state->blockedDOFs)
	{
	}
	bool operator==(const Properties& o) const
	{
		return shape == o.shape && inertia == o.inertia && mass == o.mass && blockedDOFs == o.blockedDOFs;
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

/// Settings of a step.
struct RigidSettings {
	Vector3r gravity;
	bool walls, watched, begins;            // method='wall'; O.interactions may be looked at before the next step; no step has been made
	masonry::localised::Settings ofImpacts; // of method='localised'; beside walls with the default tolerance and order
	masonry::WallSettings ofWalls;
};

struct RigidEnergies { // J, since the start of the run
	Real frictDissip, impactDissip, tieDissip, crackDissip, baseWork, potentialShift;
};

/// By the number of a body before: its number now, or -1. `inBefore`: the other way round.
inline vector<int> placesNow(const vector<int>& inBefore, size_t count)
{
	vector<int> now(count, -1);
	for (size_t b = 0; b < inBefore.size(); ++b)
		if (inBefore[b] >= 0)
			now[inBefore[b]] = int(b);
	return now;
}

/// Results of a step.
struct RigidResults {
	masonry::StepReport report;
	masonry::StepErrors errors;
	RigidEnergies energies;
	vector<masonry::Impact> impacts; // block and support by their ids
	masonry::wall::Report walls;
	int localisedBlocks = 0; // beside walls
};

/// Two blocks that touch along a face.
struct BlockJoint {
	int id1, id2;
	bool isHead;
};

/// Numbers of a row of MoreauJeanIntegrator.bondsAsked.
constexpr size_t sizeOfAskedBond = 7;

/// Throws std::invalid_argument where joints without stiffness cannot have this mortar.
void checkRigid(const JointMat& mortar, int id1, int id2);

class AnyRigidScene : public RigidRun {
public:
	/// Blocks have come, gone or changed: build it anew, with what this one remembers.
	virtual bool outdated() const = 0;
	/// Throws LeavesPlane before anything has moved.
	virtual RigidResults step(const RigidSettings& settings) = 0;
	/// O.interactions as they are after the last step: they are left behind while nobody looks.
	virtual void writeContacts() = 0;
	virtual vector<int> touching() = 0;
	/// Whether some of these never slip on each other.
	virtual bool neverSlips() const = 0;
	/// Ids of these bodies of the core, each once, and those with prescribed motion apart.
	virtual std::pair<vector<int>, vector<int>> blocksAndPrescribed(const vector<int>& bodies) const = 0;
	virtual void setInstant(Real) = 0;
	/// Brings MoreauJeanIntegrator.bondedIds and bondedState up to date.
	virtual void writeMortar(vector<int>& ids, vector<Real>& rows) = 0;
	/// Those in which mortar may be.
	virtual vector<BlockJoint> jointsInTouch() = 0;
	/// Rows of MoreauJeanIntegrator.bondsAsked, for the next step.
	virtual void ask(const vector<Real>& bonds) = 0;
	/// Takes the interactions of erased bodies out of O.interactions.
	virtual void dropErased() = 0;
};

/// Adds up O.forces for these bodies: a script's addF() between two steps does not tell YADE that there is something to add up.
inline void addUp(ForceContainer& forces, Body::id_t some)
{
	forces.addForce(some, Vector3r::Zero());
	forces.sync();
}

inline AnyRigidScene& sceneOf(const RigidMemory& memory) { return static_cast<AnyRigidScene&>(*memory.run); }

template <class K>
class RigidScene final : public AnyRigidScene {
	using System = masonry::RigidSystem<K>;
	using Pair = masonry::ContactPair<K>;

	struct Link {
		shared_ptr<Body> body;
		shared_ptr<State> state; // the body's
		Properties properties;
		Motion written;
	};

public:
	/// In the plane: `along` is the horizontal direction of the plane.
	RigidScene(Scene& scene, const Vector3r& along, const RigidSettings& settings, const RigidEnergies& energies,
	           const shared_ptr<Ip2_BlockMat_BlockMat_BlockPhys>& pairLaw, RigidWarnings& warned, const vector<BaseMotionEngine*>& motions,
	           const vector<shared_ptr<BlockTie>>& ties, const Remembered<K>& before);

	vector<Real> pack() override;

	/// Takes the memory of the step itself, if the blocks are still those of `before` and move as they did.
	void unpackStepper(masonry::NumberReader& archive, const Remembered<K>& before);

	bool isPresent() const override { return home.lock() == Omega::instance().getScene(); }
	bool outdated() const override;
	RigidResults step(const RigidSettings& settings) override;
	void writeContacts() override;
	vector<int> touching() override;
	bool neverSlips() const override;
	std::pair<vector<int>, vector<int>> blocksAndPrescribed(const vector<int>& bodies) const override;
	void setInstant(Real instant) override;
	void writeMortar(vector<int>& ids, vector<Real>& rows) override;
	vector<BlockJoint> jointsInTouch() override;
	void ask(const vector<Real>& rows) override { asked = rows; }
	void dropErased() override { contacts.dropErased(); }

private:
	void takeSettings();
	masonry::StepReport advance();

	// --- building ---

	bool says(const Seat<K>& seat, const State& state, const Properties& properties, int id, const masonry::RigidBody<K>& block) const;

	/// Returns each block's number in `before`, or -1.
	vector<int> addBlocks(const Remembered<K>& before);

	/// Motions of the same bodies are one drive.
	void addDrives(const vector<BaseMotionEngine*>& engines, const vector<int>& inBefore);

	/// Pairs of blocks that are still there, and as large as they were: others meet anew.
	void addPairs(const Remembered<K>& before, const vector<int>& inBefore);

	/// With the state that they have in `before`, or their own.
	void addTies(const Remembered<K>& before);

	void addMortar(const Remembered<K>& before, const vector<int>& inBefore);
	bool isJoint(const Pair& pair) const;
	masonry::MortarLaw askedLaw(const Real* row, size_t pair) const;
	void bond();
	masonry::MortarJoint<K> jointOf(const Pair& pair, const masonry::MortarLaw& law) const;
	void findRows(vector<int>& ids, vector<Real>& rows);

	void forgetNeighbours();
	/// After a scene has been refused: all is read again when a script has put it right.
	void forgetStates();

	void renewContacts();

	// --- scene to core ---

	/// Neither erased nor replaced by another of the same id. An erased body has lost its own.
	bool isThere(size_t b) const;

	/// Other engines act in steps that are watched, before or after the blocks move; their loads are taken back in the step after. What
	/// another thread changes meanwhile is met some steps late.
	bool mayHaveChanged() const { return unshown <= 1; }

	/// States, loads, laws and pairs as they are before a step.
	void takeScene();
	void readLoads();
	/// Bodies that a script has moved or pushed since the last step. The base goes where its motion says.
	void readStates();

	void warnOfMotion(size_t b);
	void warnOfPlace(size_t b);

	/// Walls know only the places of such a pair.
	bool isOfWall(const Pair& pair) const { return byWalls && !scheduler->isLocalised(pair.body1) && !scheduler->isLocalised(pair.body2); }

	/// The points of a pair that nothing is known of: in touch where they are, and do not approach each other. `placed`: by a script, not
	/// by a step.
	void meet(Pair& pair, bool placed);

	[[noreturn]] void refuseOverlap(const Pair& pair, Real depth) const;

	/// Scripts may change a tie between steps.
	void readTies();
	void writeTies() const;

	void takeLaws();
	/// The laws may be changed by scripts through the interactions, after they have been shown.
	void readLaws();

	// --- core to scene ---

	void showPoints();
	void showMortar();
	/// YADE's states lie scattered in memory.
	void fetch(size_t b) const;

	/// Bodies that stand still by prescription are as they were.
	void writeStates();

	RigidResults results(const masonry::StepReport& report) const;

	RigidSettings settings; // of the last step, or of the first to come
	RigidWarnings& warned;
	Scene& scene;
	const boost::weak_ptr<Scene> home; // the same; another may come to lie in its place
	const Coordinates<K> coordinates;
	System system;
	masonry::localised::Islands<K> islands;
	std::optional<masonry::Scheduler<K>> scheduler {std::in_place}; // method='wall'
	bool changed = false;                                           // what is moved, and how, is not as it was
	bool byWalls = false;
	bool bonds = false;        // no step has been made: blocks that touch are to be bonded
	vector<Real> asked;        // rows of MoreauJeanIntegrator.bondsAsked
	vector<size_t> rowOf;      // of bondedState, by joint with mortar
	bool ownsContacts = false; // what O.interactions shows of blocks is of this object
	int unshown = 1;           // steps since the interactions were written
	std::unique_ptr<masonry::Neighbours<K>> neighbours;
	vector<MotionDrive> motions;
	const vector<shared_ptr<BlockTie>> ties;
	vector<Link> links;
	vector<char> others; // by link, 1: somebody else has written the state since the last step; elsewhere: and has moved the body; driven:
	                     // it goes where its motion says
	static constexpr char elsewhere = 2, driven = 3;
	ShownContacts<K> contacts;
	Remembered<K> kept; // ids and seats; bodies and pairs are filled in when it is packed
	vector<Seen> seen;  // by id
	Real length = 0;    // smallest half size, m
};

template <>
masonry::MortarJoint<Plane> RigidScene<Plane>::jointOf(const Pair& pair, const masonry::MortarLaw& law) const;
template <>
masonry::MortarJoint<Space> RigidScene<Space>::jointOf(const Pair& pair, const masonry::MortarLaw& law) const;

} // namespace yade
