"""method='wall' in YADE: when it is chosen, what it refuses, O.interactions while nobody looks (of either method), laws changed by a script, the
same bits after loading."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import Balance, Samples, bits, refuses, rigid_engines, said_by, stone
from yade import O, Quaternion, Vector3

MU = 0.7


def wall(courses, per_course, shaking, **options):
    """A wall on a base that shakes by `shaking` g at 2 Hz from 0.1 s on; `piers` slender blocks on it and beside it."""
    O.reset()
    piers = options.pop("piers", 0)
    attributes = {"restitution": options.pop("restitution")} if "restitution" in options else {}
    base = dem.base((per_course + 6 + 4 * piers, 2, 0.4), dem.BlockMat(density=2000, frictionAngle=math.atan(MU), **attributes))
    ids = dem.wall(courses, per_course, (1.0, 0.5, 0.5), O.bodies[base].mat, on=base)
    for k in range(piers):  # the first on the wall, the others beside it
        x, under = (per_course / 2 + 2 * k, 0) if k else (0.4, 0.5 * courses)
        ids.append(dem.block((0.25, 0.5, 1.2 + 0.1 * k), O.bodies[base].mat, center=(x, 0, under + 0.6 + 0.05 * k)))
    samples = [0] * 20 + list(shaking * 9.81 * np.sin(4 * np.pi * np.arange(0, 2, 0.005)))
    motion = dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.005, direction=(1, 0, 0))
    O.engines = rigid_engines(motion, **{"dt": 1e-3, **options})
    return base, ids


def integrator():
    return O.engines[-1] if isinstance(O.engines[-1], dem.MoreauJeanIntegrator) else [e for e in O.engines if isinstance(e, dem.MoreauJeanIntegrator)][0]


# The choice of the method.


@pytest.mark.parametrize("options, method", (
    ({}, "wall"), ({"method": "localised"}, "localised"), ({"impact_order": "sequential"}, "localised"), ({"tolerance": 1e-9}, "localised"),
    ({"tolerance": 1e-4}, "wall"), ({"impact_order": "simultaneous"}, "wall"),
))
def test_the_choice(options, method):
    wall(4, 6, 0.1, **options)


    assert integrator().method == method


def test_the_choice_in_the_plane():
    wall(3, 6, 0.1)
    assert integrator().method == "localised"  # 19 blocks


@pytest.mark.parametrize("per_course, method", ((2, "localised"), (3, "wall")))
def test_the_choice_in_space(per_course, method):
    # 5 and 7 blocks
    wall(2, per_course, 0.1, model="spatial")
    assert integrator().method == method


@pytest.mark.parametrize("options, words", (
    ({}, "; 26 blocks: method 'wall'"),
    ({"piers": 2}, ", localised impacts for 1 structure of 1 block beside"),
    ({"piers": 3}, "; largest structure 27 of 29 blocks: method 'wall', localised impacts for 2 structures of 2 blocks beside"),
))
def test_what_the_choice_says_of_sizes(options, words):
    base, ids = wall(4, 6, 0.1, **options)
    said = said_by(dem.engines)
    assert words in said


# It is the largest structure that counts: blocks that stand apart move as each of them would alone. Pulses keep all in one step.


def row(sizes, motion, **options):
    O.reset()
    base = dem.base((3 * len(sizes) + 4, 2, 0.4), stone(restitution=0.8))
    O.engines = []
    ids = [dem.block(size, O.bodies[base].mat, center=(3 * k, 0, size[2] / 2)) for k, size in enumerate(sizes) if size]
    O.engines = rigid_engines(motion(base, ids), dt=1e-3, **options)
    return ids


def shaking(base, ids):
    return dem.RecordMotionEngine(ids=[base], samples=list(4 * np.sin(9 * np.arange(0, 2, 0.01))), interval=0.01, direction=(1, 0, 0))


def after(ids):
    O.run(1500, True)
    return np.array([(*O.bodies[i].state.pos, *O.bodies[i].state.vel, *O.bodies[i].state.angVel) for i in ids])


SIZES = [(0.3 + 0.01 * k, 0.5, 1 + 0.02 * k) for k in range(24)]


def test_blocks_that_stand_apart():
    ids = row(SIZES, shaking)
    assert (integrator().method, integrator().tolerance) == ("localised", 1e-9) and dem.structures() == [[i] for i in ids]
    refuses(lambda: dem.structures(gap=0), "gap", "at most 1")
    assert "; 24 structures apart, each stepped by itself; dt" in said_by(dem.engines, dt=1e-3)
    assert dem.structures(gap=1) == [[i] for i in ids]  # 2.4 to 2.7 m apart, the smallest size is 0.3 m
    many = after(ids)
    assert len(integrator().impactTimes) > 24 and integrator().failures == 0
    for k in (0, 7, 23):
        alone = after(row([size if j == k else None for j, size in enumerate(SIZES)], shaking))
        assert np.abs(alone - many[k]).max() < 1e-9, k  # round-off of the instants of impacts, which the base's velocity takes over


def test_pulses_keep_all_in_one_step():
    row(SIZES, lambda base, ids: dem.PulseTrainEngine(ids=[base], impulse=0.1, times=[0.1]))
    assert (integrator().method, integrator().tolerance) == ("wall", 1e-3)


@pytest.mark.parametrize("model, few", (("planar", 20), ("spatial", 6)))
def test_few_blocks_near_each_other(model, few):
    """Up to 20 blocks that are near each other, in space 6, have localised impacts, and any number of those farther apart than a tenth of their
    size."""
    for count, pitch, method in ((few, 1, "localised"), (few + 1, 1.09, "wall"), (few + 1, 1.11, "localised")):
        O.reset()
        base = dem.base((60, 2, 0.4), stone())
        for k in range(count):
            dem.block((1, 1, 1), O.bodies[base].mat, center=(pitch * (k - few / 2), 0, 0.5))
        assert rigid_engines(model=model)[-1].method == method, (count, pitch)


@pytest.mark.parametrize("options, words", (
    ({"impact_order": "sequential"}, ("impactOrder", "'simultaneous'")), ({"tolerance": 1e-9}, ("tolerance", "1e-6 to 1e-2")),
    ({"model": "compliant"}, ("method", "rigid")), ({"method": "fast"}, ("method", "'fast'")),
))
def test_options_that_the_method_refuses(options, words):
    refuses(lambda: wall(4, 6, 0.1, **{"method": "wall", **options}), *words)


@pytest.mark.parametrize("shaking, moves", ((0.05, False), (1.2, True)))
def test_a_wall_of_many_courses(shaking, moves, tmp_path, capfd):
    """From some height on another step is taken. It goes on with the same bits after loading, and its errors do not grow with the courses: no warning."""
    wall(33, 2, shaking)
    capfd.readouterr()
    O.run(260, True)
    assert (integrator().movingSteps > 0) == moves and (integrator().movingBlocks > 0) == moves and integrator().failures == 0
    assert "courses" not in capfd.readouterr().err
    wanted = bits()
    wall(33, 2, shaking)
    O.run(130, True)
    path = str(tmp_path / "wall.yade")
    O.save(path)
    O.reset()
    O.load(path)
    O.run(130, True)
    assert np.array_equal(wanted, bits())


@pytest.mark.parametrize("model, count", (("planar", 24), ("spatial", 8)))
def test_a_row_that_thrust_clamps(model, count):
    """Boxes that hang by friction alone, under six times the thrust that shear and the line of thrust need, stay where they are: within the 1e-2 mm
    that a wall may drift in a second. The shelves of the block that pushes are smooth, so that Coulomb's law leaves nothing open."""
    O.reset()
    rough, smooth = dem.BlockMat(density=2000, frictionAngle=math.atan(0.4)), dem.BlockMat(frictionAngle=0)
    end = 0.2 * count + 0.3
    for size, center, material in (((1, 1, 3), (-0.5, 0, 0), rough), ((0.58, 1, 0.1), (end, 0, -0.55), smooth), ((0.58, 1, 0.1), (end, 0, 0.55), smooth)):
        O.bodies[dem.base(size, material)].state.pos = center
    places = [Vector3(0.1 + 0.2 * k, 0, 0) for k in range(count)]
    boxes = [dem.block((0.2, 0.4, 0.4), rough, center=place) for place in places]
    push = dem.block((0.6, 0.4, 1), rough, center=(end, 0, 0))
    O.engines = rigid_engines(model=model, method="wall", dt=1e-3)
    weight = count * O.bodies[boxes[0]].state.mass * 9.81
    O.forces.setPermF(push, (-6 * max(weight / 2 / 0.4, weight * count / 16), 0, 0))
    O.run(1000, True)
    assert max((O.bodies[box].state.pos - place).norm() for box, place in zip(boxes, places)) < 1e-5 and integrator().failures == 0


