// Penetrations that are taken off by positions.
#include "dynamics/wall/position_projection.hpp"
#include "tolerances.hpp"
#include "wall_step_rig.hpp"
#include <catch.hpp>

using namespace rig;
namespace tolerance = masonry::tolerance;

namespace {

template <class K>
void setGaps(ContactSet<K>& c, int body1, int body2, double gap)
{
	for (Group<K>& group : c.groups)
		for (int i = 0; i < width; ++i)
			if (group.body1[i] == body1 && group.body2[i] == body2)
				for (int k = 0; k < group.count; ++k)
					if (group.point[k].gap[i] < 1)
						group.point[k].gap[i] = gap;
}

} // namespace

// A tower of three whose lowest joint is deep. All blocks rise by the depth less what may stay, `lifted` of the smallest half size; the
// joints above may close by `lifted` too, and the sweeps leave up to `penetration`.
TEMPLATE_TEST_CASE("a tower rises with the block that is too deep", "", Plane, Space)
{
	const double deep = 1e-3;
	constexpr int up = TestType::dimension - 1;
	SceneOf<TestType> scene;
	auto& s = scene.system;
	for (int k = 0; k < 3; ++k)
		addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25 + 0.5 * k));
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	auto& c = frozen.contacts;
	setGaps(c, 0, 1, -deep);
	c.shift.assign(c.velocity.size(), all(0));
	PositionProjection<TestType> lift;
	const double left = lift.settle(c), most = tolerance::wall::penetration * c.length;
	CHECK(left <= most);
	for (int b = 1; b <= 3; ++b) {
		CHECK(c.inGlobal(c.shift, b)[up] > deep - b * most);
		CHECK(c.inGlobal(c.shift, b)[up] < deep);
		CHECK(c.inGlobal(c.shift, b).template head<up>().norm() < most);
	}
	CHECK(c.inGlobal(c.shift, 0).norm() == 0);
}

TEMPLATE_TEST_CASE("what is hardly deep stays", "", Plane, Space)
{
	SceneOf<TestType> scene;
	auto& s = scene.system;
	addBlock(s, sizeOf(s, 0.5, 0.25), placeOf(s, 0, 0.25));
	scene.near.update(s);
	Frozen<TestType> frozen(s, 1e-3);
	auto& c = frozen.contacts;
	setGaps(c, 0, 1, -0.99 * tolerance::wall::penetration * c.length);
	c.shift.assign(c.velocity.size(), all(0));
	PositionProjection<TestType> lift;
	lift.settle(c);
	CHECK(c.inGlobal(c.shift, 1).norm() == 0);
}
