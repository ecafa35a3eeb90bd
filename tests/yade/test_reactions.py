"""Forces of the joints against statics and momentum: the weight, m (a - g), the line of thrust of a tilted column, base shear and overturning moment."""

import math

import numpy as np
import pytest
from masonry import dem, results
from rocking_scene import quiet_engines, refuses
from yade import O, Vector3

import masonry

GRAVITY = 9.81
# Share of the weight. Rigid: the tolerance of the solver (1e-9, of 'wall' in forces 1e-3) times a hundred blocks or so; compliant: after springs have settled.
EXACT = {"planar": 1e-7, "spatial": 1e-7, "compliant": 2e-3}
MODELS = tuple(EXACT)


def stone():
    return dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))


def weight():
    return GRAVITY * sum(b.state.mass for b in O.bodies if b.dynamic)


@pytest.mark.parametrize("model", MODELS)
def test_at_rest(model):
    """The weight, and nothing sideways."""
    base = dem.base((4, 1, 0.2), stone())
    dem.stack(4, (0.6, 0.5, 0.5), stone(), on=base)
    O.engines = quiet_engines(model=model)
    dem.run(0.5 if model == "compliant" else 0.05)
    table = dem.reactions(base)
    assert len(table) == 1 and table["id"][0] == 1
    assert np.abs(table["force"].sum(axis=0) - [0, 0, weight()]).max() < EXACT[model] * weight(), table
    assert np.abs(table["point"][0] - [0, 0, 0]).max() < 1e-4, table
    middle = dem.reactions(2)  # it carries two blocks, and presses one down
    assert sorted(middle["id"]) == [1, 3]
    assert abs(middle[middle["id"] == 3]["force"][0, 2] - weight() / 2) < EXACT[model] * weight()
    assert abs(middle[middle["id"] == 1]["force"][0, 2] + 3 * weight() / 4) < EXACT[model] * weight()  # the weight of 2, 3, 4 on 1


def test_a_wall_at_rest():
    base = dem.base((6, 1, 0.2), stone())
    ids = dem.wall(courses=6, per_course=5, size=(0.4, 0.2, 0.2), material=stone(), on=base)
    O.engines = quiet_engines(model="planar", method="wall")
    dem.run(0.1)
    total = dem.reactions(base)["force"].sum(axis=0)
    assert np.abs(total - [0, 0, weight()]).max() < 1e-2 * weight()


@pytest.mark.parametrize("model", MODELS)
def test_a_base_that_accelerates(model):
    """M (a - g), up to where it is constant."""
    acceleration = 1.0
    base = dem.base((4, 1, 0.2), stone())
    dem.stack(3, (0.6, 0.5, 0.4), stone(), on=base)
    # It grows over half a second, in which springs follow without swinging.
    record = masonry.Record(0.01, acceleration * np.minimum(1, np.arange(101) / 50), unit="m/s^2")
    recorder = dem.WallRecorder(virtPeriod=0.05, recordForces=True)
    O.engines = quiet_engines(dem.record_motion(record, ids=[base]), model=model, recorder=recorder)
    dem.run(0.9)
    mass = weight() / GRAVITY
    force = dem.reactions(base)["force"].sum(axis=0)
    assert np.abs(force - [mass * acceleration, 0, weight()]).max() < EXACT[model] * weight()
    history = dem.wall_history(recorder)
    table = results.base_reactions(history)
    # The first sample is that of a base at rest; of rigid blocks after the first step, in which the acceleration grows by 2 m/s^3.
    first = 0.1 * weight() if model == "compliant" else 2 * mass * O.dt
    assert np.abs(table["force"][0] - [0, 0, weight()]).max() < first and abs(table["time"][-1] - 0.9) < 0.06
    late = table[table["time"] > 0.6]
    assert np.abs(late["force"] - [mass * acceleration, 0, weight()]).max() < 2 * EXACT[model] * weight(), late
    # About the middle of the base: the change of angular momentum, m a at half the height of 1.2 m.
    assert np.abs(late["moment"] - [0, mass * acceleration * 0.6, 0]).max() < 2 * EXACT[model] * weight()


