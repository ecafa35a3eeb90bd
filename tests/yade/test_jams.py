"""Bodies with prescribed motion press blocks from two sides. Where no motion obeys the contact laws the work stays bounded, and the run says so."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines
from yade import O, utils

SECONDS = 2.0
WAY = 0.05  # m, largest displacement of a jaw


def integrator():
    return next(e for e in O.engines if isinstance(e, dem.MoreauJeanIntegrator))


def jaw(x, z, stone, size):
    return O.bodies.append(utils.box((x, 0, z), (0.25 * size, 0.375 * size, 0.125 * size), material=stone, fixed=True))


def pushed(friction=math.tan(0.6), blocks=3, size=0.4, courses=0, closing=False, **options):
    """A stack of cubes, or a wall, pushed to and fro at its top by two boxes 1 mm away, which move together or close. The ids of blocks and boxes."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(friction))
    base = dem.base((30 * size, 10 * size, 0.2), stone)
    if courses:
        ids = dem.wall(courses=courses, per_course=5, size=(size, size, size), material=stone, on=base)
    else:
        ids = dem.stack(blocks, (size, size, size), stone, on=base)
    reach = max(O.bodies[i].state.pos[0] + O.bodies[i].shape.extents[0] for i in ids) + 0.25 * size + 1e-3
    top = max(O.bodies[i].state.pos[2] for i in ids)
    jaws = [jaw(side * reach, top, stone, size) for side in (-1, 1)]
    displacement = WAY * np.sin(np.pi * np.arange(0, SECONDS + 0.01, 0.01) / 2) ** 3
    record = lambda ids, sign: dem.RecordMotionEngine(ids=ids, displacement=(sign * displacement).tolist(), interval=0.01)
    motion = [record(jaws[:1], 1), record(jaws[1:], -1)] if closing else record(jaws, 1)
    O.engines = quiet_engines(motion, **{"model": "auto", **options})
    return ids, jaws


def weight(ids):
    return 9.81 * sum(O.bodies[i].state.mass for i in ids)


def total():
    e = dem.energy()
    return e["kinetic"] + e["potential"] + e["frictDissip"] + e["impactDissip"] - e["baseWork"]


def runs(ids, seconds=SECONDS):
    """Runs. The work of the jaws, and by how much the balance of energy is off, J."""
    start, moved, lowest, rise = total(), 0.0, math.inf, 0.0
    while O.time < seconds:
        O.step()
        e = dem.energy()
        moved = max(moved, e["kinetic"])
        without = e["kinetic"] + e["potential"] - e["baseWork"]
        lowest, rise = min(lowest, without), max(rise, without - lowest)
    e, done = integrator(), dem.energy()
    print(f"work {done['baseWork']:.4g} J, kinetic energy at most {moved:.3g} J, rise {rise:.1e} J, made {e.madeEnergy:.1e} J, {e.failures} failures: {e.firstFailure[:150]}")
    assert moved < 0.05 * weight(ids) * 0.4  # no block is thrown: less than what lifts all of them by a twentieth of a block
    assert rise < 1e-3 * done["baseWork"]
    return done["baseWork"], abs(total() - start)


CASES = {
    "simultaneous": {},
    "sequential": {"impact_order": "sequential"},
    "few blocks of wall": {"method": "wall"},
    "rough": {"friction": 1.2},
    "four": {"blocks": 4},
}


@pytest.mark.parametrize("case", CASES)
def test_a_stack_that_wedges_between_jaws(case):
    """The top cube tilts until both jaws hold it, and its friction locks it: an upper bound of the work is the limit of four points of a face, ten
    weights each, on the way of the jaws to and fro. Compliant joints take 1.4 kJ for three cubes, without limits it was 1e15 J."""
    ids, jaws = pushed(**CASES[case])
    work, error = runs(ids)
    e = integrator()
    assert work < 2 * 2 * 10 * weight(ids) * 2 * WAY / 3  # both jaws never press all of the way
    assert error < 1e-6 * work + e.madeEnergy + e.lostEnergy
    top = ids[-1]
    assert e.failures > 0 and f"press blocks ({top}) from two sides" in e.firstFailure and str(jaws[0]) in e.firstFailure


