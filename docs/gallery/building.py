"""A house of two storeys and its course plans: writes building.png."""
import numpy as np
from masonry import dem, results
from PIL import Image
from yade import O

stone = dem.BlockMat(density=2000, frictionAngle=0.6)
concrete = dem.BlockMat(density=2400, frictionAngle=0.6)


def house(floors=2):
    """The first storeys of the house of docs/buildings.md, with their floors; all of them with the gables too."""
    O.reset()
    base = dem.base((8, 6, 0.3), stone)
    dem.building(plan={"south": ((0, 0), (6.0, 0)), "north": ((0, 4.2), (6.0, 4.2)), "west": ((0, 0), (0, 4.2)), "east": ((6.0, 0), (6.0, 4.2)), "inner": ((3.6, 0), (3.6, 4.2))},
                 brick=(0.6, 0.3, 0.3), storeys=[2.4, 2.4][:floors], material=stone, on=base, at=(-3.0, -2.1),
                 openings=[one for one in (dem.Opening("south", x=1.5, width=1.0, height=2.1), dem.Opening("south", x=4.4, width=0.9, height=1.2, sill=0.9),
                                           dem.Opening("east", x=1.6, width=1.0, height=1.2, sill=0.9), dem.Opening("south", x=1.5, width=1.0, height=1.2, sill=0.9, storey=2),
                                           dem.Opening("south", x=4.4, width=0.9, height=1.2, sill=0.9, storey=2)) if one.storey <= floors],
                 floors=[dem.Slab(0.2, strips=4, material=concrete), dem.Beams(("west", "east"), (0.15, 0.3), number=3)][:floors],
                 gables={"west": 1.8, "east": 1.8} if floors == 2 else None)


def picture(path):
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines, O.dt = [recorder], 1e-3
    O.step()
    results.draw(dem.wall_history(recorder), path, view=(0.6, -1, 0.6))
    return Image.open(path).convert("RGB")


def part(courses):
    """The house as far as those courses of the first storey."""
    house(floors=1)
    for body in list(O.bodies):
        if body.dynamic and body.state.pos[2] > 0.3 * courses:
            O.bodies.erase(body.id)


drawn = []
for make in (lambda: part(1), lambda: part(2), lambda: house(1), house):
    make()
    drawn.append(picture("building.png"))
width, height = 560, 480
sheet = Image.new("RGB", (2 * width, 2 * height), "white")
for k, one in enumerate(drawn):
    grey = np.asarray(one.convert("L")) < 250
    rows = np.flatnonzero(grey.any(axis=1))
    rows = rows[np.argmax(np.diff(rows) > 5) + 1:]  # below the title
    columns = np.flatnonzero(grey[rows].any(axis=0))
    one = one.crop((columns[0], rows[0], columns[-1] + 1, rows[-1] + 1))
    one.thumbnail((width - 20, height - 20), Image.LANCZOS)
    sheet.paste(one, (k % 2 * width + (width - one.width) // 2, k // 2 * height + (height - one.height) // 2))
sheet.quantize(64).save("building.png", optimize=True)
