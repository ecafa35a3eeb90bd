"""Crack maps of one wall with a window, with head joints that are filled and unfilled: writes mortar_wall.png."""
import math

import numpy as np
from masonry import Record, dem, results
from PIL import Image
from yade import O

stiffness = dict(normalStiffness=5e9, shearStiffness=2.2e9)
lime = dem.JointMat(tensileStrength=0.05e6, fractureEnergy=4, cohesion=0.07e6, shearFractureEnergy=28, **stiffness)
for number, unfilled in enumerate((False, True)):
    O.reset()
    brick = dem.BlockMat(density=1900, frictionAngle=math.atan(0.75), mortar=lime, unfilledHeads=unfilled, **stiffness)
    base = dem.base((4, 1, 0.2), brick)
    wall = dem.wall(length=3.0, height=2.4, size=(0.5, 0.25, 0.2), material=brick, on=base, openings=[(1.0, 0.8, 1.0, 0.8)])
    sine = Record(1e-3, 9.81 * np.sin(2 * np.pi * 4 * np.arange(251) * 1e-3))  # one period of 4 Hz, 1 g
    recorder = dem.WallRecorder(virtPeriod=0.005)
    O.engines = dem.engines(dem.record_motion(sine, ids=[base]), recorder=recorder)
    dem.run(0.25)
    cracks = results.cracks(dem.wall_history(recorder))
    print("unfilled:" if unfilled else "filled:", cracks)
    cracks.picture(f"mortar_wall_{number}.png", title="head joints unfilled" if unfilled else "head joints filled")
parts = [Image.open(f"mortar_wall_{number}.png").convert("RGB") for number in (0, 1)]
picture = Image.new("RGB", (sum(part.width for part in parts), max(part.height for part in parts)), "white")
picture.paste(parts[0], (0, 0))
picture.paste(parts[1], (parts[0].width, 0))
picture.quantize(64).save("mortar_wall.png", optimize=True)
