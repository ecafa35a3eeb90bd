"""A tilted block let go: angle against the exact solution, energies, a plot. Run with `yade -n -x scripts/02_free_rocking.py`."""
import math
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from yade import O

import masonry
from masonry import dem

half_width, half_height, restitution = 0.3, 1.5, 0.9
stone = dem.BlockMat(density=2000, frictionAngle=math.radians(35), restitution=restitution)
base = dem.base((4, 2, 0.2), stone)
block = dem.block((2 * half_width, 1.0, 2 * half_height), stone, on=base)
exact_block = masonry.RockingBlock(half_width, half_height)
tilt = 0.5 * exact_block.critical_angle
dem.tilt(block, tilt)

recorder = dem.BlockRecorder(ids=[block], iterPeriod=20)
O.engines = dem.engines(recorder=recorder)
O.run(12000, True)

history = dem.history(recorder)
time, angle = history["time"], history["rotation"][:, 0, 1]
exact = masonry.simulate(exact_block, restitution=restitution, initial_angle=tilt, t_end=time[-1])
print(f"largest difference of the angle: {np.max(np.abs(angle - exact.sample(time)[0])) / exact_block.critical_angle:.1e} of the critical angle")
print("energies (J):", {key: round(value, 3) for key, value in dem.energy().items()})

os.makedirs("results", exist_ok=True)
plt.figure(figsize=(8, 4))
plt.plot(time, angle / exact_block.critical_angle, label="YADE")
plt.plot(time, exact.sample(time)[0] / exact_block.critical_angle, "k:", label="exact")
plt.xlabel("time (s)")
plt.ylabel("angle / critical angle")
plt.legend()
plt.tight_layout()
plt.savefig("results/02_free_rocking.png", dpi=150)
dem.save_history(recorder, "results/02_free_rocking.csv")
print("wrote results/02_free_rocking.png and .csv")
