"""Collapse multipliers of dem.TiltTable against statics and limit analysis. Run by ./run."""

import math
import os
import time

from masonry import dem
from yade import O

OUT = os.environ.get("TILTING_OUT", "results/tilting")


def ground(mu):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(mu), restitution=0)
    return dem.base((4, 4, 0.2), stone), stone


def bond_wall(courses, mu):
    """Five blocks of 0.40 x 0.175 m long, on a fixed course; the lowest free course starts with a half block."""
    base, stone = ground(mu)
    ids = dem.wall(courses + 1, 5, (0.40, 0.20, 0.175), stone, base)
    for id in ids[:5]:
        O.bodies[id].dynamic = False


def stack(n):
    base, stone = ground(2.0)
    dem.stack(n, (0.6, 0.5, 0.4), stone, base)


def free_wall(courses):
    base, stone = ground(0.7)
    dem.wall(courses, 2, (0.40, 0.15, 0.20), stone, base)


def below(bound):
    return lambda result: 0.95 * bound <= result.bracket[0] and result.bracket[1] <= bound


def near(exact):
    return lambda result: abs(result.multiplier / exact - 1) <= 0.01


CASES = [
    *[(f"wall of {c} courses, mu 0.65", lambda c=c: bond_wall(c, 0.65), {}, bound, below(bound)) for c, bound in ((6, 0.64286), (10, 0.58000))],
    *[(f"wall of {c} courses, mu {mu}", lambda c=c, mu=mu: bond_wall(c, mu), {}, mu, near(mu)) for c in (6, 10) for mu in (0.3, 0.5)],
    *[(f"stack of {n}", lambda n=n: stack(n), {}, 0.6 / (0.4 * n), near(0.6 / (0.4 * n))) for n in (1, 2, 4, 8)],
    *[(f"wall of {c} courses, out of plane", lambda c=c: free_wall(c), {"direction": "y"}, 0.75 / c, near(0.75 / c)) for c in (3, 5)],
]

# Length, height, openings, in m; each wall is its own mirror image.
SYMMETRIC = [("", 1.2, 1.0, []), (", window", 1.2, 1.2, [(0.4, 0.4, 0.4, 0.4)]), (", window", 1.6, 2.0, [(0.6, 0.6, 0.4, 0.8)]),
             (", wide window", 2.4, 2.2, [(0.6, 0.6, 1.2, 1.0)]), (", two windows", 3.2, 2.2, [(0.6, 0.6, 0.4, 1.0), (2.2, 0.6, 0.4, 1.0)])]


def symmetric_walls():
    """Multipliers towards x and -x by both methods; those of 'wall' must be the same within the bisection's tolerance, 1e-3."""
    print("\n| symmetric wall, blocks 0.4 x 0.2 m, mu 0.65 | blocks | `wall`, x | `wall`, -x | `localised`, x | `localised`, -x | holds |\n" + "| --- " * 7 + "|")
    all_hold = True
    for what, length, height, openings in SYMMETRIC:
        found = []
        for method in ("wall", "localised"):
            for direction in ("x", "-x"):
                base, stone = ground(0.65)
                blocks = dem.wall(length=length, height=height, size=(0.4, 0.2, 0.2), material=stone, on=base, openings=openings)
                found.append(dem.TiltTable(direction=direction, method=method).bisect(progress=False))
        good = abs(found[0].multiplier / found[1].multiplier - 1) <= 1e-3 and not found[0].doubts and not found[1].doubts
        all_hold &= good
        multipliers = " | ".join(f"{one.multiplier:.4f}{', doubted' if one.doubts else ''}" for one in found)
        print(f"| {length} x {height} m{what} | {len(blocks)} | {multipliers} | {'yes' if good else 'NO'} |", flush=True)
    return all_hold


def main():
    os.makedirs(OUT, exist_ok=True)
    all_hold = True
    print("| scene | load | statics or bound | multiplier | bracket | difference | blocks that move | joints open / slide | trials | CPU s | holds |")
    print("| --- " * 11 + "|")
    for name, build, options, exact, holds in CASES:
        for load in ("force", "turned", "ramp"):
            build()
            clock = time.process_time()
            table = dem.TiltTable(load="turned" if load == "turned" else "force", **options)
            result = table.ramp(rate=0.005, start=0.8 * exact, progress=False) if load == "ramp" else table.bisect(progress=False)
            clock = time.process_time() - clock
            good = holds(result) if load != "ramp" else abs(result.multiplier / exact - 1) <= 0.05
            good = good and not result.doubts
            all_hold &= good
            print(f"| {name} | {load} | {exact:.5f} | {result.multiplier:.5f} | {result.bracket[0]:.5f} - {result.bracket[1]:.5f} | {100 * (result.multiplier / exact - 1):+.2f} % "
                  f"| {len(result.blocks)} | {result.joints['opens'].sum()} / {result.joints['slides'].sum()} | {len(result.trials)} | {clock:.2f} | {'yes' if good else 'NO'} |", flush=True)
            if result.doubts:
                print("  " + "; ".join(result.doubts))
            if load == "force":
                result.draw(os.path.join(OUT, name.replace(" ", "_").replace(",", "") + ".png"), f"{name}: {result}")
    return 0 if symmetric_walls() and all_hold else 1


os._exit(main())  # yade -x would end with status 0
