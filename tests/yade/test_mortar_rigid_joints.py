"""Joints of rigid blocks with mortar (method='wall') of many kinds: head joints, units that split, dem.bond, new engines, slow slip, tilting."""

import math

import numpy as np
import pytest
from masonry import Record, dem
from masonry.dem.platens import platen
from mortar_scene import AREA, BRICK_WALL, EINDHOVEN, SIZE, brick_material, eindhoven
from rocking_scene import refuses, rigid_engines, steps
from yade import O, Vector3

G = 9.81
WEAK = dict(tensileStrength=0.05e6, cohesion=0.07e6, fractureEnergy=4, shearFractureEnergy=28)
UNIT = dict(tensileStrength=2e6, fractureEnergy=80, cohesion=2.8e6, shearFractureEnergy=500, frictionAngle=math.pi / 4)
DRY = dict(density=1900, frictionAngle=0.64)


def engines(*arguments, dt=1e-3, **options):
    O.engines = rigid_engines(*arguments, method="wall", dt=dt, **options)


def wall(material=None, split=None):
    """Ids of a small wall: 10 bed joints, 4 head joints."""
    O.reset()
    stone = material or brick_material()
    base = dem.base((2, 1, 0.2), stone)
    return base, dem.wall(3, 2, BRICK_WALL, stone, on=base, split=split)


def heads():
    """Which joints of dem.damage() are head joints."""
    center = {id: O.bodies[id].state.pos for id in range(len(O.bodies))}
    return np.array([abs(center[row["body1"]][2] - center[row["body2"]][2]) < 1e-3 for row in dem.damage()])


def ramp(load, most, time=1.0):
    """The load, which grows evenly to `most`, at which a joint cracks; None: it holds."""
    begun = O.time
    while O.time - begun < time:
        load(most * (O.time - begun) / time)
        O.step()
        if dem.damage()["worst"].max() > 0.02:
            return most * (O.time - begun) / time
    return None


def end_to_end(material, split=None):
    """Two bricks on a base without mortar, the first one held: the id of the second. A thrust without friction under them."""
    O.reset()
    base = dem.base((2, 1, 0.2), dem.BlockMat(density=1900, frictionAngle=0.0))
    one, two = dem.wall(1, 1, BRICK_WALL, material, on=base, split=split) if split else (dem.block(BRICK_WALL, material, on=base), dem.block(BRICK_WALL, material, on=base, at=(0.2, 0)))
    O.bodies[one].dynamic = False
    return two


def test_slow_slip_breaks_a_joint():
    """A base that slides under a brick which a platen stops: c exp(-c q/G_II) + mu s at the slip q, in steps of which each is below the dead zone. What
    it slips before it yields, some 0.02 G_II/c to 0.04 G_II/c, does not count as damage: 4 % of the cohesion."""
    for pressure in (0, 1e5):
        O.reset()
        material = brick_material()
        base = dem.base((0.5, 0.2, 0.1), material)
        one = dem.block(SIZE, material, on=base, at=(0.2, 0))
        stop = platen(one, np.array([1.0, 0, 0]), 2e-3 * SIZE[2], 1, 0.0)
        O.forces.setPermF(one, (0, 0, G * O.bodies[one].state.mass - pressure * AREA))
        engines()
        steps(5)
        for k in range(200):
            O.bodies[base].state.vel = Vector3(0.01 * min(1, (k + 1) / 100), 0, 0)
            O.step()
        slip, force = O.bodies[base].state.pos[0], abs(dem.reactions(stop)["force"].sum(axis=0)[0])
        expected = EINDHOVEN["cohesion"] * math.exp(-EINDHOVEN["cohesion"] * slip / EINDHOVEN["shearFractureEnergy"]) + 0.75 * pressure
        assert force / AREA == pytest.approx(expected, rel=0.05)
        assert dem.damage()["mode"][0] == "shear"


