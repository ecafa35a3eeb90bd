"""A wall of real bricks with a door and a window, shaken in three directions: CPU time and where its top goes. From the project's root, after a build:

    PYTHONPATH=build/python OMP_WAIT_POLICY=passive yade -j1 -n -x validation/walls/shaking/bricks.py
"""
import math
import time

import numpy as np
from masonry import dem
from yade import O

import masonry

SECONDS, G = 0.25, 9.81
stone = dem.BlockMat(density=1800, frictionAngle=math.atan(0.6))
base = dem.base((6, 2, 0.2), stone)
ids = dem.wall(length=4, height=2.695, size=(0.25, 0.12, 0.055), material=stone, on=base, openings=[(0.75, 0, 1.0, 2.09), (2.5, 0.88, 0.75, 1.1)])
t = np.arange(0, 2, 1e-3)
motions = [dem.record_motion(masonry.Record(1e-3, g * G * np.minimum(1, t / 0.1) * np.sin(2 * np.pi * (2 + 0.7 * k) * t + k)), ids=[base], direction=direction)
           for k, (g, direction) in enumerate(((0.5, (1, 0, 0)), (0.5, (0, 1, 0)), (0.25, (0, 0, 1))))]
O.engines = dem.engines(motions, dt=1e-3, model="spatial", method="wall")
O.step()  # the first step finds the forces


def tops():
    return np.mean([O.bodies[i].state.pos - O.bodies[base].state.pos for i in ids if O.bodies[i].state.refPos[2] > 2.6], axis=0)


start, begin = tops(), time.process_time()
for _ in range(round(SECONDS / O.dt)):
    O.step()
cpu, moved = (time.process_time() - begin) / SECONDS, 1e3 * (tops() - start)
print(f"{len(ids)} bricks: {cpu:.1f} CPU s per s; the top has moved by {moved[0]:.1f} mm along, {moved[1]:.1f} mm across; failures {O.engines[-1].failures}")
