"""The normals of an interaction: one for each point, and a common one along the normal force. Without friction every force is along its point's normal."""

import random

import numpy as np
import pytest
from masonry import dem
from rocking_scene import rigid_engines
from yade import O, Quaternion

ROUND_OFF = 1e-12  # of unit vectors, and of forces relative to the largest


def tumbling_blocks(seed, **options):
    """Blocks that fall on each other askew: points of one pair have different normals."""
    O.reset()
    r = random.Random(seed)
    stone = dem.BlockMat(density=2000, frictionAngle=0.0)
    dem.base((9, 9, 0.2), stone)
    for k in range(4):
        turn = Quaternion(*[r.gauss(0, 1) for _ in range(4)])
        turn.normalize()
        dem.block([r.uniform(0.1, 0.6) for _ in range(3)], stone, center=(r.uniform(-0.3, 0.3), r.uniform(-0.3, 0.3), 0.6 + 0.9 * k), orientation=turn)
    O.engines = rigid_engines(**options)


def check(interaction, rigid=True):
    """Returns whether the points of a loaded interaction have different normals."""
    geom, phys = interaction.geom, interaction.phys
    normals, normal = np.array([tuple(n) for n in geom.normals]).reshape(-1, 3), np.array(geom.normal)
    forces, sizes = np.array([tuple(f) for f in phys.forces]).reshape(-1, 3), np.array(phys.normalForces)
    assert len(normals) == len(geom.points) == len(geom.gaps) == len(forces) == len(sizes)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=ROUND_OFF) and abs(np.linalg.norm(normal) - 1) < ROUND_OFF
    most = np.max(np.abs(sizes), initial=0)
    if not most > 0:
        assert not len(normals) or np.allclose(normal, normals[np.argmin(geom.gaps)], atol=ROUND_OFF)
        return False
    assert np.allclose(np.sum(forces * normals, axis=1), sizes, atol=ROUND_OFF * most)
    if rigid:  # there is no friction; compliant joints settle with shear
        assert np.allclose(forces, sizes[:, None] * normals, atol=ROUND_OFF * most)
    total = np.array(phys.normalForce)
    assert np.allclose(total, sizes @ normals, atol=8 * ROUND_OFF * most)
    assert np.allclose(normal, total / np.linalg.norm(total), atol=ROUND_OFF)
    return np.min(normals @ normal) < 0.9


@pytest.mark.parametrize("seed", range(4))
def test_rigid(seed):
    tumbling_blocks(seed)
    loaded = different = 0
    while O.time < 1.0:
        O.step()
        for i in O.interactions:
            loaded += i.phys.normalForce.norm() > 0
            different += check(i)
    print("seed", seed, "loaded", loaded, "with normals more than 25 degrees from the common one", different)
    assert loaded > 100


def test_compliant():
    tumbling_blocks(0, model="compliant")
    loaded = 0
    while O.time < 0.5:
        O.step()
        for i in O.interactions:
            if i.isReal and np.linalg.norm(i.phys.normalForce) > 0:
                check(i, rigid=False)
                loaded += 1
    assert loaded > 100
