"""Bad input: one clear error that names attribute, value and what is allowed, before anything has moved."""

import inspect
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import one_block, quiet_engines, refuses, refuses_to_run, said_by, steps, stone
from yade import O, Quaternion, RockingJointEngine, Vector3, utils

import masonry

nan, inf = math.nan, math.inf
text, numbers = "x" * 1000, list(range(10000))
BASE, BLOCK = 0, 1  # the ids of one_block()


@pytest.mark.parametrize("make", (
    dem.base, lambda size, material: dem.block(size, material, center=(0, 0, 0)), lambda size, material: dem.stack(2, size, material, 0),
    lambda size, material: dem.wall(2, 2, size, material, 0),
))
def test_sizes(make):
    """Sizes are refused by all that makes blocks."""
    dem.base((1, 1, 1), stone())
    for bad in ((0, 1, 1), (1, -1, 1), (1, 1, nan), (1, 1, inf), (1, 1), 0.4, "1", "111", (1, 1, "1"), (True, 1, 1), (1, 1, 1e300), (1, 1, 1e-300)):
        refuses(lambda: make(bad, stone()), "size", str(bad), "positive")


def test_places_and_counts():
    dem.base((1, 1, 1), stone())
    refuses(lambda: dem.block((1, 1, 1), stone()), "on = None", "center = None")
    refuses(lambda: dem.block((1, 1, 1), stone(), on=0, center=(0, 0, 0)), "on = 0", "one of the two")
    refuses(lambda: dem.block((1, 1, 1), stone(), center=(0, 0, nan)), "center", "nan", "finite")
    refuses(lambda: dem.block((1, 1, 1), utils.defaultMaterial(), on=0), "material", "BlockMat")
    refuses(lambda: dem.block((1, 1, 1), stone(), center=(0, 0)), "center = (0, 0)", "three")
    refuses(lambda: dem.block((1, 1, 1), stone(), on=0, orientation=Quaternion((1, 0, 0), 0.1)), "orientation", "about z")
    refuses(lambda: dem.block((1, 1, 1), stone(), on=0, orientation=0.1), "orientation = 0.1", "Quaternion")
    refuses(lambda: dem.base((1, 1, 1), stone(), at=(0, nan)), "at", "nan", "two finite numbers")
    refuses(lambda: dem.block((0.5, 0.5, 1), stone(), on=0, at=3), "at = 3", "two finite numbers")
    refuses(lambda: dem.block((0.5, 0.5, 1), stone(), center=(0, 0, 1), at=(1, 0)), "at = (1.0, 0.0)", "`on`")
    refuses(lambda: dem.stack(2, (0.5, 0.5, 1), stone(), 0, at=(0.6, 0)), "(0.6, 0)", "body 0", "all must be above it")
    refuses(lambda: dem.stack(0, (1, 1, 1), stone(), 0), "n = 0", "at least 1")
    refuses(lambda: dem.stack(1e300, (1, 1, 1), stone(), 0), "n = 1e+300", "at most 1000000")
    refuses(lambda: dem.stack(2.5, (1, 1, 1), stone(), 0), "n = 2.5", "whole number")
    refuses(lambda: dem.wall(0, 2, (1, 1, 1), stone(), 0), "courses = 0", "at least 1")
    refuses(lambda: dem.wall(2, 2, (1, 1, 1), stone(), 0, gap=-0.1), "gap = -0.1", "positive")
    refuses(lambda: dem.wall(2, 2, (1, 1, 1), stone(), 0, gap=nan), "gap = nan", "positive")


@pytest.mark.parametrize("name, bads, allowed", (
    ("density", (0, -2000, nan, inf, 1e300, 1e40, 1e-300), "from 1e-12 to 1e+12"), ("frictionAngle", (-0.1, math.pi / 2, nan), "pi/2"),
))
def test_materials(name, bads, allowed):
    """Materials: where a block is made of one, and where one has been changed before dem.engines()."""
    for bad in bads:
        O.reset()
        refuses(lambda: dem.base((1, 1, 1), dem.BlockMat(**{name: bad})), name, str(bad), allowed)
        assert len(O.bodies) == 0 and len(O.materials) == 0
        one_block(5)
        setattr(O.bodies[1].mat, name, bad)
        refuses(quiet_engines, name, str(bad), allowed)


