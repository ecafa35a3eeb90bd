"""A simulation with the plugin's classes comes back from a file, compressed or not, and from memory."""

import pytest
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


def test_a_scene_as_it_is_built():
    build()
    check("built")


@pytest.mark.parametrize("ending", ("xml", "xml.bz2", "yade", "yade.gz"))
def test_a_scene_from_a_file(ending, tmp_path):
    build()
    O.save(str(tmp_path / f"scene.{ending}"))
    O.reset()
    O.load(str(tmp_path / f"scene.{ending}"))
    check(ending)


def test_a_scene_from_memory():
    build()
    O.saveTmp()
    O.reset()
    O.loadTmp()
    check("memory")


@pytest.mark.parametrize("ending", ("xml", "yade.gz"))
def test_a_material_outlives_its_scene(ending, tmp_path):
    """It is one of the next scene's: with an id of its own, saved and loaded with it."""
    kept, path = dem.BlockMat(density=2000, restitution=0.7, label="kept"), str(tmp_path / f"kept.{ending}")
    for _ in range(2):
        O.reset()
        own = dem.BlockMat(density=1000)
        base = dem.base((4, 2, 0.2), own)
        block = dem.block((0.6, 1, 3), kept, on=base)
        assert len({O.bodies[base].mat.id, O.bodies[block].mat.id}) == len(O.materials) == 2
        O.save(path)
        O.load(path)
        assert O.bodies[block].mat.restitution == 0.7 and O.bodies[block].mat.id == O.materials["kept"].id
