#pragma once
// The functions of OpenGL with which blocks and joints are drawn. YADE's libraries open OpenGL themselves, so that the build needs no
// headers of it.

#include <lib/base/Math.hpp>

extern "C" {
void glBegin(unsigned mode);
void glEnd();
void glColor3d(double red, double green, double blue);
void glNormal3d(double x, double y, double z);
void glVertex3d(double x, double y, double z);
}

namespace yade {
namespace gl {

constexpr unsigned lines = 1, lineLoop = 2, polygon = 9; // GL_LINES, GL_LINE_LOOP, GL_POLYGON

inline void colour(const Vector3r& rgb) { glColor3d(rgb[0], rgb[1], rgb[2]); }
inline void vertex(const Vector3r& point) { glVertex3d(point[0], point[1], point[2]); }

} // namespace gl
} // namespace yade
