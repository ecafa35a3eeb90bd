#include <algorithm>

#include <core/Omega.hpp>
#include <registry.hpp>

namespace {
void enterClasses(yade::Omega&, const std::vector<std::string>&);

// The function is private in YADE's header, meant for its own start-up; an explicit instantiation may name it.
template <void (yade::Omega::*function)(const std::vector<std::string>&)>
struct Reach {
	friend void enterClasses(yade::Omega& omega, const std::vector<std::string>& names) { (omega.*function)(names); }
};
template struct Reach<&yade::Omega::buildDynlibDatabase>;
} // namespace

namespace yade {
namespace abi {

std::vector<std::string> registerClasses()
{
	static bool done = false;
	std::vector<std::string> names = {MASONRY_YADE_CLASSES};
	std::sort(names.begin(), names.end());
	if (!done)
		enterClasses(Omega::instance(), names);
	done = true;
	return names;
}

} // namespace abi
} // namespace yade
