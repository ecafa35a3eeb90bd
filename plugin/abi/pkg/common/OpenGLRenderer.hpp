// OpenGLRenderer draws a scene in YADE's Qt viewer. It is called, never derived from or made.
#pragma once

#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class OpenGLRenderer final : public Serializable {
	YADE_ABI_CLASS(OpenGLRenderer)
	OpenGLRenderer() = delete;
	void init();          // finds the classes that draw
	static bool initDone; // false: the next picture makes their objects anew
};

} // namespace yade
