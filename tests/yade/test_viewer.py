"""YADE's Qt viewer draws blocks and joints, on a display in memory. Before, it ended YADE at the first body or contact of the plugin."""

import os
import shutil
import subprocess

import pytest

# Each part is drawn on its own. The program ends itself, since YADE would wait for its window.
PROGRAM = """
import os, time
from yade import O, qt
from PyQt5.QtWidgets import QApplication
from masonry import dem

stone = dem.BlockMat(density=2000, frictionAngle=0.6)
base = dem.base((4, 2, 0.2), stone)
dem.drum(0.2, 0.3, stone, sides=6, on=base)
O.engines = dem.engines()
O.run(2, True)
view, renderer = qt.View(), qt.Renderer()
for part in ("shape", "intrGeom", "intrPhys", "bound"):
    setattr(renderer, part, True)
    end = time.time() + 0.5
    while time.time() < end:
        QApplication.processEvents()
    print("drawn:", part, flush=True)
os._exit(0)
"""


def test_viewer_draws_blocks_and_joints(tmp_path):
    if not shutil.which("xvfb-run"):
        pytest.skip("there is no xvfb-run")
    script = tmp_path / "view.py"
    script.write_text(PROGRAM)
    run = subprocess.run(["xvfb-run", "-a", "yade", str(script)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, env=os.environ)
    drawn = [line.split()[1] for line in run.stdout.splitlines() if line.startswith("drawn:")]
    assert (run.returncode, drawn) == (0, ["shape", "intrGeom", "intrPhys", "bound"]), run.stderr[-1000:]