def test_the_words_name_both_jaws():
    ids, jaws = pushed(closing=True)
    runs(ids, 0.6)
    assert f"bodies with prescribed motion ({jaws[0]}, {jaws[1]}) press blocks ({ids[-1]}) from two sides" in integrator().firstFailure


@pytest.mark.parametrize("closing", (False, True))
def test_a_wall_between_jaws(closing):
    """Of more than twenty blocks, so that all contacts are solved at once. Bound of the work: as above, where a jaw may stop all blocks in a step
    besides, at the speed that the jaws have, 0.1 m/s."""
    ids, jaws = pushed(courses=5, closing=closing, method="wall")
    force = 10 * weight(ids) + weight(ids) / 9.81 * 0.1 / O.dt
    work, error = runs(ids)
    assert integrator().localisedBlocks == 0
    assert work < 2 * 2 * force * 2 * WAY
    assert error < 1e-6 * work
    assert integrator().failures > 0 and "from two sides" in integrator().firstFailure


@pytest.mark.parametrize("friction", (0.1, 0.3))
def test_a_stack_that_slides_between_jaws(friction):
    """What may slide does not jam: no failure, and the work is what friction takes."""
    ids, _ = pushed(friction=friction)
    work, error = runs(ids)
    e = dem.energy()
    assert integrator().failures == 0 and error < 1e-6 * work
    assert abs(work - e["frictDissip"] - e["impactDissip"]) < 0.02 * work


@pytest.mark.parametrize("model, method", (("planar", "localised"), ("spatial", "localised"), ("planar", "wall"), ("spatial", "wall")))
def test_gravity_that_is_switched_off_and_on(model, method):
    """A wall rests before, while and after; no step fails."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.5)
    base = dem.base((6, 4, 0.2), stone)
    ids = dem.wall(courses=3, per_course=2, size=(0.4, 0.3, 0.2), material=stone, on=base)
    O.engines = quiet_engines(model=model, method=method)
    places = [O.bodies[i].state.pos for i in ids]
    for gravity, seconds in ((-9.81, 0.1), (0, 0.2), (-9.81, 0.2)):
        integrator().gravity = (0, 0, gravity)
        O.run(int(seconds / O.dt), True)
    moved = max((O.bodies[i].state.pos - place).norm() for i, place in zip(ids, places))
    assert integrator().failures == 0, integrator().firstFailure
    assert moved < 1e-7 * 0.2


def test_walls_sum_up_what_they_make():
    """madeEnergy of a wall that rocks under a record never falls, and no rise of the energy less the work of the base is larger."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((20, 4, 0.2), stone)
    dem.wall(courses=8, per_course=4, size=(0.4, 0.3, 0.2), material=stone, on=base)
    times = np.arange(0, 1.0, 0.01)
    displacement = 0.08 * np.sin(np.pi * times) ** 2 * np.sin(4 * np.pi * times)
    O.engines = quiet_engines(dem.RecordMotionEngine(ids=[base], displacement=displacement.tolist(), interval=0.01), model="planar", method="wall")
    e, lowest, rise, made = integrator(), math.inf, 0.0, 0.0
    while O.time < 1.5:
        O.step()
        energy = dem.energy()
        without = energy["kinetic"] + energy["potential"] - energy["baseWork"]
        lowest, rise = min(lowest, without), max(rise, without - lowest)
        assert e.madeEnergy >= made
        made = e.madeEnergy
    print(f"made {made:.2g} J, rise {rise:.2g} J of {e.turnedOver:.3g} J, failures {e.failures} {e.firstFailure[:100]}")
    assert e.localisedBlocks == 0 and 0 < made < 0.05 * e.turnedOver
    assert rise <= made
