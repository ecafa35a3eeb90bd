"""A structure in space in this plugin: `yade -n -x yade_space.py '<JSON>'`; prints one JSON line: where its blocks are.

structure (a key of BUILDERS); scene: a file to write it to, as gauss_seidel_space.cpp reads it, and no more; else amplitude (g, at 2 Hz), angle (of the motion from x,
degrees), seconds, tolerance (null: as dem.engines() chooses), dt (s, else 1e-3).
"""
import json
import math
import sys

import numpy as np
from masonry import dem
from yade import O

case = json.loads(sys.argv[1])
stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7))
base = dem.base((20, 20, 1), stone)
WHOLE = (1.0, 0.5, 0.5)
BRICK, HALF = (0.24, 0.12, 0.065), 0.12  # m


def bonded(courses, *plans):
    """Courses of bricks in plans that alternate: a plan is a list of (x0, x1, y0, y1) in half bricks."""
    right, back = (max(plan[k] for plan in plans[0]) for k in (1, 3))
    return dem.blocks_from_table([((x0 + x1 - right) * HALF / 2, (y0 + y1 - back) * HALF / 2, (course + 0.5) * BRICK[2], (x1 - x0) * HALF, (y1 - y0) * HALF, BRICK[2])
                                  for course in range(courses) for x0, x1, y0, y1 in plans[course % len(plans)]], stone, on=base)


T_PLANS = [(0, 2, 0, 1), (2, 4, 0, 1), (1.5, 2.5, 1, 3)], [(0, 1.5, 0, 1), (2.5, 4, 0, 1), (1.5, 2.5, 0, 2), (1.5, 2.5, 2, 3)]
U_PLANS = ([(0, 2, 0, 1), (2, 4, 0, 1), (0, 1, 1, 3), (3, 4, 1, 3)], [(1, 3, 0, 1), (0, 1, 0, 2), (0, 1, 2, 3), (3, 4, 0, 2), (3, 4, 2, 3)])
PILLAR_PLANS = ([(0, 2, 0, 1), (2, 3, 0, 2), (1, 3, 2, 3), (0, 1, 1, 3), (1, 2, 1, 2)], [(1, 3, 0, 1), (2, 3, 1, 3), (0, 2, 2, 3), (0, 1, 0, 2), (1, 2, 1, 2)])
BUILDERS = {"wall": lambda: dem.wall(6, 4, WHOLE, stone, on=base),
            "return wall": lambda: dem.return_wall(6, 3, 3, WHOLE, stone, on=base),
            "two wythes": lambda: dem.two_wythe_wall(6, 3, (0.8, 0.3, 0.3), stone, on=base, header_every=3),
            "wall with an opening": lambda: dem.wall(8, 4, WHOLE, stone, on=base, openings=[(1.5, 1.0, 1.0, 1.5)]),
            "pier": lambda: dem.pier(8, (0.6, 0.3, 0.3), stone, on=base, per_course=2),
            "column": lambda: dem.stack(5, (0.6, 0.4, 0.5), stone, base),
            "60 courses of bricks": lambda: dem.wall(60, 1.5, BRICK, stone, on=base),
            "40 courses of bricks": lambda: dem.wall(40, 1.5, BRICK, stone, on=base),
            "30 courses of bricks": lambda: dem.wall(30, 5, BRICK, stone, on=base),
            "32 courses of bricks": lambda: dem.wall(32, 2.5, BRICK, stone, on=base),
            "brick corner": lambda: dem.return_wall(30, 2, 2, BRICK, stone, on=base),
            "brick T": lambda: bonded(30, *T_PLANS),
            "brick U": lambda: bonded(30, *U_PLANS),
            "bricks with an opening": lambda: dem.wall(36, 3, BRICK, stone, on=base, openings=[(1, 12, 1, 12)], openings_in="blocks"),
            "brick pillar": lambda: bonded(30, *PILLAR_PLANS)}
ids = BUILDERS[case["structure"]]()
if "scene" in case:
    with open(case["scene"], "w") as out:
        for body in (O.bodies[i] for i in [base, *ids]):
            turn = body.state.ori
            print(*body.state.pos, *(2 * body.shape.extents), turn[3], turn[0], turn[1], turn[2], body.mat.density if body.dynamic else 0, file=out)
    raise SystemExit

LOOK, interval = 0.01, 1e-3  # s
samples = case["amplitude"] * 9.81 * np.sin(4 * math.pi * np.arange(0, case["seconds"] + 0.01, interval))
angle = math.radians(case["angle"])
motion = dem.RecordMotionEngine(ids=[base], samples=list(samples), interval=interval, direction=(math.cos(angle), math.sin(angle), 0))
O.engines = dem.engines(motion, model="spatial", method="wall", dt=case.get("dt", 1e-3), tolerance=case["tolerance"])
integrator = O.engines[-1]


def places():
    return [[float(x) for x in O.bodies[i].state.pos - O.bodies[base].state.pos] for i in ids]


looks = [places()]
for k in range(round(case["seconds"] / LOOK)):
    O.run(round(LOOK / O.dt), True)
    looks.append(places())
print(json.dumps(dict(case, blocks=len(ids), work=integrator.baseWork, heights=[2 * O.bodies[i].shape.extents[2] for i in ids],
                      places=looks)), flush=True)
