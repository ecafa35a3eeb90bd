"""Mortar between rigid blocks (method='wall'): closed forms of single joints, a wall below and above its strength, saved runs, bad input."""

import numpy as np
import pytest
from masonry import Record, dem
from rocking_scene import Balance, bits, refuses, refuses_to_run, rigid_engines
from yade import O, Vector3

STRENGTHS = dict(tensileStrength=0.25e6, fractureEnergy=18, cohesion=0.35e6, shearFractureEnergy=125)  # Pa, J/m^2
SIZE = (0.1, 0.2, 0.05)
AREA = SIZE[0] * SIZE[1]
G = 9.81


def material(mortar=STRENGTHS, **attributes):
    return dem.BlockMat(density=1900, mortar=dem.JointMat(**mortar), **{"frictionAngle": 0.6435, **attributes})


def brick(model="auto", **attributes):
    """The id of a brick on a base, and its weight, N."""
    O.reset()
    of = material(**attributes)
    one = dem.block(SIZE, of, on=dem.base((0.5, 0.2, 0.1), of))
    O.engines = rigid_engines(model=model, method="wall", dt=1e-3)
    return one, O.bodies[one].state.mass * G


def ramp(load, most, time=2.0):
    """A load that grows evenly from 0 to `most` in `time` s, until the joint is broken. Returns the load at which it cracks."""
    first = None
    while O.time < time and not (O.iter and dem.damage()["damage"][0] == 1):
        now = most * O.time / time
        load(now)
        O.step()
        if first is None and dem.damage()["worst"][0] > 0.02:
            first = now
    return first


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_two_blocks_that_are_pulled_apart(model):
    """f_t A = 5 kN; the energy G A = 0.36 J but for the last 0.1 %. The dead zone of opening has inertia: 1 %."""
    one, weight = brick(model)
    first = ramp(lambda force: O.forces.setPermF(one, Vector3(0, 0, force)), 5500)
    row, energy = dem.damage()[0], dem.energy()
    assert first == pytest.approx(5000 + weight, rel=0.01)
    assert energy["crackDissip"] == pytest.approx(18 * AREA, rel=0.01)
    assert row["mode"] == "tension" and row["damage"] == row["worst"] == 1 and row["area"] == pytest.approx(AREA)
    assert row["energy_tension"] == pytest.approx(energy["crackDissip"], rel=1e-12)
    assert 0 < row["cracked"] <= row["broken"] <= O.time


def test_a_rigid_joint_bears_three_times_the_elastic_moment():
    """(f_t + pressure) b h^2/2 about y, with h along x; 1 % more at 1 ms, the inertia of the dead zone of opening."""
    one, weight = brick()
    expected = 0.25e6 * SIZE[1] * SIZE[0] ** 2 / 2 + weight * SIZE[0] / 2
    assert ramp(lambda moment: O.forces.setPermT(one, Vector3(0, moment, 0)), 1.1 * expected) == pytest.approx(expected, rel=0.02)


def test_a_joint_in_space_bears_three_times_the_elastic_moment_across():
    """(f_t + pressure) h b^2/2 about x."""
    one, weight = brick("spatial")
    expected = 0.25e6 * SIZE[0] * SIZE[1] ** 2 / 2 + weight * SIZE[1] / 2
    assert ramp(lambda moment: O.forces.setPermT(one, Vector3(moment, 0, 0)), 1.1 * expected) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_the_base_feels_what_mortar_pulls(model):
    """At rest the reaction is weight less pull, also while the joint cracks under a moment."""
    one, weight = brick(model)
    O.forces.setPermF(one, Vector3(0, 0, 3000))
    O.run(200, True)
    assert dem.damage()["worst"][0] == 0
    (joint,) = dem.joint_forces()
    assert joint["force"][2] == pytest.approx(weight - 3000, rel=1e-2)


