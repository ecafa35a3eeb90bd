"""The film at the top of README, the pictures and the report of the same run: a dry wall with a window collapses under a sine of growing amplitude.
`scripts/gallery collapse` runs it; the pictures are written into the current folder."""
import math
import os
import shutil
import subprocess
import tempfile

import numpy as np
from PIL import Image, ImageSequence
from yade import O

import masonry
from masonry import dem, results

time = np.arange(0, 2.505, 0.01)
record = masonry.Record(0.01, 1.4 * np.sin(2 * np.pi * 1.0 * time) * time / 2.5, baseline="constant", unit="g")

stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))  # natural restitution
base = dem.base((8, 3, 0.2), stone)
dem.wall(courses=10, per_course=6, size=(0.40, 0.20, 0.175), material=stone, on=base, openings=[(0.8, 0.525, 0.8, 0.7)])
motion = dem.record_motion(record, ids=[base])
recorder = dem.WallRecorder(virtPeriod=0.01, recordForces=True)
O.engines = dem.engines(motion, recorder=recorder)
dem.run(3.2)

history = dem.wall_history(recorder)
print(results.collapse(history))
results.draw_joints(history, "joints.png", time=1.6)
results.draw_energy(history, "energy.png")
if shutil.which("chromium"):
    with tempfile.TemporaryDirectory() as folder:
        results.report(history, f"{folder}/report.html", title="A wall with a window under a growing sine")
        subprocess.run(["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                        "--window-size=1000,1560", "--virtual-time-budget=3000", f"--screenshot={os.path.abspath('report.png')}",
                        f"file://{folder}/report.html"], check=True, capture_output=True)
else:
    print("report.png is not made: it needs Chromium (Debian: apt install chromium)")
film = "collapse.gif"
results.film(history, film, start=0.6, frames_per_second=12.5, speed=0.5, color="rotation", progress=False)

# Two thirds of the pixels and 64 colours keep the file below 1.5 MB.
frames = [frame.convert("RGB").resize((frame.width * 2 // 3, frame.height * 2 // 3), Image.LANCZOS) for frame in ImageSequence.Iterator(Image.open(film))]
palette = frames[-1].quantize(64)
frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
frames[0].save(film, save_all=True, append_images=frames[1:], duration=[80] * (len(frames) - 1) + [1500], loop=0, optimize=True)
print(f"wrote {film}: {len(frames)} frames, {os.path.getsize(film) / 1e6:.2f} MB")
