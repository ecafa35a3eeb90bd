// The declarations in this folder fit one build of YADE only; with another, the plugin would read wrong memory. The
// guard looks at the running YADE before anything is registered in it.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace yade {
namespace abi {

/// What the running YADE must be.
struct Build {
	std::string version;                                       // yade.config.version
	std::vector<std::pair<std::string, std::string>> buildIds; // library file, GNU build id
	std::vector<std::pair<std::string, std::size_t>> sizes;    // class, bytes its objects take
};

/// The build that this folder declares: Debian 12, package yade 2023.02a-1, amd64, double precision.
[[gnu::visibility("hidden")]] Build declaredBuild();

/// Compares the running YADE with the build needed: version, build ids, sizes of objects, then the place of
/// members and virtual functions in objects that YADE makes. Throws std::runtime_error at the first difference, with
/// one sentence that says what was found, what is needed and what to do. Needs Python and an imported yade.
[[gnu::visibility("hidden")]] void requireBuild(const Build&);

} // namespace abi
} // namespace yade
