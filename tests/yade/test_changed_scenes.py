"""What a script changes between steps is met with the next: bodies that go, come and are replaced, engines, gravity; what rigid or compliant blocks
cannot do is refused then as it is before the first step."""

import numpy as np
import pytest
from masonry import dem
from mortar_scene import SIZE, brick_material
from rocking_scene import quiet_engines, refuses, refuses_to_run, rigid_engines, stone
from yade import FrictMat, NewtonIntegrator, O, State, Vector3, utils


def scene(engines=rigid_engines, reset=True):
    """(base, a block that stands on it, one in the air beside it), after some steps."""
    if reset:
        O.reset()
    base = dem.base((4, 1, 0.2), stone(0.7))
    standing = dem.block((0.6, 1, 1), O.bodies[base].mat, on=base)
    falling = dem.block((0.6, 1, 1), O.bodies[base].mat, center=(1, 0, 1e3))
    O.engines = engines(dt=1e-3) if engines is rigid_engines else engines()
    O.run(10, True)
    return base, standing, falling


def box(center, material):
    body = utils.box(center, (0.3, 0.5, 0.5), material=material)
    body.aspherical = True
    return body


def falls(id, since):
    """From rest in the step that ended at `since`, freely."""
    state, time = O.bodies[id].state, O.time - since
    return abs(state.pos[2] - state.refPos[2] + 9.81 * time**2 / 2) < 1e-9 * 9.81 * time**2 + 1e-9


@pytest.mark.parametrize("apart", (0, 10, 25))
def test_erased_blocks(apart):
    """Erased bodies: the place in memory before the first must not tell whether there is one (66 blocks, the last of them erased, stopped YADE)."""
    base = dem.base((60, 1, 0.2), stone(noSlip=False, frictionAngle=0.6))
    wall = dem.wall(10, 5, (0.4, 0.2, 0.2), O.bodies[base].mat, on=base)
    others = [dem.block((0.4, 0.2, 0.2), O.bodies[base].mat, center=(6 + k, 0, 0.1)) for k in range(apart)]
    O.engines = rigid_engines(method="wall")
    O.run(50, True)
    last = (wall + others)[-1]
    beside = [i for i in O.interactions if last in (i.id1, i.id2)]
    assert beside
    O.bodies.erase(last)
    O.run(3, True)
    assert not [i for i in O.interactions if last in (i.id1, i.id2)] and O.engines[-1].failures == 0


def lift(ids):
    O.bodies[ids[-1]].state.pos += Vector3(0, 0, 1)


def erase(ids):
    O.bodies.erase(ids[-1])


def freeze(ids):
    O.bodies[ids[1]].dynamic = O.bodies[ids[2]].dynamic = False


@pytest.mark.parametrize("act", (lift, erase, freeze))
@pytest.mark.parametrize("loaded, renewed", ((True, False), (False, True), (True, True)))
def test_forces_that_no_longer_act(act, loaded, renewed):
    """Forces that no longer act are not shown: blocks moved, frozen or erased between loading, or new engines, and the first step."""
    material = stone(0.7, noSlip=False, frictionAngle=0.5)
    ids = dem.stack(3, (0.5, 0.6, 0.4), material, dem.base((8, 8, 0.2), material))
    O.engines = rigid_engines()
    O.run(20, True)
    if loaded:
        O.saveTmp()
        O.loadTmp()
    if renewed:
        O.engines = rigid_engines()
    act(ids)
    O.run(100, True)
    assert sorted((i.id1, i.id2) for i in O.interactions) == [(0, ids[0]), (ids[0], ids[1])]


@pytest.mark.parametrize("engines", (rigid_engines, quiet_engines))
def test_a_force_that_a_script_adds(engines):
    """A force that a script adds between two steps acts in the next, alone."""
    dem.base((8, 8, 0.2), stone(0.7))
    block = dem.block((0.5, 0.5, 0.5), O.bodies[0].mat, center=(0, 0, 5))
    O.engines = engines(model="planar" if engines is rigid_engines else "compliant")
    for step, wanted in enumerate((0, 1, 1, 2, 2)):
        if step in (1, 3):
            O.forces.addF(block, Vector3(O.bodies[block].state.mass, 0, 0))
        O.step()
        assert abs(O.bodies[block].state.vel[0] - wanted * O.dt) < 1e-12 * O.dt


def test_a_body_at_the_place_of_an_erased_one():
    """A body at the place of one that was erased is another; its shape is its own."""
    base, standing, falling = scene()
    O.bodies.erase(falling)
    O.run(10, True)
    begin = O.time
    O.bodies.insertAtId(box((1, 0, 900), O.bodies[base].mat), falling)
    O.run(100, True)
    assert falls(falling, begin)
    O.bodies.erase(falling)
    O.bodies.insertAtId(box((1, 0, 800), O.bodies[base].mat), falling)
    begin = O.time
    O.run(100, True)
    assert falls(falling, begin) and O.engines[-1].chosenModel == "planar"