def test_ids():
    refuses(lambda: dem.block((1, 1, 1), stone(), on=77), "on = 77", "it is empty", "dem.base()")
    dem.base((1, 1, 1), stone())
    refuses(lambda: dem.tilt(0, 0.1), "id = 0", "prescribed", "free block")
    sphere = O.bodies.append(utils.sphere((9, 9, 9), 1))
    for bad, why in ((-1, "no such body"), (77, "no such body"), (True, "no such body"), (1.5, "no such body"), (sphere, "must be a Box")):
        refuses(lambda: dem.block((1, 1, 1), stone(), on=bad), "on = ", str(bad), why)
        refuses(lambda: dem.tilt(bad, 0.1), "id", str(bad), why)
        refuses(lambda: dem.angle(bad), "id", str(bad), why)
    for bad in (2.0, nan, -inf):
        refuses(lambda: dem.tilt(0, bad), "angle", str(bad), "-pi/2", "rad")
    for act in (lambda: dem.tilt(0, "0.1"), lambda: dem.check_blocks("0.1"), lambda: dem.structures("0.1")):
        refuses(act, "= '0.1': must be a number")
    refuses(lambda: dem.history(None), "recorder = None", "BlockRecorder")
    lying = dem.block((1, 1, 0.2), stone(), center=(9, 0, 0.5), orientation=Quaternion(Vector3(1, 0, 0), math.pi / 2))
    refuses(lambda: dem.tilt(lying, 0.1), f"id = {lying}", "does not stand")
    O.bodies.erase(lying)
    refuses(lambda: dem.tilt(0, 0.1, axis="z"), "axis", "'z'", "'x' or 'y'")
    refuses(lambda: dem.angle(0, axis="z"), "axis", "'z'", "'x' or 'y'")


@pytest.mark.parametrize("name, bad", (
    ("model", "magic"), ("penetration", 0), ("penetration", 0.1), ("penetration", nan), ("dt", 0), ("dt", -1e-4), ("dt", nan), ("gravity", -1),
    ("gravity", nan), ("gravity", inf), ("gravity", 1e300), ("gravity", 1e-300), ("gravity", None), ("gravity", (0, 0, -9.81)), ("dt", "1e-3"),
    ("dt", True), ("penetration", "1e-5"), ("penetration", 1e-300), ("tolerance", "1e-9"), ("impact_order", "random"),
))
def test_options_of_engines(name, bad):
    one_block(5)
    refuses(lambda: quiet_engines(**{name: bad}), name, str(bad), "must be")


def test_engines_of_scenes():
    dem.base((1, 1, 1), stone())
    refuses(quiet_engines, "no free block", "dem.block()")
    one_block(5)
    refuses(lambda: quiet_engines("pulse"), "motion", "'pulse'", "PulseTrainEngine")
    refuses(lambda: quiet_engines(dt=1.0), "dt", "1", "below")
    refuses(lambda: quiet_engines(gravity=0), "gravity = 0", "normalStiffness")
    quiet_engines(dt=np.float32(1e-5), gravity=np.float32(9.81))


@pytest.mark.parametrize("make, words", (
    (lambda: dem.WallRecorder(), ("WallRecorder.iterPeriod = 0", "positive")), (lambda: dem.WallRecorder(virtPeriod=nan), ("virtPeriod = nan", "positive")),
    (lambda: dem.WallRecorder(iterPeriod=1, ids=[99]), ("id = 99", "no such body")), (lambda: dem.BlockRecorder(iterPeriod=1), ("BlockRecorder.ids", "empty")),
    (lambda: dem.BlockRecorder(ids=[1], iterPeriod=-1), ("BlockRecorder.iterPeriod = -1", "positive")),
))
def test_recorders(make, words):
    one_block(5)
    refuses(lambda: quiet_engines(recorder=make()), *words)


@pytest.mark.parametrize("motion, words", (
    (masonry.Record(0.01, [0, 1]), "dem.record_motion(record, ids=[base])"), (masonry.PulseTrain(0.1), "dem.PulseTrainEngine(ids=[base], impulse=0.1, resonantBlock=block)"),
    (masonry.PulseTrain(0.1, times=[0]), "times=..."), (masonry.HalfSine(1.0, 0.1), "dem.record_motion(masonry.Record(dt, motion.acceleration(times)), ids=[base])"),
))
def test_theories_are_no_motions_of_a_scene(motion, words):
    one_block(5)
    refuses(lambda: quiet_engines(motion), f"motion = {motion!r}", words)


