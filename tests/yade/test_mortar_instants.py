"""Mortar between rigid blocks (method='wall') at instants: Dirac pulses of the base, and restitution in joints whose mortar is gone."""

import math

import numpy as np
import pytest
from masonry import dem
from mortar_scene import AREA, EINDHOVEN, SIZE, brick_material, eindhoven
from rocking_scene import Balance, bits, rigid_engines, steps
from yade import O

G = 9.81
ENERGY = EINDHOVEN["fractureEnergy"] * AREA  # J


def struck(share, dt, model="auto", weightless=True):
    """Ids of a base and of a brick that is bonded to it. The base jumps down at 2.5 steps: relative to it, the brick then has this share of the fracture energy of its bed."""
    O.reset()
    material = brick_material()
    base = dem.base((0.5, 0.2, 0.1), material)
    one = dem.block(SIZE, material, on=base)
    mass = O.bodies[one].state.mass
    pulse = dem.PulseTrainEngine(ids=[base], impulse=math.sqrt(2 * share * ENERGY / mass), times=[2.5 * dt], direction=(0, 0, -1))
    if weightless:
        O.forces.setPermF(one, (0, 0, G * mass))
    O.engines = rigid_engines(pulse, model=model, method="wall", dt=dt)
    return base, one


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_pulse_leaves_what_the_mortar_does_not_take(model):
    """KE0 - G A at any step, to 0.5 % of G A; the last 0.1 % of it is not spent."""
    for share in (0.5, 0.9, 1.1, 1.5, 3, 10):
        for dt in (1e-4, 1e-3, 4e-3):
            base, one = struck(share, dt, model)
            steps(12)
            speed, energy = (O.bodies[one].state.vel - O.bodies[base].state.vel).norm(), dem.energy()
            bound = 5e-3
            assert 0.5 * O.bodies[one].state.mass * speed**2 / ENERGY == pytest.approx(max(0, share - 1), abs=bound), (share, dt)
            assert dem.damage()["damage"][0] == pytest.approx(min(1, share), abs=bound), (share, dt)
            assert energy["crackDissip"] / ENERGY == pytest.approx(min(0.999, share), abs=bound), (share, dt)


def test_energies_balance_through_a_pulse():
    for share in (0.5, 1.5):
        struck(share, 1e-3, weightless=False)
        balance = Balance()
        steps(20)
        assert dem.energy()["crackDissip"] / ENERGY == pytest.approx(min(0.999, share), abs=0.01)  # the weight presses
        assert abs(balance.error()) < 1e-6 * dem.energy()["crackDissip"]


def test_a_run_that_is_saved_before_a_pulse_goes_on_with_the_same_bits(tmp_path):
    struck(0.5, 1e-3, weightless=False)  # a file does not have permanent forces
    steps(2)
    O.save(str(tmp_path / "brick.xml"))
    steps(10)
    there, table = bits(), dem.damage()
    assert 0.4 < table["damage"][0] < 0.6
    O.load(str(tmp_path / "brick.xml"))
    steps(10)
    assert np.array_equal(bits(), there)
    assert dem.damage().tobytes() == table.tobytes()


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_joint_has_its_restitution_once_its_mortar_is_gone(model):
    """A couple breaks the weak bed of a block, which then rocks on it."""
    O.reset()
    material = brick_material(eindhoven(tensileStrength=1e4, fractureEnergy=0.1, cohesion=1.4e4, shearFractureEnergy=0.7), restitution=0.6)
    one = dem.block((0.2, 0.2, 0.6), material, on=dem.base((2, 0.5, 0.1), material))
    O.engines = rigid_engines(model=model, method="wall", dt=1e-3)
    O.forces.setPermT(one, (0, 100, 0))  # beyond (f_t A + weight) b/2 = 85 N m
    steps(1)
    while dem.damage()["damage"][0] < 1:
        assert not len(dem.impacts()) and O.time < 0.1
        steps(1)
    O.forces.setPermT(one, (0, 0, 0))
    while not len(dem.impacts()):
        steps(1)
        assert O.time < 1
    found = dem.impacts()
    assert found["restitution"][0] == pytest.approx(0.6, rel=1e-6)
    assert not found["capped"].any()
