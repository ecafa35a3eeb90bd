// The extension module masonry._guard.
#include <boost/python.hpp>

#include "guard.hpp"

namespace {
void require() { yade::guard::requireFit(yade::guard::compiledSizes()); }
} // namespace

BOOST_PYTHON_MODULE(_guard)
{
	boost::python::def("require", require,
	                   "Raises RuntimeError with the first difference between the running YADE and what is compiled in.");
	boost::python::def("build_id", yade::guard::loadedBuildId, "Build id of a loaded library, by its file name.");
}
