#include "expose.hpp"
#include "tolerances.hpp"

BOOST_PYTHON_MODULE(_core)
{
	boost::python::numpy::initialize();
	boost::python::docstring_options docs(true, true, false);
	boost::python::scope().attr("__doc__") =
	    "Exact theory of the rocking block, and geometry of boxes; arrays in, arrays out. Use it through the package masonry.";
	// The package judges runs by the tolerances by which they warn.
	boost::python::scope().attr("MADE_SHARE") = masonry::tolerance::madeShare;
	boost::python::scope().attr("MADE_BY_JOINTS") = masonry::tolerance::madeByJoints;
	boost::python::scope().attr("REST_SPEED") = masonry::tolerance::restSpeed;
	masonry::python::exposeBoxes();
	masonry::python::exposeClosedForm();
	masonry::python::exposeMotion();
	masonry::python::exposeHistory();
	masonry::python::exposeShapes();
}
