// The wall in ODE: box on box, plastic contact, QuickStep with its 20 iterations.
#include "wall.hpp"
#include <ode/ode.h>

struct OdeWall {
	dWorldID world = dWorldCreate();
	dSpaceID space = dHashSpaceCreate(nullptr);
	dJointGroupID contacts = dJointGroupCreate(0);
	std::vector<dBodyID> bodies; // the base first
	std::vector<std::array<double, 2>> start;

	explicit OdeWall(const Request& request)
	{
		dRandSetSeed(0); // QuickStep shuffles its rows
		dWorldSetGravity(world, 0, 0, -gravity);
		add(request.perLevel + 4, 4, 1, request.perLevel / 2., -0.5);
		dBodySetKinematic(bodies[0]);
		for (const Block& b : wall(request.courses, request.perLevel))
			add(b.length, thickness, b.height, b.x, b.z);
	}
	~OdeWall()
	{
		dJointGroupDestroy(contacts);
		dSpaceDestroy(space);
		dWorldDestroy(world);
	}
	OdeWall(const OdeWall&) = delete;

	void add(double length, double depth, double height, double x, double z)
	{
		const dBodyID body = dBodyCreate(world);
		dMass mass;
		dMassSetBox(&mass, density, length, depth, height);
		dBodySetMass(body, &mass);
		dGeomSetBody(dCreateBox(space, length, depth, height), body);
		dBodySetPosition(body, x, 0, z);
		bodies.push_back(body);
		start.push_back({x, z});
	}
	void moveBase(const Request& request, double t)
	{
		dBodySetLinearVel(bodies[0], (request.basePosition(t + timeStep) - request.basePosition(t)) / timeStep, 0, 0);
	}
	static void near(void* self, dGeomID a, dGeomID b)
	{
		auto& wall = *static_cast<OdeWall*>(self);
		dContact points[8];
		const int n = dCollide(a, b, 8, &points[0].geom, sizeof(dContact));
		for (int i = 0; i < n; ++i) {
			points[i].surface = {};
			points[i].surface.mode = dContactApprox1;
			points[i].surface.mu = friction;
			dJointAttach(dJointCreateContact(wall.world, wall.contacts, &points[i]), dGeomGetBody(a), dGeomGetBody(b));
		}
	}
	void step()
	{
		dSpaceCollide(space, this, &near);
		dWorldQuickStep(world, timeStep);
		dJointGroupEmpty(contacts);
	}
	std::vector<std::array<double, 2>> places() const
	{
		std::vector<std::array<double, 2>> result;
		for (size_t b = 1; b < bodies.size(); ++b)
			result.push_back({dBodyGetPosition(bodies[b])[0], dBodyGetPosition(bodies[b])[2]});
		return result;
	}
	double base() const { return dBodyGetPosition(bodies[0])[0] - start[0][0]; }
};

int main(int argc, char** argv)
try {
	const Request request(argc, argv);
	dInitODE();
	{
		OdeWall world(request);
		measure("ODE QuickStep 20 iterations", request, world);
	}
	dCloseODE();
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
