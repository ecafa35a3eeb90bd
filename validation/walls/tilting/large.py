"""Collapse multipliers of large walls, of one with a window and of walls with corners, and what they cost. Run by ./run --large."""

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


def row(what, table):
    clock = time.process_time()
    result = table.bisect(progress=False)
    print(f"| {what} | {result.multiplier:.3f} | {len(result.trials)} | {time.process_time() - clock:.0f} | {'; '.join(result.doubts)} |", flush=True)


def ground():
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65), restitution=0)
    return dem.base((16, 16, 0.2), stone), stone


print("\n| wall | multiplier | trials | CPU s | doubts |\n" + "| --- " * 5 + "|")
for method in ("localised", "wall"):
    base, stone = ground()
    dem.wall(10, 6, (0.4, 0.2, 0.2), stone, on=base, openings=[(1, 0.6, 0.6, 0.8)])
    row(f"59 blocks round a window, along x, `{method}`", dem.TiltTable(method=method))
for courses, side in ((8, 4), (12, 6), (16, 8), (16, 16)):
    base, stone = ground()
    blocks = dem.return_wall(courses, side, side, (0.4, 0.2, 0.2), stone, on=base)
    row(f"{len(blocks)} blocks with a corner, along y", dem.TiltTable(direction="y"))
