// The plugin classes of this library, as their source files announce them when the library is opened. Nothing is
// told to YADE before registerClasses(), so that a build that the guard refuses stays as it was.
#pragma once

#include <lib/factory/Factorable.hpp>

namespace yade {
namespace abi {
using Maker = Factorable* (*)();
using SharedMaker = shared_ptr<Factorable> (*)();
using CustomMaker = void* (*)();

struct PluginClass {
	string name;
	Maker make;
	SharedMaker makeShared;
	CustomMaker makeCustom;
};

[[gnu::visibility("hidden")]] void announceClass(const PluginClass&);

/// Enters the announced classes in YADE's factory, class database and Python module; returns their names, sorted.
/// Harmless when called again. Throws std::runtime_error if YADE or another plugin has a class of the same name.
[[gnu::visibility("hidden")]] vector<string> registerClasses();
} // namespace abi
} // namespace yade
