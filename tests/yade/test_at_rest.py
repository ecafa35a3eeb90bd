"""dem.at_rest(): False where blocks move, fly or turn back, True where they stand; dem.run() ends where O.stopAtIter, O.stopAtTime and O.pause() say."""

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, refuses, stone
from yade import NewtonIntegrator, O, PyRunner, utils

import masonry

MODELS = ("planar", "spatial", "compliant")


def rocks(model, angle=0.1, **how):
    O.reset()
    block = dem.block((0.4, 1, 1), stone(0.6), on=dem.base((6, 2, 0.2), stone(0.6)))
    dem.tilt(block, angle)
    O.engines = quiet_engines(model=model, **how)
    return O.bodies[block].state


@pytest.mark.parametrize("model", MODELS)
def test_a_block_that_rocks_is_not_at_rest_until_it_stands(model):
    """It turns back in many steps, of which some are slower than a block at rest; utils.unbalancedForce() is 0 all along for rigid blocks."""
    state, slow, rested = rocks(model), 0, None
    assert not dem.at_rest()
    theory = masonry.simulate(masonry.RockingBlock(0.2, 0.5), restitution=0.6, initial_angle=0.1)
    while O.time < 1.2 * theory.rest_time:
        O.step()
        if abs(state.angVel[1]) < 1e-4 * np.sqrt(9.81 / np.hypot(0.2, 0.5)) and abs(dem.angle(1)) > 1e-3:
            slow += 1
        if rested is None and dem.at_rest():
            rested = O.time
    assert model == "compliant" or utils.unbalancedForce() == 0
    assert slow > 0 and rested is not None and dem.at_rest()
    # The last half cycles, below 1e-4 of the critical angle, take 1e-2 of a period; springs come to rest later.
    assert 0.9 * theory.rest_time < rested < 1.15 * theory.rest_time, (rested, theory.rest_time)


@pytest.mark.parametrize("model", (*MODELS, "wall"))
def test_walls_stand_at_rest_and_not_on_a_base_that_moves(model):
    how = {"model": "planar", "method": "wall"} if model == "wall" else {"model": model}
    base = dem.base((6, 2, 0.2), stone(noSlip=False, frictionAngle=0.6))
    dem.wall(courses=4, per_course=3, size=(0.4, 0.2, 0.2), material=O.bodies[base].mat, on=base)
    record = masonry.Record(0.01, 0.5 * np.sin(2 * np.pi * np.arange(101) / 100), unit="m/s^2")
    O.engines = quiet_engines(dem.record_motion(record, ids=[base], start=0.2), **how)
    dem.run(0.19)
    assert dem.at_rest()
    dem.run(0.5)
    assert not dem.at_rest()


@pytest.mark.parametrize("model, method", (("planar", "wall"), ("spatial", "wall"), ("planar", "localised"), ("compliant", "auto")))
def test_what_has_been_shaken_comes_to_rest(model, method):
    """Within half a second, and stays at rest: the forces that a solver leaves are within what counts as a balance. Walls of 126 blocks, stacks of four."""
    base, material = dem.base((14, 4, 0.2), stone(noSlip=False, frictionAngle=0.6)), stone(noSlip=False, frictionAngle=0.6)
    if method == "wall":
        dem.wall(courses=12, per_course=10, size=(0.4, 0.2, 0.2), material=material, on=base)
    else:
        dem.stack(4, (0.6, 0.5, 0.4), material, on=base)
    motion = dem.record_motion(masonry.artificial_record(seed=1, peak=3.0, duration=0.5, frequency=2.0), ids=[base])
    O.engines = quiet_engines(motion, model=model, **({} if model == "compliant" else {"method": method}))
    dem.run(1.0)
    found = []
    for _ in range(20):
        dem.run(0.005)
        found.append(dem.at_rest())
    assert all(found), found


@pytest.mark.parametrize("model", MODELS)
def test_what_falls_is_not_at_rest(model):
    dem.base((6, 2, 0.2), stone(0.7))
    dem.block((0.4, 1, 1), O.bodies[0].mat, center=(0, 0, 0.6))
    O.engines = quiet_engines(model=model)
    O.step()
    assert not dem.at_rest()


@pytest.mark.parametrize("model", MODELS)
def test_a_run_ends_where_yade_is_told_to_stop(model):
    rocks(model)
    O.stopAtIter = 30
    dem.run(1.0)
    assert O.iter == 30
    dem.run(5 * O.dt)  # it goes on
    assert O.iter in (35, 36)
    O.stopAtTime = O.time + 10.5 * O.dt
    steps = O.iter
    dem.run(1.0)
    assert O.iter == steps + 11
    O.engines = O.engines + [PyRunner(command="O.pause() if O.iter >= 80 else None", iterPeriod=1)]
    dem.run(1.0)
    assert 80 <= O.iter <= 82 and not O.running
    O.engines = O.engines[:-1]
    dem.run(20 * O.dt)
    assert O.iter > 90


def test_engines_that_were_not_given_are_missed():
    """dem.engines() returns them; YADE's own are in O.engines until a script sets them."""
    block = rocks("planar")
    own = O.engines
    for engines in (own[:1], [*own[:1], NewtonIntegrator()]):
        O.engines = engines
        refuses(lambda: dem.run(0.1), "O.engines has no MoreauJeanIntegrator and no RockingJointEngine: set O.engines = dem.engines(...)")
    assert O.iter == 0 and block.vel.norm() == 0
