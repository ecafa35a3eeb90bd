"""Convex blocks on compliant joints: against statics, and saved and loaded."""

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, stone
from scipy.optimize import linprog
from yade import O

GRAVITY = 9.81


def rubber(stiffness=1e9):
    return dem.BlockMat(density=2000, frictionAngle=0.7, normalStiffness=stiffness, shearStiffness=stiffness / 2)


def rise(id):
    return dem.geometry(id).vertices[:, 2].min()


@pytest.mark.parametrize("sides", (3, 6, 24))
@pytest.mark.parametrize("on_drum", (False, True))
def test_drum_stands_on_all_its_corners(sides, on_drum):
    """The joint bears the weight W and closes by W/(k A), A the area of the polygon; of drums on each other the lower joint has twice that."""
    base = dem.base((3, 3, 0.2), rubber())
    ids = [dem.drum(0.5, 0.8, rubber(), sides=sides, on=base)]
    if on_drum:
        ids.append(dem.drum(0.5, 0.8, rubber(), sides=sides, on=ids[0]))
    O.engines = quiet_engines(gravity=GRAVITY)
    O.run(int(1 / O.dt), True)
    found = dem.geometry(ids[0])
    weight, area = GRAVITY * O.bodies[ids[0]].state.mass, found.volume / 0.8
    depth = weight / (1e9 * area)
    assert np.allclose(dem.reactions(base)["force"].sum(axis=0), [0, 0, weight * len(ids)], rtol=0, atol=1e-9 * weight)
    assert rise(ids[0]) == pytest.approx(-len(ids) * depth, rel=1e-6)
    if on_drum:
        assert rise(ids[1]) - (rise(ids[0]) + 0.8) == pytest.approx(-depth, rel=1e-6)
    for interaction in O.interactions:
        assert len(interaction.geom.gaps) == sides and interaction.geom.area == pytest.approx(area, rel=1e-9)


def thrusts(ids, friction):
    """(least, largest) horizontal thrust of an arch over its weight, by statics: forces at both ends of each joint, which do not pull, and one along it, of at
    most the friction. The blocks are in a plane; joints are the sides that neighbours share."""
    outlines = [np.unique(np.round(dem.geometry(id).vertices[:, [0, 2]], 9), axis=0) for id in ids]
    masses = np.array([O.bodies[id].state.mass for id in ids])
    centers = np.array([tuple(O.bodies[id].state.pos) for id in ids])[:, [0, 2]]
    joints = [np.array([p for p in one if np.linalg.norm(other - p, axis=1).min() < 1e-8]) for one, other in zip(outlines, outlines[1:])]
    joints = [outlines[0][outlines[0][:, 1].argsort()[:2]], *joints, outlines[-1][outlines[-1][:, 1].argsort()[:2]]]
    equations, loads = np.zeros((3 * len(ids), 3 * len(joints))), np.zeros(3 * len(ids))
    normals = []
    for k, (a, b) in enumerate(joints):
        along = (b - a) / np.linalg.norm(b - a)
        normal = np.array([along[1], -along[0]])
        ahead = centers[k] - (a + b) / 2 if k < len(ids) else (a + b) / 2 - centers[k - 1]
        normals.append(normal if normal @ ahead > 0 else -normal)
        for block, sign in ((k, 1), (k - 1, -1)):  # a joint pushes the block after it ahead, and the one before it back
            if not 0 <= block < len(ids):
                continue
            for column, (place, force) in enumerate(((a, normals[k]), (b, normals[k]), (a, along))):
                arm = place - centers[block]
                equations[3 * block:3 * block + 3, 3 * k + column] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
    loads[1::3] = GRAVITY * masses
    slides = np.zeros((2 * len(joints), 3 * len(joints)))
    for k in range(len(joints)):
        slides[2 * k, 3 * k:3 * k + 3] = -friction, -friction, 1
        slides[2 * k + 1, 3 * k:3 * k + 3] = -friction, -friction, -1
    crown = len(joints) // 2
    cost = np.zeros(3 * len(joints))
    a, b = joints[crown]
    cost[3 * crown:3 * crown + 3] = normals[crown][0], normals[crown][0], (b - a)[0] / np.linalg.norm(b - a)
    bounds = [(0, None), (0, None), (None, None)] * len(joints)
    least, largest = (linprog(sign * cost, slides, np.zeros(len(slides)), equations, loads, bounds) for sign in (1, -1))
    assert least.success and largest.success
    return least.fun / loads.sum(), -largest.fun / loads.sum()


def semicircular_arch(stiffness=1e9):
    """15 voussoirs, the thickness 0.15 of the mean radius 2 m; what it stands on is one with the base."""
    base = dem.base((7, 3, 0.2), rubber(stiffness))
    return base, dem.arch(4, 2, 0.3, 15, 0.6, rubber(stiffness), on=base, measured="middle")


def test_arch_stands_with_a_thrust_within_the_bounds_of_statics():
    base, ids = semicircular_arch(1e10)
    least, largest = thrusts(ids, np.tan(0.7))
    assert 0.15 < least < 0.19 and 0.21 < largest < 0.25  # 16 voussoirs: 0.1766 and 0.2281
    start = dem.geometry(ids[7]).center
    O.engines = quiet_engines(gravity=GRAVITY)
    O.run(int(2 / O.dt), True)
    weight = GRAVITY * sum(O.bodies[id].state.mass for id in ids)
    forces = dem.reactions(base)["force"]
    assert len(forces) == 2 and forces[:, 2].sum() == pytest.approx(weight, rel=1e-3)
    assert least < np.abs(forces[:, 0]).mean() / weight < largest
    assert np.linalg.norm(dem.geometry(ids[7]).center - start) < 1e-3 * 0.3


