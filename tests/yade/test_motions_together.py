"""Motions of one base in perpendicular directions, such as the components of a record: they add up."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import Balance, Samples, one_block, quiet_engines, refuses, refuses_to_run, rigid_engines, stone
from scipy.integrate import solve_ivp
from yade import O, ParallelEngine

import masonry

DT = 0.01
TIMES = np.arange(0, 2, DT)
SIDEWAYS = 2.5 * np.sin(2 * math.pi * 1.3 * TIMES)
UPWARDS = 3.0 * np.sin(2 * math.pi * 2.9 * TIMES + 1)


def component(base, samples, direction=(1, 0, 0), **attributes):
    return dem.record_motion(masonry.Record(DT, samples), [base], direction, **attributes)


def rocking(block, restitution, start, until, at):
    """Angles at the times `at` of a block on a base that moves both ways: I0 t'' = -m R ((g + up) sin(critical - t) + sideways cos(critical - t))
    for t > 0, and mirrored."""
    alpha, p2 = block.critical_angle, 0.75 / block.radius  # m R / I0
    state, now, result = [start, 0.0], 0.0, []

    def rates(t, y):
        side = 1 if y[0] > 0 or (y[0] == 0 and y[1] > 0) else -1
        lean, gravity = alpha - side * y[0], block.gravity + np.interp(t, TIMES, UPWARDS)
        return [y[1], -p2 * (side * gravity * math.sin(lean) + np.interp(t, TIMES, SIDEWAYS) * math.cos(lean))]

    def lands(t, y):
        return y[0]

    lands.terminal = True
    while now < until:
        flight = solve_ivp(rates, (now, until), state, events=lands, dense_output=True, rtol=1e-9, atol=1e-12, max_step=DT / 2)
        result += [flight.sol(t)[0] for t in at if now <= t < flight.t[-1]]
        now, speed = flight.t[-1], restitution * flight.y[1, -1]
        state = [1e-14 * np.sign(speed), speed]
    return np.array(result)


@pytest.mark.parametrize("options, bound", (
    ({"model": "planar"}, 1e-4), ({"model": "spatial"}, 1e-4), ({"model": "compliant", "penetration": 1e-6}, 1e-3),
))
def test_sideways_and_up_at_once(options, bound):
    """Sideways and up at once, through some impacts, against an integration of the equation of motion. Bounds: as of one record (compare_record)."""
    base, id, block = one_block(4, restitution=0.8)
    dem.tilt(id, 0.5 * block.critical_angle)
    make = quiet_engines if options.get("model") == "compliant" else rigid_engines
    O.engines = make([component(base, SIDEWAYS), component(base, UPWARDS, (0, 0, 1))], **options)
    seen = Samples(lambda: dem.angle(id), 10)
    balance = Balance()
    O.run(int(1.9 / O.dt), True)
    wanted = rocking(block, 0.8, 0.5 * block.critical_angle, 1.95, seen.times)[: len(seen.times)]
    error = np.max(np.abs(np.array(seen.values) - wanted)) / block.critical_angle
    print(f"{options}: {len(dem.impacts())} impacts, error {error:.1e}, energy {balance.error():.1e} J")
    assert len(dem.impacts()) >= 3 and np.max(np.abs(wanted[len(wanted) // 2 :])) > 0.05 * block.critical_angle
    assert error <= bound
    assert abs(balance.error()) <= 1e-4 * dem.energy()["baseWork"]
    moved = [masonry.Record(DT, samples).displacement(O.time) for samples in (SIDEWAYS, UPWARDS)]
    assert np.allclose(O.bodies[base].state.pos, [moved[0], 0, moved[1] - 0.15], rtol=0, atol=1e-13)


ACROSS = (0.6, 0.8, 0.0)


def shaken(motions, build, until, **options):
    O.reset()
    base = dem.base((6, 6, 0.2), stone(0.7, noSlip=False, frictionAngle=0.6))
    build(base)
    make = quiet_engines if options.get("model") == "compliant" else rigid_engines
    O.engines = make(motions(base), **options)
    O.run(int(until / O.dt), True)
    carried = O.bodies[base].state.pos - O.bodies[base].state.refPos
    assert max((b.state.pos - b.state.refPos - carried).norm() for b in O.bodies) > 1e-2
    return np.array([[*b.state.pos, *b.state.ori, *b.state.vel] for b in O.bodies]), np.array(list(dem.energy().values()))


def column(base):
    dem.stack(2, (0.5, 0.5, 1), O.bodies[base].mat, base)


def wall(base):
    dem.wall(3, 4, (0.4, 0.2, 0.2), dem.BlockMat(density=2000, frictionAngle=0.6), on=base)


def aslant(base):
    return component(base, 2 * SIDEWAYS, ACROSS)


def components(base):
    return [component(base, 0.6 * 2 * SIDEWAYS), component(base, 0.8 * 2 * SIDEWAYS, (0, 1, 0)), component(base, 0 * SIDEWAYS, (0, 0, 1))]


@pytest.mark.parametrize("build, until, options, bound", (
    (column, 0.5, {"dt": 1e-3}, 1e-9), (wall, 0.5, {"method": "wall"}, 1e-4), (column, 0.6, {"model": "compliant", "penetration": 1e-4}, 1e-8),
))
def test_a_motion_aslant_and_its_components(build, until, options, bound):
    """One motion aslant, and its components along two axes: the same, and so is a third that stays zero. Round-off of the sum grows as blocks rock
    and slide (after 0.5 s it decides in which step a sliding corner stops, which moves blocks by 8e-8 m); a wall's solves end at a tolerance of
    1e-3 of what gravity gives in a step, 6e-6 m/s, which round-off may turn into one more or one less."""
    (one, energy), (sum, energies) = shaken(aslant, build, until, **options), shaken(components, build, until, **options)
    print(f"{build.__name__} {options}: differs by {np.max(np.abs(one - sum)):.1e}")
    assert np.max(np.abs(one - sum)) <= bound and np.max(np.abs(energies - energy)) <= bound * np.max(np.abs(energy))


def test_a_pulse_train_beside_a_record():
    """A pulse train beside a record; and an upright motion leaves the scene in its plane."""
    base, id, block = one_block(5, restitution=0.7)
    train = dem.PulseTrainEngine(ids=[base], impulse=0.12, resonantBlock=id)
    O.engines = rigid_engines([component(base, UPWARDS, (0, 0, 1)), train], dt=1e-3)
    O.run(1500, True)
    assert O.engines[1].chosenModel == "planar" and len(train.pulseTimes) == 1 + len(dem.impacts()) >= 3
    assert train.pulseTimes[1:] == list(dem.impacts()["time"][: len(train.pulseTimes) - 1])
    wanted = [train.residualDisplacement, 0, masonry.Record(DT, UPWARDS).displacement(O.time) - 0.15]
    assert np.allclose(O.bodies[base].state.pos, wanted, rtol=0, atol=1e-13)


def test_one_joins_another_and_goes_again():
    """One joins another, and goes again: each counts from where the base is then, across its own direction the base stays where it is."""
    base, id, block = one_block(2)
    state = O.bodies[base].state
    O.engines = rigid_engines(component(base, np.full(200, 1.0)), dt=1e-3)
    O.run(500, True)
    first = O.engines[-1].motions
    O.engines[-1].motions = [*first, component(base, np.full(200, 2.0), (0, 0, 1), start=O.time)]
    O.run(300, True)
    assert np.allclose(state.pos, [0.32, 0, 0.09 - 0.15], rtol=0, atol=1e-12) and np.allclose(state.vel, [0.8, 0, 0.6], rtol=0, atol=1e-12)
    O.engines[-1].motions = first
    O.run(200, True)
    assert np.allclose(state.pos, [0.5, 0, 0.09 - 0.15], rtol=0, atol=1e-12) and np.allclose(state.vel, [1, 0, 0], rtol=0, atol=1e-12)
    assert O.engines[-1].failures == 0


def test_one_joins_another_and_goes_again_under_compliant_joints():
    base, id, block = one_block(2)
    state = O.bodies[base].state
    first = component(base, np.full(200, 1.0))
    O.engines = quiet_engines(first)
    until = round(0.2 / O.dt)
    O.run(until, True)
    along = O.time**2 / 2
    O.engines = O.engines[:-1] + [component(base, np.full(200, 2.0), (0, 0, 1), start=O.time), O.engines[-1]]
    joined = O.time
    O.run(until, True)
    up = (O.time - O.dt - joined) ** 2  # where the base was at the start of the last step, from which it goes on with the mean velocity
    O.engines = [e for e in O.engines if not (isinstance(e, dem.RecordMotionEngine) and e.direction[2])]
    at = state.pos[2]
    O.run(until, True)
    assert abs(state.pos[0] - O.time**2 / 2) <= 1e-12 and abs(at + 0.15 - (O.time - until * O.dt - joined) ** 2) <= 1e-12 and abs(state.pos[2] - at) <= 1e-12


@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_a_slab_on_two_bases_that_part(model):
    """A slab on two bases that part: friction leaves open how much each carries, and a scene that is its own mirror image stays so, to 1 % of the
    way."""
    apart = 1.5 * np.sin(2 * math.pi * np.arange(0, 1.001, DT)) ** 3
    material = stone(noSlip=False, frictionAngle=0.5)
    bases = [dem.base((1.5, 2, 1), material) for _ in range(2)]
    for id, side in zip(bases, (-1, 1)):
        O.bodies[id].state.pos = (1.25 * side, 0, -0.5)
    slab = dem.block((4.2, 1, 0.4), material, center=(0, 0, 0.2))
    O.engines = rigid_engines([component(id, side * apart) for id, side in zip(bases, (-1, 1))], model=model)
    O.run(int(1 / O.dt), True)
    way = O.bodies[bases[1]].state.pos[0] - 1.25
    print(f"{model}: bases go {way:.3f} m to either side, the slab between them {O.bodies[slab].state.pos[0]:.1e} m")
    assert way > 0.05 and abs(O.bodies[slab].state.pos[0]) < 0.01 * way and O.engines[-1].failures == 0


def test_the_same_after_loading():
    base, id, block = one_block(2)
    O.engines = rigid_engines([component(base, np.full(200, 1.0)), component(base, np.full(200, 2.0), (0, 0, 1))], dt=1e-3)
    O.run(300, True)
    O.saveTmp()
    O.loadTmp()
    O.engines[-1].motions = O.engines[-1].motions[:1]
    O.run(200, True)
    state = O.bodies[base].state
    assert np.allclose(state.pos, [0.125, 0, 0.09 - 0.15], rtol=0, atol=1e-12) and np.allclose(state.vel, [0.5, 0, 0], rtol=0, atol=1e-12)


def test_a_base_far_away():
    """A base that nobody touches, far away, is no reason to solve anew what is known."""
    counts = []
    for far in (False, True):
        O.reset()
        base = dem.base((6, 6, 0.2), stone(0.7, noSlip=False, frictionAngle=0.6))
        dem.stack(4, (0.5, 0.5, 0.5), O.bodies[base].mat, base)
        if far:
            O.bodies[dem.base((1, 1, 0.2), O.bodies[base].mat)].state.pos = (50, 0, 0)
        O.engines = rigid_engines(component(base, 0.3 * SIDEWAYS), dt=1e-3)
        O.run(500, True)
        counts.append(O.engines[-1].sweeps)
    assert counts[0] == counts[1], counts


@pytest.mark.parametrize("act", ("within", "by hand"))
def test_a_motion_that_acts_otherwise(act):
    """From within another engine, or by hand."""
    base, id, block = one_block(2)
    motion = component(base, np.full(200, 1.0))
    O.engines = quiet_engines(motion)
    if act == "within":
        O.engines = [ParallelEngine([[e]]) if isinstance(e, dem.RecordMotionEngine) else e for e in O.engines]
        O.run(100, True)
        assert abs(O.bodies[base].state.pos[0] - O.time**2 / 2) < 1e-12
    else:
        motion()
        assert O.bodies[base].state.vel[0] > 0 and O.bodies[base].state.pos[0] == 0


@pytest.mark.parametrize("model", ("planar", "compliant"))
@pytest.mark.parametrize("samples, direction, bodies, words", (
    (SIDEWAYS, (1, 0, 0), 1, ("RecordMotionEngine.direction", "perpendicular")),
    (SIDEWAYS, (0.6, 0, 0.8), 1, ("RecordMotionEngine.direction", "perpendicular")),
    (SIDEWAYS, (0, 0, 1), 2, ("RecordMotionEngine.ids", "have all their bodies in common")),
))
def test_what_does_not_go_together(model, samples, direction, bodies, words):
    """It is refused before anything moves."""
    base, id, block = one_block(5)
    far = dem.base((1, 1, 0.2), O.bodies[base].mat)
    O.bodies[far].state.pos = (50, 0, 0)
    second = dem.record_motion(masonry.Record(DT, samples), [base, far][:bodies], direction)
    if model == "planar":
        refuses(lambda: rigid_engines([component(base, SIDEWAYS), second]), *words)
    else:
        O.engines = quiet_engines([component(base, SIDEWAYS), second])
        refuses_to_run(*words)
