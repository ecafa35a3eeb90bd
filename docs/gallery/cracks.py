"""Crack map of a wall with a window, whose mortar cracks as it is shaken in its plane: writes cracks.png."""
import numpy as np
from masonry import Record, dem, results
from PIL import Image
from yade import O

mortar = dem.JointMat(tensileStrength=0.05e6, fractureEnergy=5, cohesion=0.1e6, shearFractureEnergy=30, frictionAngle=0.6, normalStiffness=2e9, shearStiffness=0.9e9)
brick = dem.BlockMat(density=1900, frictionAngle=0.6, mortar=dem.scatter(mortar, cov=0.2, seed=1))
base = dem.base((4, 1, 0.2), brick)
wall = dem.wall(length=3.0, height=2.4, size=(0.5, 0.25, 0.2), material=brick, on=base, openings=[(1.0, 0.8, 1.0, 0.8)])
dem.add_mass(wall[-7:], 600)  # of a floor, on the upper course
sine = Record(1e-3, 7 * np.sin(2 * np.pi * 4 * np.arange(251) * 1e-3))  # one period of 4 Hz
recorder = dem.WallRecorder(virtPeriod=0.0025)
O.engines = dem.engines(dem.record_motion(sine, ids=[base]), recorder=recorder)
dem.run(0.25)
cracks = results.cracks(dem.wall_history(recorder))
print(cracks)
cracks.picture("cracks.png")
Image.open("cracks.png").convert("RGB").quantize(64).save("cracks.png", optimize=True)
