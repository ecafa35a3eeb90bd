#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

/// Motion of a body. Not copyable.
class State : public Serializable, public Indexable {
	YADE_ABI_CLASS(State)
	YADE_ABI_TOP_INDEX
	State();
	State(const State&) = delete;
	State& operator=(const State&) = delete;

	enum { DOF_NONE = 0, DOF_X = 1, DOF_Y = 2, DOF_Z = 4, DOF_RX = 8, DOF_RY = 16, DOF_RZ = 32 };
	static constexpr unsigned DOF_XYZ = 7, DOF_RXRYRZ = 56, DOF_ALL = 63;

	string blockedDOFs_vec_get() const;
	void blockedDOFs_vec_set(const string& axes);
	Vector3r displ() const;
	Vector3r rot() const;

	Vector3r& pos;    // se3.position
	Quaternionr& ori; // se3.orientation
	std::mutex updateMutex;
	Se3r se3;
	Vector3r vel;
	Real mass;
	Vector3r angVel;
	Vector3r angMom;
	Vector3r inertia;
	Vector3r refPos;
	Quaternionr refOri;
	unsigned blockedDOFs;
	bool isDamped;
	Real densityScaling;
#ifdef YADE_DEFORM // Debian's YADE is without
	Real dR;
#endif
};

} // namespace yade

YADE_ABI_ARCHIVED(State)
