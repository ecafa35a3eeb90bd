"""YADE's VTKRecorder takes blocks of every model with each of its recorders that takes YADE's own bodies: 'intr', 'cpm', 'jcfpm' and 'all' end YADE with these too."""

import math
import re

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines
from yade import O, VTKRecorder

RECORDERS = ("spheres", "velocity", "facets", "boxes", "mask", "id", "clumpId", "materialId", "colors", "stress", "bstresses", "force")


def standing(model):
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((4, 2, 0.2), stone)
    dem.stack(2, (0.4, 1.0, 2.0), stone, on=base)
    O.engines = quiet_engines(model=model)
    dem.run(0.05)


@pytest.mark.parametrize("model", ("planar", "spatial", "compliant"))
def test_every_recorder(model, tmp_path):
    standing(model)
    for name in RECORDERS:
        VTKRecorder(fileName=f"{tmp_path}/{name}-", recorders=["boxes", name])()
        VTKRecorder(fileName=f"{tmp_path}/{name}-alone-", recorders=[name])()
    assert len(list(tmp_path.glob("*-boxes.*.vtu"))) > len(RECORDERS)
    O.engines = O.engines + [VTKRecorder(fileName=f"{tmp_path}/run-", recorders=list(RECORDERS), iterPeriod=5)]
    dem.run(0.01)


@pytest.mark.parametrize("model", ("planar", "compliant"))
def test_stresses(model, tmp_path):
    """YADE sums over the contacts of a body the force on a circle of the smaller radius of the two, which is here the least half size: 0.1 m of the base, 0.2 m of
    a block. The base and the lower block share the weight of both, the upper block has its own."""
    standing(model)
    VTKRecorder(fileName=f"{tmp_path}/v-", recorders=["boxes", "stress"], ascii=True)()
    found = re.search(r'Name="stressLen"[^>]*>([^<]*)<', next(tmp_path.glob("v-boxes.*.vtu")).read_text())
    values = np.array(found[1].split(), dtype=float).reshape(3, 6)  # faces of a body
    weight = 9.81 * O.bodies[1].state.mass
    on_base, between = 2 * weight / (math.pi * 0.1**2), weight / (math.pi * 0.2**2)
    assert np.abs(values / np.array([[on_base], [on_base + between], [between]]) - 1).max() < (1e-3 if model == "compliant" else 1e-7)
