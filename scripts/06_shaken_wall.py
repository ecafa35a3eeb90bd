"""A dry wall with a window on a shaken base: does it collapse, how far do its joints open, where does the energy go? Pictures, a film and files
for ParaView go to results/06_shaken_wall. Run with `yade -n -x scripts/06_shaken_wall.py [record.AT2]`; without a file, a sine of two seconds."""
import math
import os
import sys

import numpy as np
from yade import O

import masonry
from masonry import dem, results

if len(sys.argv) > 1:
    record = masonry.read_record(sys.argv[1], baseline="constant")
else:
    time = np.arange(0, 2.005, 0.01)
    record = masonry.Record(0.01, 0.9 * 9.81 * np.sin(2 * np.pi * 1.2 * time) * np.sin(np.pi * time / 2), baseline="constant")

stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))  # natural restitution
base = dem.base((6, 3, 0.2), stone)
dem.wall(courses=10, per_course=5, size=(0.40, 0.20, 0.175), material=stone, on=base, openings=[(0.6, 0.525, 0.8, 0.7)])
motion = dem.record_motion(record, ids=[base])
recorder = dem.WallRecorder(virtPeriod=0.01)  # a sample every 0.01 s of simulated time
O.engines = dem.engines(motion, recorder=recorder)
O.run(math.ceil((record.duration + 1) / O.dt), True)

history = dem.wall_history(recorder)
report = results.collapse(history)
print(report)
joints = results.joints(history)
widest, farthest = joints[joints["opening"].argmax()], joints[joints["slip"].argmax()]
print(f"blocks {widest['id1']} and {widest['id2']} opened most: {1e3 * widest['opening']:.2f} mm at {widest['opening_time']:.3f} s; "
      f"{farthest['id1']} and {farthest['id2']} slid most: {1e3 * farthest['slip']:.2f} mm")
energy = history.energy[-1]
print(f"work of the base {energy['baseWork']:.4g} J; dissipated by friction {energy['frictDissip']:.4g} J, by impacts and numerically "
      f"{energy['impactDissip']:.4g} J")

folder = "results/06_shaken_wall"
os.makedirs(folder, exist_ok=True)
history.save(f"{folder}/wall.npz")  # masonry.results.WallHistory.load() reads it, without YADE
results.draw(history, f"{folder}/shape.png", time=report.peak_drift_time)  # enlarged where little has moved
results.draw_joints(history, f"{folder}/joints.png")
results.draw_energy(history, f"{folder}/energy.png")
results.film(history, f"{folder}/film.gif", enlarge=None)
results.write_paraview(history, f"{folder}/wall.pvd")
print(f"wrote pictures, film and ParaView files to {folder}/")
