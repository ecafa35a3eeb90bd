"""Which half-sine pulses overturn blocks of three sizes. `scripts/gallery overturning` runs it; the picture is written into
the current folder."""
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
    print(f"height {height:g} m: {amplitudes[0]:.3f} g at {durations[0]:g} s, {amplitudes[-1]:.3f} g at {durations[-1]:g} s")
axes.set(xlabel="duration of the pulse (s)", ylabel="least amplitude that overturns (g)", ylim=(0, 2))
axes.legend(title="block")
figure.savefig("overturning.png", dpi=110)