def test_head_joints_have_their_own_mortar():
    """f_t A of a head joint of 0.1 x 0.05 m, 250 N; with the mortar of the beds it bears 1250 N."""
    for material, expected in ((brick_material(headMortar=eindhoven(**WEAK)), 250), (brick_material(), 1250)):
        two = end_to_end(material)
        engines()
        steps(2)
        assert ramp(lambda force: O.forces.setPermF(two, (force, 0, 0)), 1.2 * expected) == pytest.approx(expected, rel=0.02)


def test_the_friction_of_head_joints_is_that_of_their_mortar():
    wall(brick_material(headMortar=eindhoven(**WEAK, frictionAngle=0.3)))
    engines()
    O.step()
    found = {(i.id1, i.id2): i.phys.tangensOfFrictionAngle for i in O.interactions}
    for row, isHead in zip(dem.damage(), heads()):
        assert found[row["body1"], row["body2"]] == pytest.approx(math.tan(0.3) if isHead else 0.75)
    assert len(dem.damage()) == 14 and heads().sum() == 4


def test_unfilled_head_joints_are_dry():
    wall(brick_material(unfilledHeads=True))
    engines()
    O.step()
    assert len(dem.damage()) == 10 and not heads().any()
    two = end_to_end(brick_material(unfilledHeads=True))
    engines()
    steps(2)
    O.forces.setPermF(two, (10, 0, 0))  # no mortar holds it, and its bed has no friction
    steps(100)
    assert O.bodies[two].state.pos[0] - 0.2 == pytest.approx(0.5 * 10 / O.bodies[two].state.mass * 0.1**2, rel=0.03)


def test_bond_takes_beds_or_heads():
    dry = dem.BlockMat(**DRY)
    for after in (0, 2):
        for kind, count in (("bed", 10), ("head", 4), ("all", 14)):
            wall(dry)
            engines()
            steps(after)
            assert dem.bond(material=eindhoven(), joints=kind) == count
            O.step()
            assert len(dem.damage()) == count


def test_bond_holds_what_it_bonds_and_bonds_again(tmp_path):
    """f_t A = 5 kN; mortar that is bonded anew where it has been broken is sound. Saved between dem.bond and the step, it is there after loading."""
    O.reset()
    dry = dem.BlockMat(**DRY)
    base = dem.base((0.5, 0.2, 0.1), dry)
    one = dem.block(SIZE, dry, on=base)
    engines()
    steps(5)
    assert dem.bond([base, one], dem.JointMat(**{key: value for key, value in EINDHOVEN.items() if "Stiffness" not in key})) == 1
    O.save(str(tmp_path / "bonded.xml"))
    O.load(str(tmp_path / "bonded.xml"))
    steps(2)
    expected = 5000 + G * O.bodies[one].state.mass
    assert ramp(lambda force: O.forces.setPermF(one, (0, 0, force)), 1.2 * expected) == pytest.approx(expected, rel=0.02)
    O.forces.setPermF(one, (0, 0, 0))
    O.run(1500, True)  # it falls back
    refuses(lambda: dem.bond([base, one], eindhoven(flexuralStrength=0.6e6, tensileStrength=math.nan)), "flexuralStrength", "three times")
    assert dem.damage()["worst"][0] > 0.02
    assert dem.bond([base, one], eindhoven()) == 1
    steps(2)
    assert dem.damage()["worst"][0] == 0 and np.isnan(dem.damage()["cracked"][0])


def test_units_split_in_their_middle():
    """2 MPa of 0.1 x 0.05 m: 10 kN; half blocks stay whole."""
    wall(split=dem.JointMat(**UNIT))
    engines()
    O.step()
    assert len(dem.damage()) == len(O.interactions) and len(O.bodies) == 13
    two = end_to_end(dem.BlockMat(density=1900, frictionAngle=0.0), split=dem.JointMat(**UNIT))
    engines()
    steps(2)
    assert ramp(lambda force: O.forces.setPermF(two, (force, 0, 0)), 1.2e4) == pytest.approx(1e4, rel=0.02)


