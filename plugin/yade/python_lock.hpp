#pragma once

#include <Python.h>

namespace yade {

/// O.run() works in a thread of its own: Python objects need the interpreter's lock.
struct PythonLock {
	PyGILState_STATE state = PyGILState_Ensure();
	~PythonLock() { PyGILState_Release(state); }
};

} // namespace yade
