#pragma once

#include <lib/serialization/Serializable.hpp>

namespace yade {

/// One number for each thread and key, in lines of the cache so that threads do not share one.
struct EnergyAccumulator {
	int lineSize;
	size_t threads;
	int perLine;
	vector<double*> chunks;
	size_t count;
	size_t lines;
};

class EnergyTracker : public Serializable {
	YADE_ABI_CLASS(EnergyTracker)
	EnergyTracker();

	/// Looks the key up (making it when `create`) unless id is positive already. A new key moves the storage: call it
	/// once outside parallel code before the first parallel add.
	void findId(const string& name, int& id, bool reset, bool create = true);
	/// Adds in the calling thread's place; `reset` keys start every step at zero.
	void add(const Real& value, const string& name, int& id, bool reset = false);
	Real total() const;
	void clear();
	Real getItem_py(const string& name);
	void setItem_py(const string& name, Real value);

	EnergyAccumulator energies;
	std::map<string, int> names;
	vector<bool> resetStep;
};

} // namespace yade

YADE_ABI_ARCHIVED(EnergyTracker)
