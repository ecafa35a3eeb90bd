"""The bits of shaken convex blocks by both methods, as one number that two processes can compare; run as a script it prints it."""

import hashlib

import numpy as np
from masonry import dem
from rocking_scene import bits, rigid_engines, steps, stone
from yade import O


def convex_hash():
    """A wall of rubble and a column of drums, which are structures of their own, on one shaken base."""
    whole = b""
    for method in ("localised", "wall"):
        O.reset()
        material = stone(0.3, noSlip=False, frictionAngle=0.6)
        base = dem.base((8, 3, 0.2), material)
        dem.rubble_wall(1.5, 1.0, 0.4, 0.4, material, on=base, seed=3)
        dem.column(3, 0.3, 0.5, material, on=base, sides=6, at=(2.5, 0))
        samples = list(9 * np.sin(2 * np.pi * 2 * 0.01 * np.arange(100)))
        O.engines = rigid_engines(dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01, direction=(0.8, 0.6, 0)), method=method)
        O.engines[-1].wallsOnly = method == "wall"
        steps(120)
        whole += bits().tobytes()
    return hashlib.sha256(whole).hexdigest()


if __name__ == "__main__":
    print("hash", convex_hash(), flush=True)  # the exit does not
