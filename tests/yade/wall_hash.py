"""The bits of a wall under pulses, as one number that two processes can compare; run as a script it prints it."""

import hashlib

from masonry import dem
from rocking_scene import bits, quiet_engines, stone
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


if __name__ == "__main__":
    print("hash", wall_hash(), flush=True)  # the exit does not