def test_a_state_in_the_place_of_another():
    """A state that a script puts in the place of another like it is the block's from then on: it falls back and rocks as it would have."""
    angles = []
    for replaced in (False, True):
        base, standing, falling = scene(lambda: rigid_engines(dt=1e-3))
        dem.tilt(standing, 0.2)
        O.run(50, True)
        if replaced:
            copied = State()
            copied.updateAttrs(O.bodies[standing].state.dict())
            O.bodies[standing].state = copied
        start = dem.angle(standing)
        O.run(50, True)
        angles.append(dem.angle(standing))
    assert angles[0] < start - 0.01 and abs(angles[1] - angles[0]) < 1e-12, angles


def test_a_material_that_makes_a_block_of_a_box():
    """A material that makes a block of a box, and one that makes none of it."""
    base, standing, falling = scene()
    other = O.bodies.append(box((-1, 0, 700), FrictMat()))
    O.run(10, True)
    O.bodies[other].mat = O.bodies[base].mat
    begin = O.time
    O.run(100, True)
    assert falls(other, begin)
    O.bodies[other].mat = FrictMat()
    at = O.bodies[other].state.pos
    O.run(100, True)
    assert O.bodies[other].state.pos == at and O.engines[-1].failures == 0


def test_a_block_out_of_the_plane():
    """What comes out of the plane: the run goes on in space. Beside a base that is 1 m deep nothing carries a block that is 3 m away."""
    base, standing, falling = scene()
    beside = dem.block((0.6, 1, 1), O.bodies[base].mat, center=(0, 3, 1.7))
    begin = O.time
    O.run(800, True)
    assert O.engines[-1].chosenModel == "spatial" and falls(beside, begin)


def test_the_last_free_block_goes():
    base, standing, falling = scene()
    O.bodies.erase(falling)
    O.bodies.erase(standing)
    refuses_to_run("There is no free block")


@pytest.mark.parametrize("how", ("loaded", "refused"))
def test_a_block_out_of_the_plane_later(how):
    """The same after loading, and after a first step that was refused."""
    base, standing, falling = scene()
    if how == "loaded":
        O.saveTmp()
        O.loadTmp()
    else:
        O.engines = rigid_engines(dt=1e-3)
        O.bodies[falling].state.blockedDOFs = "x"
        refuses_to_run("blockedDOFs")
        O.bodies[falling].state.blockedDOFs = ""
    beside = dem.block((0.6, 1, 1), O.bodies[base].mat, center=(0, 3, 1.7))
    begin = O.time
    O.run(800, True)
    assert O.engines[-1].chosenModel == "spatial" and falls(beside, begin)


def test_a_base_that_is_replaced():
    """A base that is replaced while a motion moves it is not put where the other was; what scripts give a base that is not moved is its own."""
    base, standing, falling = scene()
    O.engines[-1].motions = [dem.RecordMotionEngine(ids=[base], samples=[1.0] * 200, interval=0.01, start=O.time)]
    O.run(100, True)
    O.bodies.erase(base)
    another = utils.box((5, 0, -9), (2, 0.5, 0.1), material=O.bodies[standing].mat)
    another.dynamic = False
    O.bodies.insertAtId(another, base)
    refuses_to_run("would put body 0", "start=O.time")


def test_other_engines_and_gravity():
    """Engines and gravity that the next step meets."""
    base, standing, falling = scene()
    kept = O.engines
    O.engines = kept + [NewtonIntegrator(gravity=(0, 0, -9.81))]
    refuses_to_run("NewtonIntegrator would move block")
    sleeping = NewtonIntegrator(gravity=(0, 0, -9.81), dead=True)
    O.engines = kept + [sleeping]
    O.run(10, True)
    sleeping.dead = False
    refuses_to_run("NewtonIntegrator would move block")
    O.engines = kept
    O.periodic = True
    refuses_to_run("O.periodic = True")
    O.periodic = False
    O.engines[-1].gravity = (0, 0, -9.81e6)
    refuses_to_run("O.dt = 0.001 s is not allowed")
    O.engines[-1].gravity = (0, 0, -9.81)
    O.run(10, True)


@pytest.mark.parametrize("model", ("planar", "compliant"))
def test_no_clumps_and_no_periodic_cells(model):
    """No clumps, no periodic cells, with neither model."""
    base = dem.base((4, 1, 0.2), stone(0.7))
    ids = dem.stack(2, (0.6, 1, 1), O.bodies[base].mat, base)
    O.engines = quiet_engines(model=model)
    O.periodic = True
    O.cell.setBox(50, 50, 50)
    refuses_to_run("O.periodic = True", "no periodic cell")
    O.periodic = False
    O.bodies.clump(ids)
    refuses_to_run(f"O.bodies[{ids[0]}] is a member of a clump")


