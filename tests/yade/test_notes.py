"""What dem.engines() says of scenes that may not be what the script means, and of those that are: nothing."""
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import said_by
from yade import FrictMat, NewtonIntegrator, O, Vector3, utils

import masonry


def scene(size=(0.5, 0.5, 1.5), friction=0.8, **material):
    O.reset()
    stone = dem.BlockMat(**{"density": 2000, "frictionAngle": math.atan(friction), **material})
    base = dem.base((4, 2, 0.2), stone)
    return base, dem.block(size, stone, on=base), stone


def lines(*arguments, **options):
    return [line for line in said_by(dem.engines, *arguments, **options).splitlines() if line]


def test_a_sound_scene():
    """The choice and no more."""
    base, block, _ = scene()
    assert len(lines()) == 1
    motion = dem.record_motion(masonry.Record(0.01, 2 * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01))), ids=[base])
    assert len(lines(motion)) == 1 and "at most 2 m/s^2 (0.204 g)" in lines(motion)[0]  # 2/9.80665


@pytest.mark.parametrize("add, said", (
    (lambda: O.bodies.append(utils.sphere((0, 0, 5), 0.1, material=FrictMat())), "2 (Sphere); no engine of `others` moves those that are free"),
    (lambda: O.bodies.append(utils.box((0, 0, 5), (1, 1, 1), fixed=True, material=FrictMat())), "2 (Box)"),
    (lambda: O.bodies.append(utils.facet([(0, 0, 5), (1, 0, 5), (0, 1, 5)], fixed=True, material=FrictMat())), "2 (Facet)"),
))
def test_bodies_that_no_block_touches(add, said):
    scene()
    add()
    said_here = [line for line in lines() if "no block touches" in line]
    assert len(said_here) == 1 and said_here[0].endswith(said)


def test_a_body_that_another_engine_moves():
    scene()
    O.bodies.append(utils.sphere((0, 0, 5), 0.1, material=FrictMat()))
    assert "no engine of" not in "".join(lines(others=[NewtonIntegrator(mask=2)])) and "2 (Sphere)" in "".join(lines(others=[NewtonIntegrator(mask=2)]))


def test_a_motion_that_was_made_and_not_given():
    """A motion that was made and not given; once it has been, it is the script's choice to go on without it."""
    base, block, _ = scene()
    motion = dem.PulseTrainEngine(ids=[base], impulse=0.05, times=[0])
    assert sum("no motion: the PulseTrainEngine of body 0" in line for line in lines()) == 1
    motion.dead = True
    assert len(lines()) == 1
    motion.dead = False
    lines(motion)
    assert len(lines()) == 1


def test_a_motion_of_a_scene_that_is_gone():
    """It is not named, though the script still has it."""
    base, block, _ = scene()
    motion = dem.PulseTrainEngine(ids=[base], impulse=0.05, times=[0])
    scene()
    assert len(lines()) == 1


@pytest.mark.parametrize("baseline, said", (("none", True), ("constant", False)))
def test_a_base_that_goes_on(baseline, said):
    """A base that goes on: a constant acceleration a for T leaves it at a T^2/2 with a T."""
    scene()
    motion = dem.record_motion(masonry.Record(0.1, [2.0] * 11, baseline=baseline), ids=[0], start=0.5)
    found = [line for line in lines(motion) if "when the record ends" in line]
    assert len(found) == said
    assert not said or "at 1.5 s, the base is 1 m from where it was and goes on at 2 m/s" in found[0]


@pytest.mark.parametrize("size, asked", (((0.5, 0.5, 1.5), 13 / 9), ((0.5, 0.5, 1.0), 4 / 3)))
@pytest.mark.parametrize("factor", (0.98, 1.02))
def test_a_dirac_pulse_asks_for_friction(size, asked, factor):
    """Dirac pulses ask for (s^2 + 4)/(3 s): 13/9 for s = 3, 8/6 for s = 2; with less, the block slips (measured in the run), with more it does not."""
    base, block, _ = scene(size, factor * asked)
    said = "".join(lines(motion := dem.PulseTrainEngine(ids=[base], impulse=0.2, times=[0])))
    assert (f"Dirac pulse of body 0 asks for a friction coefficient of {asked:.3g} to tip block 1" in said) == (factor < 1)
    O.engines = dem.engines(motion)
    O.dt /= 10
    dem.run(0.05)
    b, pivot = size[0] / 2, O.bodies[block].state
    # The lower corner that it turns about, relative to the base: the one that is on the floor.
    corner = pivot.pos + pivot.ori * type(pivot.pos)(-b, 0, -size[2] / 2)
    slip = abs(corner[0] - O.bodies[base].state.pos[0] + b)
    assert (slip > 1e-6 * b) == (factor < 1)


