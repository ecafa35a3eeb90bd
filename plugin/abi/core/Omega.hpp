#pragma once

#include <lib/base/Singleton.hpp>
#include <lib/factory/Factorable.hpp>

namespace yade {

class Scene;

/// The running YADE. Created by libyade only, so its members are not declared.
class Omega : public Singleton<Omega> {
public:
	/// The current scene.
	const shared_ptr<Scene>& getScene() const;
	bool isRunning();
	/// Enters classes known to the factory in the class database and in Python's yade.wrapper.
	void buildDynlibDatabase(const vector<string>& classNames);
};

} // namespace yade
