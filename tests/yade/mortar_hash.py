"""The bits of a mortared wall that cracks, as one number that processes with other numbers of threads can compare; run as a script it prints it."""

import hashlib

import masonry
import numpy as np
from masonry import dem
from mortar_scene import brick_material, eindhoven
from rocking_scene import bits, joint_engine, quiet_engines
from yade import O


def wall(peak=100.0, **changes):
    """A running-bond wall of weak mortar on a base that shakes it across, with this peak acceleration in m/s^2. Returns the ids of the wall."""
    O.reset()
    weak = eindhoven(tensileStrength=0.05e6, fractureEnergy=4, cohesion=0.07e6, shearFractureEnergy=28, normalStiffness=8.2e9, shearStiffness=3.6e9)
    material = brick_material(dem.scatter(weak, cov=0.2, seed=3))
    base = dem.base((2, 1, 0.2), material)
    ids = dem.wall(4, 2, (0.21, 0.1, 0.052), material, on=base)
    sine = masonry.Record(1e-3, peak * np.sin(2 * np.pi * 10 * np.arange(200) * 1e-3))
    O.engines = quiet_engines(dem.record_motion(sine, [base], direction=(0, 1, 0)), model="auto", **changes)
    return ids


def mortar_hash(steps=1500):
    wall()
    O.run(steps, True)
    state = np.array(joint_engine().bondedState)
    state = np.where(np.isnan(state), -1, state)
    return hashlib.sha256(np.concatenate([bits(), state.view(np.int64)])).hexdigest()


if __name__ == "__main__":
    print("hash", mortar_hash(), flush=True)  # the exit does not
