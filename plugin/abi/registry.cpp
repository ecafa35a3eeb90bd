#include <algorithm>

#include <core/Omega.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <registry.hpp>

namespace yade {
namespace abi {

namespace {
// Local to a function, so that it exists whichever file announces first.
vector<PluginClass>& announced()
{
	static vector<PluginClass> classes;
	return classes;
}
} // namespace

void announceClass(const PluginClass& one) { announced().push_back(one); }

vector<string> registerClasses()
{
	static bool done = false;
	vector<string> names;
	for (const PluginClass& one : announced())
		names.push_back(one.name);
	std::sort(names.begin(), names.end());
	if (done)
		return names;
	for (const PluginClass& one : announced())
		if (!ClassFactory::instance().registerFactorable(one.name, one.make, one.makeShared, one.makeCustom))
			throw std::runtime_error("YADE has a class " + one.name + " already: another plugin must be loaded; start YADE without it.");
	Omega::instance().buildDynlibDatabase(names);
	done = true;
	return names;
}

} // namespace abi
} // namespace yade
