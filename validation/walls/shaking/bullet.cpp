// The wall in Bullet (double precision): btBoxShape, 10 iterations as it comes, or as many as the environment's ITERATIONS says; no
// sleeping.
#include "wall.hpp"
#include <btBulletDynamicsCommon.h>
#include <memory>

struct BulletWall {
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher {&configuration};
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	btDiscreteDynamicsWorld world {&dispatcher, &broadphase, &solver, &configuration};
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> bodies; // the base first

	BulletWall(const Request& request, int iterations)
	{
		world.setGravity(btVector3(0, 0, -gravity));
		world.getSolverInfo().m_numIterations = iterations;
		add(btVector3(request.perLevel / 2. + 2, 2, 0.5), 0, btVector3(request.perLevel / 2., 0, -0.5));
		bodies[0]->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
		for (const Block& b : wall(request.courses, request.perLevel))
			add(btVector3(b.length / 2, thickness / 2, b.height / 2), density * b.length * b.height * thickness, btVector3(b.x, 0, b.z));
	}
	~BulletWall()
	{
		for (auto& body : bodies)
			world.removeRigidBody(body.get());
	}
	void add(const btVector3& half, double mass, const btVector3& place)
	{
		shapes.push_back(std::make_unique<btBoxShape>(half));
		btVector3 inertia(0, 0, 0);
		if (mass > 0)
			shapes.back()->calculateLocalInertia(mass, inertia);
		bodies.push_back(
		    std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, shapes.back().get(), inertia)));
		btRigidBody& body = *bodies.back();
		body.setWorldTransform(btTransform(btQuaternion::getIdentity(), place));
		body.setInterpolationWorldTransform(body.getWorldTransform());
		body.setFriction(std::sqrt(friction)); // the pair has the product
		body.setActivationState(DISABLE_DEACTIVATION);
		world.addRigidBody(&body);
		start.push_back(place);
	}
	// Kinematic bodies take their velocity from how far they are moved in the step.
	void moveBase(const Request& request, double t)
	{
		btTransform place = bodies[0]->getWorldTransform();
		bodies[0]->setInterpolationWorldTransform(place);
		place.setOrigin(start[0] + btVector3(request.basePosition(t + timeStep), 0, 0));
		bodies[0]->setWorldTransform(place);
	}
	void step() { world.stepSimulation(timeStep, 0); } // one step of exactly that
	std::vector<std::array<double, 2>> places() const
	{
		std::vector<std::array<double, 2>> result;
		for (size_t b = 1; b < bodies.size(); ++b)
			result.push_back({bodies[b]->getWorldTransform().getOrigin().x(), bodies[b]->getWorldTransform().getOrigin().z()});
		return result;
	}
	double base() const { return bodies[0]->getWorldTransform().getOrigin().x() - start[0].x(); }

	std::vector<btVector3> start;
};

int main(int argc, char** argv)
try {
	const Request request(argc, argv);
	const char* given = std::getenv("ITERATIONS");
	const int iterations = given ? std::atoi(given) : 10;
	BulletWall world(request, iterations);
	measure("Bullet double " + std::to_string(iterations) + " iterations", request, world);
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
