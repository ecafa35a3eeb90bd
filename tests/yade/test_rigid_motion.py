"""Rigid blocks on a base that moves: resonant and scheduled pulses, finite pulses, records, and a base with a velocity of its own."""

import numpy as np
import pytest
from driven_block import IMPULSE, compare_record, compare_schedules, compare_shapes, keep_place
from masonry import dem
from rocking_scene import Balance, Samples, one_block, quiet_engines, refuses, refuses_to_run, rigid_engines
from yade import O, Vector3

import masonry


TIMES = [0.0, 0.15037, 0.5]  # the second not at a step's end


def engines(motion, **options):
    return rigid_engines(motion, dt=1e-3, **options)


@pytest.mark.parametrize("model", ("auto", "spatial"))
def test_resonant(model):
    """Eq. 7's velocities; times and base displacement of the exact history; a base that ends at rest."""
    n = 20
    base, id, block = one_block(5, restitution=0.7)
    train = dem.PulseTrainEngine(ids=[base], impulse=IMPULSE, resonantBlock=id, halfCycles=n)
    O.engines = engines(train, model=model)
    angles = Samples(lambda: dem.angle(id), 1)
    balance = Balance()
    exact = masonry.simulate(block, masonry.PulseTrain(IMPULSE, half_cycles=n), restitution=0.7, half_cycles=n)
    O.run(int(1.001 * exact.impact_times[-1] / O.dt), True)
    impacts = dem.impacts()
    wanted = masonry.closed_form.pulse_sequence(block, IMPULSE, 0.7, n).angular_velocity
    velocity = np.max(np.abs(impacts["velocity"][:n] / wanted - 1))
    times = np.max(np.abs(impacts["time"][:n] / exact.impact_times - 1))
    peaks = np.max(np.abs(angles.peaks()[:n] / np.abs(exact.peak_angles[:n]) - 1))
    print(f"resonant, {O.engines[1].chosenModel}: velocities {velocity:.1e}, times {times:.1e}, peaks {peaks:.1e}, energy {balance.error() / dem.energy()['baseWork']:.1e}")
    # Peaks as asked of the integrator. Late half cycles have nearly the same length: times inherit the error of the peaks.
    assert peaks <= 3e-6 and velocity <= 3e-6 and times <= 3e-6
    assert np.array_equal(train.pulseJumps, IMPULSE * np.array([1] + [2 * (-1) ** k for k in range(1, n)] + [1]))
    assert train.pulseTimes == [0.0] + list(impacts["time"][:n])
    rest = O.bodies[base].state.pos
    assert O.bodies[base].state.vel.norm() == 0  # sums of I, -2I, 2I, ... I: exact in binary
    assert abs(rest[0] / exact.base_displacement - 1) <= 3e-5  # a difference of displacements ten times as large
    O.run(100, True)
    assert (O.bodies[base].state.pos - rest).norm() < 1e-13  # round-off of a sum of 20 terms I t
    assert abs(balance.error()) <= 1e-5 * dem.energy()["baseWork"]


def test_schedules():
    compare_schedules(engines, TIMES, 1e-5)


def test_shapes():
    """An acceleration that is constant between the ends of a pulse, inside steps too, adds nothing to the error of the integrator, that of resonant()."""
    compare_shapes(engines, TIMES, 1e-4, rectangular=3e-6)


def test_a_record():
    compare_record(engines, 1e-4)


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_base_keeps_its_place(method):
    keep_place(lambda motion: engines(motion, method=method))


def test_a_base_that_moves_by_itself():
    """A base that moves by itself carries its block along: nobody accelerates."""
    base, id, block = one_block(5)
    for body in O.bodies:
        body.state.vel = (0.1, 0, 0)
    O.engines = rigid_engines(dt=1e-3)
    O.run(1000, True)
    for body in O.bodies:
        assert abs(body.state.pos[0] - 0.1) < 1e-12 and abs(body.state.vel[0] - 0.1) < 1e-12, body.state.pos


@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_a_base_that_turns(model):
    """On a base that turns, an impact takes away (1 - C^2) of what the block has relative to it: of the turning about the pivot, (4/3) m R^2 its
    moment. That is of the impulse alone, to round-off; the restitution is met to 1e-10."""
    base, id, block = one_block(5, restitution=0.6)
    dem.tilt(id, 0.3 * block.critical_angle)
    O.bodies[base].state.angVel = (0, 0.1, 0)
    O.engines = engines(None, model=model)
    while len(dem.impacts()) == 0:
        O.step()
    first = dem.impacts()[0]
    lost = 2 / 3 * O.bodies[id].state.mass * block.radius**2 * (1 - 0.6**2) * first["velocity"] ** 2
    print(f"{model}, on a base that turns: energy lost {first['energy_lost'] / lost - 1:.1e}")
    assert abs(first["energy_lost"] / lost - 1) < 1e-8, first


