"""The lines of thrust of an arch, its mechanism on two piers, and the film of its fall. `scripts/gallery arch` runs it; the pictures are written into the current folder."""
import math

from yade import O

import masonry
from masonry import dem, results


def scene():
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.6))  # natural restitution
    base = dem.base((6, 3, 0.2), stone)
    piers = [dem.stack(3, (0.9, 0.6, 0.4), stone, on=base, at=(x, 0))[-1] for x in (-1.65, 1.65)]
    dem.arch(span=3.0, rise=1.5, thickness=0.3, n=15, depth=0.5, material=stone, on=piers)
    return base


base = dem.base((6, 3, 0.2), dem.BlockMat(density=2000, frictionAngle=math.atan(0.6)))
dem.arch(span=3.0, rise=1.5, thickness=0.3, n=15, depth=0.5, material=O.bodies[base].mat, on=base)
recorder = dem.WallRecorder(virtPeriod=0.05, recordForces=True)
O.engines = dem.engines(recorder=recorder)
dem.run(1.0)
results.draw_joints(dem.wall_history(recorder), "thrust.png", time=0.9)

scene()
result = dem.TiltTable().bisect(progress=False)
print(result)
result.draw("arch.png")

base = scene()
motion = dem.record_motion(masonry.artificial_record(seed=3, peak=0.5 * 9.81, duration=6, frequency=1.0), ids=[base])
recorder = dem.WallRecorder(virtPeriod=0.02)
O.engines = dem.engines(motion, recorder=recorder)
dem.run(4.0)
history = dem.wall_history(recorder)
print(results.collapse(history))
results.film(history, "arch.gif", start=1.6, end=3.6, frames_per_second=12.5, speed=0.5, color="rotation", progress=False)
