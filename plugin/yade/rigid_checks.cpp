// MoreauJeanIntegrator checks a scene before it steps, and finds whether it lies in a plane.

#include "BaseMotionEngine.hpp"
#include "BlockTie.hpp"
#include "MoreauJeanIntegrator.hpp"
#include "RockingJointEngine.hpp"
#include "checked_body.hpp"
#include "joint_engines.hpp"
#include "python_lock.hpp"
#include "rigid_scene.hpp"

#include "tolerances.hpp"
#include <algorithm>
#include <boost/python/extract.hpp>
#include <core/Scene.hpp>
#include <set>

namespace yade {

namespace {

/// Largest time step relative to sqrt(R/g) of the smallest block: there, peaks of one block are off by up to 0.3 %.
constexpr Real coarsestStep = 0.15;

/// Degrees of freedom, as in State::blockedDOFs, that a planar motion never uses.
unsigned unusedInPlane(const Vector3r& normal)
{
	unsigned result = 0;
	for (int axis = 0; axis < 3; ++axis) {
		if (std::abs(normal[axis]) == 1)
			result |= State::DOF_X << axis;
		if (normal[axis] == 0)
			result |= State::DOF_RX << axis;
	}
	return result;
}

} // namespace

vector<const Body*> MoreauJeanIntegrator::blocks() const
{
	vector<const Body*> result;
	for (const auto& body : scene->bodies->body)
		if (body && isBlock(*body))
			result.push_back(body.get());
	return result;
}

void MoreauJeanIntegrator::checkBlocks(const Choice& choice) const
{
	const vector<BaseMotionEngine*> motions = motionEngines();
	BaseMotionEngine::checkTogether(motions);
	std::set<int> moved;
	for (const BaseMotionEngine* motion : motions)
		moved.insert(motion->ids.begin(), motion->ids.end());
	const unsigned unused = choice.planar() ? unusedInPlane(Coordinates<Plane>(choice.along).normal) : 0;
	bool free = false;
	for (const Body* body : blocks()) {
		checkBody(*body);
		free |= body->isDynamic();
		if (body->isDynamic() && moved.count(body->id))
			throw std::invalid_argument(
			    sentence("Body ", body->id,
			             " is free, and in the ids of a motion: what a motion moves must have all degrees of freedom "
			             "prescribed (O.bodies[",
			             body->id, "].dynamic = False)."));
		if (body->isDynamic() && (body->state->blockedDOFs & ~unused))
			throw std::invalid_argument(
			    sentence("O.bodies[", body->id, "].state.blockedDOFs = '", body->state->blockedDOFs_vec_get(),
			             "' is not allowed for a rigid block: all six degrees of freedom are blocked ('xyzXYZ') or none."));
	}
	for (const auto& tie : livingTiesOf(ties))
		tie->check(*scene);
	if (!free)
		throw std::invalid_argument("There is no free block in O.bodies: add one with dem.block().");
	checkMortar();
	for (const auto& body : scene->bodies->body)
		if (body && dynamic_cast<BlockMat*>(body->material.get()) && !isBlock(*body))
			throw std::invalid_argument(
			    sentence("O.bodies[", body->id,
			             "] has a BlockMat, but its shape is neither a Box nor a ConvexBlock: rigid blocks do not touch it."));
}

bool MoreauJeanIntegrator::hasMortar() const
{
	if (!bondsAsked.empty() || !bondedIds.empty())
		return true;
	const vector<const Body*> all = blocks();
	return std::any_of(all.begin(), all.end(), [](const Body* body) {
		const auto* material = dynamic_cast<const BlockMat*>(body->material.get());
		return material && material->mortar;
	});
}

void MoreauJeanIntegrator::checkMortar() const
{
	for (const Body* body : blocks()) {
		const auto* material = dynamic_cast<const BlockMat*>(body->material.get());
		if (!material || !material->mortar)
			continue;
		const string of = sentence("O.bodies[", body->id, "].mat.");
		if (!wall)
			throw std::invalid_argument(of + "mortar is not allowed here: of rigid blocks, those of method='wall' have it; leave it out, "
			                                 "or give the scene compliant joints (model='compliant').");
	}
}

void MoreauJeanIntegrator::checkEngines()
{
	checkedEngines.clear();
	const auto isOne = [](const auto& engine) { return !engine->dead && dynamic_cast<MoreauJeanIntegrator*>(engine.get()); };
	if (std::count_if(scene->engines.begin(), scene->engines.end(), isOne) > 1)
		throw std::invalid_argument("O.engines has more than one MoreauJeanIntegrator: each moves all blocks; there must be one.");
	for (const auto& engine : scene->engines) {
		if (engine->dead)
			continue;
		if (dynamic_cast<BaseMotionEngine*>(engine.get()))
			throw std::invalid_argument(engine->getClassName() +
			                            " is in O.engines: rigid blocks need it in MoreauJeanIntegrator.motions instead.");
		if (dynamic_cast<RockingJointEngine*>(engine.get()))
			throw std::invalid_argument(
			    "O.engines has a RockingJointEngine and a MoreauJeanIntegrator: blocks are compliant or rigid, not both.");
		if (engine->getClassName() != "NewtonIntegrator")
			continue;
		const PythonLock lock;
		const int mask = boost::python::extract<int>(engine->pyDict()["mask"])();
		for (const Body* body : blocks())
			if (mask == 0 || (body->groupMask & mask) != 0)
				throw std::invalid_argument(
				    sentence("NewtonIntegrator would move block ", body->id,
				             " as well: give the other bodies mask=3 and NewtonIntegrator mask=2, which the blocks (groupMask ",
				             body->groupMask, ") must not have."));
	}
	for (const auto& engine : scene->engines)
		checkedEngines.emplace_back(engine.get(), engine->dead);
}

// --- plane or space ---

void MoreauJeanIntegrator::checkPlane(const Vector3r& horizontal) const
{
	const Coordinates<Plane> plane(horizontal);
	const Vector3r& normal = plane.normal;
	const auto all = blocks();
	const auto first = std::find_if(all.begin(), all.end(), [](const Body* body) { return body->isDynamic(); });
	if (first == all.end())
		return;
	plane.gravity(gravity);
	const Real depth = normal.dot((*first)->state->pos);
	Real front = depth, back = depth; // of the free blocks
	for (int pass : {0, 1})           // free blocks, then the others
		for (const Body* body : all) {
			if (body->isDynamic() != (pass == 0))
				continue;
			const State& state = *body->state;
			const Vector3r local = state.ori.conjugate() * normal;
			const BlockShape shape(*body->shape);
			int axis;
			local.cwiseAbs().maxCoeff(&axis);
			const Real half = shape.reach(Vector3r::Unit(axis)), here = normal.dot(state.pos), rounding = outOfPlane * shape.thickness();
			if (local.cwiseAbs().sum() - std::abs(local[axis]) > outOfPlane)
				throw LeavesPlane(sentence("body ", body->id, " has no axis across the plane"));
			if (!shape.isRightPrism(axis))
				throw LeavesPlane(sentence("body ", body->id, " is no right prism across the plane"));
			const bool shares = std::abs(here - depth) <= rounding;
			if (body->isDynamic()) {
				if (!shares)
					throw LeavesPlane(sentence("blocks ", (*first)->id, " and ", body->id, " have different mid-planes"));
				front = std::max(front, here + half);
				back = std::min(back, here - half);
			} else if (!shares && !(here + half >= front - rounding && here - half <= back + rounding)) {
				throw LeavesPlane(sentence("body ", body->id, " lies under a part of the depth only"));
			}
			plane.velocity(state, body->id);
		}
	for (const BaseMotionEngine* motion : motionEngines())
		plane.direction(motion->direction);
	for (const auto& tie : livingTiesOf(ties))
		checkPlane(*tie, normal, depth);
	addUp(scene->forces, (*first)->id);
	for (const Body* body : all)
		if (body->isDynamic())
			plane.load(scene->forces.getForce(body->id), scene->forces.getTorque(body->id), body->id);
}

/// `depth`: of the mid-plane of the blocks along its normal, m.
void MoreauJeanIntegrator::checkPlane(const BlockTie& tie, const Vector3r& normal, Real depth) const
{
	tie.check(*scene);
	for (const auto& [id, point] : {std::pair(tie.body1, tie.point1), std::pair(tie.body2, tie.point2)}) {
		const Body& body = *(*scene->bodies)[id];
		if (!(std::abs(normal.dot(BlockTie::placeOf(body, point)) - depth) <= outOfPlane * BlockShape(*body.shape).thickness()))
			throw LeavesPlane(sentence("the tie of bodies ", tie.body1, " and ", tie.body2, " does not lie in the mid-plane"));
	}
}

/// The plane is upright; its normal is an axis of every block. Of two that will do, the one nearest to `along` is taken, without one
/// nearest to x.
MoreauJeanIntegrator::Choice MoreauJeanIntegrator::choose() const
{
	if (model == "spatial")
		return {"spatial", "asked for", along};
	const auto all = blocks();
	const auto first = std::find_if(all.begin(), all.end(), [](const Body* body) { return body->isDynamic(); });
	vector<Vector3r> normals;
	if (first != all.end()) {
		const Matrix3r axes = (*first)->state->ori.toRotationMatrix();
		for (int axis = 0; axis < 3; ++axis)
			if (std::abs(axes(2, axis)) <= outOfPlane)
				normals.push_back(Vector3r(axes(0, axis), axes(1, axis), 0).normalized());
	}
	const Vector3r ahead = along.allFinite() && along.head<2>().norm() > 0 ? along : Vector3r(Vector3r::UnitX());
	std::sort(normals.begin(), normals.end(),
	          [&](const Vector3r& a, const Vector3r& b) { return std::abs(a.dot(ahead)) < std::abs(b.dot(ahead)); });
	string whyNot = "no block has a horizontal axis";
	for (size_t k = 0; k < normals.size(); ++k) {
		Vector3r horizontal = Vector3r::UnitZ().cross(normals[k]);
		if (horizontal.x() < 0 || (horizontal.x() == 0 && horizontal.y() < 0))
			horizontal = Vector3r::Zero() - horizontal; // no -0
		try {
			checkPlane(horizontal);
			return {"planar", "blocks, motions and loads lie in one upright plane", horizontal};
		} catch (const LeavesPlane& obstacle) {
			if (k == 0)
				whyNot = obstacle.what();
		}
	}
	if (model == "planar")
		throw std::invalid_argument("MoreauJeanIntegrator.model = 'planar' is not allowed for this scene: " + whyNot + ".");
	return {"spatial", whyNot, along};
}

string MoreauJeanIntegrator::choice()
{
	scene = Omega::instance().getScene().get();
	const Choice choice = choose();
	checkBlocks(choice);
	return choice.model + ": " + choice.reason;
}

// --- time step ---

Real MoreauJeanIntegrator::largestTimeStep()
{
	scene = Omega::instance().getScene().get();
	const Choice choice = chosen();
	const Vector3r across = choice.planar() ? Coordinates<Plane>(choice.along).normal : Vector3r(Vector3r::Zero());
	Real smallest = std::numeric_limits<Real>::infinity(); // R^2, in the plane without the depth
	for (const Body* body : blocks()) {
		if (!body->isDynamic())
			continue;
		smallest = std::min(smallest, BlockShape(*body->shape).leastRadiusSquared(body->state->ori.conjugate() * across));
	}
	return coarsestStep * std::sqrt(std::sqrt(smallest) / gravity.norm());
}

void MoreauJeanIntegrator::checkTimeStep()
{
	const Real largest = largestTimeStep();
	if (!(scene->dt > 0 && scene->dt <= largest))
		throw std::runtime_error(sentence("O.dt = ", scene->dt, " s is not allowed for these blocks: it must be positive and at most ",
		                                  largest, " s (", coarsestStep,
		                                  " of sqrt(R/g) of the smallest block); dem.engines() chooses one."));
	sceneOf(memory).setInstant(masonry::tolerance::instant * scene->dt);
	checkedTimeStep = scene->dt;
	checkedGravity = gravity.norm();
}

} // namespace yade
