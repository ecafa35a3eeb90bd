// The guard with an expectation that Python can alter: a list of (kind, name, value) laid over the shipped one.
#include <boost/python.hpp>

#include <guard.hpp>

namespace {

template <class Pairs, class Value>
void alter(Pairs& pairs, const std::string& name, const Value& value)
{
	for (auto& pair : pairs)
		if (pair.first == name)
			pair.second = value;
}

void require(boost::python::list changes)
{
	yade::abi::Build build = yade::abi::declaredBuild();
	for (long i = 0; i < boost::python::len(changes); i++) {
		const std::string kind = boost::python::extract<std::string>(changes[i][0]);
		const std::string name = boost::python::extract<std::string>(changes[i][1]);
		if (kind == "version")
			build.version = name;
		if (kind == "build id")
			alter(build.buildIds, name, boost::python::extract<std::string>(changes[i][2])());
		if (kind == "size")
			alter(build.sizes, name, boost::python::extract<size_t>(changes[i][2])());
	}
	yade::abi::requireBuild(build);
}

} // namespace

BOOST_PYTHON_MODULE(guard_probe) { boost::python::def("require", require); }