def wall(peak, strength=0.02e6, direction=(1, 0, 0)):
    """Three courses of six bricks, shaken by a sine of 3 Hz, g. It slides along x at c A + mu N, 10.4 g (validation/mortar/limit.py 3 6)."""
    O.reset()
    of = material(dict(tensileStrength=strength, fractureEnergy=7e-5 * strength, cohesion=1.4 * strength, shearFractureEnergy=4.9e-4 * strength))
    base = dem.base((2, 0.3, 0.2), of)
    dem.wall(3, 6, (0.21, 0.1, 0.052), of, on=base)
    times = np.arange(0, 1.001, 0.005)
    record = Record(0.005, peak * G * np.sin(2 * np.pi * 3 * times))
    O.engines = rigid_engines(dem.record_motion(record, ids=[base], direction=direction), method="wall", dt=1e-3)


def test_a_wall_below_its_strength_stays_sound():
    wall(peak=1.0)
    O.run(600, True)
    assert len(dem.damage()) > 30 and not dem.damage()["worst"].any()
    assert dem.energy()["crackDissip"] == 0


def test_a_wall_above_its_strength_cracks_and_its_energy_closes():
    wall(peak=14.0)
    balance = Balance()
    O.run(300, True)
    table, energy = dem.damage(), dem.energy()
    assert (table["worst"] > 0.5).any()
    assert (table["energy_tension"] + table["energy_shear"]).sum() == pytest.approx(energy["crackDissip"], rel=1e-9)
    assert abs(balance.error()) < 1e-6 * energy["baseWork"]


@pytest.mark.parametrize("direction", [(1, 0, 0), (0.8, 0.6, 0)])
def test_a_saved_run_goes_on_with_the_same_bits(tmp_path, direction):
    """Saved while joints crack, in the plane and in space."""
    wall(peak=14.0, direction=direction)
    O.run(100, True)
    while dem.energy()["crackDissip"] == 0:
        O.run(10, True)
        assert O.time < 0.3
    O.save(str(tmp_path / "wall.xml"))
    O.run(100, True)
    there, table = bits(), dem.damage()
    O.load(str(tmp_path / "wall.xml"))
    O.run(100, True)
    assert np.array_equal(bits(), there)
    assert dem.damage().tobytes() == table.tobytes()


def test_what_is_refused():
    brick(frictionAngle=0.0)
    refuses_to_run("frictionAngle", "method='wall'")
    O.reset()
    of = material()
    one = dem.block(SIZE, of, on=dem.base((0.5, 0.2, 0.1), of))
    refuses(lambda: rigid_engines(model="planar"), "method = 'auto'", "'wall'")
    refuses(lambda: rigid_engines(model="spatial"), "model = 'spatial'", "'wall'")
    refuses(lambda: rigid_engines(method="localised"), "method = 'localised'")
    O.engines = rigid_engines(method="wall")
    O.step()
    O.engines[-1].method = "localised"
    O.engines[-1].tolerance = 1e-6
    refuses(O.step, "method = 'localised'", kind=(RuntimeError, ValueError))
    assert one


@pytest.mark.parametrize("peak", [4.75, 8.0])
def test_a_wall_across_cracks_above_its_strength_alone(peak):
    """Out of its plane the strength is that of the base joint: (t/H) (1 + f_t/(rho g H)) = 5.05 g."""
    wall(peak, direction=(0, 1, 0))
    balance = Balance()
    O.run(300, True)
    table, energy = dem.damage(), dem.energy()
    assert (table["worst"].max() > 0.5) == (peak > 5.05)
    assert peak > 5.05 or not table["worst"].any()
    assert (table["energy_tension"] + table["energy_shear"]).sum() == pytest.approx(energy["crackDissip"], rel=1e-9)
    assert abs(balance.error()) < 1e-6 * energy["baseWork"]


def test_a_scene_with_mortar_that_leaves_its_plane_is_refused():
    one, _ = brick()
    O.run(2, True)
    O.forces.setPermF(one, Vector3(0, 10, 0))
    refuses(O.step, "no longer planar", "model = 'spatial'", kind=(RuntimeError, ValueError))
