"""Collapse multipliers of large walls and what they cost. Run by ./run --large."""

import math
import time

from masonry import dem
from yade import O

print("| blocks | multiplier | trials | CPU s |\n" + "| --- " * 4 + "|")
for courses in (20, 32):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))
    base = dem.base((courses + 6, 2, 0.4), stone)
    blocks = dem.wall(courses, courses, (0.4, 0.2, 0.175), stone, on=base)
    clock = time.process_time()
    result = dem.TiltTable().bisect(progress=False)
    assert not result.doubts, result.doubts
    print(f"| {len(blocks)} | {result.multiplier:.4f} | {len(result.trials)} | {time.process_time() - clock:.0f} |", flush=True)