def test_two_blocks_that_land_at_once():
    """Two blocks alike that a pulse sets rocking land at the same instant: what they lose is listed once. The pulse, from rest and about pivots that
    hold, loses nothing, and a smooth step no more than its residual: of 20 J far below 1e-6."""
    base, id, block = one_block(5, restitution=0.7)
    beside = dem.block((0.6, 1, 3), O.bodies[id].mat, center=(3, 0, 1.5))
    O.engines = engines(dem.PulseTrainEngine(ids=[base], impulse=IMPULSE, times=[0]))
    while len(dem.impacts()) == 0:
        O.step()
    listed = dem.impacts()
    print(f"two blocks that land at once: {listed['energy_lost']} J, dissipated {dem.energy()['impactDissip']} J")
    assert set(listed["body"]) == {id, beside} and listed["time"][0] == listed["time"][1], listed
    assert abs(listed["energy_lost"].sum() / dem.energy()["impactDissip"] - 1) < 1e-6, (listed, dem.energy())


# Motions that a script changes on the way.


def pushed(method="localised", **options):
    """A block, or one of a wall, on a base that accelerates by 1 m/s^2 for 2 s: (base, block, integrator), after 1 s."""
    base, block, _ = one_block(2)
    if method == "wall":
        O.bodies.erase(block)
        block = dem.wall(6, 4, (0.4, 0.2, 0.2), O.bodies[base].mat, on=base)[-1]
    O.engines = engines(dem.RecordMotionEngine(ids=[base], samples=[1.0] * 201, interval=0.01), method=method, **options)
    O.run(1000, True)
    assert abs(O.bodies[base].state.pos[0] - 0.5) < 1e-9
    return O.bodies[base].state, O.bodies[block].state, O.engines[-1]


def record(base, value, **attributes):
    return dem.RecordMotionEngine(ids=[base], samples=[value] * 201, interval=0.01, **attributes)


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_motion_that_is_taken_out(method):
    """The base goes on as fast as it was, and so do what stands on it and the energies."""
    base, block, integrator = pushed(method)
    integrator.motions = []
    O.step()
    work = integrator.baseWork
    O.run(999, True)
    assert abs(base.vel[0] - 1) < 1e-9 and abs(base.pos[0] - 1.5) < 1e-9, (base.vel, base.pos)
    assert abs(block.displ()[0] - base.displ()[0]) < 1e-6 and abs(integrator.baseWork - work) < 1e-4 * work


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_motion_that_is_dead(method):
    """As if it were taken out; one that was from the beginning moves nothing, and another may move its base."""
    base, block, integrator = pushed(method)
    integrator.motions[0].dead = True
    O.run(1000, True)
    assert abs(base.vel[0] - 1) < 1e-9 and abs(base.pos[0] - 1.5) < 1e-9, (base.vel, base.pos)
    O.engines = engines(integrator.motions, method=method)  # which a script may make anew
    O.run(100, True)
    assert abs(base.vel[0] - 1) < 1e-9
    O.engines[-1].motions[0].dead = False
    refuses_to_run("RecordMotionEngine.start = 0 s has passed", "start=O.time")
    base, _, _ = one_block(2)
    O.engines = engines([record(base, 1.0, dead=True), record(base, -1.0)], method=method)
    O.run(1000, True)
    assert abs(O.bodies[base].state.pos[0] + 0.5) < 1e-9


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_motion_in_the_place_of_another(method):
    """It counts from where its body is when it begins."""
    base, block, integrator = pushed(method)
    base.vel, gone = (0, 0, 0), integrator.motions[0]
    integrator.motions = [record(0, -1.0, start=O.time)]
    O.run(1000, True)
    assert abs(base.pos[0] - 0) < 1e-9 and abs(base.vel[0] + 1) < 1e-9, (base.pos, base.vel)
    gone.scale = 2  # moves nothing any more
    gone.start = O.time
    integrator.motions = [gone]
    O.run(500, True)
    assert abs(base.pos[0] - 0.25) < 1e-9, base.pos
    assert integrator.chosenModel == "planar"
    integrator.motions = []
    O.run(1, True)
    at = base.pos[0]
    integrator.motions = [record(0, 1.0, direction=(0, 1, 0), start=O.time)]
    O.run(500, True)
    assert integrator.chosenModel == "spatial" and abs(base.pos[1] - 0.125) < 1e-9 and abs(base.pos[0] - at) < 2e-3


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_motion_beside_another(method):
    base, block, integrator = pushed(method)
    other = dem.base((1, 1, 0.2), O.bodies[0].mat)
    O.bodies[other].state.pos += Vector3(50, 0, 0)
    integrator.motions = integrator.motions + [record(other, 0.5, start=O.time)]
    O.run(500, True)
    assert abs(O.bodies[other].state.pos[0] - 50.0625) < 1e-9 and abs(base.pos[0] - 1.125) < 1e-9


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_motion_that_has_begun(method):
    """It goes on as it is; the run too."""
    base, block, integrator = pushed(method)
    motion = integrator.motions[0]
    for name, bad in (("scale", 3), ("samples", [3.0] * 201), ("start", 0.5), ("interval", 0.02), ("baseline", "linear"), ("direction", (0, 1, 0))):
        before = getattr(motion, name)
        refuses(lambda: setattr(motion, name, bad), f"RecordMotionEngine.{name} = ", str(bad)[:10] if name != "direction" else "0,1,0", "once the motion has begun", "start=O.time")
        assert getattr(motion, name) == before
    motion.scale = 1.0  # as it was
    other = dem.base((1, 1, 0.2), O.bodies[0].mat)
    O.bodies[other].state.pos += Vector3(50, 0, 0)
    motion.ids = [0, other]
    refuses_to_run(f"RecordMotionEngine.ids = [0, {other}]", "once the motion has begun with [0]")
    motion.ids = [0]
    integrator.motions = [motion, record(0, 1.0, direction=(0, 0, 1))]
    refuses_to_run("RecordMotionEngine.start = 0 s has passed", "start=O.time")
    integrator.motions = [motion, record(0, 1.0, start=O.time)]
    refuses_to_run("RecordMotionEngine.direction = ", "beside a RecordMotionEngine", "perpendicular")
    integrator.motions = [motion]
    O.bodies[0].dynamic = True
    refuses_to_run("Body 0 is free, and in the ids of a motion", "O.bodies[0].dynamic = False")
    O.bodies[0].dynamic = False
    O.run(500, True)
    assert abs(base.pos[0] - 1.125) < 1e-9 and integrator.failures == 0


