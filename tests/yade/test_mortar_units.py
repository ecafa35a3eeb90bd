"""Head joints with mortar of their own, units that split, and tops that are held."""

import math

import numpy as np
import pytest
from masonry import dem, results
from mortar_scene import EINDHOVEN, brick_material, eindhoven
from rocking_scene import bits, joint_engine, quiet_engines, refuses, said_by, steps
from yade import O

BRICK = (0.2, 0.1, 0.05)
UNIT = dict(tensileStrength=2e6, fractureEnergy=80, cohesion=2.8e6, shearFractureEnergy=500, frictionAngle=math.pi / 4, normalStiffness=2e11, shearStiffness=1e11)


def wall(courses=3, per_course=2, split=None, **material):
    """Ids of a small wall in its plane, on a base of its own mortar."""
    O.reset()
    stone = brick_material(**material)
    base = dem.base((2, 1, 0.2), stone)
    return base, dem.wall(courses, per_course, BRICK, stone, on=base, split=split)


def joints():
    """{pair of ids: (mortar of the joint or None, whether the joint is upright, whether it is bonded)} after a step."""
    return {(min(i.id1, i.id2), max(i.id1, i.id2)): (i.phys.mortar, abs(i.geom.normal[2]) < 0.1, i.phys.bonded) for i in O.interactions}


def test_head_joints_have_their_own_mortar():
    """A bed joint has `mortar`, a head joint `headMortar`: strengths are read back from the force that each bears in a single joint."""
    weak = eindhoven(tensileStrength=0.05e6, cohesion=0.07e6)
    base, ids = wall(headMortar=weak)
    O.engines = quiet_engines(model="auto")
    O.step()
    found = joints()
    assert len(found) == len(dem.damage())
    heads = [mortar for mortar, upright, _ in found.values() if upright]
    beds = [mortar for mortar, upright, _ in found.values() if not upright]
    assert len(heads) == 4 and all(one.tensileStrength == 0.05e6 for one in heads)  # 1 of two whole blocks, 2 of a course with halves, 1
    assert len(beds) == 10 and all(one.tensileStrength == 0.25e6 for one in beds)


def test_a_head_joint_breaks_at_the_strength_of_its_mortar():
    """Two bricks end to end, the first one prescribed: f_t A = 0.05 MPa of 0.1 x 0.05 m, 250 N; bed mortar would bear 1250 N."""
    for factor, breaks in ((0.95, False), (1.1, True)):
        O.reset()
        stone = brick_material(headMortar=eindhoven(tensileStrength=0.05e6, cohesion=0.07e6))
        dem.block(BRICK, stone, center=(0, 0, 1))
        O.bodies[0].state.blockedDOFs = "xyzXYZ"
        two = dem.block(BRICK, stone, center=(0.2, 0, 1))
        O.engines = quiet_engines(model="auto", gravity=0)
        steps(2)
        for k in range(40):  # slowly, so that it does not swing
            O.forces.setPermF(two, (250 * factor * (k + 1) / 40, 0, 0))
            steps(60)
        steps(3000)
        assert (dem.damage()["worst"][0] > 0.999) == breaks, (factor, dem.damage())


def test_unfilled_head_joints_are_dry():
    wall(unfilledHeads=True)
    O.engines = quiet_engines(model="auto")
    O.step()
    for mortar, upright, bonded in joints().values():
        assert (mortar is None) == upright and bonded != upright
    assert len(dem.damage()) == 10


def test_bond_takes_beds_or_heads():
    dry = dem.BlockMat(density=1900, frictionAngle=0.64, normalStiffness=82e9, shearStiffness=36e9)
    for kind, count in (("bed", 10), ("head", 4), ("all", 14)):
        O.reset()
        base = dem.base((2, 1, 0.2), dry)
        dem.wall(3, 2, BRICK, dry, on=base)
        O.engines = quiet_engines(model="compliant")
        steps(2)
        assert dem.bond(material=eindhoven(), joints=kind) == count
        O.step()
        assert len(dem.damage()) == count
    refuses(lambda: dem.bond(material=eindhoven(), joints="none"), "joints = 'none'", "'bed'")


def test_units_split_in_their_middle():
    """Whole blocks are two halves with the mortar of `split`; half blocks stay whole; heads and beds keep theirs. The step fits the stiff joint."""
    split = dem.JointMat(**UNIT)
    base, ids = wall(split=split)
    assert len(ids) == 2 * 5 + 2  # 2, 1 and two halves, 2 blocks
    O.engines = quiet_engines(model="auto")
    chosen = O.dt
    steps(5)
    assert O.dt == chosen == pytest.approx(0.2 * joint_engine().criticalTimeStep(), rel=1e-6)
    law = {pair: i.phys.normalStiffness for pair, i in (((min(i.id1, i.id2), max(i.id1, i.id2)), i) for i in O.interactions)}
    stiff = [pair for pair, value in law.items() if value == 2e11]
    assert len(stiff) == 5 and all(b == a + 1 and O.bodies[a].shape.extents[0] == O.bodies[b].shape.extents[0] == 0.05 for a, b in stiff)
    assert all(O.bodies[b].state.pos[0] - O.bodies[a].state.pos[0] == pytest.approx(0.1, abs=1e-9) for a, b in stiff)
    assert len(dem.damage()) == len(law)