def test_record_motion():
    base, block, _ = one_block(5)
    refuses(lambda: dem.record_motion([0, 1], ids=[base]), "record = [0, 1]", "masonry.Record")
    for bad in (0, "0", [0.5], [-1]):
        refuses(lambda: dem.record_motion(masonry.Record(0.01, [0, 1]), ids=bad), f"ids = {bad!r}", "a list of ids")
    assert dem.record_motion(masonry.Record(0.01, [0, 1]), ids=np.array([base])).ids == [base]
    for bad in ("x", (2, 0, 0), (0.6, 0, 0), (1, 0), (nan, 0, 1), 1, None):
        refuses(lambda: dem.record_motion(masonry.Record(0.01, [0, 1]), ids=[base], direction=bad), f"direction = {bad!r}: must be a unit vector of three numbers")
    for good in ([0, 0, 1], np.array([0, 0, 1.0]), Vector3(0, 0, 1)):
        assert dem.record_motion(masonry.Record(0.01, [0, 1]), ids=[base], direction=good).direction == Vector3(0, 0, 1)
    refuses(lambda: dem.record_motion(masonry.Record(0.01, [0, 1], scale=[1, 2]), ids=[base]), "record.scale = [1, 2]", "one number")


@pytest.mark.parametrize("name, bad, why", (
    ("impulse", inf, "finite"), ("times", [0, 2, 1], "increasing"), ("times", [1, 1], "increasing"), ("times", [-1, 1], ">= 0"),
    ("times", [0, nan], "finite"), ("halfCycles", -2, ">= 1"), ("halfCycles", 0, ">= 1"), ("duration", -1, ">= 0"), ("duration", nan, ">= 0"), ("shape", "square", "square"),
))
def test_attributes_of_pulse_trains(name, bad, why):
    refuses(lambda: dem.PulseTrainEngine(**{name: bad}), name, why)


def test_motions_of_a_scene():
    base, block, _ = one_block(5)
    for bad in (77, -1):
        refuses(lambda: quiet_engines(dem.PulseTrainEngine(ids=[bad], impulse=0.1, times=[0])), "ids", str(bad), "no such body")
    refuses(lambda: quiet_engines(dem.PulseTrainEngine(impulse=0.1, times=[0])), "ids", "empty")
    refuses(lambda: quiet_engines(dem.PulseTrainEngine(ids=[block], impulse=0.1, times=[0])), "ids", str(block), "prescribed")
    refuses(lambda: quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0], direction=(2, 0, 0))), "direction = 2 0 0", "unit")
    for bad in (nan, inf):
        refuses(lambda: quiet_engines(dem.RecordMotionEngine(ids=[base], samples=[0, 1], start=bad)), f"RecordMotionEngine.start = {bad}", "finite")


@pytest.mark.parametrize("bad, words", (
    (dict(times=[0]), ("impulse", "nan")), (dict(impulse=1e300, times=[0]), ("impulse = 1e+300", "at most 1e6")), (dict(impulse=0.1), ("times has 0 entries", "resonantBlock = -1")),
    (dict(impulse=0.1, times=[0], resonantBlock=BLOCK), ("times has 1 entries", f"resonantBlock = {BLOCK}")), (dict(impulse=0.1, resonantBlock=77), ("resonantBlock", "77")), (dict(impulse=0.1, resonantBlock=BASE), ("resonantBlock = 0", "free block")),
    (dict(impulse=0.1, times=[0], halfCycles=1), ("halfCycles = 1", "where times are given")),
    (dict(impulse=0.1, times=[0], assembly=True), ("assembly = True", "a single pulse")),
    (dict(impulse=0.1, resonantBlock=BLOCK, assembly=True), ("assembly = True", "with resonantBlock")), (dict(impulse=0.1, times=[0], duration=1), ("duration", "1", "dirac")), (dict(impulse=0.1, times=[0], shape="half-sine"), ("duration", "0")),
))
def test_pulse_trains(bad, words):
    one_block(5)
    refuses(lambda: quiet_engines(dem.PulseTrainEngine(ids=[BASE], **bad)), *words)


@pytest.mark.parametrize("bad, words", (
    (dict(samples=[0, nan]), ("samples", "nan")), (dict(samples=[1]), ("samples has 1 value", "at least two")), (dict(samples=[0, 1], interval=0), ("interval", "0")), (dict(samples=[0, 1], scale=inf), ("scale", "inf")),
    (dict(samples=[0, 1], baseline="wavy"), ("baseline", "wavy")),
))
def test_attributes_of_records(bad, words):
    refuses(lambda: dem.RecordMotionEngine(**bad), *words)


