#pragma once

#include <core/Omega.hpp>
#include <core/Timing.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Engine : public Serializable {
	YADE_ABI_CLASS(Engine)
	Engine();
	virtual bool isActivated();
	virtual void action();

	Scene* scene; // set by the scene before every call
	TimingInfo timingInfo;
	shared_ptr<TimingDeltas> timingDeltas;
	bool dead;
	int ompThreads;
	string label;
};

} // namespace yade

YADE_ABI_ARCHIVED(Engine)
