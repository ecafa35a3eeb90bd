"""BlockMat: defaults, bad values refused where they are given, and the stiffness that is chosen where none is."""

import math

import pytest
from masonry import dem
from rocking_scene import quiet_engines, refuses, said_by
from yade import O, Quaternion, Vector3


def test_defaults():
    stone = dem.BlockMat()
    assert all(math.isnan(getattr(stone, name)) for name in ("restitution", "normalStiffness", "shearStiffness"))
    assert stone.noSlip is False


def test_given_values():
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.7, normalStiffness=1e9, shearStiffness=5e8, noSlip=True)
    assert (stone.density, stone.frictionAngle, stone.restitution) == (2000, 0.6, 0.7)
    assert (stone.normalStiffness, stone.shearStiffness, stone.noSlip) == (1e9, 5e8, True)
    for edge in (0, 1, math.nan):
        dem.BlockMat(restitution=edge).restitution = edge


@pytest.mark.parametrize("attribute, bad, allowed", (
    ("restitution", -0.1, "from 0 to 1"),
    ("restitution", 1.0000001, "from 0 to 1"),
    ("restitution", math.inf, "from 0 to 1"),
    ("normalStiffness", 0, "positive"),
    ("normalStiffness", -1e9, "positive"),
    ("shearStiffness", 0, "positive"),
    ("shearStiffness", math.inf, "positive"),
))
def test_bad_values(attribute, bad, allowed):
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.7, normalStiffness=1e9, shearStiffness=5e8, noSlip=True)
    refuses(lambda: dem.BlockMat(**{attribute: bad}), attribute, allowed)
    old = getattr(stone, attribute)
    refuses(lambda: setattr(stone, attribute, bad), attribute, allowed)
    assert getattr(stone, attribute) == old, "a refused value must not stay"
    refuses(lambda: stone.updateAttrs({attribute: bad}), attribute, allowed)


@pytest.mark.parametrize("above, weights", ((0, 1.0), (1, 1.5)))
def test_the_weight_presses_the_most_loaded_joint_in(above, weights):
    """The weight presses the most loaded face in by half of the penetration times the smallest width. Half of a block bears on each of the two below it:
    their joints with the base carry one and a half weights."""
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((4, 2, 0.2), stone)
    for place in [(-0.5, 0, 0.2), (0.5, 0, 0.2), (0, 0, 0.6)][: 2 + above]:
        dem.block((1, 0.5, 0.4), stone, center=place)
    said = said_by(lambda: setattr(O, "engines", dem.engines(model="compliant", penetration=1e-4)))
    assert f"; stiffness {stone.normalStiffness:.3g} Pa/m (the weight presses faces in by 5e-05 of the width, edges by 0.0002); dt" in said
    pressure = weights * 2000 * 0.4 * 9.81
    assert abs(stone.normalStiffness * 5e-5 * 0.5 / pressure - 1) < 1e-9 and stone.shearStiffness == stone.normalStiffness / 2


