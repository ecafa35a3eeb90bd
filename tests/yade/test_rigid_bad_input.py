"""Bad input to rigid blocks: one clear error that names attribute, value and what is allowed, before anything has moved."""

import math

import pytest
from masonry import dem
from rocking_scene import one_block, refuses, refuses_to_run, rigid_engines, stone
from yade import NewtonIntegrator, O, Quaternion, Vector3, utils


nan = math.nan
base, block = 0, 1  # the ids of one_block()


@pytest.mark.parametrize("name, bad, why", (
    ("model", "magic", "'planar'"), ("impactOrder", "random", "'simultaneous'"), ("onTrouble", "ignore", "'continue'"), ("tolerance", 0, "above 0"),
    ("tolerance", 0.1, "1e-3"), ("tolerance", nan, "above 0"), ("mostEvents", 0, "at least 1"), ("motions", [NewtonIntegrator()], "PulseTrainEngine"),
))
def test_attributes(name, bad, why):
    refuses(lambda: dem.MoreauJeanIntegrator(**{name: bad}), "MoreauJeanIntegrator." + name, why)
    engine = dem.MoreauJeanIntegrator()
    before = getattr(engine, name)
    refuses(lambda: setattr(engine, name, bad), name, why)
    assert getattr(engine, name) == before


@pytest.mark.parametrize("option, bad, words", (
    ("model", "magic", ("planar",)), ("dt", 1.0, ("at most",)), ("dt", "1e-3", ("number",)), ("gravity", 1e300, ("from 1e-06 to 1e+06",)), ("dt", 0, ("positive",)), ("dt", nan, ("positive",)), ("tolerance", 0, ("above 0",)),
    ("tolerance", 1, ("0.001",)), ("impact_order", "random", ("simultaneous",)), ("penetration", 1e-5, ("compliant",)), ("motion", "pulse", ("PulseTrainEngine",)), ("recorder", 3, ("BlockRecorder",)),
    ("others", 3, ("list of engines",)),
))
def test_options_of_engines(option, bad, words):
    one_block(5)
    model = {} if option == "model" else {"model": "planar"}
    refuses(lambda: rigid_engines(**{**model, option: bad}), str(bad), *words)


def test_motions_and_gravity():
    one_block(5)
    refuses(lambda: rigid_engines(gravity=0), "dt = None", "gravity is 0")
    refuses(lambda: rigid_engines(model="compliant", tolerance=1e-9), "tolerance", "rigid")
    refuses(lambda: rigid_engines(dem.PulseTrainEngine(ids=[block], impulse=0.1, times=[0])), "ids", str(block), "prescribed")
    refuses(lambda: rigid_engines([dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0])] * 2), "PulseTrainEngine.direction", "beside a PulseTrainEngine", "perpendicular")


def test_a_scene_without_blocks():
    dem.base((1, 1, 1), stone())
    refuses(rigid_engines, "no free block", "dem.block()")


@pytest.mark.parametrize("ask", (dem.MoreauJeanIntegrator.choice, lambda _: O.step()))
def test_a_choice_of_the_model_that_was_refused(ask):
    """It leaves nothing behind."""
    dem.base((1, 1, 1), stone())
    engine = dem.MoreauJeanIntegrator()
    O.engines = [engine]
    refuses(lambda: ask(engine), "no free block", kind=(RuntimeError, ValueError))
    one_block(5)
    O.engines = [engine]
    O.dt = 0.2 * engine.largestTimeStep
    O.step()
    assert engine.chosenModel == "planar", engine.reason


def scene(**options):
    ids = one_block(5)
    O.engines = rigid_engines(**options)
    return ids


@pytest.mark.parametrize("change, words", (
    (lambda: setattr(O, "dt", 0.1), ("O.dt", "0.1", "at most")),
    (lambda: setattr(O, "dt", 0), ("O.dt", "0", "positive")),
    (lambda: setattr(O, "engines", O.engines + rigid_engines()), ("more than one MoreauJeanIntegrator",)),
    (lambda: setattr(O, "engines", O.engines * 2), ("more than one MoreauJeanIntegrator",)),
    (lambda: setattr(O.engines[-1], "gravity", (0, 0, nan)), ("MoreauJeanIntegrator.gravity", "nan", "finite")),
    (lambda: setattr(O.bodies[block].state, "blockedDOFs", "z"), (f"O.bodies[{block}]", "blockedDOFs = 'z'", "none")),
    (lambda: setattr(O, "engines", O.engines + [NewtonIntegrator()]), ("NewtonIntegrator", f"move block {base}", "mask")),
    (lambda: setattr(O, "engines", [dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0])] + O.engines), ("PulseTrainEngine", "MoreauJeanIntegrator.motions")),
    (lambda: setattr(O, "engines", [dem.RockingJointEngine()] + O.engines), ("RockingJointEngine", "not both")),
    (lambda: O.bodies.append(utils.sphere((9, 9, 9), 1, material=O.bodies[block].mat)), ("BlockMat", "neither a Box nor a ConvexBlock")),
))
def test_changes_after_the_engines_were_made(change, words):
    scene()
    change()
    refuses_to_run(*words)