def test_records():
    base, block, _ = one_block(5)
    refuses(lambda: quiet_engines(dem.RecordMotionEngine(ids=[base])), "samples", "empty")
    refuses(lambda: quiet_engines(dem.RecordMotionEngine(ids=[base], samples=[0, 3], scale=1e300)), "samples has 3", "scale = 1e+300", "at most 1e6 m/s^2")


def test_a_record_is_described():
    base, block, _ = one_block(5)
    assert "; record of 400 s, at most 2.94 m/s^2 (0.3 g)\n" in said_by(dem.engines, dem.RecordMotionEngine(ids=[base], samples=[0, 0.3, -0.2], interval=200, scale=9.81))


@pytest.mark.parametrize("peak, said", ((343.0, True), (0.035, True), (50.0, False), (0.1, False), (0.0, False)))
def test_units_of_a_record(peak, said):
    one_block(5)
    text = said_by(dem.engines, dem.RecordMotionEngine(ids=[BASE], samples=[0, -peak]))
    assert (f"a record reaches {peak:g}: in g or cm/s^2? Accelerations are in m/s^2\n" in text) == said


@pytest.mark.parametrize("density, said", ((2.0, True), (2000.0, False), (2e6, True)))
def test_units_of_densities(density, said):
    one_block(5)
    O.bodies[1].mat.density = density
    assert (f"a density is {density:g}: densities are in kg/m^3\n" in said_by(dem.engines)) == said


def test_units_of_sizes():
    """A free block is as large as a convex one may be; a base, which does not move, may be larger."""
    base = dem.base((4000, 1000, 100), stone())
    dem.block((60, 30, 30), stone(), on=base)
    assert "the longest block measures 60 m: sizes are in m\n" in said_by(dem.engines)
    for size in ((1000,) * 3, (1e-6,) * 3):
        refuses(lambda: dem.block(size, stone(), on=base), f"size = {size}: extent = {size[0]:g}: must be from 0.001 to 100, in m")
    refuses(lambda: dem.wall(4, 3, (400, 200, 175), stone(), base), "size = (400, 200, 175): extent = 400: must be from 0.001 to 100, in m")
    refuses(lambda: dem.arch(3000, 1500, 300, 9, 600, stone(), on=base), "span = 3000, rise = 1500, thickness = 300, n = 9: voussoirs: extent = ")
    assert len(O.bodies) == 2


@pytest.mark.parametrize("below, above, said", (
    (dict(frictionAngle=0.2), dict(frictionAngle=1.2, restitution=0.6), "of 1.2 to land with restitution 0.6 and has 0.2:"),
    (dict(frictionAngle=1.2), dict(frictionAngle=1.2, restitution=0.6), None),
    (dict(restitution=0.6), {}, "of 1.2 to land with restitution 0.6 and has 0.55:"),
    (dict(restitution=0.2), dict(restitution=0.6), "of 2.1 to land with restitution 0.4 and has 0.55:"), ({}, {}, None),
    (dict(noSlip=True), dict(restitution=0.6), None),
))
def test_pivots_that_slip(below, above, said):
    """Landings that slip, of a block of slenderness 5 that asks for 5 (1 - C)/(1 + C): the joint's law counts, not that of the block's own material."""
    ground, other = (dem.BlockMat(**{"density": 2000, "frictionAngle": 0.5, **given}) for given in (below, above))
    block = dem.block((0.6, 1, 3), other, on=dem.base((4, 2, 0.2), ground))
    text = said_by(dem.engines)
    assert f"block {block} rocks on body 0 about its narrow side it asks for a friction coefficient {said}" in text if said else "pivots slip" not in text


@pytest.mark.parametrize("heights", ((3, 2.4), (2.4, 3)))
def test_of_several_pivots_that_slip_the_worst_is_named(heights):
    base = dem.base((9, 2, 0.2), material := stone(0.3, noSlip=False, frictionAngle=0.5))
    ids = [dem.block((0.6, 1, height), material, center=(x, 0, height / 2)) for x, height in zip((-2, 2), heights)]
    assert f"block {ids[heights.index(3)]} rocks on body {base} about its narrow side it asks for a friction coefficient of 2.7 " in said_by(dem.engines)


def test_a_recorder_without_period():
    base, block, _ = one_block(5)
    assert "BlockRecorder records nothing until its iterPeriod or virtPeriod is set\n" in said_by(dem.engines, recorder=dem.BlockRecorder(ids=[block]))


