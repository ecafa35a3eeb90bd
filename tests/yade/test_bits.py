"""The same bits: in one run or two, through files and memory, with one thread or two; bodies that leave, objects that are copied."""

import copy
import hashlib
import os
import pickle
import subprocess
import sys
import tempfile

import numpy as np
from masonry import dem
from rocking_scene import bits, one_block, quiet_engines, stone
from yade import O


def wall_hash():
    """A pulse under a running-bond wall of seven blocks: many joints, friction, several impacts in one step."""
    O.reset()
    material = stone(0.7, noSlip=False, frictionAngle=0.6)
    base = dem.base((2, 1, 0.2), material)
    dem.wall(3, 2, (0.4, 0.2, 0.175), material, on=base)
    O.engines = quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.3, times=[0, 0.1], assembly=True), penetration=1e-4)
    O.run(3000, True)
    return hashlib.sha256(bits()).hexdigest()


if os.environ.get("MASONRY_WALL_HASH"):
    print("hash", wall_hash(), flush=True)  # the exit does not
    O.exitNoBacktrace()


def pulsed():
    base, block, _ = one_block(5, restitution=0.7)
    O.engines = quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.12, resonantBlock=block, halfCycles=6))


def run_to(step):
    O.run(step - O.iter, True)


# Steps right before, at and after an impact, and in the middle of a half cycle.
pulsed()
while len(dem.impacts()) < 2:
    O.step()
impact = O.iter
stops = [impact - 1, impact, impact + 1, impact + 700]
run_to(impact + 5000)
wanted, seen = bits(), dem.impacts()
assert len(seen) >= 3

pulsed()
for stop in stops:
    run_to(stop)
run_to(impact + 5000)
assert np.array_equal(bits(), wanted), "runs in pieces"

with tempfile.TemporaryDirectory() as folder:
    for ending in ("xml", "yade", "memory"):
        for stop in stops:
            pulsed()
            run_to(stop)
            if ending == "memory":
                O.saveTmp()
                O.reset()
                O.loadTmp()
            else:
                path = os.path.join(folder, "scene." + ending)
                O.save(path)
                O.reset()
                O.load(path)
            run_to(impact + 5000)
            assert np.array_equal(bits(), wanted), (ending, stop - impact)

# The critical time step of the joints is known after loading, before the first step, too.
def critical_step():
    return next(e for e in O.engines if isinstance(e, dem.RockingJointEngine)).criticalTimeStep()


pulsed()
run_to(impact)
known = critical_step()
O.saveTmp()
O.loadTmp()
assert np.isclose(critical_step(), known, rtol=1e-6), (critical_step(), known)

# Any number of threads; here, after other scenes, one.
own = wall_hash()
output = subprocess.run(["yade", "-j2", "-n", "-x", os.path.abspath(sys.argv[0])], env={**os.environ, "MASONRY_WALL_HASH": "1"},
                        capture_output=True, text=True, timeout=200).stdout
assert f"hash {own}" in output, (own, output[-300:])

# A block that is taken away while it rocks leaves the others as if it had never been there (but for the order of sums).
O.reset()
material = stone(0.7)
base = dem.base((6, 1, 0.2), material)
left = dem.block((0.3, 0.3, 0.9), material, center=(-1, 0, 0.45))
right = dem.block((0.3, 0.3, 0.9), material, center=(1, 0, 0.45))
for id in (left, right):
    dem.tilt(id, 0.2)
O.engines = quiet_engines()
O.run(1000, True)
O.bodies.erase(right)
O.run(5000, True)
alone = tuple(O.bodies[left].state.pos)
assert all(right not in (i.id1, i.id2) for i in O.interactions if i.isReal)
O.reset()
material = stone(0.7)
base = dem.base((6, 1, 0.2), material)
left = dem.block((0.3, 0.3, 0.9), material, center=(-1, 0, 0.45))
dem.tilt(left, 0.2)
O.engines = quiet_engines()
O.run(6000, True)
assert np.allclose(O.bodies[left].state.pos, alone, rtol=0, atol=1e-10)

# What a scene holds can be copied and pickled, and keeps its values.
for thing in (*O.engines, *(i.phys for i in O.interactions), *(i.geom for i in O.interactions)):
    for twin in (copy.deepcopy(thing), pickle.loads(pickle.dumps(thing))):
        for name, value in thing.dict().items():
            if isinstance(value, (int, float, str)) or (isinstance(value, list) and value and isinstance(value[0], (int, float))):
                assert np.array_equal(getattr(twin, name), value, equal_nan=not isinstance(value, str)), (type(thing).__name__, name)