def landing_of_a_stack(model, method, others):
    """Share of the energy that two blocks keep which rock as one and land with C = 0.5 at either joint; `others` stand beside them."""
    O.reset()
    rough = dem.BlockMat(density=2000, restitution=0.5, noSlip=True)
    base = dem.base((40, 4, 0.2), rough)
    ids, turn, edge = dem.stack(2, (0.6, 1, 1.2), rough, on=base), Quaternion((0, 1, 0), 0.02), Vector3(0.3, 0, 0)
    for state in (O.bodies[id].state for id in ids):
        state.pos, state.ori = edge + turn * (state.pos - edge), turn
    for k in range(others):
        dem.block((0.5, 1, 0.2), rough, center=(2 + 0.6 * k, 0, 0.1))
    O.engines = rigid_engines(model=model, method=method, dt=2e-4)
    kinetic = []
    while O.time < 0.25:
        O.step()
        kinetic.append(dem.energy()["kinetic"])
    before = max(range(len(kinetic) - 2), key=lambda k: kinetic[k] - kinetic[k + 2])
    return kinetic[before + 2] / kinetic[before]


@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_joints_that_land_together(model):
    """In a scene of more blocks than localised impacts take, both joints get their restitution at once, as there: 0.60 of the
    energy stays, where joint by joint 0.78 would. Two steps add 2 x 2 x 2e-4/0.2 to the energy of a fall of 0.2 s."""
    assert abs(landing_of_a_stack(model, "wall", 19) / landing_of_a_stack(model, "localised", 0) - 1) < 0.01


