"""madeEnergy and lostEnergy of rigid blocks: what steps make and lose, never set off against each other, is the whole error of the balance."""

import functools
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, stone
from yade import O, Quaternion, Vector3


def integrator():
    return next(e for e in O.engines if isinstance(e, dem.MoreauJeanIntegrator))


def total():
    e = dem.energy()
    return e["kinetic"] + e["potential"] + e["frictDissip"] + e["impactDissip"] - e["baseWork"]


def rocks():
    base = dem.base((4, 4, 0.2), stone())
    dem.tilt(dem.block((0.2, 0.5, 1), stone(), on=base), 0.1)


def tumbles():
    dem.base((8, 8, 0.4), stone())
    turned = Quaternion(1, 0.3, 0.2, 0.5)
    turned.normalize()
    state = O.bodies[dem.block((0.2, 0.3, 0.5), stone(), center=(0, 0, 1), orientation=turned)].state
    state.vel, state.angVel = Vector3(1, 0.5, 0), Vector3(2, 3, 1)


CASES = [(*run, dt) for run in ((rocks, "planar", 2.0), (rocks, "spatial", 1.0), (tumbles, "spatial", 0.8)) for dt in (2e-3, 2e-2)]


@functools.lru_cache(maxsize=None)
def sums(build, model, seconds, dt):
    """After each step, in J: energies made, lost and turned over, and the change of the total. The total at the start."""
    O.reset()
    build()
    O.engines = quiet_engines(model=model, method="localised", dt=dt)
    start, seen = total(), []
    for _ in range(math.ceil(seconds / dt)):
        O.step()
        e = integrator()
        seen.append((e.madeEnergy, e.lostEnergy, e.turnedOver, total() - start))
    return (*np.array(seen).T, start)


@pytest.mark.parametrize("build, model, seconds, dt", CASES)
def test_they_are_the_error_of_the_balance(build, model, seconds, dt):
    made, lost, turned_over, change, start = sums(build, model, seconds, dt)
    assert made[0] >= 0 and lost[0] >= 0 and np.all(np.diff(made) >= 0) and np.all(np.diff(lost) >= 0)
    # Round-off of the sums of energies, of which the potential one is largest.
    assert np.all(np.abs(change - (made - lost)) < 1e-9 * (abs(start) + turned_over))


def test_they_are_not_always_zero():
    assert max((made[-1] + lost[-1]) / turned_over[-1] for made, lost, turned_over, *_ in (sums(*case) for case in CASES)) > 1e-7
