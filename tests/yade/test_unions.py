"""Rigid unions of convex parts: mass, motion beside that of one solid, joints, what is refused, saved runs."""

import math

import numpy as np
import pytest
from masonry import dem, results
from masonry.dem.meshes import write_obj
from rocking_scene import refuses, rigid_engines, said_by, stone
from yade import O, Quaternion, Vector3

METHODS, MODELS = ("localised", "wall"), ("planar", "spatial")
# An L of two boxes 0.4 m deep: its foot is 1 x 0.2 m, its stem 0.3 x 0.8 m at the left end of that. Lower left corner at x = 0, z = 0.
FOOT, STEM, DEPTH = ((0, 1.0), (0, 0.2)), ((0, 0.3), (0.2, 1.0)), 0.4


def cuboid(x, z, y=(-DEPTH / 2, DEPTH / 2)):
    return np.array([(a, b, c) for a in x for b in y for c in z], dtype=float)


def mirrored(parts):
    return [part * (-1, 1, 1) for part in parts]


def an_l(material, mirror=False, **place):
    parts = [cuboid(*FOOT), cuboid(*STEM)]
    return dem.union(mirrored(parts) if mirror else parts, material, **place)


# By hand: areas, centre (x, z) and second moment over area about it, of the section of the L.
AREAS = np.array([0.2, 0.24])
CENTERS = np.array([(0.5, 0.1), (0.15, 0.6)])
CENTER = AREAS @ CENTERS / AREAS.sum()
SQUARES = np.array([(1.0**2 + 0.2**2) / 12, (0.3**2 + 0.8**2) / 12])
GYRATION2 = (AREAS @ (SQUARES + ((CENTERS - CENTER) ** 2).sum(axis=1))) / AREAS.sum()


def move(*motion, **options):
    O.engines = rigid_engines(*motion, **options)
    O.engines[-1].wallsOnly = options.get("method") == "wall"
    O.engines[-1].onTrouble = "stop"


def count(seconds):
    return round(seconds / O.dt)


def inclined_base(material, slope, size=(8, 4, 0.2)):
    """A base that slopes down along +x."""
    base = dem.base(size, material)
    O.bodies[base].state.ori = Quaternion(Vector3.UnitY, slope)
    return base


def test_mass_centre_and_inertia_of_an_l():
    """Steiner's theorem by hand, for the section and for the depth."""
    found = dem.geometry(an_l(stone()))
    mass = 2000 * AREAS.sum() * DEPTH
    assert found.volume == pytest.approx(AREAS.sum() * DEPTH, rel=1e-14)
    assert found.center == pytest.approx([CENTER[0], 0, CENTER[1]], abs=1e-14)
    assert found.inertia[1, 1] == pytest.approx(mass * GYRATION2, rel=1e-13)
    arms = CENTERS - CENTER
    heights, widths = np.array([0.2, 0.8]), np.array([1.0, 0.3])
    part = 2000 * AREAS * DEPTH
    assert found.inertia[0, 0] == pytest.approx(part @ ((heights**2 + DEPTH**2) / 12 + arms[:, 1] ** 2), rel=1e-13)
    assert found.inertia[2, 2] == pytest.approx(part @ ((widths**2 + DEPTH**2) / 12 + arms[:, 0] ** 2), rel=1e-13)
    assert found.inertia[0, 2] == pytest.approx(-part @ arms.prod(axis=1), rel=1e-13)
    assert not found.is_box and len(found.vertices) == 16 and len(found.faces) == 12