def slab(density, method):
    """How far a slab on two courses slides on a shaken base, m; friction 0.3."""
    O.reset()
    light = dem.BlockMat(density=20, frictionAngle=math.atan(0.3))
    base = dem.base((8, 4, 0.25), light)
    dem.wall(2, 2, (0.5, 0.25, 0.2), light, on=base)
    top = dem.block((1, 0.25, 0.2), dem.BlockMat(density=density, frictionAngle=math.atan(0.3)), center=(0, 0, 0.5))
    t = np.arange(0, 0.8, 0.01)
    motion = dem.RecordMotionEngine(ids=[base], samples=list(0.8 * 9.81 * np.sin(4 * np.pi * t) * np.sin(np.pi * t / 0.8)), interval=0.01, direction=(1, 0, 0))
    O.engines = rigid_engines(motion, dt=5e-4, method=method)
    while O.time < 1:
        O.step()
    return O.bodies[top].state.pos[0] - O.bodies[base].state.pos[0]


def test_heavy_bodies_on_light_blocks():
    exact = slab(2e4, "localised")
    assert exact > 0.05
    for density in (20, 2e4, 2e6):
        assert abs(slab(density, "wall") / exact - 1) < 0.01 and integrator().failures == 0  # first order: half a step of 0.9 m/s is 0.5 %


def test_a_block_that_turns_by_much_in_a_step():
    """It is none of the wall's, though so near that it is stepped with it."""
    _, ids = wall(4, 6, 0, method="wall", dt=1e-3)
    O.bodies[dem.block((1, 0.5, 0.5), stone(), center=O.bodies[ids[-1]].state.pos + Vector3(0, 0, 0.82))].state.angVel = (0, 300, 0)
    O.step()
    assert integrator().failures == 1 and "turns by 0.3" in integrator().firstFailure and "localised" in integrator().firstFailure


def reaction(base):
    return sum(((1 if i.id1 == base else -1) * (i.phys.normalForce + i.phys.shearForce) for i in O.interactions if base in (i.id1, i.id2)), Vector3.Zero)


@pytest.mark.parametrize("courses, per_course, method", ((5, 6, "wall"), (2, 2, "localised")))
def test_interactions(courses, per_course, method):
    """What one step after the other shows, a run shows where somebody looks."""
    base, ids = wall(courses, per_course, 0.5)
    shown = []
    for _ in range(300):
        O.step()
        shown.append(reaction(base))
    weight = sum(O.bodies[i].state.mass for i in ids) * 9.81
    assert abs(shown[90][2] / weight - 1) < 1e-3  # the tolerance, while the wall stands
    for period in ({"virtPeriod": 36.5 * O.dt}, {"iterPeriod": 37}):
        wall(courses, per_course, 0.5)
        seen = Samples(lambda: (O.iter, reaction(base)), **period)
        O.run(222, True)
        assert integrator().method == method and len(seen.values) >= 5 and all(forces == shown[step] for step, forces in seen.values), period
    O.engines = O.engines[:-1]
    assert reaction(base) == shown[221]
    O.run(53, True)
    assert reaction(base) == shown[274]
    print("interactions: base reaction", reaction(base)[2] / weight, "of the weight")


