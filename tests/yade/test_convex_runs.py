"""Rigid convex blocks in motion, with both methods, in the plane and in space: right values, balances, symmetries and saved runs. validation/convex has more cases."""

import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
from convex_hash import convex_hash
from masonry import dem, results
from rocking_scene import Balance, bits, quiet_engines, rigid_engines, steps, stone
from yade import O, Quaternion, Vector3

METHODS, MODELS = ("localised", "wall"), ("planar", "spatial")
TRAPEZOID = [(0, 0), (0.8, 0), (0.4, 2), (0, 2)]
# Centre and squared radius of gyration of the trapezoid, by hand; arms from its pivots A (left) and B to the centre.
CENTER, GYRATION2 = np.array([0.311111111, 0.888888889]), 0.3575309
ARMS = {"A": CENTER, "B": CENTER - (0.8, 0)}


def regular(n, radius):
    angles = 2 * math.pi * (np.arange(n) + 0.5) / n - math.pi / 2
    return (radius * np.column_stack([np.cos(angles), np.sin(angles)])).tolist()


def move(*motion, **options):
    """Sets the engines. With method='wall' they step few blocks by it, too."""
    O.engines = rigid_engines(*motion, **options)
    O.engines[-1].wallsOnly = options.get("method") == "wall"
    O.engines[-1].onTrouble = "stop"


def rocking_trapezoid(angle, restitution=math.nan, yaw=0.0, **options):
    """The block of a fresh scene, turned about y so that it stands on B (angle > 0) or A."""
    O.reset()
    material = stone(restitution)
    base = dem.base((6, 6, 0.2), material)
    O.bodies[base].state.ori = Quaternion(Vector3.UnitZ, yaw)
    body = O.bodies[dem.prism(TRAPEZOID, 1.0, material, axis="y", on=base)]
    dem.tilt(body.id, angle)
    move(**options)
    return body


def run_to_impact(count=1):
    while len(dem.impacts()) < count:
        O.step()
    return dem.impacts()


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("angle, old, new", ((0.1, "B", "A"), (-0.1, "A", "B")))
def test_natural_restitution_of_a_block_that_is_not_symmetric(angle, old, new, model):
    """Moment of momentum about the new pivot is kept: C = (k^2 + r_old . r_new) / (k^2 + r_new^2), another one in each direction (0.8, 0.717949)."""
    rocking_trapezoid(angle, model=model)
    impact = run_to_impact()[0]
    right = (GYRATION2 + ARMS[old] @ ARMS[new]) / (GYRATION2 + ARMS[new] @ ARMS[new])
    assert np.isnan(impact["restitution_asked"]) and not impact["capped"]
    assert impact["restitution"] == pytest.approx(right, rel=1e-6)  # of the constants above
    drop = math.hypot(*ARMS[old]) * math.cos(math.atan2(abs(ARMS[old][0]), ARMS[old][1]) - 0.1) - CENTER[1]
    assert impact["velocity"] == pytest.approx(math.sqrt(2 * 9.81 * drop / (GYRATION2 + ARMS[old] @ ARMS[old])), rel=1e-6)


@pytest.mark.parametrize("model, method, error", [(model, method, {"localised": 1e-6, "wall": 6e-3}[method]) for model in MODELS for method in METHODS] + [("compliant", None, 2e-5)])
def test_restitution_of_1_is_capped_where_it_would_make_energy(model, method, error):
    """The energy I w^2/2 of the rotation about the new pivot is at most that about the old one, I = k^2 + r^2: C is at most sqrt(I_old/I_new), 0.947331 from A to B
    and more than 1 from B to A. `wall` gives up to a step's gravity away."""
    most = math.sqrt((GYRATION2 + ARMS["A"] @ ARMS["A"]) / (GYRATION2 + ARMS["B"] @ ARMS["B"]))
    for angle, right in ((-0.1, most), (0.1, 1)):
        rocking_trapezoid(angle, 1.0, **({} if method is None else {"model": model, "method": method}))
        if method is None:
            O.engines = quiet_engines()
        impact = run_to_impact()[0]
        assert impact["restitution_asked"] == 1 and impact["capped"] == (right < 1)
        assert (1 - error) * right < impact["restitution"] < (1 + 1e-6) * right


