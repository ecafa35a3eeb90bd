#include "Gl1_BlockPhys.hpp"
#include "BlockGeom.hpp"
#include "opengl.hpp"

#include <core/Body.hpp>
#include <core/Interaction.hpp>
#include <core/State.hpp>
#include <lib/factory/ClassFactory.hpp>

namespace yade {

YADE_PLUGIN((Gl1_BlockPhys));

void Gl1_BlockPhys::go(const shared_ptr<IPhys>& shown, const shared_ptr<Interaction>& pair, const shared_ptr<Body>& body1,
                       const shared_ptr<Body>& body2, bool)
{
	const auto* geom = dynamic_cast<const BlockGeom*>(pair->geom.get());
	if (!geom)
		return;
	const vector<Vector3r> points = geom->points(), &forces = static_cast<const BlockPhys&>(*shown).forces;
	for (const Vector3r& force : forces)
		largest = std::max(largest, force.norm());
	const Real scale = largest > 0 ? (body1->state->pos - body2->state->pos).norm() / largest : 0; // m/N
	gl::colour({0.8, 0, 0});
	glBegin(gl::lines);
	for (size_t k = 0; k < std::min(points.size(), forces.size()); ++k) {
		gl::vertex(points[k] - scale / 2 * forces[k]);
		gl::vertex(points[k] + scale / 2 * forces[k]);
	}
	glEnd();
}

} // namespace yade
