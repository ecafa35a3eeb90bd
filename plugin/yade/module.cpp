// The extension module masonry._yade. Its initialisation does nothing but define functions: an exception there would
// reach Python without its text.
#include <boost/python.hpp>
#include <dynamics/scheduler/scheduler.hpp>
#include <string>
#include <vector>

#include <registry.hpp>
#ifdef MASONRY_VIEWER
#include <pkg/common/OpenGLRenderer.hpp>
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

/// Makes the plugin's classes known to the running YADE, once; returns their names. The guard has found before that they fit.
py::list setup()
{
	AnyNumber<int, PyNumber_Index>::accept("Integral");
	AnyNumber<double, PyNumber_Float>::accept("Real");
	py::list all;
	for (const std::string& name : yade::abi::registerClasses())
		all.append(name);
	return all;
}

/// By model of rigid blocks: up to so many free blocks that are stepped together have localised impacts.
py::dict fewBlocks()
{
	py::dict all;
	all["planar"] = int(masonry::Scheduler<masonry::Plane>::maxBlocks);
	all["spatial"] = int(masonry::Scheduler<masonry::Space>::maxBlocks);
	return all;
}

#ifdef MASONRY_VIEWER
/// YADE's renderer looks for the classes that draw when YADE's windows start. It ends YADE when it meets a body or a contact of a class
/// that came later, so that it has to look again.
void drawOurClasses(py::object renderer)
{
	yade::OpenGLRenderer& found = py::extract<yade::OpenGLRenderer&>(renderer);
	found.init();
	yade::OpenGLRenderer::initDone = false;
}
#endif

} // namespace

BOOST_PYTHON_MODULE(_yade)
{
	py::def("setup", setup, "Registers the plugin's classes in YADE; returns their names.");
#ifdef MASONRY_VIEWER
	py::def("draw_our_classes", drawOurClasses, "Makes yade.qt.Renderer() draw the plugin's bodies and contacts.");
#endif
	py::def("few_blocks", fewBlocks,
	        "By model of rigid blocks: up to so many free blocks that are stepped together have localised impacts.");
}
