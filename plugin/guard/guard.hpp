// The classes of YADE that the plugin derives from and reads are compiled in: from plugin/abi, or from YADE's own headers under the
// definitions that its features stand for. Where they differ from those of the running YADE, the plugin would read wrong memory. The guard
// is a module of its own (masonry._guard), so that it looks before the plugin is opened and anything is registered.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace yade {
namespace guard {

/// Class and bytes that its objects take.
using Sizes = std::vector<std::pair<std::string, std::size_t>>;

/// As compiled in.
[[gnu::visibility("hidden")]] Sizes compiledSizes();

/// Compares the running YADE with what is compiled in: sizes of objects, then the place of members and virtual functions in objects that
/// YADE makes. Throws std::runtime_error at the first difference, with the clause that says which. Needs Python and an imported yade.
[[gnu::visibility("hidden")]] void requireFit(const Sizes&);

/// GNU build id of the loaded library of that file name, in hexadecimal digits; empty when it is not loaded or has none.
[[gnu::visibility("hidden")]] std::string loadedBuildId(const std::string& library);

} // namespace guard
} // namespace yade