def shaken(dt=1e-3):
    O.reset()
    weak = brick_material(eindhoven(**{**WEAK, "tensileStrength": 0.01e6, "cohesion": 0.014e6}))
    base = dem.base((2, 1, 0.2), weak)
    dem.wall(6, 2, BRICK_WALL, weak, on=base)
    motion = dem.record_motion(Record(1e-3, 40 * np.sin(2 * np.pi * 5 * np.arange(1001) * 1e-3)), [base])
    engines(motion, dt=dt)
    return motion


def test_new_engines_go_on_with_the_cracks():
    """With the same motion, they go on with the same bits of the blocks as the old ones."""
    motion = shaken()
    O.run(150, True)
    assert dem.energy()["crackDissip"] > 0
    O.run(50, True)
    table, state = dem.damage(), bits_of_blocks()
    shaken()
    O.run(150, True)
    motion = O.engines[-1].motions[0]
    engines(motion)
    O.run(50, True)
    assert np.array_equal(bits_of_blocks(), state) and dem.damage().tobytes() == table.tobytes()
    assert (table["energy_tension"] + table["energy_shear"]).sum() == pytest.approx(dem.energy()["crackDissip"], rel=1e-9)
    refuses(lambda: rigid_engines(motion, model="compliant"), "another model")


def bits_of_blocks():
    return np.array([x for b in O.bodies for v in (b.state.pos, b.state.ori, b.state.vel, b.state.angVel) for x in v]).view(np.int64)


@pytest.mark.parametrize("size, courses", [((0.2, 0.5, 0.4), 1), ((0.2, 0.5, 0.2), 4)])
def test_a_tilting_table_breaks_mortar_at_its_closed_form(size, courses):
    """(t/H) (1 + f_t/(rho g H)): one block, and a stack, whose lowest joint breaks. The load comes at once."""
    O.reset()
    of = brick_material(eindhoven(**{**WEAK, "tensileStrength": 0.02e6, "cohesion": 0.028e6}))
    dem.stack(courses, size, of, on=dem.base((2, 1, 0.2), of))
    height = courses * size[2]
    expected = size[0] / height * (1 + 0.02e6 / (1900 * G * height))
    found = dem.TiltTable().bisect(tolerance=5e-3, lower=0.8 * expected)
    assert found.multiplier == pytest.approx(expected, rel=1e-2)
    assert not found.doubts


@pytest.mark.parametrize("height, load", [(0.3, 0), (0.3, 2000), (0.05, 0), (0.05, 2000)])
def test_a_pushed_stack_breaks_at_its_closed_form(height, load):
    """(f_t A + W) t/2 over the height of the push where the joint turns, c A + mu W where it slips, whichever is less; W with the dead load on top. The peak lasts while the
    crack opens by G_I/f_t = 0.08 mm, 0.8 s at 0.1 mm/s: means over 0.02 s have it."""
    O.reset()
    of = brick_material(eindhoven(**WEAK))
    base = dem.base((2, 0.2, 0.1), of)
    ids = dem.stack(2, (0.2, 0.2, 0.2), of, on=base)
    weight = 2 * G * O.bodies[ids[0]].state.mass
    given = {"vertical": "load", "force": load} if load else {}
    push = dem.push([ids[-1] if height > 0.2 else ids[0]], displacement=1e-4, speed=1e-4, height=height, **given)
    engines(push)
    dem.run(until=push)
    turn, slip = (WEAK["tensileStrength"] * 0.04 + weight + load) * 0.1 / height, WEAK["cohesion"] * 0.04 + 0.75 * (weight + load)
    assert (turn < slip) == (height > 0.2)
    assert push.averaged(0.02)["force"].max() == pytest.approx(min(turn, slip), rel=0.03)