def test_a_motion_that_waits_for_its_time():
    """It may still be changed, finite pulses among it."""
    base, block, _ = one_block(2)
    train = dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0, 1], shape="half-sine", duration=0.1, singleKeeps="duration", start=1e9)
    O.engines = engines(train)
    O.run(500, True)
    train.start = O.time
    train.impulse = 0.2
    train.direction = (-1, 0, 0)
    O.run(500, True)
    assert abs(O.bodies[base].state.vel[0] + 0.2) < 1e-9 and abs(O.bodies[base].state.pos[0] + 0.2 * 0.45) < 1e-9
    for name, bad in (("times", [0, 0.7]), ("impulse", 1), ("shape", "rectangular"), ("duration", 0.2)):
        refuses(lambda: setattr(train, name, bad), f"PulseTrainEngine.{name} = ", "once the motion has begun")


@pytest.mark.parametrize("model", ("planar", "compliant"))
def test_a_start_that_has_passed(model):
    """Before the first step of the run and on the way; new engines with a motion that goes on."""
    base, block, _ = one_block(2)
    refuses(lambda: quiet_engines(record(base, 1.0, start=-1), model=model), "RecordMotionEngine.start = -1 s has passed", "O.time = 0 s", "start=O.time")
    O.engines = quiet_engines(model=model)
    O.run(95, True)
    refuses(lambda: quiet_engines(record(base, 1.0), model=model), "RecordMotionEngine.start = 0 s has passed", "start=O.time")
    refuses(lambda: quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0]), model=model), "PulseTrainEngine.start = 0 s has passed")
    motion, begin = record(base, 1.0, start=O.time), O.time
    O.engines = quiet_engines(motion, model=model)
    O.run(100, True)
    O.engines = quiet_engines(motion, model=model)
    O.run(100, True)
    assert abs(O.bodies[base].state.pos[0] - 0.5 * (O.time - begin) ** 2) < 1e-9
    refuses(lambda: setattr(motion, "scale", 2), "RecordMotionEngine.scale = 2")
    O.engines = quiet_engines(model=model)
    O.run(100, True)
    refuses(lambda: quiet_engines(motion, model=model), "RecordMotionEngine", f"would put body {base}", "start=O.time")
    # In another scene it is as new.
    base, block, _ = one_block(2)
    motion.scale, motion.start = 2, 0
    O.engines = quiet_engines(motion, model=model)
    O.run(100, True)
    assert abs(O.bodies[base].state.pos[0] - O.time**2) < 1e-9
