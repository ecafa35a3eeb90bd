"""Convex blocks as their makers lay them out: writes arch.png, vault.png, dome.png, column.png and rubble.png."""
from masonry import dem, results
from yade import O

stone = dem.BlockMat(density=2000, frictionAngle=0.6)


def draw(name, make, view=(0.5, -1, 0.45)):
    """Writes a picture of what make(base) puts on a base: a recorder takes the scene as it is, and nothing runs."""
    O.reset()
    make(dem.base((7, 7, 0.2), stone))
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines, O.dt = [recorder], 1e-3
    O.step()
    results.draw(dem.wall_history(recorder), name, view=view)


def arch(base):
    dem.arch(span=3, rise=1.0, thickness=0.3, n=11, depth=0.6, material=stone, on=base, springers=True)


def vault(base):
    dem.barrel_vault(span=3, rise=1.5, thickness=0.25, n=13, length=4, along=5, material=stone, on=base)


def dome(base):
    dem.dome(radius=2.5, thickness=0.3, courses=7, per_course=20, material=stone, on=base, oculus=0.4)


def column(base):
    dem.column(drums=5, radii=[0.5, 0.48, 0.46, 0.44, 0.42, 0.4], heights=0.8, material=stone, on=base, sides=16)


def rubble(base):
    dem.rubble_wall(length=4, height=2, thickness=0.6, size=0.45, material=stone, on=base, seed=3)


for make in (arch, vault, dome, column, rubble):
    draw(f"{make.__name__}.png", make)
