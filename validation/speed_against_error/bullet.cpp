// The rocking block in Bullet: btBoxShape on btBoxShape, no sleeping, enough friction not to slip. "default" is Bullet as it comes.
// "tuned" is the best of some thirty trials: friction in two directions (by default it acts along the momentary slip alone and the
// block turns sideways), and contact points that are dropped at a gap of 1 mm rather than 20 mm.
#include "driver.hpp"
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>
#include <memory>

extern btScalar gContactBreakingThreshold;

enum class Method { Default, Tuned, TunedDantzig };

class BulletBlock {
public:
	BulletBlock(const Scene& scene, Method method)
	    : blockShape(btVector3(btScalar(scene.halfWidth), btScalar(scene.depth / 2), btScalar(scene.halfHeight))),
	      solver(method == Method::TunedDantzig ? static_cast<btConstraintSolver*>(new btMLCPSolver(&dantzig))
	                                            : new btSequentialImpulseConstraintSolver),
	      world(&dispatcher, &broadphase, solver.get(), &configuration),
	      base(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &baseShape)), block(constructionInfo(scene))
	{
		gContactBreakingThreshold = method == Method::Default ? btScalar(0.02) : btScalar(0.001);
		if (method != Method::Default)
			world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
		world.setGravity(btVector3(0, 0, btScalar(-scene.gravity)));
		base.getWorldTransform().setOrigin(btVector3(0, 0, -baseHalfHeight));
		const btQuaternion turn(btVector3(0, 1, 0), btScalar(scene.startAngle));
		block.setWorldTransform(btTransform(turn, btVector3(btScalar(scene.startX()), 0, btScalar(scene.startZ()))));
		block.setActivationState(DISABLE_DEACTIVATION);
		for (btRigidBody* body : {&base, &block}) {
			body->setFriction(3); // the pair has the product
			world.addRigidBody(body);
		}
	}
	~BulletBlock()
	{
		world.removeRigidBody(&block);
		world.removeRigidBody(&base);
	}
	BulletBlock(const BulletBlock&) = delete;

	// No sub-steps: one step of exactly dt.
	void step(double dt) { world.stepSimulation(btScalar(dt), 0); }
	double angle() const
	{
		const btQuaternion turn = block.getWorldTransform().getRotation();
		return 2 * std::atan2(double(turn.y()), double(turn.w()));
	}

private:
	btRigidBody::btRigidBodyConstructionInfo constructionInfo(const Scene& scene)
	{
		btVector3 inertia;
		blockShape.calculateLocalInertia(btScalar(scene.mass()), inertia);
		return {btScalar(scene.mass()), nullptr, &blockShape, inertia};
	}

	static constexpr btScalar baseHalfHeight = 0.5;
	btBoxShape baseShape {btVector3(5, 5, baseHalfHeight)};
	btBoxShape blockShape;
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher {&configuration};
	btDbvtBroadphase broadphase;
	btDantzigSolver dantzig;
	std::unique_ptr<btConstraintSolver> solver;
	btDiscreteDynamicsWorld world;
	btRigidBody base, block;
};

int main(int argc, char** argv)
try {
	const Request request = parse(argc, argv);
	const std::string solver = sizeof(btScalar) == sizeof(double) ? "Bullet double" : "Bullet float";
	for (const double dt : request.timeSteps) {
		const auto run = [&](const char* settings, Method method) {
			measure(request, solver, settings, dt, [&] { return std::make_unique<BulletBlock>(request.scene, method); });
		};
		run("default", Method::Default);
		run("tuned", Method::Tuned);
		run("tuned Dantzig", Method::TunedDantzig);
	}
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
