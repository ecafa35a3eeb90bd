// The counterpart of plugin/abi/registry.hpp where the plugin is compiled with YADE's own headers: its macros enter the classes in YADE's
// factory when the library is opened.
#pragma once

#include <string>
#include <vector>

namespace yade {
namespace abi {
/// Enters the plugin's classes in YADE's class database and Python module; returns their names, sorted. Harmless when called again.
[[gnu::visibility("hidden")]] std::vector<std::string> registerClasses();
} // namespace abi
} // namespace yade
