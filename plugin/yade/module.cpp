// The extension module masonry._yade. Its initialisation does nothing but define setup(): an exception there would
// reach Python without its text.
#include <boost/python.hpp>
#include <string>
#include <vector>

#ifdef MASONRY_YADE_TREE
#include <core/Omega.hpp>
#else
#include <guard.hpp>
#include <registry.hpp>
#endif

#ifdef MASONRY_YADE_TREE
namespace {
void enterClasses(yade::Omega&, const std::vector<std::string>&);

// The function is private in YADE's header, meant for its own start-up; an explicit instantiation may name it.
template <void (yade::Omega::*function)(const std::vector<std::string>&)>
struct Reach {
	friend void enterClasses(yade::Omega& omega, const std::vector<std::string>& names) { (omega.*function)(names); }
};
template struct Reach<&yade::Omega::buildDynlibDatabase>;
} // namespace
#endif

namespace {

/// Makes the plugin's classes known to the running YADE, once; returns their names. Raises RuntimeError, and leaves
/// YADE as it was, when the plugin does not fit.
boost::python::list setup()
{
#ifdef MASONRY_YADE_TREE
	// YADE's own macros have entered the classes in its factory; they are the source files of this folder.
	static const std::vector<std::string> names = {MASONRY_YADE_CLASSES};
	static bool done = false;
	if (!done)
		enterClasses(yade::Omega::instance(), names);
	done = true;
#else
	yade::abi::requireBuild(yade::abi::declaredBuild());
	const std::vector<std::string> names = yade::abi::registerClasses();
#endif
	boost::python::list all;
	for (const std::string& name : names)
		all.append(name);
	return all;
}

} // namespace

BOOST_PYTHON_MODULE(_yade) { boost::python::def("setup", setup, "Registers the plugin's classes in YADE; returns their names."); }
