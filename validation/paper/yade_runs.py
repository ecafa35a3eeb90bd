"""Runs cases in YADE, one scene after the other: yade -j1 -n -x yade_runs.py '[{...}, ...]' (fields of cases.Case),
with this folder on PYTHONPATH.

Prints one line a case, 'RESULT {json}': what the simulation did, measured. Angles are sampled during the run, each peak is refined
by the parabola through its three highest samples; impacts are those that the joint engine reports. No theory is used."""
import json
import math
import sys
import time

from cases import GRAVITY, Case
from masonry import dem
from yade import O, PyRunner

DEPTH = 1.0         # m, through the plane of rocking; nothing depends on it
DENSITY = 2000      # kg/m^3; nothing depends on it
SAMPLES = 200       # of the angle, in a half cycle of the expected length
TIME_LIMIT = 200.0  # s of simulated time; no run should come near


class Recorder:
    """Samples the angle; pauses the run at the end of the train or when the block has passed its critical angle."""

    def __init__(self, block, case):
        self.block, self.case = block, case
        self.critical = math.atan(1 / case.slenderness)
        self.joints = next(e for e in O.engines if type(e).__name__ == "RockingJointEngine")
        self.times, self.angles = [], []
        self.overturned = False

    def sample(self):
        self.times.append(O.time)
        self.angles.append(dem.angle(self.block))
        self.overturned = abs(self.angles[-1]) > self.critical
        if self.overturned or len(self.joints.impactTimes) >= self.case.half_cycles or O.time > TIME_LIMIT:
            O.pause()

    def peaks(self, impact_times):
        """Largest |angle| between the start and each impact in turn."""
        result, start = [], 0
        for end in impact_times:
            stop = start
            while stop < len(self.times) and self.times[stop] < end:
                stop += 1
            top = max(range(start, stop), key=lambda i: abs(self.angles[i]))
            result.append(self._refined(top))
            start = stop
        return result

    def thinned(self):
        """(time, angle), a few tens a cycle."""
        return list(zip(self.times, self.angles))[::SAMPLES // 20]

    def _refined(self, i):
        before, at, after = (abs(self.angles[j]) for j in (i - 1, i, i + 1))
        return at + (after - before) ** 2 / (8 * (2 * at - before - after))


def simulate(case):
    global recorder
    O.reset()
    stone = dem.BlockMat(density=DENSITY, frictionAngle=0.6, restitution=case.restitution, noSlip=True)
    base = dem.base((4 * case.two_b, 2 * DEPTH, 0.2), stone)
    block = dem.block((case.two_b, DEPTH, case.two_b * case.slenderness), stone, on=base)
    shape = dict(shape="rectangular", duration=case.duration) if case.duration else {}
    train = dem.PulseTrainEngine(ids=[base], impulse=case.impulse, resonantBlock=block, halfCycles=case.half_cycles, **shape)
    engines = dem.engines(train, penetration=case.penetration)
    first_half_cycle = 2 * case.slenderness * case.impulse / GRAVITY
    period = max(1, int(first_half_cycle / (1 - case.restitution) / SAMPLES / O.dt))
    O.engines = engines + [PyRunner(command="recorder.sample()", iterPeriod=period)]
    recorder = Recorder(block, case)
    clock = time.process_time()
    O.run(int(TIME_LIMIT / O.dt), True)
    impacts = dem.impacts()[:case.half_cycles]
    return dict(key=case.key, overturn_half_cycle=len(impacts) + 1 if recorder.overturned else 0,
                impact_times=impacts["time"].tolist(), velocities=impacts["velocity"].tolist(),
                peaks=recorder.peaks(impacts["time"]), restitutions=impacts["restitution"].tolist(),
                base_displacement=train.residualDisplacement, history=recorder.thinned() if case.duration else [],
                simulated_s=O.time, cpu_s=time.process_time() - clock, time_step=O.dt)


for fields in json.loads(sys.argv[1]):
    print("RESULT", json.dumps(simulate(Case(**fields))), flush=True)
