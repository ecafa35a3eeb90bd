"""A stack of two blocks under an accelerogram. Run with `yade -n -x scripts/03_record.py [record.AT2]`; without a file, two
seconds of a made-up one."""
import sys

import numpy as np
from yade import O

import masonry
from masonry import dem

if len(sys.argv) > 1:
    record = masonry.read_record(sys.argv[1], baseline="constant")
else:
    time = np.arange(0, 2.005, 0.01)
    record = masonry.Record(0.01, 0.3 * 9.81 * np.sin(2 * np.pi * time) * np.sin(np.pi * time / 2) ** 2, baseline="constant")

stone = dem.BlockMat(density=2000, frictionAngle=0.6)  # natural restitution
base = dem.base((4, 2, 0.2), stone)
lower, upper = dem.stack(2, (0.6, 1.0, 1.5), stone, on=base)
motion = dem.record_motion(record, ids=[base])
O.engines = dem.engines(motion)
print("time (s)  base (m)    angle of the lower and the upper block (rad)")
while O.time < record.duration + 1:
    O.run(250, True)
    print(f"{O.time:8.3f}  {O.bodies[base].state.displ()[0]:9.6f}   {dem.angle(lower):9.6f}  {dem.angle(upper):9.6f}")
print(f"base at the end of the record: {record.displacement(O.time):.6f} m by exact integration")
print(dem.impacts()[["time", "body", "support", "restitution", "energy_lost", "switched"]])