def test_free_rocking_of_a_block_that_is_not_symmetric():
    """Times and spins of landings from 0.2 rad about B with C = 0.7, by quadrature (validation/convex/rolling.py)."""
    rocking_trapezoid(0.2, 0.7)
    found = run_to_impact(4)
    assert found["time"][:4] == pytest.approx([0.412276, 1.251559, 1.567592, 1.880957], rel=2e-6)
    assert found["velocity"][:4] == pytest.approx([1.059979, 0.741985, 0.519390, 0.363573], rel=2e-6)


@pytest.mark.parametrize("method", METHODS)
def test_plane_and_space_agree(method):
    """The same prism, in the plane, in space and turned by 30 degrees about z: angles of one rocking motion, at the same step. They differ by what
    the tolerance of the contact laws leaves."""
    found = []
    for model, yaw in (("planar", 0), ("spatial", 0), ("planar", math.pi / 6), ("spatial", math.pi / 6)):
        body = rocking_trapezoid(0.2, 0.7, yaw, model=model, method=method, dt=5e-4, tolerance=1e-6 if method == "wall" else 1e-9)
        angles = []
        for _ in range(40):
            steps(50)
            angles.append(dem.angle(body.id))
        found.append(angles)
    assert np.ptp(found[0]) > 0.3
    apart = np.abs(np.array(found) - found[0]).max(axis=1)
    assert apart.max() < {"localised": 1e-11, "wall": 1e-6}[method], apart


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("n, right", ((4, 1 / 4), (6, 11 / 17), (24, 0.977198)))
def test_a_prism_that_falls_on_its_next_side(n, right, model):
    """Natural restitution (k^2 + R^2 cos(2 pi/n)) / (k^2 + R^2) of a regular n-gon; of the hexagon 11/17."""
    material = stone()
    base = dem.base((6, 6, 0.2), material)
    id = dem.prism(regular(n, 0.5), 1.0, material, axis="y", on=base)
    dem.tilt(id, math.pi / n + 0.02)  # past the corner
    move(model=model)
    impact = run_to_impact()[0]
    assert impact["restitution"] == pytest.approx(right, rel=2e-6) and impact["switched"]


@pytest.mark.parametrize("slope, rolls", ((6.5, False), (6.6, True)))
def test_least_slope_on_which_a_hexagon_rolls(slope, rolls):
    """6.572 degrees (validation/convex/rolling.py): from the faster side, 16 landings."""
    side = 0.2
    material = stone()
    base = dem.base((10, 2, 0.2), material)
    O.bodies[base].state.pos += Vector3(4, 0, 0)
    body = O.bodies[dem.prism(regular(6, side), 0.4, material, axis="y", center=(0, 0, side * math.sqrt(3) / 2))]
    pivot = Vector3(side / 2, 0, 0)
    spin = Vector3(0, 2.6, 0)
    body.state.angVel, body.state.vel = spin, spin.cross(body.state.pos - pivot)
    move()
    angle = math.radians(slope)
    O.engines[-1].gravity = 9.81 * Vector3(math.sin(angle), 0, -math.cos(angle))
    while body.state.angVel[1] > 1e-3 and len(dem.impacts()) < 16:
        O.step()
    assert (len(dem.impacts()) == 16) == rolls


def column(friction=0.7):
    material = stone(0, noSlip=False, frictionAngle=math.atan(friction))
    base = dem.base((4, 3, 0.2), material)
    widths = np.linspace(1.0, 0.7, 6)
    return base, [dem.convex([(s * x / 2, y, z) for s in (-1, 1) for x, z in ((a, k), (b, k + 1)) for y in (-0.5, 0.5)], material)
                  for k, (a, b) in enumerate(zip(widths, widths[1:]))]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("friction, right", ((0.7, 0.2125), (0.15, 0.15)))
