// The guard with sizes that Python can alter: a list of (class, bytes) laid over those that are compiled in. Built twice: as the plugin is,
// and with a wrong definition, which shifts State.
#include <boost/python.hpp>

#include <guard.hpp>

namespace {

void require(boost::python::list changes)
{
	yade::guard::Sizes sizes = yade::guard::compiledSizes();
	for (long i = 0; i < boost::python::len(changes); i++) {
		const std::string name = boost::python::extract<std::string>(changes[i][0]);
		for (auto& size : sizes)
			if (size.first == name)
				size.second = boost::python::extract<size_t>(changes[i][1]);
	}
	yade::guard::requireFit(sizes);
}

} // namespace

BOOST_PYTHON_MODULE(GUARD_PROBE)
{
	boost::python::def("require", require, (boost::python::arg("changes") = boost::python::list()));
	boost::python::def("build_id", yade::guard::loadedBuildId);
}
