"""A wall that is shaken for half a second and then held: `yade -n -x yade_rest.py '<JSON>'`; prints one JSON line.

courses, per_course, amplitude (g, at 2 Hz); model; held (s); after (g, at 3 Hz: how the base goes on).
"""
import json
import math
import sys

import numpy as np
from masonry import dem
from yade import O, PyRunner

case = json.loads(sys.argv[1])
SHAKEN = 0.5  # s: one cycle, after which the base stands
STANDS = 0.1  # s without motion, after which a wall stands: rocking blocks are as slow for some steps where they turn back
stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7))
base = dem.base((case["per_course"] + 4, 4, 1), stone)
ids = dem.wall(case["courses"], case["per_course"], (1.0, 0.5, 0.5), stone, on=base)
interval = 1e-3
shaking = case["amplitude"] * np.sin(4 * math.pi * np.arange(0, SHAKEN, interval))
after = case["after"] * np.sin(6 * math.pi * np.arange(0, case["held"] + 0.01, interval))
motion = dem.RecordMotionEngine(ids=[base], samples=list(9.81 * np.concatenate([shaking, after])), interval=interval, direction=(1, 0, 0))
O.engines = dem.engines(motion, model=case["model"], method="wall", dt=1e-3)
integrator = O.engines[-1]
moves = []  # in each step
O.engines = O.engines + [PyRunner(command="moves.append(integrator.movingBlocks > 0)", iterPeriod=1, initRun=True)]
O.run(round((SHAKEN + case["held"]) / O.dt), True)
held = moves[round(SHAKEN / O.dt):]
velocity = np.array(O.bodies[base].state.vel)
stood = round(STANDS / O.dt)
set_off = sum(held[k] and not any(held[k - stood:k]) for k in range(stood, len(held)))
print(json.dumps(dict(case, blocks=len(ids), setOff=set_off, ends="moving" if held[-1] else "still",
                      moving=sum(held) * O.dt, fastest=max(float(np.linalg.norm(np.array(O.bodies[i].state.vel) - velocity)) for i in ids))), flush=True)
