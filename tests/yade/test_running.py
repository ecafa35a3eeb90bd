"""dem.run(): to the second asked for or the end of the motion, with the bits of O.step(); what goes wrong is raised; reports know how much was run."""
import contextlib
import io
import math
import tempfile

import numpy as np
from yade import O, Vector3

import masonry
from masonry import dem, results

RECORD = masonry.Record(0.01, 2.0 * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01)))


def shaken(start=0.0, model="auto"):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7))
    base = dem.base((2, 1, 0.2), stone)
    block = dem.block((0.4, 0.4, 1.0), stone, on=base)
    motion = dem.record_motion(RECORD, ids=[base], start=start)
    recorder = dem.WallRecorder(virtPeriod=0.05)
    with contextlib.redirect_stdout(io.StringIO()):
        O.engines = dem.engines(motion, model=model, recorder=recorder)
    return block, motion, recorder


def raised(kind, says, call):
    try:
        call()
    except kind as error:
        assert says in str(error), error
        return
    raise AssertionError(f"no {kind.__name__} with {says!r}")


print("run: seconds, and the end of a motion, to the step; the same bits as O.step()")
for model in ("planar", "compliant"):
    block, motion, recorder = shaken(model=model)
    assert motion.end == 1.0
    dem.run(0.3)
    assert 0.3 - 1e-3 * O.dt <= O.time < 0.3 + O.dt
    steps = O.iter
    dem.run(until=motion)
    assert 1.0 - 1e-3 * O.dt <= O.time < 1.0 + O.dt
    total, there = O.iter, np.array(O.bodies[block].state.pos)
    shaken(model=model)
    for _ in range(total):
        O.step()
    assert (np.array(O.bodies[block].state.pos) == there).all() and 0 < steps < total
_, motion, _ = shaken(start=0.25)
assert motion.end == 1.25
dem.run(until=[motion])
assert 1.25 - 1e-3 * O.dt <= O.time < 1.25 + O.dt
raised(ValueError, "over at 1.25 s", lambda: dem.run(until=motion))

print("ends of pulse trains")
for train, end in ((dem.PulseTrainEngine(ids=[0], impulse=0.1, times=[0, 0.4], start=1), 1.4),
                   (dem.PulseTrainEngine(ids=[0], impulse=0.1, times=[0, 0.4], shape="half-sine", duration=0.1), 0.5),
                   (dem.PulseTrainEngine(ids=[0], impulse=0.1, resonantBlock=1, halfCycles=2), math.inf),
                   (dem.PulseTrainEngine(ids=[0], impulse=0.1, resonantBlock=1), math.inf)):
    assert train.end == end
raised(ValueError, "not known", lambda: dem.run(until=train))

print("the end of a motion that moves nothing is refused; one that the integrator was given later is not, nor one of a loaded scene")
shaken()
later = dem.record_motion(RECORD, ids=[0])
raised(ValueError, "until: this RecordMotionEngine of body 0 moves nothing: give it to dem.engines(motion=...)", lambda: dem.run(until=later))
O.engines[-1].motions = [later]
dem.run(until=later)
assert 1.0 - 1e-3 * O.dt <= O.time < 1.0 + O.dt
with tempfile.NamedTemporaryFile(suffix=".yade.gz") as file:
    shaken()
    O.save(file.name)
    O.load(file.name)
    dem.run(until=O.engines[-1].motions)
assert 1.0 - 1e-3 * O.dt <= O.time < 1.0 + O.dt

O.reset()
stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.9, noSlip=True)
base = dem.base((2, 1, 0.2), stone)
train = dem.PulseTrainEngine(ids=[base], impulse=0.1, resonantBlock=dem.block((0.4, 0.4, 1.0), stone, on=base), halfCycles=2)
O.engines = dem.engines(train)
dem.run(3)
assert len(train.pulseTimes) == 3 and train.end == train.pulseTimes[-1] < O.time

print("what goes wrong is raised")
for arguments in ({}, {"seconds": 1, "until": motion}):
    raised(ValueError, "give one of the two", lambda: dem.run(**arguments))
for seconds in (0, -1, math.nan, math.inf, "1", True):
    raised(ValueError, "seconds", lambda: dem.run(seconds))
for until in ([], 3, [None], recorder):
    raised(ValueError, "until", lambda: dem.run(until=until))
block, motion, _ = shaken()
O.bodies[block].state.vel = Vector3(math.nan, 0, 0)
raised(ValueError, "state.vel", lambda: dem.run(0.1))
shaken()
O.dt = 10
raised(RuntimeError, "O.dt = 10 s is not allowed", lambda: dem.run(30))
O.reset()
raised(ValueError, "O.engines is empty", lambda: dem.run(1))

print("reports say how much of the motion has been run, saved and loaded")
_, motion, recorder = shaken()
dem.run(0.5)
report = results.collapse(dem.wall_history(recorder))
assert report.verdict == "unfinished" and "0.5 of 1 s" in report.run.replace(f"{O.time:.4g}", "0.5") and "stands" not in str(report), report
with tempfile.TemporaryDirectory() as folder:
    O.save(folder + "/half.yade.gz")
    O.load(folder + "/half.yade.gz", quiet=True)
recorder = next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder))
dem.run(until=O.engines[-1].motions)
history = dem.wall_history(recorder)
report = results.collapse(history)
assert report.verdict == "stands" and history.motion.tolist() == [0, 1] and history.end == O.time > history.time[-1], report
# A motion that was given up before its end was no whole one.
_, motion, recorder = shaken()
dem.run(0.5)
with contextlib.redirect_stdout(io.StringIO()):
    O.engines = dem.engines(recorder=recorder)
dem.run(0.2)
assert results.collapse(dem.wall_history(recorder)).verdict == "unfinished"
with contextlib.redirect_stdout(io.StringIO()):
    O.engines = dem.engines()
dem.run(0.1)
assert dem.wall_history(recorder).end == recorder.times[-1]
# Without a motion, a run of any length is whole.
O.reset()
base = dem.base((2, 1, 0.2), stone)
dem.block((0.4, 0.4, 1.0), stone, on=base)
recorder = dem.WallRecorder(virtPeriod=0.05)
O.engines = dem.engines(recorder=recorder)
dem.run(0.2)
assert results.collapse(dem.wall_history(recorder)).verdict == "stands"