def test_a_unit_breaks_at_its_own_strength():
    """A brick of two halves on a dry bed, one half held: 2 MPa of 0.1 x 0.05 m, 10 kN. Joints with such mortar alone are compliant by themselves."""
    O.reset()
    stone = dem.BlockMat(density=1900, frictionAngle=0.64)
    base = dem.base((2, 1, 0.2), stone)
    one, two = dem.wall(1, 1, BRICK, stone, on=base, split=dem.JointMat(**UNIT))
    said = said_by(lambda: setattr(O, "engines", dem.engines()))
    assert "units may split" in said
    O.bodies[one].state.blockedDOFs = "xyzXYZ"
    for factor, breaks in ((0.95, False), (1.1, True)):
        for k in range(40):
            O.forces.setPermF(two, (1e4 * factor * (k + 1) / 40, 0, 0))
            steps(60)
        steps(1000)
        assert (dem.damage()["worst"].max() > 0.999) == breaks


@pytest.mark.parametrize("after", (0, 300))
def test_a_saved_wall_of_units_goes_on_with_the_same_bits(after, tmp_path):
    """Also where it is saved before its first step: the engine keeps the joints that are asked for."""
    path = str(tmp_path / "wall.yade.gz")
    base, ids = wall(split=dem.JointMat(**UNIT), headMortar=eindhoven(tensileStrength=0.05e6, cohesion=0.07e6))
    O.engines = quiet_engines(model="auto")
    O.forces.setPermF(ids[-1], (8000, 0, 0))
    if after:
        O.run(after, True)
    O.save(path)
    steps(300)
    straight, state = bits(), np.array(joint_engine().bondedState)
    O.reset()
    O.load(path)
    O.forces.setPermF(ids[-1], (8000, 0, 0))  # YADE does not save it
    steps(300)
    assert np.array_equal(bits(), straight)
    assert np.array_equal(np.array(joint_engine().bondedState), state, equal_nan=True)


def test_bad_heads_and_units():
    refuses(lambda: dem.BlockMat(headMortar=eindhoven()), "headMortar", "mortar")
    refuses(lambda: dem.BlockMat(unfilledHeads=True), "unfilledHeads", "mortar")
    refuses(lambda: brick_material(unfilledHeads=True, headMortar=eindhoven()), "unfilledHeads", "headMortar")
    refuses(lambda: brick_material(headMortar=dem.JointMat()), "headMortar", "fractureEnergy")
    refuses(lambda: brick_material(headMortar=3), "headMortar = 3", "JointMat", kind=TypeError)
    refuses(lambda: wall(split=3), "split = 3", "JointMat")
    refuses(lambda: wall(split=dem.JointMat()), "fractureEnergy")
    O.reset()
    dry = dem.BlockMat(density=1900, frictionAngle=0.64)
    base = dem.base((2, 1, 0.2), dry)
    dem.wall(2, 2, BRICK, dry, on=base, split=dem.JointMat(**UNIT))
    refuses(lambda: dem.engines(model="planar"), "model = 'planar'", "compliant")
    O.reset()
    one, other = brick_material(headMortar=eindhoven(fractureEnergy=20)), brick_material()
    base = dem.base((2, 1, 0.2), one)
    dem.block(BRICK, one, on=base)
    dem.block(BRICK, other, center=(0.2, 0, 0.025))
    refuses(dem.engines, "bodies 1 and 2", "different mortar")


def test_a_report_names_the_mortar_of_head_joints(tmp_path):
    recorder = dem.WallRecorder(iterPeriod=5)
    wall(unfilledHeads=True)
    O.engines = quiet_engines(model="auto", recorder=recorder)
    steps(11)
    results.report(dem.wall_history(recorder), tmp_path / "wall.html")
    assert "head joints unfilled" in (tmp_path / "wall.html").read_text()


def test_a_top_that_is_held():
    """A dry pier of one block under a held beam: it cannot rock up, so the force goes on beyond that of a free top, W b/2 over h, by the springs that the turn presses in."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7), normalStiffness=1e9, shearStiffness=5e8)
    base = dem.base((2, 1, 0.2), stone)
    pier = dem.block((0.4, 0.4, 0.8), stone, on=base)
    beam = dem.block((0.6, 0.4, 0.1), stone, on=pier)
    O.engines = quiet_engines(model="compliant")
    dem.run(0.02)
    height, weight = O.bodies[beam].state.pos[2], 9.81 * (O.bodies[beam].state.mass + O.bodies[pier].state.mass)
    push = dem.push([beam], displacement=1e-3, vertical="held", speed=0.02)
    O.engines = quiet_engines(push, model="compliant")
    dem.run(until=push)
    curve = push.curve
    assert push.ended == "displacement" and abs(O.bodies[beam].state.pos[2] - height) < 1e-12
    assert curve["displacement"][-1] == pytest.approx(1e-3, rel=1e-3) and curve["moved"][-1] == pytest.approx(1e-3, rel=1e-3)
    assert curve["force"].max() > 1.5 * weight * 0.2 / 0.8
    refuses(lambda: dem.push([beam], displacement=1e-3, vertical="held"), "ids", "prescribed")
    push.release()
    steps(200)
    assert O.bodies[beam].dynamic and O.bodies[beam].state.pos[0] < 1e-3 * (1 - 1e-6)  # it springs back
    O.reset()
    base = dem.base((2, 1, 0.2), stone := dem.BlockMat(density=2000, frictionAngle=0.6))
    one = dem.block((0.4, 0.4, 0.8), stone, on=base)
    push = dem.push([one], displacement=1e-3, vertical="held")
    two = dem.block((0.4, 0.4, 0.8), stone, center=(0.8, 0, 0.4))
    refuses(lambda: dem.engines(push), "vertical = 'held'", "compliant")
