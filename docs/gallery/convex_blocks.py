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


MAKERS = (arch, flat_arch), (vault, dome), (column, rubble)
sheet = Image.new("RGB", (len(MAKERS[0]) * WIDTH, len(MAKERS) * HEIGHT), "white")
for row, makers in enumerate(MAKERS):
    for column_, make in enumerate(makers):
        drawn = picture(make)
        sheet.paste(drawn, (column_ * WIDTH + (WIDTH - drawn.width) // 2, row * HEIGHT + (HEIGHT - drawn.height) // 2))
sheet.quantize(64).save("convex_blocks.png", optimize=True)
