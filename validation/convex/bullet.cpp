// Convex hulls in Bullet (double precision) behind five C functions, which peers.py calls: no sleeping, friction in two directions.
//
// A scene is a text. First the number of bodies; of each its mass (kg; 0: fixed), principal moments (kg m^2), position (m), orientation
// (x, y, z, w), velocity, spin, friction coefficient, and its vertices: how many, and x, y, z of each (m), about the centre of mass in
// principal axes. The hull of the vertices is rounded and thickened by the margin, so that peers.py gives them farther inside by as much.
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

extern btScalar gContactBreakingThreshold;

namespace {

btVector3 readVector(std::istream& in)
{
	double x, y, z;
	in >> x >> y >> z;
	return btVector3(x, y, z);
}

struct World {
	World(std::istream& in, int iterations, double margin, double threshold)
	{
		gContactBreakingThreshold = threshold; // m; a contact point that is farther apart is dropped
		world.getSolverInfo().m_numIterations = iterations;
		world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS; // else friction acts along the momentary slip alone
		int count = 0;
		for (in >> count; count > 0; --count)
			read(in, margin);
	}
	~World()
	{
		for (auto& body : bodies)
			world.removeRigidBody(body.get());
	}
	World(const World&) = delete;

	void read(std::istream& in, double margin)
	{
		double mass, qx, qy, qz, qw, friction;
		int vertices;
		in >> mass;
		const btVector3 moments = readVector(in), position = readVector(in);
		in >> qx >> qy >> qz >> qw;
		const btVector3 velocity = readVector(in), spin = readVector(in);
		in >> friction >> vertices;
		auto shape = std::make_unique<btConvexHullShape>();
		for (int k = 0; k < vertices; ++k)
			shape->addPoint(readVector(in), false);
		shape->recalcLocalAabb();
		shape->setMargin(margin);
		const btVector3 inertia = mass > 0 ? moments : btVector3(0, 0, 0);
		bodies.push_back(std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, shape.get(), inertia)));
		shapes.push_back(std::move(shape));
		btRigidBody& body = *bodies.back();
		body.setWorldTransform(btTransform(btQuaternion(qx, qy, qz, qw), position));
		body.setInterpolationWorldTransform(body.getWorldTransform());
		body.setLinearVelocity(velocity);
		body.setAngularVelocity(spin);
		body.setFriction(std::sqrt(friction)); // the pair has the product
		body.setActivationState(DISABLE_DEACTIVATION);
		world.addRigidBody(&body);
	}

	// Sum of the contact impulses that a body got in the last step, N s.
	btVector3 impulseOn(const btCollisionObject* body)
	{
		btVector3 sum(0, 0, 0);
		for (int k = 0; k < dispatcher.getNumManifolds(); ++k) {
			const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(k);
			const double sign = manifold.getBody0() == body ? 1 : manifold.getBody1() == body ? -1 : 0;
			for (int i = 0; i < manifold.getNumContacts(); ++i) {
				const btManifoldPoint& point = manifold.getContactPoint(i);
				sum +=
				    sign * (point.m_appliedImpulse * point.m_normalWorldOnB + point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
				            point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2);
			}
		}
		return sum;
	}

	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher {&configuration};
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	btDiscreteDynamicsWorld world {&dispatcher, &broadphase, &solver, &configuration};
	std::vector<std::unique_ptr<btConvexHullShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> bodies;
};

} // namespace

extern "C" {

World* bullet_make(const char* scene, int iterations, double margin, double threshold)
{
	std::istringstream in(scene);
	return new World(in, iterations, margin, threshold);
}

void bullet_free(World* world) { delete world; }

void bullet_step(World* world, double dt, long steps, const double* gravity)
{
	for (auto& body : world->bodies)
		body->setGravity(btVector3(gravity[0], gravity[1], gravity[2]));
	for (long k = 0; k < steps; ++k)
		world->world.stepSimulation(dt, 0); // one step of exactly that
}

// Position, orientation (x, y, z, w), velocity and spin of all bodies.
void bullet_states(const World* world, double* out)
{
	for (const auto& body : world->bodies) {
		const btVector3 &x = body->getWorldTransform().getOrigin(), &v = body->getLinearVelocity(), &w = body->getAngularVelocity();
		const btQuaternion q = body->getWorldTransform().getRotation();
		for (const double value : {x[0], x[1], x[2], q.x(), q.y(), q.z(), q.w(), v[0], v[1], v[2], w[0], w[1], w[2]})
			*out++ = value;
	}
}

// Contact impulse on body number `body` in the last step, N s.
void bullet_impulse(World* world, int body, double* out)
{
	const btVector3 sum = world->impulseOn(world->bodies[body].get());
	for (int k = 0; k < 3; ++k)
		out[k] = sum[k];
}
}
