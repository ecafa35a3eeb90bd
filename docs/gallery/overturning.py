"""Which half-sine pulses overturn blocks of three sizes. No YADE needed. Run with `PYTHONPATH=build/python /usr/bin/python3
docs/gallery/overturning.py`; the picture is written beside this file."""
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import masonry

durations = np.linspace(0.1, 1.5, 29)
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
for height in (1.0, 2.0, 4.0):
    block = masonry.RockingBlock.from_size(height / 5, height)
    amplitudes = [np.min(masonry.overturning_amplitude(block, masonry.HalfSine(1.0, duration))) / 9.81 for duration in durations]
    axes.plot(durations, amplitudes, label=f"{height / 5:g} x {height:g} m")
axes.set(xlabel="duration of the pulse (s)", ylabel="least amplitude that overturns (g)", ylim=(0, 2))
axes.legend(title="block")
path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "overturning.png")
figure.savefig(path, dpi=110)
print(f"wrote {path}")