@pytest.mark.parametrize("model", MODELS)
def test_the_line_of_thrust(model):
    """The line of thrust of a column under gravity that is tilted by an angle: at each joint the weight above acts along gravity and meets the joint
    where its line through the centre of what is above comes to it: tan(angle) times the height of that centre over the joint from the middle."""
    angle, blocks, height = 0.08, 5, 0.4
    base = dem.base((4, 1, 0.2), stone())
    ids = dem.stack(blocks, (0.6, 0.5, height), stone(), on=base)
    recorder = dem.WallRecorder(iterPeriod=50, recordForces=True)
    O.engines = quiet_engines(model=model, recorder=recorder)
    tilted = Vector3(GRAVITY * math.sin(angle), 0, -GRAVITY * math.cos(angle))
    O.engines[-1].gravity = tilted
    dem.run(1.5 if model == "compliant" else 0.1)
    # Compliant: pressed in by 1e-5 of the width, blocks lean by some 1e-5 of it, at up to four times the width in height.
    close = 1e-3 if model == "compliant" else 1e-6
    table = dem.joint_forces()
    assert len(table) == blocks
    one = weight() / blocks
    for k, row in enumerate(np.sort(table, order="id1")):
        above = (blocks - k) * height / 2
        assert (row["id1"], row["id2"]) == (([base] + ids)[k], ids[k])
        assert np.abs(row["force"] - np.array([-math.sin(angle), 0, math.cos(angle)]) * (blocks - k) * one).max() < max(close, EXACT[model]) * weight(), row
        assert abs(row["point"][0] - math.tan(angle) * above) < close and abs(row["point"][2] - k * height) < 1e-4, row["point"]
    history = dem.wall_history(recorder)
    assert np.abs(results.thrust(history)["point"][:, 0] - table["point"][:, 0]).max() < 2 * close
    overturning = results.base_reactions(history)["moment"][-1]
    assert abs(overturning[1] + weight() * math.sin(angle) * blocks * height / 2) < 5 * EXACT[model] * weight(), overturning


@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_momentum(model):
    """What a rocking block gains in a step is the force of the joint and its weight."""
    base = dem.base((4, 1, 0.2), stone())
    block = dem.block((0.6, 0.5, 2.0), stone(), on=base)
    dem.tilt(block, 0.12)
    O.engines = quiet_engines(model=model)
    O.step()
    state = O.bodies[block].state
    for _ in range(100):
        before = np.array(state.vel)
        O.step()
        gained = state.mass * (np.array(state.vel) - before) / O.dt
        force = dem.reactions(base)["force"].sum(axis=0)
        assert np.abs(force + [0, 0, -weight()] - gained).max() < 1e-6 * weight()


def test_reactions_of_no_body():
    refuses(lambda: dem.reactions(99), "id = 99")


@pytest.mark.parametrize("model", MODELS)
def test_a_body_that_carries_nothing(model):
    """Before the first step, and under a block that flies: empty arrays of the same fields."""
    base = dem.base((4, 1, 0.2), stone())
    dem.block((0.4, 0.5, 1.0), stone(), center=(0, 0, 3))
    O.engines = quiet_engines(model=model)
    for _ in range(3):
        assert dem.joint_forces().shape == (0,) and dem.reactions(base).shape == (0,)
        assert dem.reactions(base)["force"].sum(axis=0).tolist() == [0, 0, 0] and dem.reactions(base).dtype.names == ("id", "force", "point")
        O.step()


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("period", (1, 10))
def test_the_first_sample_has_forces(model, period):
    """So has the first one after loading, which comes before a step, also where every step has a sample; what starts in the air has none."""
    base = dem.base((4, 1, 0.2), stone())
    dem.stack(3, (0.6, 0.5, 0.4), stone(), on=base)
    recorder = dem.WallRecorder(iterPeriod=period, recordForces=True)
    O.engines = quiet_engines(model=model, recorder=recorder)
    dem.run(5 * O.dt)
    O.saveTmp()
    for _ in range(2):
        recorder = next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder))
        dem.run(22 * O.dt)
        history = dem.wall_history(recorder)
        table = results.base_reactions(history)
        assert len(table) == len(history.time) == len(recorder.jointCounts) and recorder.jointCounts[0] == 3
        assert np.abs(table["force"][:, 2] - weight()).max() < (0.1 if model == "compliant" else EXACT[model]) * weight()
        O.loadTmp()
    O.reset()
    dem.base((4, 1, 0.2), stone())
    dem.block((0.6, 0.5, 0.4), stone(), center=(0, 0, 0.22))
    recorder = dem.WallRecorder(iterPeriod=50, recordForces=True)
    O.engines = quiet_engines(model=model, recorder=recorder)
    dem.run(0.2)
    assert recorder.jointCounts[0] == 0 and recorder.jointCounts[-1] == 1


def test_forces_are_kept_from_the_first_sample_on():
    """Forces are kept from the first sample on, or not at all."""
    dem.block((0.6, 0.5, 2.0), stone(), on=dem.base((4, 1, 0.2), stone()))
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines = quiet_engines(model="planar", recorder=recorder)
    dem.run(10 * O.dt)
    assert dem.wall_history(recorder).forces is None and len(recorder.jointCounts) == 0
    recorder.recordForces = True
    refuses(O.step, "WallRecorder.recordForces", "new WallRecorder")