def test_impact_order():
    refuses(lambda: dem.RockingJointEngine(impactOrder="random"), "impactOrder", "'random'", "simultaneous")


@pytest.mark.parametrize("kind, wrong, near", (
    (dem.BlockMat, "restitutoin", "restitution"), (dem.RecordMotionEngine, "scal", "scale"), (dem.MoreauJeanIntegrator, "onTruble", "onTrouble"),
    (dem.WallRecorder, "virtperiod", "virtPeriod"), (dem.BlockPhys, "restitution_", "restitution"),
))
def test_misspelled_attributes(kind, wrong, near):
    """In the constructor and set later."""
    for act in (lambda: setattr(kind(), wrong, 1), lambda: kind(**{wrong: 1})):
        refuses(act, f"dem.{kind.__name__} has no `{wrong}`; did you mean `{near}`", kind=AttributeError)


@pytest.mark.parametrize("act, sentence", (
    (lambda: dem.wall(lenght=2, height=1, size=(0.4, 0.2, 0.2), material=stone(), on=0), "dem.wall() has no `lenght`; did you mean `length`?"),
    (lambda: dem.engines(tolerence=1e-3), "dem.engines() has no `tolerence`; did you mean `tolerance`?"),
    (lambda: dem.TiltTable(dirction="x"), "dem.TiltTable() has no `dirction`; did you mean `direction`?"),
    (lambda: dem.Opening(widht=1), "dem.Opening() has no `widht`; did you mean `width`?"),
    (lambda: dem.push(ids=[1], displacment=1), "dem.push() has no `displacment`; did you mean `displacement`?"),
    (lambda: dem.at_rest(speed=1), "dem.at_rest() has no `speed`; it takes no keywords"),
))
def test_misspelled_keywords(act, sentence):
    assert refuses(act, kind=TypeError) == sentence
    refuses(lambda: dem.RecordMotionEngine(displacment=[1]), "dem.RecordMotionEngine has no `displacment`; did you mean `displacement`", kind=AttributeError)
    refuses(lambda: dem.BlockMat(friction_angle=1), "dem.BlockMat has no `friction_angle`; did you mean `frictionAngle`?", kind=AttributeError)


def test_every_public_call_checks_its_keywords():
    for name, call in vars(dem).items():
        if inspect.isfunction(call) and name[0] != "_":
            refuses(lambda: call(no_such_word=1), f"dem.{name}() has no `no_such_word`", kind=TypeError)


def test_attributes_that_are_there():
    """Those of YADE's base classes are there, those of classes that a script derives too."""
    refuses(lambda: dem.BlockMat(xyzzy=1), "see help(dem.BlockMat)", kind=AttributeError)
    refuses(lambda: dem.MoreauJeanIntegrator(largestTimeStep=1), "largestTimeStep", kind=AttributeError)  # it is there, to be read
    motion = dem.RecordMotionEngine(dead=True)
    motion.label, motion.dead = "quake", False
    assert motion.label == "quake" and not motion.dead
    derived = type("Derived", (dem.PulseTrainEngine,), {})()
    derived.note = 1
    assert derived.note == 1


@pytest.mark.parametrize("make, name", (
    (dem.BlockMat, "density"), (dem.BlockMat, "restitution"), (dem.PulseTrainEngine, "impulse"), (dem.PulseTrainEngine, "ids"),
    (dem.PulseTrainEngine, "direction"), (dem.RecordMotionEngine, "samples"), (dem.MoreauJeanIntegrator, "tolerance"),
))
def test_kinds_of_values(make, name):
    for bad in ("1e-3", None) if name != "restitution" else ("1e-3",):
        refuses(lambda: make(**{name: bad}), f"{make.__name__}.{name} = {bad!r}: must be", kind=TypeError)
        refuses(lambda: setattr(make(), name, bad), f"{make.__name__}.{name} = {bad!r}: must be", kind=TypeError)


def test_a_restitution_of_none():
    material = dem.BlockMat(restitution=None)
    assert math.isnan(material.restitution)
    material.restitution = 0.5
    material.restitution = None
    assert math.isnan(material.restitution)


def pressed_by_nan():
    O.bodies[1].mat.normalStiffness = nan


def rough_beyond_a_right_angle():
    O.bodies[0].mat.noSlip, O.bodies[0].mat.frictionAngle = False, 30