def test_friction_that_is_changed_through_the_interactions():
    """Blocks pushed by half their weight slide with (0.5 - mu) g."""
    base = dem.base((60, 2, 0.4), dem.BlockMat(density=2000, frictionAngle=math.atan(MU)))
    ids = [dem.block((1, 0.5, 0.5), O.bodies[base].mat, center=(2 * k - 24, 0, 0.25)) for k in range(25)]
    O.engines = rigid_engines(dt=1e-3, method="wall")
    for id in ids:
        O.forces.setPermF(id, (0.5 * O.bodies[id].state.mass * 9.81, 0, 0))
    O.run(200, True)
    assert integrator().method == "wall" and max(abs(O.bodies[i].state.vel[0]) for i in ids) < 1e-6
    for i in O.interactions:
        i.phys.tangensOfFrictionAngle = 0.3
    O.run(200, True)
    speeds = [O.bodies[i].state.vel[0] / (0.2 * 9.81 * 0.2) - 1 for i in ids]
    print("sliding with the new friction: speed", max(map(abs, speeds)))
    assert max(map(abs, speeds)) < 2 * 9.81e-3 / (0.2 * 9.81 * 0.2)  # what gravity gives in two steps
    O.bodies[base].mat.frictionAngle = 0  # a material is read when two blocks come near each other, not again
    before = np.array([O.bodies[i].state.vel[0] for i in ids])
    O.run(100, True)
    gained = np.array([O.bodies[i].state.vel[0] for i in ids]) - before
    assert max(abs(gained / (0.2 * 9.81 * 0.1) - 1)) < 1e-3  # 0.5 g without friction; sliding at a constant pull is stepped exactly


@pytest.mark.parametrize("model, shaking, options", (
    ("planar", 0.3, {}), ("planar", 1.2, {"restitution": 0.6}), ("planar", 0.3, {"restitution": 0.6, "piers": 4}),
    ("spatial", 0.3, {}), ("spatial", 1.2, {"restitution": 0.6}), ("spatial", 0.3, {"restitution": 0.6, "piers": 4}),
))
def test_saved_and_loaded(model, shaking, options, tmp_path):
    last = 850 if model == "planar" else 500
    wall(6, 6, shaking, model=model, **options)
    O.run(last, True)
    wanted = bits()
    moving, beside = integrator().movingSteps, integrator().movingBlocks
    for first, ending in ((80, "xml"), (457, "yade")):
        wall(6, 6, shaking, model=model, **options)
        O.run(first, True)
        path = str(tmp_path / f"wall.{ending}")
        O.save(path)
        saved = bits()
        O.reset()
        O.load(path)
        assert np.array_equal(saved, bits()), first
        O.run(last - first, True)
        assert np.array_equal(wanted, bits()), (first, np.flatnonzero(wanted != bits())[:5])
    print(f"{model}, {shaking} g: {moving} of {last} steps move, {len(dem.impacts())} impacts, {beside} of {len(O.bodies) - 1} blocks move")
    if "piers" in options:
        assert moving > 200 and 0 < beside <= 2 * options["piers"] and len(dem.impacts()) >= options["piers"]  # each has landed
        assert integrator().localisedBlocks == options["piers"] - 1  # those beside the wall
        assert integrator().events >= len(dem.impacts())  # of both ways: each listed impact is one, and few are the wall's
    else:
        assert (moving == 0) if shaking < MU else (moving > 200 and len(dem.impacts()) > 10)


def test_energy_of_a_wall_that_stands():
    """What the base puts into it is what its blocks have."""
    wall(6, 6, 0.3)
    before = sum(dem.energy()[key] for key in ("kinetic", "potential"))
    O.run(345, True)
    gained = sum(dem.energy()[key] for key in ("kinetic", "potential")) - before
    print(f"still wall: work of the base over what the blocks gain {dem.energy()['baseWork'] / gained - 1:.1e}")
    assert integrator().movingSteps == 0 and abs(dem.energy()["baseWork"] / gained - 1) < 1e-4