def test_a_stiffness_that_is_chosen_or_given():
    """A block whose longest axis is its own x, stood on end, presses like one that is made upright. Materials outlive their scenes, and another
    penetration chooses anew; what a script has given stays."""
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    for penetration in (1e-4, 1e-5):
        for size, turn in (((0.5, 0.6, 1.5), 0), ((1.5, 0.6, 0.5), math.pi / 2)):
            O.reset()
            dem.base((4, 2, 0.2), stone)
            dem.block(size, stone, center=(0, 0, 0.75), orientation=Quaternion(Vector3(0, 1, 0), turn))
            O.engines = quiet_engines(penetration=penetration)
            assert abs(stone.normalStiffness * penetration / 2 * 0.5 / (2000 * 1.5 * 9.81) - 1) < 1e-9 and stone.shearStiffness == stone.normalStiffness / 2
    assert isinstance(quiet_engines(model="auto")[-1], dem.MoreauJeanIntegrator)
    same = dem.BlockMat(density=2000, normalStiffness=stone.normalStiffness)  # of the number alone it is not told who has given it
    O.engines = quiet_engines(model="auto", penetration=1e-4)
    chosen = stone.normalStiffness
    O.run(2, True)
    assert not isinstance(quiet_engines(model="auto")[-1], dem.MoreauJeanIntegrator) and stone.normalStiffness == chosen  # a run that goes on keeps it
    O.reset()
    dem.block((0.5, 0.6, 1.5), same, on=dem.base((4, 2, 0.2), same))
    assert not isinstance(quiet_engines(model="auto")[-1], dem.MoreauJeanIntegrator) and same.normalStiffness == 2 * 2000 * 1.5 * 9.81 / (1e-5 * 0.5)
    O.reset()
    dem.block((0.5, 0.6, 1.5), stone, on=dem.base((4, 2, 0.2), stone))
    stone.normalStiffness *= 2
    given = stone.normalStiffness
    assert "penetration = 0.0001 is not used" in said_by(dem.engines, penetration=1e-4) and stone.normalStiffness == given
    assert not isinstance(quiet_engines(model="auto")[-1], dem.MoreauJeanIntegrator) and stone.normalStiffness == given


def test_a_joint_has_the_harmonic_mean_of_two_stiffnesses():
    """Of two stiffnesses a joint has the harmonic mean: two layers of half the thickness, one on the other."""
    below, above = dem.BlockMat(density=2000, normalStiffness=1e9, shearStiffness=4e8), dem.BlockMat(density=2000, normalStiffness=3e9, shearStiffness=1e9)
    block = dem.block((0.5, 0.6, 1.5), above, on=dem.base((4, 2, 0.2), below))
    O.engines = quiet_engines()
    O.step()
    joint = O.interactions[0, block].phys
    normal, shear = joint.normalStiffness, joint.shearStiffness
    assert math.isclose(normal, 2 / (1 / 1e9 + 1 / 3e9)) and math.isclose(shear, 2 / (1 / 4e8 + 1 / 1e9))


def test_the_critical_step_where_nothing_touches_yet():
    """Where nothing touches yet the critical step is that of a landing with all springs of the largest face at a corner, (2/step)^2 = k A (1/m +
    r^2/I). The base, thin and light, does not move."""
    stone = dem.BlockMat(density=2000, normalStiffness=1e9, shearStiffness=4e8)
    dem.base((1, 1, 0.01), stone)
    dem.block((0.5, 0.6, 1.5), stone, center=(0, 0, 9))
    quiet_engines()
    mass = 2000 * 0.5 * 0.6 * 1.5
    stiffness = 1e9 * 0.6 * 1.5 * (1 / mass + (0.5**2 + 0.6**2 + 1.5**2) / 4 / (mass * (0.5**2 + 0.6**2) / 12))
    assert math.isclose(O.dt, 0.2 * 2 / math.sqrt(stiffness))


@pytest.mark.parametrize("name", ("normalStiffness", "shearStiffness"))
@pytest.mark.parametrize("stiffness, said", ((10, "refused"), (1e5, "refused"), (1e7, "named"), (1e9, ""), (1e11, ""), (1e18, "refused")))
def test_units_of_stiffness(name, stiffness, said):
    """10 for 10 GPa/m presses a block in by thousands of its width and gives a step of seconds: it is refused with the unit. The weight of a block 1.5 m high
    and 0.5 m wide is 29 kPa: 1e7 Pa/m sinks by 3 mm, 6e-3 of the width; 1e18 Pa/m by less than positions resolve."""
    material = dem.BlockMat(density=2000, frictionAngle=0.6, **{name: stiffness})
    dem.block((0.5, 1, 1.5), material, on=dem.base((6, 4, 0.4), material))
    if said == "refused":
        refuses(quiet_engines, f"{name} = {stiffness:g} Pa/m", "10 GPa/m = 10 N/mm^3 = 1e10 Pa/m")
        return
    assert (f"{name} = {stiffness:g} Pa/m" in said_by(dem.engines)) == (said == "named")
    O.step()
