"""Convex blocks as their makers lay them out: writes convex_blocks.png."""
import tempfile
from pathlib import Path

from PIL import Image

from masonry import dem, results
from yade import O

stone = dem.BlockMat(density=2000, frictionAngle=0.6)
WIDTH, HEIGHT = 560, 400  # of a picture, pixels


def picture(make):
    """What make(base) puts on a base: a recorder takes the scene as it is, and nothing runs."""
    O.reset()
    make(dem.base((7, 7, 0.2), stone))
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines, O.dt = [recorder], 1e-3
    O.step()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "one.png"
        results.draw(dem.wall_history(recorder), path, view=(0.5, -1, 0.45))
        drawn = Image.open(path).convert("RGB")
        drawn.thumbnail((WIDTH, HEIGHT), Image.LANCZOS)
        return drawn


def arch(base):
    dem.arch(span=3, rise=1.0, thickness=0.3, n=11, depth=0.6, material=stone, on=base, springers=True)


def flat_arch(base):
    dem.flat_arch(span=2, depth=0.4, n=7, below=1.6, width=0.6, material=stone, on=base, springers=True)


def vault(base):
    dem.barrel_vault(span=3, rise=1.5, thickness=0.25, n=13, length=4, along=5, material=stone, on=base)


def dome(base):
    dem.dome(radius=2.5, thickness=0.3, courses=7, per_course=20, material=stone, on=base, oculus=0.4)


def column(base):
    dem.column(drums=5, radii=[0.5, 0.48, 0.46, 0.44, 0.42, 0.4], heights=0.8, material=stone, on=base, sides=16)


def rubble(base):
    dem.rubble_wall(length=4, height=2, thickness=0.6, size=0.45, material=stone, on=base, seed=3)


def cuboid(x, y, z):
    """Corners of a box between two x, two y and two z, m."""
    return [(a, b, c) for a in x for b in y for c in z]


def unions(base):
    """An L, a T, a U and a stone with a hole, each one body of convex parts."""
    deep = (-0.3, 0.3)
    dem.union([cuboid((-2.6, -1.6), deep, (0, 0.25)), cuboid((-2.6, -2.3), deep, (0.25, 1.2))], stone)
    dem.union([cuboid((-1.1, -0.8), deep, (0, 0.9)), cuboid((-1.4, -0.5), deep, (0.9, 1.2))], stone)
    dem.union([cuboid((0, 1), deep, (0.9, 1.2)), cuboid((0, 0.25), deep, (0, 0.9)), cuboid((0.75, 1), deep, (0, 0.9))], stone)
    bars = [((1.5, 2.7), (0, 0.3)), ((1.5, 2.7), (0.9, 1.2)), ((1.5, 1.85), (0.3, 0.9)), ((2.35, 2.7), (0.3, 0.9))]
    dem.union([cuboid(x, deep, z) for x, z in bars], stone)


def gate(base):
    """Posts with dovetails, a lintel with notches that sits on them, and two steps of three flush parts."""
    deep = (-0.3, 0.3)
    for middle in (-1, 1):
        tail = [(middle + x, y, z) for x, z in ((-0.12, 1.8), (0.12, 1.8), (-0.25, 2.1), (0.25, 2.1)) for y in deep]
        dem.union([cuboid((middle - 0.3, middle + 0.3), deep, (0, 1.8)), tail], stone)
    ends = [-1.6, -1, 1, 1.6]
    def side(middle, sign, end):
        return [(x, y, z) for x, z in ((middle + sign * 0.12, 1.8), (middle + sign * 0.25, 2.1), (end, 1.8), (end, 2.1)) for y in deep]
    parts = [side(-1, -1, ends[0]), side(-1, 1, 0), side(1, -1, 0), side(1, 1, ends[-1])]
    dem.union([*parts, cuboid((ends[0], ends[-1]), deep, (2.1, 2.5))], stone)
    for k in range(2):
        dem.union([cuboid(x, (-0.9 + 0.3 * k, -0.3), (0.15 * k, 0.15 * (k + 1))) for x in ((-0.7, -0.2), (-0.2, 0.3), (0.3, 0.7))], stone)


MAKERS = (arch, flat_arch), (vault, dome), (column, rubble), (unions, gate)
sheet = Image.new("RGB", (len(MAKERS[0]) * WIDTH, len(MAKERS) * HEIGHT), "white")
for row, makers in enumerate(MAKERS):
    for column_, make in enumerate(makers):
        drawn = picture(make)
        sheet.paste(drawn, (column_ * WIDTH + (WIDTH - drawn.width) // 2, row * HEIGHT + (HEIGHT - drawn.height) // 2))
sheet.quantize(64).save("convex_blocks.png", optimize=True)