def test_a_dead_integrator_integrates_nothing():
    """Compliant: an integrator that is dead integrates nothing, and its gravity and damping are nobody's."""
    base, standing, falling = scene(quiet_engines)
    O.engines = O.engines + [NewtonIntegrator(gravity=(0, 0, 0), damping=0.2, dead=True)]
    O.run(1, True)
    assert abs(dem.energy()["potential"] / (O.bodies[standing].state.mass * 9.81 * (0.5 + 1e3)) - 1) < 1e-6


def test_what_the_step_remembers_in_the_plane():
    """What the step remembers in the plane is of no use in space."""
    base, standing, falling = scene()
    kept = O.engines[-1].remembered
    O.bodies[falling].state.vel = (0, 1, 0)
    O.run(10, True)
    O.engines[-1].remembered = kept
    refuses_to_run("remembered is of a run in the plane")


def test_a_train_that_has_begun():
    """A train that has begun goes on as it is."""
    base, standing, falling = scene()
    train = dem.PulseTrainEngine(ids=[base], impulse=0.1, resonantBlock=standing, start=O.time)
    O.engines[-1].motions = [train]
    O.run(10, True)
    for name, value in (("resonantBlock", falling), ("assembly", True)):
        refuses(lambda: setattr(train, name, value), f"PulseTrainEngine.{name} = ", "once the motion has begun")
    assert np.isfinite(O.bodies[standing].state.pos).all()


@pytest.mark.parametrize("make", (rigid_engines, quiet_engines))
def test_engines_of_one_scene_in_another(make, tmp_path):
    """Engines that are used in another scene have nothing of the one before, wherever that lies in memory (after several resets a scene lies where
    another did), and saved before their first step neither."""
    seen, engines, compliant = [], None, make is quiet_engines

    def used(stiffness=1e8):
        for body in O.bodies:
            if compliant:
                body.mat.normalStiffness = body.mat.shearStiffness = stiffness
        chosen = engines or make(model="compliant" if compliant else "auto")
        O.dt = 5e-4
        return chosen

    for resets in (0, 1, 3):
        for _ in range(resets):
            O.reset()
        base, standing, falling = scene(used)
        engines = O.engines
        dem.tilt(standing, 0.05)
        O.run(2000, True)
        seen.append((len(dem.impacts()), dem.energy()["impactDissip"], dem.energy()["kinetic"]))
    assert seen[0][0] > 5 and seen[0] == seen[1] == seen[2], seen
    O.reset()
    dem.block((0.6, 1, 1), stone(0.7), on=dem.base((4, 1, 0.2), stone(0.7)))
    O.engines = used(stiffness=1e10)
    if compliant:
        joints, = (e for e in engines if isinstance(e, dem.RockingJointEngine))
        assert joints.criticalTimeStep() == dem.RockingJointEngine().criticalTimeStep()
        O.dt = 0.1 * joints.criticalTimeStep()
    O.save(str(tmp_path / "second.yade"))
    O.load(str(tmp_path / "second.yade"))
    O.run(10, True)
    assert len(dem.impacts()) == 0 and abs(dem.energy()["impactDissip"]) < 1e-9 and dem.energy()["kinetic"] < 1e-9
    assert compliant or O.engines[-1].substeps == 10


def two_bricks():
    material = brick_material()
    return dem.stack(2, SIZE, material, on=dem.base((1, 1, 0.1), material))


def test_cleared_bodies():
    """O.bodies.clear() leaves the joints of its bodies in O.interactions. Compliant blocks refuse to take them for joints of the bodies that come in their
    places; without them new engines begin anew, with sound mortar. Rigid blocks find their contacts themselves: the second scene moves as the first."""
    two_bricks()
    O.engines = quiet_engines(model="auto")
    O.run(20, True)
    O.bodies.clear()
    two_bricks()
    refuses(lambda: quiet_engines(model="auto"), "bodies 0 and 1", "O.bodies.clear()", "O.reset()", kind=RuntimeError)
    refuses_to_run("O.bodies.clear()", "O.reset()")
    O.interactions.clear()
    O.engines = quiet_engines(model="auto")
    O.run(20, True)
    assert [i.phys.bonded for i in O.interactions if i.isReal] == [True, True] and len(dem.damage()) == 2
    found = []
    O.reset()
    for _ in range(2):
        O.bodies.clear()
        base, standing, _ = scene(lambda: O.engines or rigid_engines(dt=1e-3), reset=False)
        dem.tilt(standing, 0.2)
        O.run(300, True)
        found.append((tuple(O.bodies[standing].state.pos), dem.angle(standing)))
    assert found[0] == found[1] and O.engines[-1].failures == 0
