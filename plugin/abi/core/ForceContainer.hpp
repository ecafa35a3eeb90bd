#pragma once

#include <lib/base/Math.hpp>

namespace yade {

/// Forces and torques of a step, one set a thread, added up by sync(). Only the add* functions may be called inside a
/// parallel region; getForce and getTorque throw before sync().
class ForceContainer {
public:
	void addForce(int id, const Vector3r&);
	void addTorque(int id, const Vector3r&);
	void addForceUnsynced(int id, const Vector3r&);
	void addTorqueUnsynced(int id, const Vector3r&);
	void setPermForce(int id, const Vector3r&);
	void setPermTorque(int id, const Vector3r&);
	void addMaxId(int id);
	void sync();
	void reset(long iter, bool resetAll = false);
	const Vector3r& getForce(int id);
	const Vector3r& getTorque(int id);
	const Vector3r& getPermForce(int id);
	const Vector3r& getPermTorque(int id);
	const Vector3r getForceSingle(int id);
	const Vector3r getTorqueSingle(int id);
	int getNumAllocatedThreads() const;
	bool getPermForceUsed() const;

	vector<vector<Vector3r>> _forceData;
	vector<vector<Vector3r>> _torqueData;
	vector<int> _maxId;
	vector<size_t> sizeOfThreads;
	vector<Vector3r> _force;
	vector<Vector3r> _torque;
	vector<Vector3r> _permForce;
	vector<Vector3r> _permTorque;
	size_t size;
	bool syncedSizes;
	int nThreads;
	bool permForceUsed;
	bool permForceSynced;
	std::mutex globalMutex;
	const Vector3r _zero;
	bool synced;
	unsigned long syncCount;
	long lastReset;

	ForceContainer();
	~ForceContainer();
	ForceContainer(const ForceContainer&) = delete;
};

} // namespace yade
