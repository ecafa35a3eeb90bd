// The rocking block in ODE: box on box, plastic contact with unlimited friction, ODE's default ERP and CFM.
#include "driver.hpp"
#include <memory>
#include <ode/ode.h>

enum class Method { Direct, QuickStep };

class OdeBlock {
public:
	OdeBlock(const Scene& scene, Method stepMethod) : method(stepMethod)
	{
		dRandSetSeed(0); // QuickStep shuffles its rows
		dWorldSetGravity(world, 0, 0, -scene.gravity);
		dWorldSetQuickStepNumIterations(world, 50);
		const dReal baseHeight = 1;
		base = dCreateBox(space, 10, 10, baseHeight);
		dGeomSetPosition(base, 0, 0, -baseHeight / 2);

		const dReal width = 2 * scene.halfWidth, height = 2 * scene.halfHeight;
		box = dCreateBox(space, width, scene.depth, height);
		dMass mass;
		dMassSetBoxTotal(&mass, scene.mass(), width, scene.depth, height);
		dBodySetMass(block, &mass);
		dGeomSetBody(box, block);
		const dQuaternion turn = {std::cos(scene.startAngle / 2), 0, std::sin(scene.startAngle / 2), 0};
		dBodySetQuaternion(block, turn);
		dBodySetPosition(block, scene.startX(), 0, scene.startZ());
	}
	~OdeBlock()
	{
		dJointGroupDestroy(contacts);
		dSpaceDestroy(space);
		dWorldDestroy(world);
	}
	OdeBlock(const OdeBlock&) = delete;

	void step(double dt)
	{
		dContact points[8];
		const int n = dCollide(base, box, 8, &points[0].geom, sizeof(dContact));
		for (int i = 0; i < n; ++i) {
			points[i].surface = {};
			points[i].surface.mu = dInfinity;
			dJointAttach(dJointCreateContact(world, contacts, &points[i]), dGeomGetBody(points[i].geom.g1),
			             dGeomGetBody(points[i].geom.g2));
		}
		if (method == Method::Direct)
			dWorldStep(world, dt);
		else
			dWorldQuickStep(world, dt);
		dJointGroupEmpty(contacts);
	}
	double angle() const
	{
		const dReal* turn = dBodyGetQuaternion(block);
		return 2 * std::atan2(turn[2], turn[0]);
	}

private:
	const Method method;
	dWorldID world = dWorldCreate();
	dSpaceID space = dSimpleSpaceCreate(nullptr);
	dJointGroupID contacts = dJointGroupCreate(0);
	dBodyID block = dBodyCreate(world);
	dGeomID base, box;
};

int main(int argc, char** argv)
try {
	const Request request = parse(argc, argv);
	dInitODE();
	const std::string solver = sizeof(dReal) == sizeof(double) ? "ODE double" : "ODE float";
	for (const double dt : request.timeSteps) {
		const auto run = [&](const char* settings, Method method) {
			measure(request, solver, settings, dt, [&] { return std::make_unique<OdeBlock>(request.scene, method); });
		};
		run("direct", Method::Direct);
		run("QuickStep 50 iterations", Method::QuickStep);
	}
	dCloseODE();
} catch (const std::exception& error) {
	std::fprintf(stderr, "%s\n", error.what());
	return 1;
}
