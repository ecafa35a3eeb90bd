"""A simulation with the plugin's classes comes back from a file, compressed or not, and from memory."""

import os
import tempfile

from masonry import dem
from yade import O, Body, Box

stone = dict(density=2000.0, frictionAngle=0.6, restitution=0.1 + 0.2, shearStiffness=1e9 / 3, noSlip=True, label="stone")


def build():
    O.reset()
    O.materials.append(dem.BlockMat(**stone))
    body = Body()
    body.shape = Box(extents=(0.5, 1, 1.5))
    body.material = O.materials["stone"]
    O.bodies.append(body)


def check(where):
    material = O.bodies[0].material
    assert type(material) is dem.BlockMat and material.id == O.materials["stone"].id, where
    for name, value in stone.items():
        assert getattr(material, name) == value, (where, name, getattr(material, name))  # 17 digits: the same bits
    assert material.normalStiffness != material.normalStiffness, (where, "NaN is kept")
    assert material.dispHierarchy()[1] == "FrictMat", where


build()
check("built")
with tempfile.TemporaryDirectory() as folder:
    for ending in ("xml", "xml.bz2", "yade", "yade.gz"):
        build()
        path = os.path.join(folder, "scene." + ending)
        O.save(path)
        O.reset()
        O.load(path)
        check(ending)
build()
O.saveTmp()
O.reset()
O.loadTmp()
check("memory")

# A material that outlives its scene is one of the next scene's: with an id of its own, saved and loaded with it.
kept = dem.BlockMat(density=2000, restitution=0.7, label="kept")
with tempfile.TemporaryDirectory() as folder:
    for ending in ("xml", "yade.gz"):
        for _ in range(2):
            O.reset()
            own = dem.BlockMat(density=1000)
            base = dem.base((4, 2, 0.2), own)
            block = dem.block((0.6, 1, 3), kept, on=base)
            assert len({O.bodies[base].mat.id, O.bodies[block].mat.id}) == len(O.materials) == 2
            O.save(os.path.join(folder, "kept." + ending))
            O.load(os.path.join(folder, "kept." + ending))
            assert O.bodies[block].mat.restitution == 0.7 and O.bodies[block].mat.id == O.materials["kept"].id
