"""Random buildings on a base that rests and is then shaken, one seed each."""

import math
import random

import numpy as np
from masonry import artificial_record, dem
from measures import quiet_engines
from yade import O

# Length, width and height of the blocks, m.
BRICKS = ((0.6, 0.3, 0.2), (0.5, 0.25, 0.25), (0.4, 0.2, 0.2), (0.8, 0.3, 0.3))
# s at rest before the base moves, and from then on.
RESTS, SHAKEN = 0.2, 0.3
# By how much the reaction of the base may differ from the weight at rest, relative to the weight, and by how much of the smallest half size a block may
# sink: a joint may be 1.15e-5 of it deep (tolerance::wall::penetration), and there are at most 20 joints over each other.
REACTION, SINK = 1e-3, 20 * 1.15e-5


def random_plan(r, brick):
    """Arguments of dem.building(): three or four outer walls, often an inner wall that makes T junctions, one or two storeys, doors and windows, slabs, beams and gables."""
    long, wide, high = r.uniform(4, 7) * brick[0], r.uniform(3, 5) * brick[0], brick[2]
    plan = {"south": ((0, 0), (long, 0)), "north": ((0, wide), (long, wide)), "west": ((0, wide), (0, 0)), "east": ((long, 0), (long, wide))}
    if r.random() < 0.2:
        del plan["north"]
    if r.random() < 0.4:
        x = long * r.uniform(0.4, 0.6)
        plan["inner"] = ((x, 0), (x, wide))
    storeys = [high * r.randint(4, 7) for _ in range(r.randint(1, 2))]
    openings = [dem.Opening(wall, x=r.uniform(1, 1.8) * brick[0], width=r.uniform(0.5, 1.2) * brick[0], height=high * r.randint(2, 3), sill=high * r.randint(0, 1), storey=k + 1)
                for wall in plan for k in range(len(storeys)) if r.random() < 0.5]
    floors = [r.choice((None, dem.Slab(high * r.uniform(0.5, 1), strips=r.randint(1, 4)), dem.Beams(("west", "east"), (brick[1] / 2, high), number=r.randint(1, 3)))) for _ in storeys]
    gables = {"west": high * r.randint(2, 4), "east": high * r.randint(2, 4)} if r.random() < 0.3 else None
    return dict(plan=plan, brick=brick, storeys=storeys, openings=openings, floors=floors, gables=gables, at=(-long / 2, -wide / 2))


def building(seed):
    """The first of the plans of the seed that can be built, on a base that moves from RESTS on, in up to three directions."""
    r = random.Random(-2000001 - seed)
    O.reset()
    material = dem.BlockMat(density=10 ** r.uniform(3, 3.5), frictionAngle=math.atan(r.uniform(0.5, 0.9)), **({} if r.random() < 0.6 else {"restitution": r.uniform(0, 0.9)}))
    base = dem.base((20, 20, 0.4), material)
    while len(O.bodies) == 1:
        try:
            made = dem.building(material=material, on=base, **random_plan(r, r.choice(BRICKS)))
        except ValueError:  # no bond, no bearing, or a block that would tip
            continue
    if r.random() < 0.3:
        dem.add_mass(made.top(1), r.uniform(0.1, 1) * made.mass)
    turn, peak = r.uniform(0, 2 * math.pi), r.uniform(0.5, 6)
    motions = [dem.record_motion(artificial_record(seed=r.randint(1, 10**6), peak=share * peak, duration=SHAKEN), ids=[base], direction=direction, start=RESTS)
               for share, direction in ((1, (math.cos(turn), math.sin(turn), 0)), (0.8, (-math.sin(turn), math.cos(turn), 0)), (0.5, (0, 0, 1)))[:r.randint(1, 3)]]
    O.engines = quiet_engines(motions, model="spatial", method="wall")
    return "wall in space"


class Rest:
    """A building while its base rests."""

    def __init__(self):
        self.free = [b for b in O.bodies if b.dynamic]
        self.heights = self._heights()
        self.size = min(min(b.shape.extents) for b in self.free)

    def _heights(self):
        return np.array([b.state.pos[2] for b in self.free])

    def errors(self):
        """At the end of the rest: error of the reaction relative to the weight; how far the block that has sunk most has, relative to the smallest half size."""
        weight = sum(b.state.mass for b in self.free) * 9.81
        error = np.abs(dem.reactions(0)["force"].sum(axis=0) - [0, 0, weight]).max() / weight
        sunk = (self.heights - self._heights()).max() / self.size
        return {"reaction": float(error), "sink": float(sunk)}
