"""Forces of joints whose mortar pulls and shears, against statics: a block of 32 kg that mortar holds at rest under any gravity."""

import numpy as np
import pytest
from masonry import dem, results
from mortar_scene import eindhoven
from rocking_scene import quiet_engines
from yade import O, Vector3

SIZE = (0.2, 0.2, 0.4)
MASS = 32.0
EXACT = 1e-6  # of the largest force or moment: the dashpots have brought the block to rest


def held(gravity, recorder=None, base_size=(1, 1, 0.2), center=None):
    """Ids of base and block of a fresh scene, at rest under gravity."""
    O.reset()
    material = dem.BlockMat(density=MASS / np.prod(SIZE), frictionAngle=0.64, mortar=eindhoven())
    base = dem.base(base_size, material)
    block = dem.block(SIZE, material, **({"on": base} if center is None else {"center": center}))
    O.engines = quiet_engines(model="compliant", gravity=9.81, recorder=recorder)
    O.engines[-1].gravity = gravity
    O.run(20000, True)
    assert O.bodies[block].state.vel.norm() < 1e-9
    return base, block


@pytest.mark.parametrize("gravity", ((4, 0, 5), (1, 2, -9.81), (4, -3, -5)))
def test_a_block_that_mortar_holds(gravity):
    """The base bears the weight and its moment: upward (the joint pulls), and sideways. The joint's normal has no moment: the weight acts above its middle."""
    recorder = dem.WallRecorder(iterPeriod=20000, recordForces=True)
    base, block = held(gravity, recorder)
    O.run(20001, True)
    weight, arm = MASS * np.array(gravity), np.array([0, 0, SIZE[2] / 2])
    exact = EXACT * np.abs(weight).max()
    (row,) = dem.reactions(base)
    assert row["id"] == block and np.abs(row["force"] + weight).max() < exact
    (joint,) = dem.joint_forces()
    assert (joint["id1"], joint["id2"]) == (base, block) and np.array_equal(joint["force"], row["force"])
    crossing = arm - weight * arm[2] / weight[2]  # of the line through the middle of the block
    assert np.abs(joint["point"] - (O.bodies[block].state.pos - arm + crossing)).max() < 1e-6
    phys = O.interactions[base, block].phys
    assert (phys.normalForce + phys.shearForce - Vector3(row["force"])).norm() < exact

    history = dem.wall_history(recorder)
    found = results.base_reactions(history, about=(0, 0, 0))[-1]
    assert np.abs(found["force"] + weight).max() < exact
    assert np.abs(found["moment"] + np.cross(arm, weight)).max() < exact
    (line,) = results.thrust(history)
    assert np.abs(line["force"] + weight).max() < exact
    assert (np.abs(line["point"][:2]) < 0.1).all() == (abs(crossing[0]) < 0.1 and abs(crossing[1]) < 0.1)
    joint = results.joint_history(history, base, block).table[-1]
    assert joint["normal"] == pytest.approx(-weight[2], abs=exact) and joint["shear"] == pytest.approx(np.linalg.norm(weight[:2]), abs=exact)


def test_a_block_at_the_side_of_its_base():
    """Hardly any force crosses the joint: it bears the weight by shear, and its moment by tension and pressure."""
    recorder = dem.WallRecorder(iterPeriod=20000, recordForces=True)
    base, _ = held((0, 0, -9.81), recorder, base_size=(0.4, 0.4, 0.4), center=(0.3, 0, -0.2))
    O.run(20001, True)
    weight = MASS * 9.81
    found = results.base_reactions(dem.wall_history(recorder), about=(0, 0, 0))[-1]
    assert np.abs(found["force"] - [0, 0, weight]).max() < EXACT * weight
    assert np.abs(found["moment"] - [0, -0.3 * weight, 0]).max() < EXACT * weight
    assert np.abs(dem.reactions(base)["force"][0] - [0, 0, weight]).max() < EXACT * weight
