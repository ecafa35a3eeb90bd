"""A dry wall on a tilting table: its collapse multiplier and its mechanism. Run with `yade -n -x scripts/05_tilting.py`."""
import math
import os

from masonry import dem

stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65), restitution=0)
base = dem.base((3, 1, 0.2), stone)
dem.wall(courses=8, per_course=5, size=(0.40, 0.20, 0.175), material=stone, on=base)

result = dem.TiltTable(load="turned").bisect()
print(result)
print(f"the table stands at {math.degrees(math.atan(result.multiplier)):.2f} degrees")
widest = max(result.joints, key=lambda joint: joint["opening"])
print(f"the joint of blocks {widest['id1']} and {widest['id2']} opens most")

os.makedirs("results", exist_ok=True)
result.draw("results/05_tilting.png")
print("wrote results/05_tilting.png")
