#include "WallRecorder.hpp"
#include "BaseMotionEngine.hpp"
#include "BlockMat.hpp"
#include "BlockTie.hpp"
#include "ConvexBlock.hpp"
#include "MoreauJeanIntegrator.hpp"
#include "RockingJointEngine.hpp"
#include "bonded_state.hpp"
#include "joint_forces.hpp"
#include "sentence.hpp"

#include <algorithm>
#include <boost/python/handle.hpp>
#include <cmath>
#include <core/Scene.hpp>
#include <iterator>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/Box.hpp>
#include <unordered_set>

namespace yade {

YADE_PLUGIN((WallRecorder));

namespace {

constexpr size_t blockNumbers = 4, poseNumbers = 7;

template <class... Numbers>
void add(vector<Real>& row, Numbers... numbers)
{
	(row.push_back(numbers), ...);
}

void addRow(vector<Real>& row, const JointForce& joint)
{
	add(row, Real(joint.id1), Real(joint.id2), joint.force.x(), joint.force.y(), joint.force.z(), joint.point.x(), joint.point.y(),
	    joint.point.z());
}

boost::python::object asBytes(const vector<Real>& numbers)
{
	const char* first = reinterpret_cast<const char*>(numbers.data());
	return boost::python::object(boost::python::handle<>(PyBytes_FromStringAndSize(first, Py_ssize_t(numbers.size() * sizeof(Real)))));
}

bool isShown(const Body& body) { return dynamic_cast<const Box*>(body.shape.get()) || dynamic_cast<const ConvexBlock*>(body.shape.get()); }

} // namespace

/// Fixes what is recorded.
void WallRecorder::begin()
{
	if (iterPeriod <= 0 && virtPeriod <= 0 && realPeriod <= 0)
		throw std::invalid_argument(
		    sentence("WallRecorder.iterPeriod = ", iterPeriod, ", virtPeriod = ", virtPeriod, ": one of them must be positive."));
	if (ids.empty())
		for (const auto& body : scene->bodies->body)
			if (body && isShown(*body) && dynamic_cast<const BlockMat*>(body->material.get()))
				ids.push_back(body->id);
	blocks.clear();
	vertices.clear();
	vertexCounts.clear();
	partCounts.clear();
	for (int id : ids) {
		if (!scene->bodies->exists(id) || !isShown(*(*scene->bodies)[id]))
			throw std::invalid_argument(sentence("WallRecorder.ids has ", id, ": there is no such block in O.bodies."));
		const Body& body = *(*scene->bodies)[id];
		Vector3r half = Vector3r::Zero();
		vertexCounts.push_back(0);
		if (const auto* box = dynamic_cast<const Box*>(body.shape.get())) {
			half = box->extents;
		} else {
			const ConvexBlock& block = static_cast<const ConvexBlock&>(*body.shape);
			const vector<Vector3r>& own = block.vertices;
			for (int part = 0; part < block.parts(); ++part)
				partCounts.push_back(int(block.solid->part(part).vertices().size()));
			vertices.insert(vertices.end(), own.begin(), own.end());
			vertexCounts.back() = int(own.size());
		}
		add(blocks, half.x(), half.y(), half.z(), Real(body.isDynamic()));
	}
}

/// Energies of now belong to the present integrator; what has been dissipated and done, to all that there have been.
void WallRecorder::addEnergies()
{
	const auto integrates = [](const auto& engine) {
		return !engine->dead && (dynamic_cast<MoreauJeanIntegrator*>(engine.get()) || dynamic_cast<RockingJointEngine*>(engine.get()));
	};
	const auto present = std::find_if(scene->engines.begin(), scene->engines.end(), integrates);
	if (present == scene->engines.end())
		return add(energies, NaN, NaN, NaN, NaN, NaN, NaN, NaN);
	if (std::find(integrators.begin(), integrators.end(), *present) == integrators.end())
		integrators.push_back(*present);
	Real friction = 0, dashpots = 0, impacts = 0, work = 0;
	for (const auto& engine : integrators) {
		if (const auto* rigid = dynamic_cast<MoreauJeanIntegrator*>(engine.get()))
			friction += rigid->frictDissip, dashpots += rigid->dampDissip, impacts += rigid->impactDissip, work += rigid->baseWork;
		if (const auto* joints = dynamic_cast<RockingJointEngine*>(engine.get()))
			friction += joints->frictDissip, dashpots += joints->dampDissip, impacts += joints->impactDissip, work += joints->baseWork;
	}
	if (auto* rigid = dynamic_cast<MoreauJeanIntegrator*>(present->get()))
		add(energies, rigid->kinetic(), rigid->potential(), rigid->elastPotential());
	else if (const auto* joints = dynamic_cast<RockingJointEngine*>(present->get()))
		add(energies, joints->kinetic, joints->potential, joints->elastPotential);
	add(energies, friction, dashpots, impacts, work);
}

void WallRecorder::addMotions()
{
	const auto add = [this](const shared_ptr<Engine>& engine) {
		if (dynamic_cast<BaseMotionEngine*>(engine.get()) && !engine->dead &&
		    std::find(motions.begin(), motions.end(), engine) == motions.end())
			motions.push_back(engine);
	};
	for (const auto& engine : scene->engines) {
		add(engine);
		if (const auto* rigid = dynamic_cast<MoreauJeanIntegrator*>(engine.get()); rigid && !rigid->dead)
			std::for_each(rigid->motions.begin(), rigid->motions.end(), add);
	}
}

/// Ties that are there at the first sample.
void WallRecorder::addTies()
{
	const auto addLiving = [this](const vector<shared_ptr<Engine>>& present) {
		std::copy_if(present.begin(), present.end(), std::back_inserter(ties), [](const auto& tie) { return !tie->dead; });
	};
	if (times.size() == 1)
		for (const auto& engine : scene->engines) {
			if (const auto* rigid = dynamic_cast<MoreauJeanIntegrator*>(engine.get()); rigid && !rigid->dead)
				addLiving(rigid->ties);
			if (const auto* joints = dynamic_cast<RockingJointEngine*>(engine.get()); joints && !joints->dead)
				addLiving(joints->ties);
		}
	for (const auto& engine : ties) {
		const auto& tie = static_cast<const BlockTie&>(*engine);
		add(tieStates, tie.force, tie.extension, std::isnan(tie.energy) ? Real(0) : tie.energy, Real(tie.broken));
	}
}

/// Joints with mortar: all of the scene, since crackDissip is that of all. Other engines that know fewer of them leave them as they were.
void WallRecorder::addDamages()
{
	constexpr size_t damage = 4, cracked = 11; // columns of RockingJointEngine.bondedState
	const auto take = [this](const auto* joints) {
		if (!joints || joints->dead || joints->bondedIds.size() < bondIds.size())
			return;
		bondIds = joints->bondedIds;
		bondStates = joints->bondedState;
	};
	for (const auto& engine : scene->engines) {
		take(dynamic_cast<const RockingJointEngine*>(engine.get()));
		take(dynamic_cast<const MoreauJeanIntegrator*>(engine.get()));
	}
	bondCounts.push_back(int(bondIds.size() / 2));
	for (size_t start = 0; start < bondStates.size(); start += bondedRow)
		damages.insert(damages.end(), bondStates.begin() + start + damage, bondStates.begin() + start + cracked);
}

bool WallRecorder::isActivated()
{
	const bool due = isDue(*this);
	onlyOwed = owesForces && !due;
	return owesForces || due;
}

/// Rigid blocks have no forces before their first step, or the first one after loading: a sample of then gets those of that step.
void WallRecorder::addJointForces()
{
	const std::unordered_set<int> recorded(ids.begin(), ids.end());
	const auto isRecorded = [&](int id) { return recorded.count(id) > 0; };
	int count = 0;
	for (const JointForce& joint : jointForces(*scene)) {
		if (!isRecorded(joint.id1) || !isRecorded(joint.id2))
			continue;
		addRow(joints, joint);
		++count;
	}
	jointCounts.push_back(count);
	const auto isNew = [](const auto& engine) {
		const auto* rigid = dynamic_cast<MoreauJeanIntegrator*>(engine.get());
		return rigid && !rigid->dead && !rigid->hasRun();
	};
	owesForces = count == 0 && std::any_of(scene->engines.begin(), scene->engines.end(), isNew);
}

void WallRecorder::action()
{
	if (owesForces) {
		jointCounts.pop_back();
		addJointForces();
		if (onlyOwed)
			return;
	}
	if (times.empty())
		begin();
	if (blocks.size() != blockNumbers * ids.size())
		throw std::invalid_argument("WallRecorder.ids has been changed after the first sample: make a new WallRecorder.");
	if (recordForces != (jointCounts.size() == times.size()) && !times.empty())
		throw std::invalid_argument("WallRecorder.recordForces has been changed after the first sample: make a new WallRecorder.");
	bodies.begin(*scene, ids, [&](size_t k) { return !times.empty() && std::isnan(poses[poses.size() - poseNumbers * (ids.size() - k)]); });
	times.push_back(scene->time);
	addEnergies();
	addMotions();
	addTies();
	addDamages();
	if (recordForces)
		addJointForces();
	for (size_t k = 0; k < ids.size(); ++k) {
		const Body* body = bodies.find(*scene, ids, k);
		if (!body) {
			poses.insert(poses.end(), poseNumbers, NaN);
			continue;
		}
		const State& state = *body->state;
		add(poses, state.pos.x(), state.pos.y(), state.pos.z(), state.ori.w(), state.ori.x(), state.ori.y(), state.ori.z());
	}
}

boost::python::object WallRecorder::posesAsBytes() const { return asBytes(poses); }

boost::python::object WallRecorder::tieStatesAsBytes() const { return asBytes(tieStates); }

boost::python::object WallRecorder::damagesAsBytes() const { return asBytes(damages); }

boost::python::object WallRecorder::jointForcesAsBytes() const { return asBytes(joints); }

boost::python::object WallRecorder::jointForcesNow() const
{
	vector<Real> rows;
	for (const JointForce& joint : jointForces(*Omega::instance().getScene()))
		addRow(rows, joint);
	return asBytes(rows);
}

} // namespace yade
