#pragma once

#include <core/Dispatching.hpp>
#include <core/GlobalEngine.hpp>

namespace yade {

class IntrCallback;

class InteractionLoop : public GlobalEngine {
	YADE_ABI_CLASS(InteractionLoop)
	InteractionLoop();
	void action() override;
	void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords) override;

	bool alreadyWarnedNoCollider;
	vector<std::list<Interaction*>> eraseAfterLoopIds; // one list a thread
	shared_ptr<IGeomDispatcher> geomDispatcher;
	shared_ptr<IPhysDispatcher> physDispatcher;
	shared_ptr<LawDispatcher> lawDispatcher;
	vector<shared_ptr<IntrCallback>> callbacks;
	bool loopOnSortedInteractions;
};

} // namespace yade

YADE_ABI_ARCHIVED(InteractionLoop)
