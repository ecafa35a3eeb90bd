"""dem.run(): to the second asked for or the end of the motion, with the bits of O.step(); what goes wrong is raised; reports know how much was run."""
import math

import numpy as np
import pytest
from masonry import dem, results
from rocking_scene import refuses, rigid_engines
from yade import O, Vector3

import masonry

RECORD = masonry.Record(0.01, 2.0 * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01)))


def shaken(start=0.0, model="auto"):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7))
    base = dem.base((2, 1, 0.2), stone)
    block = dem.block((0.4, 0.4, 1.0), stone, on=base)
    motion = dem.record_motion(RECORD, ids=[base], start=start)
    recorder = dem.WallRecorder(virtPeriod=0.05)
    O.engines = rigid_engines(motion, model=model, recorder=recorder)
    return block, motion, recorder


def ends_at(time):
    """To the step."""
    return time - 1e-3 * O.dt <= O.time < time + O.dt


@pytest.mark.parametrize("model", ("planar", "compliant"))
def test_to_a_second_and_to_the_end_of_a_motion(model):
    """With the bits of O.step()."""
    block, motion, recorder = shaken(model=model)
    assert motion.end == 1.0
    dem.run(0.3)
    assert ends_at(0.3)
    steps = O.iter
    dem.run(until=motion)
    assert ends_at(1.0)
    total, there = O.iter, np.array(O.bodies[block].state.pos)
    shaken(model=model)
    for _ in range(total):
        O.step()
    assert (np.array(O.bodies[block].state.pos) == there).all() and 0 < steps < total


def test_to_the_end_of_a_motion_that_begins_later():
    _, motion, _ = shaken(start=0.25)
    assert motion.end == 1.25
    dem.run(until=[motion])
    assert ends_at(1.25)
    refuses(lambda: dem.run(until=motion), "over at 1.25 s")


@pytest.mark.parametrize("options, end", (
    (dict(times=[0, 0.4], start=1), 1.4), (dict(times=[0, 0.4], shape="half-sine", duration=0.1), 0.5), (dict(resonantBlock=1, halfCycles=2), math.inf),
    (dict(resonantBlock=1), math.inf),
))
def test_ends_of_pulse_trains(options, end):
    shaken()
    train = dem.PulseTrainEngine(ids=[0], impulse=0.1, **options)
    assert train.end == end
    if end == math.inf:
        refuses(lambda: dem.run(until=train), "not known")


def test_a_motion_that_moves_nothing():
    """It is refused; one that the integrator was given later is not."""
    shaken()
    later = dem.record_motion(RECORD, ids=[0])
    refuses(lambda: dem.run(until=later), "until: this RecordMotionEngine of body 0 moves nothing: give it to dem.engines(motion=...)")
    O.engines[-1].motions = [later]
    dem.run(until=later)
    assert ends_at(1.0)


def test_a_motion_of_a_loaded_scene(tmp_path):
    shaken()
    O.save(str(tmp_path / "scene.yade.gz"))
    O.load(str(tmp_path / "scene.yade.gz"))
    dem.run(until=O.engines[-1].motions)
    assert ends_at(1.0)


def test_a_resonant_train_ends_with_its_last_pulse():
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.9, noSlip=True)
    base = dem.base((2, 1, 0.2), stone)
    train = dem.PulseTrainEngine(ids=[base], impulse=0.1, resonantBlock=dem.block((0.4, 0.4, 1.0), stone, on=base), halfCycles=2)
    O.engines = dem.engines(train)
    dem.run(3)
    assert len(train.pulseTimes) == 3 and train.end == train.pulseTimes[-1] < O.time


def test_what_goes_wrong_is_raised():
    _, motion, recorder = shaken()
    for arguments in ({}, {"seconds": 1, "until": motion}):
        refuses(lambda: dem.run(**arguments), "give one of the two")
    for seconds in (0, -1, math.nan, math.inf, "1", True):
        refuses(lambda: dem.run(seconds), "seconds")
    for until in ([], 3, [None], recorder):
        refuses(lambda: dem.run(until=until), "until")


def test_what_goes_wrong_in_a_run_is_raised():
    block, _, _ = shaken()
    O.bodies[block].state.vel = Vector3(math.nan, 0, 0)
    refuses(lambda: dem.run(0.1), "state.vel")
    shaken()
    O.dt = 10
    refuses(lambda: dem.run(30), "O.dt = 10 s is not allowed", kind=RuntimeError)
    O.reset()
    refuses(lambda: dem.run(1), "O.engines is empty")