def test_flat_arch_stands_on_its_least_thrust():
    """Its joints open until the thrust is the least that statics allow, H/W = 0.52818 (validation/convex/statics.py). Its stones then sway by the play of their
    springs, so that joints close and hand over their pivots."""
    voussoir = dem.BlockMat(density=2000, frictionAngle=np.arctan(0.4), restitution=0)
    ids = dem.flat_arch(2.0, 0.4, 5, 2.0, 0.5, voussoir, springers=True)
    for end in (ids[0], ids[-1]):
        O.bodies[end].dynamic = False
    starts = [O.bodies[id].state.pos for id in ids]
    O.engines = quiet_engines(gravity=GRAVITY)
    O.run(int(0.7 / O.dt), True)
    weight = GRAVITY * sum(O.bodies[id].state.mass for id in ids[1:-1])
    assert max((O.bodies[id].state.pos - start).norm() for id, start in zip(ids, starts)) < 1e-3 * 0.4
    assert abs(dem.reactions(ids[0])["force"].sum(axis=0)[0]) / weight == pytest.approx(0.52818, rel=1e-2)


def test_saved_and_loaded_arch_goes_on_with_the_same_bits(tmp_path):
    def state():
        return np.array([[*b.state.pos, *b.state.ori, *b.state.vel, *b.state.angVel] for b in O.bodies]).view(np.int64)

    semicircular_arch()
    O.engines = quiet_engines(gravity=GRAVITY)
    O.run(200, True)
    O.save(str(tmp_path / "arch.xml"))
    O.run(200, True)
    was = state()
    O.reset()
    O.load(str(tmp_path / "arch.xml"))
    O.run(200, True)
    assert np.array_equal(state(), was)


def test_boxes_and_convex_blocks_stand_on_each_other():
    """A box of points is a box, on a box and under one: the stack of both kinds closes like one of boxes."""
    depths = []
    for convex in (False, True):
        O.reset()
        base, places = dem.base((3, 3, 0.2), rubber()), []
        for k in range(3):
            half = np.array([0.5, 0.4, 0.3])
            corners = half * [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
            below = places[-1] if places else base
            make = (lambda: dem.convex(corners, rubber(), on=below)) if convex and k == 1 else (lambda: dem.block(2 * half, rubber(), on=below))
            places.append(make())
        O.engines = quiet_engines(gravity=GRAVITY)
        O.run(int(0.5 / O.dt), True)
        depths.append([0.6 * k - rise(id) for k, id in enumerate(places)])
    assert np.allclose(*depths, rtol=0, atol=1e-12)


def test_convex_block_in_the_air_has_a_step():
    dem.base((3, 3, 0.2), rubber())
    id = dem.drum(0.5, 0.8, rubber(), sides=6, center=(0, 0, 1.5))
    O.engines = quiet_engines(gravity=GRAVITY)
    O.run(int(2 / O.dt), True)
    weight = GRAVITY * O.bodies[id].state.mass
    assert abs(rise(id)) < 1e-3 and dem.reactions(0)["force"][0][2] == pytest.approx(weight, rel=0.05)


def test_stiffness_is_chosen_by_the_lower_face():
    """The weight presses the whole face in by half of the penetration times the smallest width."""
    base = dem.base((3, 3, 0.2), stone())
    id = dem.drum(0.5, 0.8, stone(), sides=6, on=base)
    O.engines = quiet_engines(gravity=GRAVITY, penetration=1e-5)
    O.run(int(0.5 / O.dt), True)
    width = np.ptp(dem.geometry(id).vertices, axis=0)[:2].min()
    assert -rise(id) == pytest.approx(0.5e-5 * width, rel=1e-6)


@pytest.mark.parametrize("sides", (3, 6, 24))
def test_period_of_a_drum_on_its_joint(sides):
    """Sway u and turn t of the drum, of which the joint has the springs k_s A against u - h t and k_n I against t, I = A R^2 (2 + cos(2 pi/n))/12 the second
    moment of a regular polygon with corners at the distance R. The weight, at the height h, turns it on by W h t. Modes of these two freedoms; the lower one is set going.
    Steps of 0.2 of the critical one shorten a period by (w dt)^2/24, at most 0.7 %."""
    base = dem.base((3, 3, 0.2), rubber())
    id = dem.drum(0.5, 0.8, rubber(), sides=sides, on=base)
    state, found, h = O.bodies[id].state, dem.geometry(id), 0.4
    shear, area = 0.5e9, found.volume / 0.8
    radius = np.linalg.norm(found.vertices[:, :2] - found.center[:2], axis=1).max()
    turning = 1e9 * area * radius**2 * (2 + np.cos(2 * np.pi / sides)) / 12 - GRAVITY * state.mass * h
    stiffness = shear * area * np.array([[1, -h], [-h, h**2]]) + np.diag([0, turning])
    mass = np.diag([state.mass, found.inertia[1, 1]])
    squares, modes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    lowest = squares.argmin()
    O.engines = quiet_engines(gravity=GRAVITY)
    O.engines[2].lawDispatcher.functors[0].dampingRatio = 0
    O.run(2, True)
    u, t = modes[:, lowest] / modes[0, lowest]
    state.vel, state.angVel = (1e-4 * u, 0, 0), (0, 1e-4 * t, 0)
    times, places = [], []
    period = 2 * np.pi / np.sqrt(squares[lowest])
    start = O.time
    while O.time < start + 5.2 * period:
        O.step()
        times.append(O.time)
        places.append(state.pos[0])
    up = [k for k in range(len(places) - 1) if places[k] < 0 <= places[k + 1]]
    crossings = [times[k] - places[k] * (times[k + 1] - times[k]) / (places[k + 1] - places[k]) for k in up]
    assert np.diff(crossings).mean() == pytest.approx(period, rel=7e-3)