def test_ids_become_one_body_and_one_part_is_a_block():
    base, material = dem.base((9, 9, 0.2), stone()), stone()
    ids = [dem.block((1, 0.4, 0.2), material, center=(0, 0, 0.1)), dem.block((0.3, 0.4, 0.8), material, center=(-0.35, 0, 0.6))]
    id = dem.union(ids)
    assert all(O.bodies[k] is None for k in ids) and O.bodies[id].mat.id == material.id and O.bodies[id].shape.parts == 2
    assert dem.geometry(id).center == pytest.approx([CENTER[0] - 0.5, 0, CENTER[1]])
    one = dem.union([cuboid((2, 3), (0, 1))], material)
    assert dem.geometry(one).is_box and O.bodies[one].shape.parts == 1
    first, second = dem.block((1, 1, 1), material, center=(5, 0, 0.5)), dem.block((1, 1, 1), material, center=(6, 0, 0.5))
    dem.union([first, second], keep=True, center=(0, 3, 0.5), orientation=Quaternion(Vector3.UnitZ, 1))
    assert O.bodies[first] is not None and dem.check_blocks(floating=False) == [first, second]
    assert O.bodies[base] is not None


def test_bad_input():
    material = stone()
    a, b = cuboid((0, 1), (0, 1)), cuboid((0.95, 2), (0, 1))
    refuses(lambda: dem.union([a, b], material), "parts: 0 and 1 overlap by 0.05 m")
    refuses(lambda: dem.union([a, cuboid((1.1, 2), (0, 1))], material), "parts: 1 touches none of those that are joined to part 0 on a face")
    refuses(lambda: dem.union([a, cuboid((1, 2), (1, 2))], material), "parts: 1 touches none")
    refuses(lambda: dem.union([a, a * (1, 1, 0)], material), "parts[1]: thickness of the vertices")
    refuses(lambda: dem.union([], material), "parts = []: must be ids of blocks, or corners")
    refuses(lambda: dem.union([a, cuboid((1, 2), (0, 1))]), "material = None: must be a BlockMat, because the parts have no materials")
    base = dem.base((1, 1, 1), material)
    refuses(lambda: dem.union([base]), f"parts[0] = {base}: that body is prescribed")
    refuses(lambda: dem.union([a * 1e3, cuboid((1, 2), (0, 1)) * 1e3], material), "extent")
    assert len(O.bodies) == 1