def test_a_dirac_pulse_without_a_note():
    base, block, stone = scene((0.5, 0.5, 0.5), 0.7)
    dem.block((0.5, 0.5, 0.5), stone, on=block)
    assert "Dirac" not in "".join(lines(dem.PulseTrainEngine(ids=[base], impulse=0.2, times=[0])))  # stacks ask for something else
    base, *_ = scene(noSlip=True)
    assert "Dirac" not in "".join(lines(dem.PulseTrainEngine(ids=[base], impulse=0.2, times=[0])))


@pytest.mark.parametrize("density, said", ((27, True), (300, False), (20001, True)))  # stone in kN/m^3; light timber
def test_units_of_a_density(density, said):
    scene(density=density)
    assert (f"a density is {density:g}: densities are in kg/m^3" in "".join(lines())) == said


@pytest.mark.parametrize("peak, unit, said", ((0.3, False, True), (0.3, True, False), (0.3, None, True), (1.6, False, False), (0.099, False, False)))
def test_units_of_a_record(peak, unit, said):
    base, *_ = scene()
    record = masonry.Record(0.01, peak * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01)))
    if unit is not None:
        record.unit_given = unit
    found = [line for line in lines(dem.record_motion(record, ids=[base])) if "without a unit" in line]
    assert len(found) == said and (not said or "is it in g?" in found[0])


@pytest.mark.parametrize("model, given, said", (
    ("planar", dict(young=1e10), "young of a BlockMat have no effect"), ("compliant", dict(young=1e10, poisson=0.1), "young and poisson of"),
    ("planar", dict(normalStiffness=1e9), "normalStiffness of a BlockMat have no effect with model='planar'"),
    ("compliant", dict(normalStiffness=1e9), None), ("planar", {}, None),
))
def test_attributes_without_effect(model, given, said):
    scene(**given)
    found = [line for line in lines(model=model) if "no effect" in line]
    assert len(found) == (said is not None) and (said is None or said in found[0])


def test_forces_that_a_recorder_leaves_out():
    """Reactions of the base would lack them; where all blocks are recorded, or no forces, nothing is said."""
    base, block, stone = scene()
    dem.block((0.5, 0.5, 1.0), stone, center=(1.2, 0, 0.5))
    for ids, forces, said in (([base, block], True, 1), ([base, block], False, 0), ([], True, 0), ([0, 1, 2], True, 0)):
        found = [line for line in lines(recorder=dem.WallRecorder(virtPeriod=1, ids=ids, recordForces=forces)) if "leaves out 1 block:" in line]
        assert len(found) == said


def test_a_motion_that_leaves_bodies_behind():
    """A prescribed pier on a base that moves stays where it is, and with it what it carries; a base that carries nothing shakes nothing."""
    base, block, stone = scene()
    pier = dem.block((0.5, 0.5, 1), stone, center=(1.2, 0, 0.5))
    O.bodies[pier].dynamic = False
    dem.block((0.5, 0.5, 1), stone, on=pier)
    far = dem.base((1, 1, 0.2), stone, at=(9, 0))
    record = masonry.Record(0.01, 2 * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01)))
    for ids, said in (([base], f"a motion moves body {base} and not body {pier}, which touches it"), ([far], f"no free block stands on what a motion moves (body {far})"),
                      ([base, pier], None), ([base, pier, far], None)):
        *found, _ = lines(dem.record_motion(record, ids=ids))  # the last line: the choice
        assert found == [] if said is None else len(found) == 1 and said in found[0], (ids, found)


def test_warnings_are_words_alone(capfd):
    """Without names of functions and files."""
    base = dem.base((4, 2, 0.2), stone := dem.BlockMat(density=2000, frictionAngle=0.6))
    dem.block((0.4, 1, 1), stone, on=base)
    O.engines = dem.engines()
    O.step()
    O.bodies[base].state.pos += Vector3(0.001, 0, 0)
    O.step()
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 1 and said[0].startswith(f"masonry.dem: warning: a script has moved body {base} by its state.pos"), said


def test_a_tilting_table_says_nothing_in_between(capfd):
    """It seeks one impact in a step where blocks begin to move: such steps are counted in its trials, and give no warning."""
    base = dem.base((5, 1, 0.2), stone := dem.BlockMat(density=2000, frictionAngle=math.atan(0.65)))
    dem.wall(length=1.6, height=2.0, size=(0.4, 0.2, 0.2), material=stone, on=base, openings=[(0.6, 0.6, 0.4, 0.8)])
    dem.TiltTable(direction="-x", method="localised").bisect(progress=False)
    said = capfd.readouterr()
    assert said.err == "" and "warning" not in said.out, said