def test_energy_of_a_wall_that_moves():
    """No step gives any."""
    wall(6, 6, 1.2, restitution=0.6)
    balance, lost = Balance(), [0]
    for _ in range(600):
        O.step()
        lost.append(integrator().impactDissip + integrator().frictDissip)
    rise = -min(np.diff(lost))
    print(f"largest rise of energy in a step {rise:.1e} J, of {lost[-1]:.0f} J lost; balance {balance.error():.1e} J")
    assert rise < 1e-3 * lost[-1] and abs(balance.error()) < 1e-4 * abs(dem.energy()["baseWork"])


def test_what_a_wall_has_left_another_run_takes(tmp_path):
    """A base that a script drives, new engines of either method, a saved table."""
    base = dem.base((6, 4, 0.2), dem.BlockMat(density=2000, frictionAngle=0.6))
    ids = dem.wall(6, 4, (0.4, 0.2, 0.175), O.bodies[base].mat, on=base)
    O.engines = rigid_engines()
    O.run(100, True)
    for speed in (0.05, 0):
        O.bodies[base].state.vel = (speed, 0, 0)
        O.run(100, True)
    assert integrator().movingSteps > 0 and integrator().failures == 0
    dem.save_blocks(str(tmp_path / "wall.csv"))
    for method in ("wall", "localised", "table"):
        if method == "table":
            O.reset()
            base = dem.base((6, 4, 0.2), dem.BlockMat(density=2000, frictionAngle=0.6))
            ids = dem.blocks_from_table(str(tmp_path / "wall.csv"), O.bodies[base].mat)
        places = [O.bodies[id].state.pos for id in ids]
        O.engines = rigid_engines(method="wall" if method == "table" else method)
        O.run(50, True)
        moved = max((O.bodies[id].state.pos - place).norm() for id, place in zip(ids, places))
        print(f"wall that was moved, then '{method}': its blocks move by {moved:.1e} m")
        assert moved < 1e-4 * 0.175  # what an overlap may be


@pytest.mark.parametrize("model", ("planar", "spatial"))
@pytest.mark.parametrize("method, columns", (("localised", 1), ("wall", 5)))
def test_the_deepest_overlap_that_is_accepted(model, method, columns):
    """Blocks keep it at rest, and nothing comes of it."""
    overlap = 0.95e-4 * 0.25  # of the smallest half size
    base = dem.base((6, 4, 1), dem.BlockMat(density=2000, frictionAngle=0.6))
    ids = [dem.block((0.6, 0.6, 0.5), O.bodies[base].mat, center=(0.6 * x, 0, 0.25 + 0.5 * k - (k + 1) * overlap)) for x in range(columns) for k in range(5)]
    places = [O.bodies[id].state.pos for id in ids]
    O.engines = rigid_engines(model=model, method=method)
    O.run(300, True)
    moved = max((O.bodies[id].state.pos - place).norm() for id, place in zip(ids, places))
    assert moved < (1e-3 if method == "localised" else 1e-2) * overlap and integrator().failures == 0  # `wall`: 5e-8 m a joint, by its tolerance


def test_a_base_whose_place_a_script_changes(capfd):
    """A warning, since blocks do not feel it."""
    wall(2, 2, 0, method="wall")
    O.engines = rigid_engines(method="wall")
    capfd.readouterr()
    for _ in range(3):
        O.bodies[0].state.pos += Vector3(1e-4, 0, 0)
        O.step()
    text = capfd.readouterr().err
    assert text.count("state.pos") == 1 and "state.vel" in text


@pytest.mark.parametrize("method", ("localised", "wall"))
def test_gravity_that_a_script_turns_out_of_the_plane(method, capfd):
    """On in space, where it topples what it must."""
    base = dem.base((4, 4, 0.2), dem.BlockMat(density=2000, frictionAngle=0.6))
    block = dem.block((0.3, 0.3, 1.5), O.bodies[base].mat, on=base)
    O.engines = rigid_engines(method=method)
    O.run(20, True)
    assert integrator().chosenModel == "planar"
    integrator().gravity = (0, 0.5 * 9.81, -9.81)
    capfd.readouterr()
    O.run(600, True)
    text = capfd.readouterr().err
    # Rigid: 3/(4 R^2) (a 0.5 g - b g) at first, 3 rad/s^2.
    least = 0.5 * 3 / (4 * (0.15**2 + 0.75**2)) * (0.75 * 0.5 - 0.15) * 9.81 * (600 * O.dt) ** 2
    assert integrator().chosenModel == "spatial" and "gravity points out of the plane" in text
    assert -dem.angle(block, "x") > 0.9 * least or dem.overturned()
