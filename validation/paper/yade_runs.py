"""Runs cases in YADE, one scene after the other: yade -j1 -n -x yade_runs.py '[{...}, ...]' (fields of cases.Case),
with this folder on PYTHONPATH.

Prints one line a case, 'RESULT {json}': what the simulation did, measured. A BlockRecorder samples the angle, each peak is that of the
quartic through the five samples around the highest; impacts are those that the engine of the joints reports. No theory is used."""
import json
import math
import sys
import time

import numpy as np
from cases import GRAVITY, Case
from masonry import dem
from yade import O, PyRunner

DENSITY = 2000      # kg/m^3; nothing depends on it
# Of the angle, in a half cycle of the expected length. Near a peak the angle is A cos(pi t/T) at most: the quartic is wrong by less than
# (pi/200)^5/33 = 3e-11 of it.
SAMPLES = 200
WATCHES = 10        # in the same half cycle: is the run over?
TIME_LIMIT = 200.0  # s of simulated time; no run should come near


def watch(block, joints, case):
    """Pauses the run at the end of the train or when the block has passed its critical angle."""
    overturned = abs(dem.angle(block)) > math.atan(1 / case.slenderness)
    if overturned or len(joints.impactTimes) >= case.half_cycles or O.time > TIME_LIMIT:
        O.pause()


def peaks(times, angles, impact_times):
    """Largest |angle| between the start and each impact in turn."""
    ends = np.searchsorted(times, impact_times)
    return [peak(np.abs(angles), start + int(np.argmax(np.abs(angles[start:end])))) for start, end in zip([0, *ends], ends)]


def peak(angles, highest):
    quartic = np.polyfit(range(-2, 3), angles[highest - 2:highest + 3], 4)
    place = min(np.roots(np.polyder(quartic)), key=abs).real
    return float(np.polyval(quartic, place))


def simulate(case):
    O.reset()
    stone = dem.BlockMat(density=DENSITY, frictionAngle=0.6, restitution=case.restitution, noSlip=True)
    # Square in plan: the choices of dem.engines go by the half diagonal of the box (time step) and its smaller width (stiffness).
    base = dem.base((4 * case.two_b, 2 * case.two_b, 0.2), stone)
    block = dem.block((case.two_b, case.two_b, case.two_b * case.slenderness), stone, on=base)
    shape = dict(shape="rectangular", duration=case.duration, singleKeeps="duration") if case.duration else {}
    train = dem.PulseTrainEngine(ids=[base], impulse=case.impulse, resonantBlock=block, halfCycles=case.half_cycles, **shape)
    recorder = dem.BlockRecorder(ids=[block])
    engines = dem.engines(train, model=case.model, recorder=recorder)
    half_cycle = 2 * case.slenderness * case.impulse / GRAVITY / (1 - case.restitution)
    recorder.iterPeriod = max(1, int(half_cycle / SAMPLES / O.dt))
    O.engines = engines + [PyRunner(command="watch(block, joints, case)", iterPeriod=max(1, int(half_cycle / WATCHES / O.dt)))]
    joints = next(e for e in engines if hasattr(e, "impactTimes"))
    globals().update(block=block, joints=joints, case=case)  # where PyRunner looks
    clock = time.process_time()
    O.run(int(TIME_LIMIT / O.dt), True)
    cpu = time.process_time() - clock
    overturned = abs(dem.angle(block)) > math.atan(1 / case.slenderness)
    impacts = dem.impacts()[:case.half_cycles]
    history = dem.history(recorder)
    times, angles = history["time"], history["rotation"][:, 0, 1]
    thinned = np.column_stack([times, angles])[::SAMPLES // 20]
    return dict(key=case.key, overturn_half_cycle=len(impacts) + 1 if overturned else 0,
                impact_times=impacts["time"].tolist(), velocities=impacts["velocity"].tolist(),
                peaks=peaks(times, angles, impacts["time"]), restitutions=impacts["restitution"].tolist(),
                base_displacement=train.residualDisplacement, history=thinned.tolist() if case.duration else [],
                simulated_s=O.time, cpu_s=cpu, time_step=O.dt)


for fields in json.loads(sys.argv[1]):
    print("RESULT", json.dumps(simulate(Case(**fields))), flush=True)