# Reports say how much of the motion has been run.


def test_a_run_that_is_saved_before_its_end(tmp_path):
    _, motion, recorder = shaken()
    dem.run(0.5)
    report = results.collapse(dem.wall_history(recorder))
    assert report.verdict == "unfinished" and "0.5 of 1 s" in report.run.replace(f"{O.time:.4g}", "0.5") and "stands" not in str(report)
    O.save(str(tmp_path / "half.yade.gz"))
    O.load(str(tmp_path / "half.yade.gz"), quiet=True)
    recorder = next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder))
    dem.run(until=O.engines[-1].motions)
    history = dem.wall_history(recorder)
    report = results.collapse(history)
    assert report.verdict == "stands" and history.motion.tolist() == [0, 1] and history.end == O.time > history.time[-1]


def test_a_motion_that_was_given_up_before_its_end():
    """It was no whole one."""
    _, motion, recorder = shaken()
    dem.run(0.5)
    O.engines = rigid_engines(recorder=recorder)
    dem.run(0.2)
    assert results.collapse(dem.wall_history(recorder)).verdict == "unfinished"
    O.engines = rigid_engines()
    dem.run(0.1)
    assert dem.wall_history(recorder).end == recorder.times[-1]


def test_a_run_without_a_motion():
    """It is whole, whatever its length."""
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.9, noSlip=True)
    dem.block((0.4, 0.4, 1.0), stone, on=dem.base((2, 1, 0.2), stone))
    recorder = dem.WallRecorder(virtPeriod=0.05)
    O.engines = dem.engines(recorder=recorder)
    dem.run(0.2)
    assert results.collapse(dem.wall_history(recorder)).verdict == "stands"


def test_to_a_condition():
    """A block that is let go comes to rest long before the minute is over; the run ends within the time between two looks after it does."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.6)
    block = dem.block((0.4, 1.0, 1.0), stone, on=dem.base((4, 2, 0.2), stone))
    dem.tilt(block, 0.1)
    O.engines = rigid_engines()
    assert dem.run(60, until=dem.at_rest) is True
    assert dem.at_rest() and 0.1 < O.time < 5
    there = O.iter
    assert dem.run(60, until=dem.at_rest) is True and O.iter == there  # it is at rest already
    assert dem.run(0.1, until=lambda: False) is False and O.iter > there
    assert dem.run(0.1) is False


def test_to_the_first_block_that_overturns():
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    block = dem.block((0.2, 1.0, 1.0), stone, on=dem.base((4, 2, 0.2), stone))
    dem.tilt(block, math.atan(0.2) - 0.01)
    O.engines = rigid_engines()
    O.bodies[block].state.angVel = Vector3(0, 1, 0)
    seen = []
    assert dem.run(2, until=lambda: seen.append(O.time) or dem.overturned()) is True
    assert dem.overturned() == [block] and abs(dem.angle(block)) < math.atan(0.2) + 0.1
    assert all(0.01 <= b - a < 0.01 + O.dt for a, b in zip(seen[1:-2], seen[2:-1]))


def test_a_condition_needs_a_limit():
    shaken()
    refuses(lambda: dem.run(until=dem.at_rest), "seconds = None: must say how long the run may wait")


def test_to_a_collapse():
    """Three slender blocks, of which two are let go beyond their critical angles: dem.collapsed counts what results.fallen counts in the history, also after loading."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0)
    base = dem.base((8, 2, 0.2), stone)
    ids = [dem.block((0.2, 1.0, 1.0), stone, on=base, at=(x, 0)) for x in (-3, 0, 3)]
    for id, lean in zip(ids, (0.0, math.atan(0.2) + 0.02, -math.atan(0.2) - 0.002)):
        dem.tilt(id, lean)
    recorder = dem.WallRecorder(virtPeriod=0.01)
    O.engines = rigid_engines(recorder=recorder)
    assert dem.collapsed() is False  # before the first step
    assert dem.run(5, until=lambda: dem.collapsed(2)) is True and O.time < 5
    for _ in range(2):
        recorder = next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder))
        dem.run(1)
        fallen = int(results.fallen(dem.wall_history(recorder))[-1].sum())
        assert fallen == 2 and [dem.collapsed(k) for k in (1, 2, 3)] == [True, True, False]
        O.saveTmp()
        O.loadTmp(quiet=True)