def rocking(material, whole, angle=0.12):
    """A block 0.6 x 0.8 x 2 m on a base, whole or of three parts: two halves, of which one is cut again across."""
    base = dem.base((6, 6, 0.2), material)
    y = (-0.4, 0.4)
    parts = [cuboid((-0.3, 0.3), (0, 2), y)] if whole else [cuboid((-0.3, 0.3), (0, 0.7), y), cuboid((-0.3, 0.1), (0.7, 2), y), cuboid((0.1, 0.3), (0.7, 2), y)]
    id = dem.union(parts, material, on=base)
    dem.tilt(id, angle)
    return id


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_a_box_of_parts_rocks_as_the_box(method, model):
    """No seam touches the base, so the motions differ by round-off of the centre. Rocking is regular: 2 s keep the digits. method='wall' solves to its
    tolerance, 1e-6 here, and the order of its points is another one."""
    angles = []
    for whole in (True, False):
        O.reset()
        id = rocking(stone(0.8), whole)
        move(method=method, model=model, tolerance=1e-6 if method == "wall" else None)
        found = []
        for _ in range(40):
            O.run(max(1, round(0.05 / O.dt)), True)
            found.append(dem.angle(id))
        angles.append(found)
    assert np.ptp(angles[0]) > 0.1
    assert np.abs(np.subtract(*angles)).max() < (1e-9 if method == "localised" else 1e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("cut", ("upright", "level"))
def test_seams_on_the_base_do_no_harm(cut, model, method):
    """A block cut along the plane through its base: points at the seam lie within the support of the whole and carry at most a share of it. It slides and
    it rocks about its edges as the whole does."""
    found = []
    for whole in (True, False):
        O.reset()
        material = stone(0.8, noSlip=False, frictionAngle=math.atan(0.3))
        base = dem.base((20, 6, 0.2), material)
        y = (-0.4, 0.4)
        cuts = [cuboid((-0.5, 0.1), (0, 0.5), y), cuboid((0.1, 0.5), (0, 0.5), y)] if cut == "upright" else [cuboid((-0.5, 0.5), (0, 0.2), y), cuboid((-0.5, 0.5), (0.2, 0.5), y)]
        id = dem.union([cuboid((-0.5, 0.5), (0, 0.5), y)] if whole else cuts, material, on=base)
        O.bodies[id].state.vel = Vector3(1.5, 0, 0)
        move(method=method, model=model, tolerance=1e-6 if method == "wall" else None)
        O.run(count(0.8), True)
        found.append([*O.bodies[id].state.pos, dem.angle(id)])
    assert found[0][0] == pytest.approx(1.5**2 / (2 * 0.3 * 9.81), rel=1e-3 if method == "localised" else 3e-3)  # one step of sliding
    assert np.abs(np.subtract(*found)).max() < (1e-8 if method == "localised" else 2e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_a_block_slides_over_a_seam(model, method):
    """A small block slides across the seam of two flush parts of a fixed union: it stops at v^2 / (2 mu g), on the far side of the seam, and never jumps."""
    material = stone(0.5, noSlip=False, frictionAngle=math.atan(0.3))
    below = dem.union([cuboid((-1, 0), (-0.3, 0), (-0.5, 0.5)), cuboid((0, 1.5), (-0.3, 0), (-0.5, 0.5))], material)
    O.bodies[below].dynamic = False
    block = dem.block((0.3, 0.2, 0.2), material, center=(-0.4, 0, 0.1))
    O.bodies[block].state.vel = Vector3(2, 0, 0)
    move(method=method, model=model)
    highest = 0
    for _ in range(count(1.0)):
        O.step()
        highest = max(highest, abs(O.bodies[block].state.pos[2] - 0.1), abs(dem.angle(block)))
    assert O.bodies[block].state.pos[0] == pytest.approx(-0.4 + 4 / (2 * 0.3 * 9.81), abs=2e-3)
    assert highest < 1e-6 and O.bodies[block].state.vel.norm() < 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("sunk", (0, 1e-7, 1e-5))
def test_a_wedge_stops_at_a_step(sunk, model, method):
    """Its toe slides along a slab that is one body with the step before it, with 0.5 m/s on friction that would carry it 0.13 m. It stops at the step, 0.05 m away, however
    it has sunk into the slab at first."""
    material = stone(0, noSlip=False, frictionAngle=math.atan(0.1))
    below = dem.union([cuboid((-1, 0.4), (-0.3, 0), (-0.5, 0.5)), cuboid((0, 0.4), (0, 0.4), (-0.5, 0.5))], material)
    O.bodies[below].dynamic = False
    section = ((-0.65, 0), (-0.05, 0), (-0.15, 0.3), (-0.55, 0.3))
    wedge = dem.convex([(x, y, z - sunk) for x, z in section for y in (-0.3, 0.3)], material)
    O.bodies[wedge].state.vel = Vector3(0.5, 0, 0)
    move(method=method, model=model)
    farthest = -1
    for _ in range(count(0.5)):
        O.step()
        toe = dem.geometry(wedge).vertices[:, 0].max()
        farthest = max(farthest, toe)
    assert -1e-6 < farthest < 1e-5 and toe > -5e-3
    assert O.bodies[wedge].state.vel.norm() < 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_a_corner_slides_down_into_a_notch(model, method):
    """Between a floor that rises to the notch and a wall that leans away from it, without friction: the corner of a block that comes down along the wall with 1 m/s
    lands on the floor, and stays above it."""
    material = stone(0, noSlip=False, frictionAngle=0.0)
    floor = [(-1, -0.3), (0, 0), (0.7, -0.165), (0.7, -0.5), (-1, -0.5)]
    wall = [(0, 0), (0.7, -0.165), (0.7, 0.5), (0.25, 0.5)]
    below = dem.union([np.array([(x, y, z) for x, z in section for y in (-0.3, 0.3)]) for section in (floor, wall)], material)
    O.bodies[below].dynamic = False
    down = Vector3(-1, 0, -2).normalized()
    turn = Quaternion(Vector3.UnitY, 0.25)
    block = dem.block((0.4, 0.4, 0.4), material, center=-0.05 * down + Vector3(-1e-6, 0, 0) - turn * Vector3(0.2, 0, -0.2), orientation=turn)
    O.bodies[block].state.vel = down
    move(method=method, model=model)
    lowest = []
    for _ in range(count(0.15)):
        O.step()
        corners = dem.geometry(block).vertices
        heights = (corners @ (-0.3, 0, 1)) / math.hypot(0.3, 1)
        lowest.append(heights[(corners[:, 0] < 0) & (corners[:, 0] > -1)].min())
    assert -1e-6 < min(lowest) < 1e-6, min(lowest)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("mirror", (False, True))
@pytest.mark.parametrize("side", (-1, 1))
def test_an_l_tips_at_its_critical_angle(side, mirror, method):
    """It comes back from 1 % below atan(arm / height) of its centre over the edge, and falls from 1 % above: other angles to the left and to the right."""
    arm = CENTER[0] if (side < 0) != mirror else 1 - CENTER[0]
    critical = math.atan2(arm, CENTER[1])
    for share, falls in ((0.99, False), (1.01, True)):
        O.reset()
        material = stone(0.5)
        base = dem.base((9, 9, 0.2), material)
        id = an_l(material, mirror, on=base)
        resting = Quaternion(O.bodies[id].state.ori)
        edge = dem.geometry(id).vertices
        pivot = Vector3(edge[:, 0].max() if side > 0 else edge[:, 0].min(), 0, 0)
        turn = Quaternion(Vector3.UnitY, side * share * critical)
        state = O.bodies[id].state
        state.ori, state.pos = turn * resting, pivot + turn * (state.pos - pivot)
        move(method=method)
        assert O.engines[-1].choice().startswith("planar")
        O.run(count(1.2), True)
        now = 2 * math.asin((state.ori * resting.conjugate())[1]) * side
        assert (now > 1.2 * critical) if falls else (now < share * critical - 0.01), (share, now, critical)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_an_l_slides_at_its_friction(model, method):
    """On a slope of tan = 1.05 mu with g (sin - mu cos), whatever the seam carries; on one of 0.95 mu it stays."""
    mu = 0.3
    for share in (0.95, 1.05):
        O.reset()
        material = stone(0.5, noSlip=False, frictionAngle=math.atan(mu))
        slope = math.atan(share * mu)
        id = an_l(material, on=inclined_base(material, slope))
        start = Vector3(O.bodies[id].state.pos)
        move(method=method, model=model)
        O.run(count(1.0), True)
        way = (O.bodies[id].state.pos - start).norm()
        right = max(0, 9.81 * (math.sin(slope) - mu * math.cos(slope))) * O.time**2 / 2
        assert way == pytest.approx(right, abs=1e-6 if share < 1 else 0, rel=1e-2)


def a_u(material, base):
    """Two legs 0.2 m wide under a beam 1 m long and 0.2 m high; a block beside the middle makes the legs carry different shares."""
    parts = [cuboid((0, 1), (0.5, 0.7)), cuboid((0, 0.2), (0, 0.5)), cuboid((0.8, 1), (0, 0.5)), cuboid((0.1, 0.4), (0.7, 1.0))]
    return dem.union(parts, material, on=base)


@pytest.mark.parametrize("method", METHODS)
def test_a_u_stands_on_two_legs(method):
    """The centre of pressure is below the centre of mass, between the legs, where nothing touches; both legs carry, and both feet are one joint of its pivots."""
    material = stone(0.7)
    base = dem.base((9, 9, 0.2), material)
    id = a_u(material, base)
    center, weight = dem.geometry(id).center, O.bodies[id].state.mass * 9.81
    move(method=method, model="planar")
    O.run(20, True)
    (force,) = dem.joint_forces()
    assert abs(force["force"][2]) == pytest.approx(weight, rel=1e-6) and force["point"][0] == pytest.approx(center[0], abs=1e-5)
    (contact,) = [i for i in O.interactions if i.isReal]
    places, loads = np.array([tuple(p) for p in contact.geom.points])[:, 0], np.array(contact.phys.normalForces)
    edge = dem.geometry(id).vertices[:, 0].min()
    assert sorted(set((places - edge).round(9))) == pytest.approx([0, 0.2, 0.8, 1.0])
    assert loads[places < edge + 0.5].sum() > 0.05 * weight and loads[places > edge + 0.5].sum() > 0.05 * weight
    assert abs(dem.angle(id)) < 1e-8


def test_a_u_rocks_from_leg_to_leg():
    """Its landing is one impact of one joint, about the outer edge of the other leg: C natural = (k^2 + r_old . r_new) / (k^2 + r_new^2)."""
    material = stone()
    base = dem.base((9, 9, 0.2), material)
    parts = [cuboid((0, 1), (0.5, 0.7)), cuboid((0, 0.2), (0, 0.5)), cuboid((0.8, 1), (0, 0.5))]
    id = dem.union(parts, material, on=base)
    found = dem.geometry(id)
    gyration2, height = found.inertia[1, 1] / O.bodies[id].state.mass, found.center[2]
    dem.tilt(id, 0.05)
    move(model="planar")
    while not len(dem.impacts()):
        O.step()
    impact = dem.impacts()[0]
    right = (gyration2 - 0.25 + height**2) / (gyration2 + 0.25 + height**2)
    assert impact["restitution"] == pytest.approx(right, rel=1e-6) and impact["switched"]


def dovetail(material):
    """A fixed socket of three parts, open along y, and the key in it, 0.02 m clear of the jaws, which lean over it by 0.1 m each."""
    floor = cuboid((-0.6, 0.6), (-0.2, 0), (-0.5, 0.5))
    jaw = [(0.42, 0), (0.6, 0), (0.6, 0.3), (0.32, 0.3)]
    jaws = [np.array([(side * x, y, z) for x, z in jaw for y in (-0.5, 0.5)]) for side in (-1, 1)]
    socket = dem.union([floor, *jaws], material)
    O.bodies[socket].dynamic = False
    tail = np.array([(x, y, z) for x, z in ((-0.4, 0), (0.4, 0), (0.3, 0.3), (-0.3, 0.3)) for y in (-0.2, 0.2)])
    return socket, dem.union([tail, cuboid((-0.2, 0.2), (0.3, 0.8), (-0.2, 0.2))], material)


def test_a_dovetail_holds_against_a_pull():
    """Pulled up with three times its weight the key rises until its flanks meet the jaws, and stays there: without friction between flanks of 1 : 3 its wedges
    would carry any force. Along y it comes out under its own push, less friction."""
    material = stone(0.0, noSlip=False, frictionAngle=math.atan(0.2))
    socket, key = dovetail(material)
    assert dem.check_blocks(floating=False) == []
    weight = O.bodies[key].state.mass * 9.81
    start = Vector3(O.bodies[key].state.pos)
    move(model="spatial")
    O.forces.setPermF(key, (0, 0, 3 * weight))
    O.run(count(1.0), True)
    # Clear by 0.02 m along x: flanks rise by 0.02 / (1/3) until they meet.
    rise = O.bodies[key].state.pos[2] - start[2]
    assert rise == pytest.approx(0.06, abs=1e-4) and O.bodies[key].state.vel.norm() < 1e-5
    held = Vector3(O.bodies[key].state.pos)
    O.forces.setPermF(key, (0, 4 * weight, 3 * weight))
    began = O.time
    O.run(count(0.12), True)
    # While it slides, friction is along y, and the normals of the flanks, sqrt(10) times as long as high, carry the 2 W of the pull.
    right = 9.81 * (4 - 0.2 * 2 * math.sqrt(10)) * (O.time - began) ** 2 / 2
    assert O.bodies[key].state.pos[1] - held[1] == pytest.approx(right, rel=0.01) and abs(O.bodies[key].state.pos[2] - held[2]) < 1e-4


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_mirrored(model, method):
    """A leaning L with a block on its foot, and the mirror image: the same motion to what the order of the parts leaves."""
    found = []
    for mirror in (False, True):
        O.reset()
        material = stone(0.6, noSlip=False, frictionAngle=0.5)
        base = dem.base((9, 9, 0.2), material)
        sign = -1 if mirror else 1
        id = an_l(material, mirror, on=base)
        foot = dem.geometry(id).vertices[:, 0]
        right = foot.max() if not mirror else foot.min()
        dem.block((0.2, 0.2, 0.2), material, center=(right - sign * 0.2, 0, 0.3))
        O.bodies[id].state.vel = Vector3(sign * 0.5, 0, 0)
        move(method=method, model=model)
        O.run(count(0.5), True)
        found.append([[sign * s.pos[0], s.pos[2], sign * s.vel[0]] for b in O.bodies for s in (b.state,)])
    assert np.abs(np.subtract(*found)).max() < (1e-9 if method == "localised" else 1e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
def test_saved_and_loaded_with_the_same_bits(model, method, tmp_path):
    def numbers():
        return np.array([[*s.pos, *s.ori, *s.vel, *s.angVel] for b in O.bodies for s in (b.state,)]).view(np.int64)

    material = stone(0.6, noSlip=False, frictionAngle=0.4)
    base = dem.base((9, 9, 0.2), material)
    id = an_l(material, on=base)
    dem.tilt(id, 0.1)
    move(method=method, model=model)
    O.run(50, True)
    O.save(str(tmp_path / "half.xml"))
    O.run(50, True)
    straight = numbers()
    O.reset()
    O.load(str(tmp_path / "half.xml"))
    assert O.bodies[id].shape.parts == 2 and len(O.bodies[id].shape.firstVertices) == 2
    O.run(50, True)
    assert np.array_equal(numbers(), straight)


def test_tables_checks_and_results(tmp_path):
    """What is around a union knows its parts: overlaps and supports, tables, joints, pictures, ParaView, npz, reports."""
    material = stone(0.6, label="stone")
    base = dem.base((9, 9, 0.2), material)
    id = an_l(material, on=base)
    corner = dem.geometry(id).vertices
    left, top = corner[:, 0].min(), 0.2
    block = dem.block((0.3, 0.3, 0.3), material, center=(left + 0.3 + 0.16, 0, top + 0.15))  # in the notch, inside the hull of the whole
    assert dem.check_blocks() == []
    with pytest.raises(ValueError, match=f"overlapping blocks: {id} and {block} "):
        O.bodies[block].state.pos -= Vector3(0.1, 0, 0)
        dem.check_blocks()
    O.bodies[block].state.pos += Vector3(0.1, 0, 0)
    dem.save_blocks(str(tmp_path / "blocks.json"))
    again = dem.blocks_from_table(str(tmp_path / "blocks.json"), material)
    assert O.bodies[again[0]].shape.firstVertices == O.bodies[id].shape.firstVertices and O.bodies[again[0]].shape.vertices == O.bodies[id].shape.vertices
    assert O.bodies[again[0]].state.inertia == O.bodies[id].state.inertia and O.bodies[again[0]].state.pos == O.bodies[id].state.pos
    for one in again:
        O.bodies.erase(one)
    dem.save_blocks(str(tmp_path / "blocks.obj"))  # a mesh has no unions: the parts are blocks
    meshed = dem.blocks_from_mesh(str(tmp_path / "blocks.obj"), material)
    assert len(meshed) == 3 and sum(dem.geometry(k).is_box for k in meshed) == 3
    for one in meshed:
        O.bodies.erase(one)
    recorder = dem.WallRecorder(iterPeriod=5)
    O.engines = rigid_engines() + [recorder]
    O.run(40, True)
    history = dem.wall_history(recorder)
    assert len(history.shapes.part_start) == 1 + 4 and len(history.shapes.loops[1]) == 12
    table = results.joints(history)
    assert {(r["id1"], r["id2"]) for r in table} == {(base, id), (id, block)} and table["opening"].max() < 1e-6
    history.save(str(tmp_path / "h.npz"))
    assert results.WallHistory.load(str(tmp_path / "h.npz")).shapes.part_start.tolist() == history.shapes.part_start.tolist()
    results.write_paraview(history, str(tmp_path / "p.pvd"))
    results.report(history, str(tmp_path / "r.html"))
    results.draw(history, path=str(tmp_path / "p.png"))


def test_pieces_of_a_concave_mesh_are_joined(tmp_path):
    """An L that another program has turned, cut and written in single precision."""
    turn = np.array(Quaternion(Vector3(0.3, 0.5, 1).normalized(), 0.7).toRotationMatrix()).reshape(3, 3)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    write_obj(tmp_path / "pieces.obj", [(name, np.float32(cuboid(*one) @ turn.T), faces) for name, one in (("foot", FOOT), ("stem", STEM))])
    id = dem.union(dem.blocks_from_mesh(tmp_path / "pieces.obj", stone()))
    assert dem.geometry(id).volume == pytest.approx(DEPTH * AREAS.sum(), rel=1e-6) and O.bodies[id].shape.parts == 2


def test_compliant_joints_refuse_unions():
    material = stone(0.5, normalStiffness=1e9, shearStiffness=1e9)
    base = dem.base((9, 9, 0.2), material)
    id = an_l(material, on=base)
    with pytest.raises(Exception, match=rf"O.bodies\[{id}\] is a union of convex parts, which compliant joints do not take"):
        O.engines = rigid_engines(model="compliant")
        O.run(1, True)


def test_a_union_across_half_the_depth_is_spatial():
    """Parts of different depths are no prism: the scene is spatial, and says why."""
    material = stone()
    base = dem.base((9, 9, 0.2), material)
    id = dem.union([cuboid((0, 1), (0, 0.2)), cuboid((0, 0.3), (0.2, 1), (-0.1, 0.1))], material, on=base)
    assert f"body {id} is no right prism across the plane" in said_by(lambda: dem.engines())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("below", ("a union", "two blocks"))
def test_a_block_rocks_on_a_seam(below, model, method):
    """A block whose left edge is on the seam of a fixed union, or exactly above a head joint, rocks as on one solid, with friction that holds it, although
    the support under its pivot changes when it slips across: the edges at the seam are none of the solid's and give no reaction of their own. Bounds: two
    blocks are two pairs, whose points close within mergedClosing of each other, 1e-6 of 0.25 m; the tolerance of method='wall'."""
    seam, bound, found = -0.25, {"wall": 5e-5, "localised": 1e-9 if below == "a union" else 2.5e-7}[method], []
    for whole in (True, False):
        O.reset()
        material = stone(0.8, noSlip=False, frictionAngle=0.5)
        y = (-1, 1)
        parts = [cuboid((-3, 3), (-0.5, 0), y)] if whole else [cuboid((-3, seam), (-0.5, 0), y), cuboid((seam, 3), (-0.5, 0), y)]
        for id in [dem.union(parts, material)] if below == "a union" else [dem.convex(part, material) for part in parts]:
            O.bodies[id].dynamic = False
        block = dem.block((0.5, 0.4, 1.5), material, center=(0, 0, 0.75))
        dem.tilt(block, 0.15)
        move(method=method, model=model, tolerance=1e-6 if method == "wall" else None)
        found.append([])
        for _ in range(40):
            O.run(count(0.05), True)
            found[-1] += [dem.angle(block), O.bodies[block].state.pos[0]]
    assert np.ptp(found[0]) > 0.1
    assert np.abs(np.subtract(*found)).max() < bound


@pytest.mark.parametrize("method", METHODS)
def test_a_block_slides_askew_over_a_pavement(method):
    """A turned block slides askew over nine flush parts, across their corners: v^2 / (2 mu g) along its way, as on one solid."""
    material = stone(0.5, noSlip=False, frictionAngle=math.atan(0.3))
    ends = [-1, -0.1, 0.6, 2]
    parts = [cuboid(x, (-0.3, 0), y) for x in zip(ends, ends[1:]) for y in zip(ends, ends[1:])]
    below = dem.union(parts, material)
    O.bodies[below].dynamic = False
    block = dem.block((0.3, 0.2, 0.2), material, center=(-0.4, -0.4, 0.1), orientation=Quaternion(Vector3.UnitZ, 0.3))
    O.bodies[block].state.vel = Vector3(2 * math.cos(0.7), 2 * math.sin(0.7), 0)
    move(method=method, model="spatial")
    highest = 0
    for _ in range(count(1.0)):
        O.step()
        highest = max(highest, abs(O.bodies[block].state.pos[2] - 0.1))
    way = np.array(tuple(O.bodies[block].state.pos)) - (-0.4, -0.4, 0.1)
    # Its weight is ahead of its middle while it slides, and the pressure under four corners is not even: the way is not quite straight.
    assert np.hypot(*way[:2]) == pytest.approx(4 / (2 * 0.3 * 9.81), rel=2e-2) and highest < 1e-6


def where_the_pivot_pulls(arm, height, gyration2, slope):
    """Turn from rest, rad, at which the pivot of a block on a slope would have to pull, by hand: it falls about an edge at the distance r from its centre,
    which is arm (down the slope) and height away along the face. With phi between the vertical and the line from the edge to the centre, e and t its unit
    vectors, and c = r^2 / (r^2 + k^2), the force of the pivot is m g (z + c sin(phi) t - 2 c (cos(phi_0) - cos(phi)) e)."""
    share, start = (arm**2 + height**2) / (arm**2 + height**2 + gyration2), slope - math.atan2(arm, height)
    phi = np.linspace(start, 2, 200001)
    along, across = np.array([np.sin(phi), np.cos(phi)]), np.array([np.cos(phi), -np.sin(phi)])
    force = share * np.sin(phi) * across - 2 * share * (math.cos(start) - np.cos(phi)) * along + np.array([[0], [1]])
    return phi[np.argmax(np.array([math.sin(slope), math.cos(slope)]) @ force < 0)] - start


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("whole", (False, True))
def test_a_pivot_without_slip_that_would_pull_is_told(whole, model, method):
    """An L, and a box, fall down a slope about an edge that never slips. From where the edge would have to pull no motion obeys the laws: if it is let go it
    goes into the base. The run says so in that step, names noSlip, and with friction it has nothing to say. The turn in two steps is the bound. Few blocks have
    localised impacts with method='wall' too."""
    arm, height, gyration2 = (0.3, 1.0, (0.3**2 + 1.0) / 3) if whole else (*CENTER, GYRATION2)
    slope = 1.02 * math.atan2(arm, height)
    for slips in (False, True):
        O.reset()
        material = stone(0, frictionAngle=1.2, noSlip=not slips)
        base = inclined_base(material, slope)
        id = dem.block((0.6, DEPTH, 2.0), material, on=base) if whole else an_l(material, mirror=True, on=base)
        state = O.bodies[id].state
        resting = Quaternion(state.ori)
        move(model=model, method=method)
        O.engines[-1].wallsOnly = False
        seconds = 4 if whole else 2
        if slips:
            O.run(count(seconds), True)
            assert O.engines[-1].failures == 0
            continue
        said = refuses(lambda: O.run(count(seconds), True), "contact laws are missed", "noSlip", kind=RuntimeError)
        turned = 2 * math.asin((state.ori * resting.conjugate())[1])
        assert turned == pytest.approx(where_the_pivot_pulls(arm, height, gyration2, slope), abs=2 * O.dt * state.angVel[1]), said
