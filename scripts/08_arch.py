"""An arch on two piers: its thrust, its collapse multiplier, and how it falls under a record. Pictures, a film and a report go to
results/08_arch. Run with `yade -n -x scripts/08_arch.py`."""
import math
import os

from yade import O

import masonry
from masonry import dem, results


def scene():
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.6))
    base = dem.base((8, 3, 0.2), stone)
    piers = [dem.stack(3, (0.9, 0.6, 0.4), stone, on=base, at=(x, 0))[-1] for x in (-1.65, 1.65)]
    voussoirs = dem.arch(span=3.0, rise=1.5, thickness=0.3, n=15, depth=0.5, material=stone, on=piers)
    return base, piers, voussoirs


base, piers, voussoirs = scene()
O.engines = dem.engines()
dem.run(1.0)
carried = dem.reactions(piers[0])
push, _, load = carried["force"][carried["id"] == voussoirs[0]].sum(axis=0)
print(f"each pier carries {load / 1e3:.2f} kN of the arch, which pushes it outwards with {push / 1e3:.2f} kN")

scene()
result = dem.TiltTable().bisect(progress=False)
print(result)

base, _, _ = scene()
record = masonry.artificial_record(seed=3, peak=0.5 * 9.81, duration=6, frequency=1.0)
motion = dem.record_motion(record, ids=[base])
recorder = dem.WallRecorder(virtPeriod=0.02, recordForces=True)
O.engines = dem.engines(motion, recorder=recorder)
dem.run(8.0)
history = dem.wall_history(recorder)
print(results.collapse(history))

folder = "results/08_arch"
os.makedirs(folder, exist_ok=True)
result.draw(f"{folder}/mechanism.png")
results.draw(history, f"{folder}/end.png")
results.film(history, f"{folder}/film.gif")
results.report(history, f"{folder}/report.html", title="An arch on two piers")
print(f"wrote pictures, a film and report.html to {folder}/")
