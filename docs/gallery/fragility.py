"""Fragility of a block under 50 records x 20 levels: the case of the tutorial. No YADE needed. Run with
`PYTHONPATH=build/python /usr/bin/python3 docs/gallery/fragility.py`; the picture is written beside this file."""
import os

import numpy as np

import masonry

block = masonry.RockingBlock.from_size(width=0.4, height=2.0)
records = [masonry.artificial_record(seed, peak=1.0, duration=10, frequency=1.0) for seed in range(50)]
curve = masonry.fragility(block, records, levels=np.linspace(0.05, 1.0, 20), measure="PGA/g")
print(curve)
path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "fragility.png")
curve.plot(path)
print(f"wrote {path}")
