"""Fragility of a block under 50 records x 20 levels: the case of the tutorial. `scripts/gallery fragility` runs it; the picture is written into
the current folder."""
import numpy as np

import masonry

block = masonry.RockingBlock.from_size(width=0.4, height=2.0)
records = [masonry.artificial_record(seed, peak=1.0, duration=10, frequency=1.0) for seed in range(50)]
curve = masonry.fragility(block, records, levels=np.linspace(0.05, 1.0, 20), measure="PGA/g")
print(curve)
curve.plot("fragility.png")
