"""What the YADE scripts here share: one scene run at several settings, timed, its history written.

Prints one line a run, as the C++ drivers do: solver,settings,time step,CPU seconds per simulated second,file.
"""
import math
import statistics
import sys
import time

import measures
import numpy as np
from yade import O, Quaternion, Vector3
from yade.wrapper import PyRunner

SAMPLE = 5e-5  # s; histories are sampled at least this finely, or at every step
FOLDER = sys.argv[1]
_written = 0


def start_pose():
    """Position and orientation of the block on its edge x = +half width, turned by the start angle."""
    c, s = math.cos(measures.START_ANGLE), math.sin(measures.START_ANGLE)
    b, a = measures.HALF_WIDTH, measures.HALF_HEIGHT
    return Vector3(b - b * c + a * s, 0, a * c + b * s), Quaternion((0, 1, 0), measures.START_ANGLE)


def angle_about_y(turn):
    return 2 * math.atan2(turn[1], turn[3])


def _run(steps):
    """CPU seconds of so many steps"""
    start = time.process_time()
    O.run(steps, True)
    return time.process_time() - start


def _timed(create, steps):
    """CPU seconds per simulated second. The first step, which sets the engines up, and the call of O.run itself (of one step) are left out."""
    O.reset()
    create()
    O.run(1, True)
    call = statistics.median(_run(1) for _ in range(3))
    return (_run(steps) - call) / ((steps - 1) * O.dt)


def measure(solver, settings, create, cpu_limit=40.0):
    """`create()` fills an empty scene (bodies, engines, O.dt) and returns a function that gives the block's angle. The history is
    recorded in one run and timed in others (the median of five where they are short), which YADE's determinism on one thread allows. A
    run that would take more than `cpu_limit` CPU seconds is cut short: what it shows by then is judged."""
    global _written
    O.reset()
    create()
    O.run(20, True)
    steps = min(round(measures.DURATION / O.dt), round(200 * cpu_limit / _run(200)))

    cpu_per_second = _timed(create, steps)
    if cpu_per_second < 0.1:
        cpu_per_second = statistics.median([cpu_per_second, *(_timed(create, steps) for _ in range(4))])

    O.reset()
    angle, dt = create(), O.dt
    history = [(0.0, angle())]
    O.engines = O.engines + [PyRunner(command="record()", iterPeriod=max(1, round(SAMPLE / dt)), initRun=False)]
    sys.modules["__main__"].record = lambda: history.append((O.time + dt, angle()))
    O.run(steps, True)

    file = f"{FOLDER}/{_written}.f64"
    _written += 1
    np.array(history).tofile(file)
    print(f"{solver},{settings},{dt:.9g},{cpu_per_second:.4g},{file}", flush=True)