@pytest.mark.parametrize("change, words", (
    (lambda: setattr(O, "dt", 1e-2), ("O.dt", "0.01", "below")),
    (lambda: setattr(O.engines[-1], "damping", 0.2), ("NewtonIntegrator.damping", "0.2", "must be 0")),
    (lambda: setattr(O.bodies[1], "aspherical", False), ("O.bodies[1].aspherical", "True")),
    (lambda: setattr(O.bodies[1].state, "mass", 0), ("O.bodies[1].state.mass = 0", "from 1e-18 to 1e+18 kg")),
    (lambda: setattr(O, "engines", O.engines + O.engines), ("more than one RockingJointEngine",)),
    (rough_beyond_a_right_angle, ("bodies 0 and 1", "tangensOfFrictionAngle = nan", "rad")),
    (pressed_by_nan, ("normalStiffness", "nan", "positive")),
))
def test_changes_after_the_engines_were_made(change, words):
    one_block(5, restitution=0.7)
    O.engines = quiet_engines()
    change()
    refuses_to_run(*words)


@pytest.mark.parametrize("make, attribute, bad, kind", (
    (dem.MoreauJeanIntegrator, "gravity", 9.81, "three numbers"), (dem.MoreauJeanIntegrator, "gravity", (0, -9.81), "three numbers"),
    (dem.PulseTrainEngine, "direction", 3, "three numbers"), (dem.MoreauJeanIntegrator, "tolerance", "a", "a number"),
    (dem.BlockMat, "noSlip", "yes", "True or False"), (dem.RecordMotionEngine, "ids", 0, "a list"),
))
def test_kinds_of_attributes(make, attribute, bad, kind):
    for act in (lambda: make(**{attribute: bad}), lambda: setattr(make(), attribute, bad)):
        refuses(act, f"{make.__name__}.{attribute} = {bad!r}: must be {kind}", kind=TypeError)


def test_gravity_is_one_number():
    dem.base((1, 1, 1), stone())
    refuses(lambda: dem.engines(gravity=(0, 0, -9.81)), "gravity = (0, 0, -9.81)", "one number", "along -z")


@pytest.mark.parametrize("act", (
    lambda: masonry.Record(text, numbers), lambda: masonry.Record(0.01, numbers, unit=text), lambda: masonry.Record(0.01, [text]), lambda: masonry.Record(numbers, [0.0]),
    lambda: masonry.RockingBlock(text, 1), lambda: masonry.simulate(masonry.RockingBlock(0.1, 0.5), restitution=text), lambda: masonry.HalfSine(text, 1),
    lambda: masonry.PulseTrain(1, times=text), lambda: masonry.overturning_amplitude(masonry.RockingBlock(1, 4), numbers),
    lambda: masonry.closed_form.pulse_sequence(masonry.RockingBlock(1, 4), 1, 0.5, numbers), lambda: dem.base(numbers, stone()), lambda: dem.base(text, stone()),
    lambda: dem.engines(model=text), lambda: dem.engines(gravity=numbers), lambda: dem.engines(dt=numbers), lambda: dem.engines(tolerance=numbers),
    lambda: dem.engines(numbers), lambda: dem.engines(others=numbers), lambda: dem.record_motion(masonry.Record(0.01, [0, 1]), ids=[0], direction=numbers),
    lambda: dem.blocks_from_table([numbers], stone()), lambda: dem.blocks_from_table([(0, 0, 0.5, 1, 1, 1)], numbers), lambda: dem.TiltTable(direction=text),
    lambda: dem.TiltTable(hold=numbers), lambda: dem.wall(2, 2, (1, 1, 1), stone(), 0, openings=[numbers]), lambda: dem.wall(numbers, 2, (1, 1, 1), stone(), 0),
))
def test_long_values(act):
    """A message never repeats at length what was given."""
    dem.base((1, 1, 1), stone())
    assert len(refuses(act, "")) < 300


@pytest.mark.parametrize("lost", ("left out", "dead"))
def test_joints_without_their_engine(lost):
    """Without RockingJointEngine the restitution, and with it every joint force, would be lost in silence. A functor can stop the run only at the end of its
    step, and Python raises as soon as it has its turn: the block has fallen by a step or two."""
    one_block(5, restitution=0.7)
    O.engines = quiet_engines()
    if lost == "dead":
        O.engines[3].dead = True
    else:
        O.engines = [e for e in O.engines if not isinstance(e, RockingJointEngine)]
    refuses(lambda: steps(1000), "RockingJointEngine", "InteractionLoop", kind=RuntimeError)
    assert O.iter <= 2
