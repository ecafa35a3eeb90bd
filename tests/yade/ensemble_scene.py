"""The scene of test_ensemble: one block of slenderness 4 under a sine whose size is the case's."""

import math

SLENDERNESS, HALF_WIDTH, RESTITUTION = 4, 0.25, 0.8


def record(scale):
    import numpy as np

    import masonry

    return masonry.Record(0.01, scale * 9.81 * np.sin(2 * np.pi * np.arange(0, 1.005, 0.01)), baseline="constant", unit="m/s^2")


def run(case):
    from masonry import dem, results
    from yade import O

    if case["scale"] < 0:
        raise RuntimeError("this case is made to fail")
    motion = record(case["scale"])
    stone = dem.BlockMat(density=2000, restitution=RESTITUTION, noSlip=True)
    base = dem.base((6, 6, 0.2), stone)
    dem.block((2 * HALF_WIDTH, 1, 2 * HALF_WIDTH * SLENDERNESS), stone, on=base)
    recorder = dem.WallRecorder(virtPeriod=0.005)
    O.engines = dem.engines(dem.record_motion(motion, ids=[base]), recorder=recorder)
    O.run(math.ceil(2 / O.dt), True)
    history = dem.wall_history(recorder)
    return {**results.collapse(history).numbers(), "drift": history.drift()}