@pytest.mark.parametrize("bad", (0, -1, nan, math.inf, 1e300, 1e-300))
def test_masses_and_inertias(bad):
    for attribute, value in (("mass", bad), ("inertia", Vector3(1, bad, 1))):
        one_block(5)
        setattr(O.bodies[block].state, attribute, value)
        refuses(rigid_engines, f"O.bodies[{block}].state.{attribute}", "from 1e-18 to 1e+18 kg")


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_mass_that_is_changed_in_a_run(method):
    scene(method=method)
    O.step()
    O.bodies[block].state.mass = 0
    refuses_to_run(f"O.bodies[{block}].state.mass = 0", "from 1e-18")


def test_extents():
    one_block(5)
    O.bodies[block].shape.extents = (-0.3, 0.5, 1.5)
    refuses(rigid_engines, f"O.bodies[{block}].shape.extents[0] = -0.3", "from 1e-18 to 1e+18 m")


@pytest.mark.parametrize("bad", (30, 45, -1, nan))
def test_friction_angles(bad):
    scene()
    O.materials[0].noSlip, O.materials[0].frictionAngle = False, bad
    refuses_to_run(f"bodies {base} and {block}", "tangensOfFrictionAngle = nan", "below pi/2, in rad")


@pytest.mark.parametrize("name, bad, why", (("tangensOfFrictionAngle", -0.5, "0 or positive"), ("restitution", 1.5, "from 0 to 1")))
def test_laws_of_joints(name, bad, why):
    scene()
    O.step()
    O.interactions[base, block].phys.noSlip = False
    setattr(O.interactions[base, block].phys, name, bad)
    refuses_to_run(f"bodies {base} and {block}", f"{name} = {bad}", why)


def test_what_the_plane_never_uses_may_be_blocked():
    scene()
    O.bodies[block].state.blockedDOFs = "yXZ"
    O.step()


def test_a_plane_that_no_block_has():
    scene(model="planar")
    O.bodies[block].state.ori = Quaternion(Vector3(1, 1, 0).normalized(), 0.1)
    refuses_to_run("'planar'", "no block has a horizontal axis")


@pytest.mark.parametrize("share", (4e-5, 6e-5))
@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_overlap(share, model):
    """It is refused from 5e-5 of the smallest size on, which is the 0.3 m of the base."""
    base, block, _ = one_block(5)
    O.bodies[block].state.pos -= Vector3(0, 0, share * 0.3)
    if share > 5e-5:
        refuses(lambda: rigid_engines(model=model), f"overlapping blocks: {base} and {block} (by 1.8e-05 m)")
    else:
        O.engines = rigid_engines(model=model)
        O.step()


def test_overlap_of_a_block_that_a_script_moves():
    """At the start, and where a script puts a block; right again, the run goes on."""
    scene()
    O.bodies[block].state.pos -= Vector3(0, 0, 1e-3)
    refuses_to_run(f"Blocks {base} and {block}", "0.001", "overlap")
    O.bodies[block].state.pos += Vector3(0, 0, 1e-3)
    O.run(10, True)
    O.bodies[block].state.pos -= Vector3(0, 0, 1e-3)
    refuses_to_run(f"Blocks {base} and {block}", "0.001", "overlap")
    O.bodies[block].state.pos += Vector3(0, 0, 1e-3)
    O.run(10, True)
    assert abs(O.bodies[block].state.pos[2] - 1.5) < 1e-9


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_a_block_that_a_script_makes_larger_in_a_run(method):
    base, block, _ = one_block(2)
    O.engines = rigid_engines(method=method, dt=1e-3)
    O.run(5, True)
    O.bodies[block].shape.extents += Vector3(0, 0, 0.01)
    refuses_to_run(f"Blocks {base} and {block}", "0.01", "overlap")
    O.bodies[block].shape.extents -= Vector3(0, 0, 0.01)
    O.run(5, True)
    assert O.engines[-1].failures == 0


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_numbers_that_are_none(method):
    """Given by a script on the way."""
    _, block, _ = scene(method=method)
    O.step()
    state = O.bodies[block].state
    for attribute in ("pos", "vel", "angVel"):
        before = Vector3(getattr(state, attribute))
        setattr(state, attribute, (nan, 0, math.inf))
        refuses(O.step, f"O.bodies[{block}].state.{attribute} = (nan   0 inf)", "must be finite")
        setattr(state, attribute, before)
    O.forces.setPermF(block, (0, nan, 0))
    refuses(O.step, f"O.forces of body {block}", "f =   0 nan   0")
    O.forces.setPermF(block, (0, 0, 0))
    O.step()
    assert state.pos.norm() < 10 and not O.engines[-1].failures
    # A speed whose square is none: what the step itself makes of it.
    state.vel = (1e300, 0, 0)
    refuses(O.step, "diverged", "no longer finite", kind=RuntimeError)