def test_column_of_frusta_on_a_tilting_table(friction, right, model, method, tmp_path):
    """It tips as one at half the base over the height of its centre, or slides at mu."""
    _, ids = column(friction)
    found = dem.TiltTable(model=model, method=method).bisect(tolerance=1e-3, lower=0.8 * right, progress=False)
    assert found.multiplier == pytest.approx(right, rel=1e-3) and not found.doubts and found.blocks == ids
    found.draw(tmp_path / "frusta.png")
    assert (tmp_path / "frusta.png").stat().st_size > 1e4


@pytest.mark.parametrize("sides", (3, 6))
def test_prisms_tip_at_the_edge_of_their_base_in_every_direction(sides):
    """Their multiplier is the distance from the centre to the edge of the base in that direction over the height of the centre: no corner of a patch is lost."""
    for turn in 0.1 + 2 * math.pi * np.arange(8) / 8:
        O.reset()
        material = stone(0, noSlip=False, frictionAngle=math.atan(3))
        base = dem.base((4, 4, 0.2), material)
        dem.prism(regular(sides, 0.5), 2.0, material, on=base, orientation=Quaternion(Vector3.UnitZ, turn))
        found = dem.TiltTable(model="spatial").bisect(progress=False).multiplier
        to_normal = (turn - math.pi / 2) % (2 * math.pi / sides)  # from the normal of a side to x
        to_normal = min(to_normal, 2 * math.pi / sides - to_normal)
        assert found == pytest.approx(0.5 * math.cos(math.pi / sides) / math.cos(to_normal), rel=1e-3), turn


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("weights", (0, 1, 100))
def test_a_keystone_without_slip_locks(weights, model, method):
    """Sides at 20 degrees from the vertical, between two blocks on a floor. Joints without slip bear any push: the forces of the sides may be upright, and the
    blocks bear them within their beds. The solvers leave a residual of 1e-9 of the speed that weight and push give in a step: in a second the blocks move
    by that speed times a second at most, here ten times."""
    material = stone()
    base = dem.base((12, 3, 0.2), material)
    rise = math.tan(math.radians(20))
    inner, top, foot = 0.3, 0.3 + rise, 0.3 + 0.3 * rise
    section = [(inner, 0), (3, 0), (3, 1), (top, 1)]
    sides = [dem.prism([(sign * x, z) for x, z in section[::sign]], 1.0, material, axis="y") for sign in (1, -1)]
    key = dem.prism([(-foot, 0.3), (foot, 0.3), (top, 1), (-top, 1)], 1.0, material, axis="y")
    weight = 9.81 * O.bodies[key].state.mass
    O.forces.setPermF(key, Vector3(0, 0, -weights * weight))
    places = [Vector3(O.bodies[id].state.pos) for id in (*sides, key)]
    move(model=model, method=method)
    dem.run(1.0, progress=False)
    moved = max((O.bodies[id].state.pos - before).norm() for id, before in zip((*sides, key), places, strict=True))
    carried = dem.reactions(base)["force"].sum(axis=0)[2] / (sum(O.bodies[id].state.mass * 9.81 for id in (*sides, key)) + weights * weight)
    print(f"moved {moved:.1e} m, carried {carried - 1:.1e}, failures {O.engines[-1].failures}")
    assert O.engines[-1].failures == 0
    assert moved < 10 * 1e-9 * (1 + weights) * 9.81 * O.dt * O.time
    assert carried == pytest.approx(1, rel=1e-9)


# --- balances ---


def tetrahedron(method):
    """It falls on its base and slides."""
    material = stone(0.5, noSlip=False, frictionAngle=0.4)
    base = dem.base((6, 6, 0.2), material)
    corners = [(math.cos(t), math.sin(t), 0) for t in 2 * np.pi * np.arange(3) / 3] + [(0, 0, math.sqrt(2))]
    body = O.bodies[dem.convex(corners, material, on=base)]
    body.state.ori = Quaternion(Vector3(0.3, 1, 0).normalized(), 0.3) * body.state.ori
    body.state.pos += Vector3(0, 0, 0.05 - dem.geometry(body.id).vertices[:, 2].min())
    body.state.vel = Vector3(1, 0.5, 0)
    move(method=method)
    return base, body.id


