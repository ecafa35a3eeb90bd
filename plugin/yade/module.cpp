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

namespace py = boost::python;

/// Lets an attribute of type T take what is an instance of this class of Python's module `numbers`, as NumPy's numbers are; `plain` makes
/// of it the int or float that Boost.Python knows.
template <class T, PyObject* plain(PyObject*)>
struct AnyNumber {
	static void accept(const char* className)
	{
		kind() = py::import("numbers").attr(className);
		py::converter::registry::push_back(&convertible, &construct, py::type_id<T>());
	}

private:
	static py::object& kind()
	{
		static auto* one = new py::object; // for good: Python ends before statics do
		return *one;
	}
	static void* convertible(PyObject* object)
	{
		const int is = PyObject_IsInstance(object, kind().ptr());
		if (is < 0)
			PyErr_Clear();
		return is > 0 ? object : nullptr;
	}
	static void construct(PyObject* object, py::converter::rvalue_from_python_stage1_data* data)
	{
		const py::object number {py::handle<>(plain(object))};
		void* place = reinterpret_cast<py::converter::rvalue_from_python_storage<T>*>(data)->storage.bytes;
		data->convertible = new (place) T(py::extract<T>(number));
	}
};

/// Makes the plugin's classes known to the running YADE, once; returns their names. Raises RuntimeError, and leaves
/// YADE as it was, when the plugin does not fit.
py::list setup()
{
	AnyNumber<int, PyNumber_Index>::accept("Integral");
	AnyNumber<double, PyNumber_Float>::accept("Real");
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
	py::list all;
	for (const std::string& name : names)
		all.append(name);
	return all;
}

} // namespace

BOOST_PYTHON_MODULE(_yade) { py::def("setup", setup, "Registers the plugin's classes in YADE; returns their names."); }
