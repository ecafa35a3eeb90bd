#include "expose.hpp"

BOOST_PYTHON_MODULE(_core)
{
	boost::python::numpy::initialize();
	boost::python::docstring_options docs(true, true, false);
	boost::python::scope().attr("__doc__") =
	    "Exact theory of the rocking block, and geometry of boxes; arrays in, arrays out. Use it through the package masonry.";
	masonry::python::exposeBoxes();
	masonry::python::exposeClosedForm();
	masonry::python::exposeMotion();
	masonry::python::exposeHistory();
	masonry::python::exposeShapes();
}