def rubble(method):
    base = dem.base((6, 3, 0.2), stone(0.3, noSlip=False, frictionAngle=0.6))
    dem.rubble_wall(1.5, 1.0, 0.4, 0.4, O.bodies[base].mat, on=base, seed=3)
    samples = list(12 * np.sin(2 * math.pi * 2 * 0.01 * np.arange(100)))
    move(dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01), method=method)


def frusta(method):
    base, _ = column()
    samples = list(4 * np.sin(2 * math.pi * 1 * 0.01 * np.arange(100)))
    move(dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01), method=method)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", (tetrahedron, rubble, frusta))
def test_energies_balance(scene, method):
    """The sum changes by what the engine says it has made or lost, which in walls is part of impactDissip. Relative to the energy that has been turned over."""
    scene(method)
    balance = Balance()
    dem.run(1.0, progress=False)
    engine, e = O.engines[-1], dem.energy()
    turned = e["kinetic"] + e["frictDissip"] + e["impactDissip"]
    error = balance.error() - (0 if method == "wall" else engine.madeEnergy - engine.lostEnergy)
    assert turned > 100 and abs(error) < 1e-12 * turned and engine.madeEnergy < 1e-3 * turned


@pytest.mark.parametrize("method", METHODS)
def test_a_tetrahedron_comes_to_rest_on_its_face(method):
    base, id = tetrahedron(method)
    dem.run(3, progress=False)
    assert dem.at_rest() and dem.overturned() == []
    weight = 9.81 * O.bodies[id].state.mass
    assert dem.reactions(base)["force"].sum(axis=0) == pytest.approx([0, 0, weight], abs=1e-3 * weight)
    assert abs(dem.geometry(id).vertices[:, 2]).min() < 1e-6


# --- saved runs ---


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", (tetrahedron, rubble, frusta))
def test_saved_and_loaded(scene, method, tmp_path):
    """A run that is saved, loaded and continued has the bits of one that was not."""
    scene(method)
    steps(400)
    wanted = bits()
    for ending in ("xml", "yade"):
        O.reset()
        scene(method)
        steps(157)
        path = str(tmp_path / f"scene.{ending}")
        O.save(path)
        saved = bits()
        O.reset()
        O.load(path)
        assert np.array_equal(saved, bits()), ending
        steps(400 - 157)
        assert np.array_equal(wanted, bits()), ending


def test_any_number_of_threads():
    """One thread and two give the same bits."""
    script = Path(__file__).with_name("convex_hash.py")
    output = subprocess.run(["yade", "-j2", "-n", "-x", str(script)], capture_output=True, text=True, timeout=200).stdout
    assert f"hash {convex_hash()}" in output, output


# --- what is recorded ---


@pytest.mark.parametrize("method", METHODS)
def test_recorders(method, tmp_path):
    """Shapes, forces and poses of a column that is shaken; a report and a picture of it."""
    base, ids = column()
    wall, block = dem.WallRecorder(iterPeriod=20, recordForces=True), dem.BlockRecorder(iterPeriod=20, ids=[ids[0], ids[-1]])
    samples = list(4 * np.sin(2 * math.pi * 1 * 0.01 * np.arange(100)))
    move(dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01), method=method, recorder=[wall, block])
    dem.run(1, progress=False)
    h, own = dem.wall_history(wall), dem.history(block)
    row, apart = h.ids.tolist().index(ids[-1]), lambda corners: np.linalg.norm(corners[:, None] - corners, axis=2)
    assert np.allclose(apart(h.corners(h.time.size - 1)[row, :8]), apart(dem.geometry(ids[-1]).vertices), rtol=0, atol=1e-12)
    weight = sum(O.bodies[id].state.mass for id in ids) * 9.81
    assert own["force"][1, 0] @ (0, 0, 1) == pytest.approx(weight, rel=0.02) and np.nanmax(own["uplift"]) > 1e-3
    results.report(h, tmp_path / "report.html")
    results.draw(h, tmp_path / "column.png")
    h.save(tmp_path / "column.npz")
    assert (tmp_path / "report.html").stat().st_size > 1e5
