#pragma once

#include <chrono>

#include <core/Body.hpp>
#include <core/BodyContainer.hpp>
#include <core/Cell.hpp>
#include <core/EnergyTracker.hpp>
#include <core/Engine.hpp>
#include <core/ForceContainer.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Material.hpp>

namespace yade {

class DisplayParameters;
class OpenGLRenderer;

class Scene : public Serializable {
	YADE_ABI_CLASS(Scene)
	Scene();

	shared_ptr<Engine> engineByName(const string& className);
	bool timeStepperPresent();
	bool timeStepperActive();
	bool timeStepperActivate(bool);

	const unsigned allBits;
	ForceContainer forces;
	double speedElements[10];
	shared_ptr<OpenGLRenderer> renderer;
	std::chrono::system_clock::time_point prevTime;
	Real dt;
	long iter;
	bool subStepping;
	int subStep;
	Real time;
	Real speed;
	long stopAtIter;
	Real stopAtTime;
	bool isPeriodic;
	bool trackEnergy;
	bool doSort;
	bool runInternalConsistencyChecks;
	Body::id_t selectedBody;
	int subdomain;
	shared_ptr<Shape> subD;
	vector<string> tags;
	vector<shared_ptr<Engine>> engines;
	vector<shared_ptr<Engine>> _nextEngines;
	shared_ptr<BodyContainer> bodies;
	shared_ptr<InteractionContainer> interactions;
	shared_ptr<EnergyTracker> energy;
	vector<shared_ptr<Material>> materials;
	shared_ptr<Bound> bound;
	shared_ptr<Cell> cell; // always set
	vector<shared_ptr<Serializable>> miscParams;
	vector<shared_ptr<DisplayParameters>> dispParams;
};

} // namespace yade

YADE_ABI_ARCHIVED(Scene)
