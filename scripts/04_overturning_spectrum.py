"""Which half-sine pulses overturn a block: no YADE needed. Run with `PYTHONPATH=build/python /usr/bin/python3
scripts/04_overturning_spectrum.py`."""
import argparse

import numpy as np

import masonry

argparse.ArgumentParser(description=__doc__).parse_args()
block = masonry.RockingBlock(0.3, 1.5)
frequencies = np.linspace(0.5, 8, 16)  # pulse frequency over the block's frequency parameter p
print("frequency / p   overturning amplitudes / (g alpha)")
for ratio in frequencies:
    duration = np.pi / (ratio * block.frequency_parameter)
    thresholds = masonry.overturning_amplitude(block, masonry.HalfSine(1.0, duration))
    print(f"{ratio:13.2f}  ", "  ".join(f"{a / (9.81 * block.critical_angle):.6f}" for a in np.atleast_1d(thresholds)))
