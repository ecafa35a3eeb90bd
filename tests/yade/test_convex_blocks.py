"""Convex blocks of a scene: places, mass, faces, round trips, and what is refused."""

import math
import re

import numpy as np
import pytest
from masonry import dem, results
from masonry.dem import mechanism
from masonry.dem.checks import check_recorder
from rocking_scene import refuses, said_by, stone
from scipy.spatial import ConvexHull
from yade import Bo1_Box_Aabb, InsertionSortCollider, O, Quaternion, Vector3

TRAPEZOID = [(0, 0), (0.8, 0), (0.4, 2), (0, 2)]


def bottom(id):
    return dem.geometry(id).vertices[:, 2].min()


def inertia_of(corners, density):
    """(3, 3) about the centre of mass, from the tetrahedra of scipy's hull with one corner at the middle."""
    hull, middle = ConvexHull(corners), corners.mean(axis=0)
    sums, volume = np.zeros((3, 3)), 0
    centroid = np.zeros(3)
    for a, b, c in corners[hull.simplices] - middle:
        v = abs(np.dot(a, np.cross(b, c))) / 6
        total = a + b + c
        volume, centroid = volume + v, centroid + v * total / 4
        sums += v / 20 * (np.outer(a, a) + np.outer(b, b) + np.outer(c, c) + np.outer(total, total))
    centroid /= volume
    second = density * (sums - volume * np.outer(centroid, centroid))
    return np.trace(second) * np.eye(3) - second


def test_the_right_trapezoid_of_the_tables():
    """Centre (.311111, .888889), k^2 = .3575309 about y; its prism is along y, and its own y axis stays y."""
    id = dem.prism(TRAPEZOID, 1.0, stone(), axis="y")
    found, state = dem.geometry(id), O.bodies[id].state
    assert found.center == pytest.approx([0.311111, 0, 0.888889], abs=1e-6) and found.volume == pytest.approx(1.2)
    assert found.inertia[1, 1] / state.mass == pytest.approx(0.3575309, abs=1e-7)
    assert (state.ori * Vector3.UnitY - Vector3.UnitY).norm() < 1e-12 and dem.angle(id) == 0
    assert sorted(map(len, found.faces)) == [4] * 6 and not found.is_box


@pytest.mark.parametrize("seed", range(5))
def test_mass_and_inertia_of_random_hulls(seed):
    """By the tetrahedra of scipy's hull; the corners come back where they were given."""
    r = np.random.default_rng(seed)
    points = r.normal(size=(4 + 4 * seed, 3))
    points = points[ConvexHull(points).vertices] + [3, -2, 1]
    found = dem.geometry(dem.convex(points, stone()))
    hull = ConvexHull(points)
    assert found.volume == pytest.approx(hull.volume, rel=1e-12)
    assert np.allclose(found.inertia, inertia_of(points, 2000), rtol=0, atol=1e-11 * np.abs(found.inertia).max())
    near = np.linalg.norm(found.vertices[:, None] - points[None], axis=2).min(axis=0)
    assert near.max() < 1e-14 * 10 and len(found.vertices) == len(points)
    for loop in found.faces:
        a, b, c = found.vertices[loop[:3]]
        assert np.cross(b - a, c - a) @ (found.vertices - a).T.mean(axis=1) < 0  # counter-clockwise from outside


def test_a_box_of_points_is_a_box():
    points = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    turn = Quaternion(Vector3(0.3, 0.2, 1).normalized(), 0.7)
    for id in (dem.convex(points, stone()), dem.convex(points, stone(), center=(5, 0, 0), orientation=turn)):
        assert dem.geometry(id).is_box and sorted(O.bodies[id].state.inertia) == pytest.approx([1000 * k for k in (5, 10, 13)])
    assert (O.bodies[id].state.ori.conjugate() * turn).norm() == pytest.approx(1) and O.bodies[id].state.pos == Vector3(5, 0, 0)
    box = dem.block((1, 1, 1), stone(), center=(9, 0, 0))
    assert dem.geometry(box).is_box and dem.geometry(box).volume == pytest.approx(1)


def test_blocks_stand_where_they_are_put():
    """The centre of mass is above the middle of the upper face, also on a convex block and on a base that is turned about z."""
    base = dem.base((4, 4, 0.2), stone())
    O.bodies[base].state.ori = Quaternion(Vector3.UnitZ, 0.3)
    first = dem.drum(0.5, 0.8, stone(), sides=12, on=base)
    second = dem.wedge((0.6, 0.5, 0.4), stone(), top=0.2, shift=0.1, on=first)
    third = dem.block((0.2, 0.2, 0.2), stone(), on=first)
    assert [bottom(k) for k in (first, second, third)] == pytest.approx([0, 0.8, 0.8], abs=1e-15)
    for id in (first, second, third):
        assert tuple(O.bodies[id].state.pos)[:2] == pytest.approx([0, 0], abs=1e-15)
    assert "critical angle" in said_by(dem.drum, 0.5, 0.8, stone(), center=(9, 9, 9))


def test_dem_angle_counts_from_the_turn_about_z():
    lean = Quaternion(Vector3.UnitZ, 0.4) * Quaternion(Vector3.UnitY, 0.1)
    id = dem.prism(TRAPEZOID, 1.0, stone(), axis="y", orientation=lean)
    assert dem.angle(id) == pytest.approx(0.1)


def test_arch_on_one_body_and_on_two():
    """Its joints are shared in the world, too: the corners of neighbours coincide to round-off."""
    left, right = dem.base((1, 1, 0.2), stone()), dem.base((1, 1, 0.2), stone())
    O.bodies[left].state.pos, O.bodies[right].state.pos = Vector3(-1, 3, 0.9), Vector3(1.4, 3, 0.9)
    ids = dem.arch(2, 0.4, 0.2, 7, 0.5, stone(), on=(left, right), springers=True)
    assert len(ids) == 9 and bottom(ids[0]) == pytest.approx(1.0) and bottom(ids[8]) == pytest.approx(1.0)
    ends = [dem.geometry(k).center for k in (ids[0], ids[8])]
    assert (ends[0] + ends[1])[:2] / 2 == pytest.approx([0.2, 3]) and ends[1][0] > ends[0][0]
    for a, b in zip(ids[:-1], ids[1:]):
        gap = np.linalg.norm(dem.geometry(a).vertices[:, None] - dem.geometry(b).vertices[None], axis=2)
        assert (gap.min(axis=1) < 4e-16).sum() == 4
    single = dem.base((9, 9, 0.2), stone())
    assert bottom(dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=single, at=(1, 1))[0]) == pytest.approx(0, abs=1e-15)


def test_structures():
    base = dem.base((20, 20, 0.2), stone())
    assert len(dem.barrel_vault(4, 2, 0.3, 7, 6, 5, stone(), on=base)) == 38
    assert len(dem.dome(2, 0.2, 4, 10, stone(), on=base)) == 41
    assert len(dem.flat_arch(2, 0.4, 5, 2, 0.3, stone(), springers=True)) == 7
    assert len(dem.column(3, [0.5, 0.45, 0.4, 0.4], 0.5, stone(), on=base, at=(3, 3))) == 3
    said = said_by(dem.rubble_wall, 2, 1, 0.4, 0.4, stone(), on=base, seed=7)
    assert "seed=7" in said


def test_saved_and_loaded_with_the_same_bits(tmp_path):
    base = dem.base((9, 9, 0.2), stone())
    dem.rubble_wall(2, 1, 0.4, 0.4, stone(), on=base, seed=7)
    dem.arch(2, 0.4, 0.2, 7, 0.5, stone())

    def scene():
        bodies = [b for b in O.bodies if isinstance(b.shape, dem.ConvexBlock)]
        numbers = [[*v, *s.pos, *s.ori, *s.refOri, *s.inertia, s.mass] for b in bodies for s in (b.state,) for v in b.shape.vertices]
        return np.array(numbers).view(np.int64), [b.shape.faces for b in bodies]

    was = scene()
    for name in ("a.xml", "b.yade", "c.xml.bz2"):
        O.save(str(tmp_path / name))
        O.reset()
        O.load(str(tmp_path / name))
        numbers, faces = scene()
        assert np.array_equal(numbers, was[0]) and faces == was[1]
    O.saveTmp()
    O.reset()
    O.loadTmp()
    numbers, faces = scene()
    assert np.array_equal(numbers, was[0]) and faces == was[1]


def test_shape_serves_scripts_that_loop_over_polyhedra():
    shape = O.bodies[dem.wedge((1, 1, 1), stone())].shape
    assert shape.v == shape.vertices and shape.GetSurfaces() == shape.faces and len(shape.faces) == 5
    edges = {frozenset(pair) for loop in shape.GetSurfaces() for pair in zip(loop, loop[1:] + loop[:1])}
    assert len(shape.v) - len(edges) + len(shape.faces) == 2


def test_bounds_of_the_collider():
    """Without a sweep length the bound is that of the corners."""
    ids = [dem.convex(np.random.default_rng(k).normal(size=(4, 3)) + [5 * k, 0, 0], stone()) for k in range(3)]
    ids.append(dem.block((1, 2, 3), stone(), center=(20, 0, 0)))
    O.engines = [InsertionSortCollider([dem.Bo1_ConvexBlock_Aabb(), Bo1_Box_Aabb()], verletDist=0)]
    O.step()
    for id in ids:
        corners, bound = dem.geometry(id).vertices, O.bodies[id].bound
        assert np.allclose(corners.min(axis=0), bound.min, rtol=0, atol=1e-14) and np.allclose(corners.max(axis=0), bound.max, rtol=0, atol=1e-14)


def test_meshes_round_trip(tmp_path):
    """Blocks that are written as a mesh are the same blocks, in the world, to the bit of their coordinates."""
    ids = dem.arch(2, 0.4, 0.2, 7, 0.5, stone())
    dem.save_blocks(tmp_path / "arch.obj")
    said = said_by(dem.blocks_from_mesh, tmp_path / "arch.obj", stone())
    assert "7 blocks with 42 faces" in said
    for a, b in zip(ids, range(7, 14)):
        one, other = dem.geometry(a), dem.geometry(b)
        assert np.allclose(one.vertices, other.vertices, rtol=0, atol=1e-15) and one.faces == other.faces


def test_tables_round_trip_bit_by_bit(tmp_path):
    material = stone(label="stone")
    base = dem.base((9, 9, 0.2), material)
    ids = dem.rubble_wall(2, 1, 0.4, 0.4, material, on=base, seed=7) + [dem.block((1, 2, 3), material, center=(5, 5, 5))]
    ids.append(dem.prism(TRAPEZOID, 1.0, material, axis="y", orientation=Quaternion(Vector3.UnitZ, 0.4) * Quaternion(Vector3.UnitY, 0.1)))
    dem.save_blocks(tmp_path / "a.json")
    again = dem.blocks_from_table(tmp_path / "a.json", material)
    assert len(again) == len(ids)

    def numbers(id):
        body = O.bodies[id]
        shape = getattr(body.shape, "vertices", None) or [body.shape.extents]
        state = body.state
        return np.array([*(x for v in shape for x in v), *state.pos, *state.ori, *state.refOri, *state.inertia, state.mass]).view(np.int64)

    for a, b in zip(ids, again):
        assert np.array_equal(numbers(a), numbers(b)) and type(O.bodies[a].shape) is type(O.bodies[b].shape)


def test_from_yade():
    """A Polyhedra of YADE, which has turned to its own axes: the same corners in the world."""
    from yade import polyhedra_utils

    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1.2), (0.9, 1, 1)]
    body = polyhedra_utils.polyhedra(stone(), v=points)
    body.state.pos = Vector3(5, 6, 7)
    body.state.vel, body.state.angVel = Vector3(1, 2, 3), Vector3(4, 5, 6)
    wanted = np.array([tuple(body.state.pos + body.state.ori * v) for v in body.shape.v])
    id = dem.from_yade(body, stone())
    found = dem.geometry(id).vertices
    assert np.linalg.norm(found[:, None] - wanted[None], axis=2).min(axis=0).max() < 1e-12 and len(found) == 7
    assert O.bodies[id].state.vel == Vector3(1, 2, 3) and O.bodies[id].state.angVel == Vector3(4, 5, 6)


CUBE = np.array([(x, y, z) for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])


def test_bad_blocks_are_refused():
    base = dem.base((9, 9, 0.2), stone())
    refuses(lambda: dem.convex(CUBE[:4], stone()), "vertices: thickness of the vertices = 0: m, must be above 1e-5 of their extent: they have no volume")
    refuses(lambda: dem.convex(CUBE[:3], stone()), "vertices: number of vertices = 3: must be 4 or more")
    refuses(lambda: dem.convex([*CUBE, (0.5, 0.5, 0.9)], stone()), "vertices: vertex 8: depth inside the convex hull = 0.1: m: leave it out, or make two blocks")
    refuses(lambda: dem.convex(CUBE * 1e-6, stone()), "vertices: extent = 1e-06: must be from 0.001 to 100, in m")
    refuses(lambda: dem.convex(CUBE * 1e3, stone()), "vertices: extent = 1000: must be from 0.001 to 100, in m")
    refuses(lambda: dem.convex(CUBE[:, :2], stone()), "must be points of three numbers, in m")
    refuses(lambda: dem.convex(np.where(CUBE == 1, math.nan, CUBE), stone()), "vertices: vertex 1, z = nan: must be finite")
    bent = CUBE.copy()
    bent[7, 2] = 0.9
    loops = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    refuses(lambda: dem.convex(bent, stone(), faces=loops), "vertices: face 5: distance of a vertex from the plane of the others = 0.0")
    assert dem.convex(CUBE, stone(), faces=loops) == 1
    refuses(lambda: dem.convex(CUBE, stone(), faces=7), "faces = 7: must be lists of numbers of vertices")
    refuses(lambda: dem.convex(CUBE, stone(), faces=[[0, 1, 0.5]]), "faces[0] = [0, 1, 0.5]: must be a list of numbers of vertices")
    refuses(lambda: dem.convex(CUBE, stone(), faces=[[0, 1, 8]]), "face 0: vertex = 8: there is no such vertex")
    refuses(lambda: dem.convex(CUBE, stone(), faces=loops[1:]), "area of the faces = 5: m^2, must be that of the convex hull: a face is missing or given twice")
    refuses(lambda: dem.convex(CUBE, stone(), on=base, center=(0, 0, 0)), "on = 0, center = (0, 0, 0): give one of the two, or none")
    refuses(lambda: dem.convex(CUBE, stone(), on=base, orientation=Quaternion(Vector3.UnitY, 0.1)), "the block has no face that looks down in this orientation")
    refuses(lambda: dem.convex(CUBE, stone(), orientation=(1, 0, 0, 0)), "orientation = (1, 0, 0, 0): must be a Quaternion of length 1")
    refuses(lambda: dem.convex(CUBE, "stone"), "material = 'stone': must be a BlockMat")
    refuses(lambda: dem.arch(2, 0.4, 0.2, 7, 0.5, stone(), on=base), "the blocks would stand on edges, because the lowest joints are not level")
    for at in ("ab", None, 5, ("a", 0)):
        refuses(lambda: dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=base, at=at), "at = ", "must be two finite numbers, in m")
    refuses(lambda: dem.arch(12, 6, 0.2, 7, 0.5, stone(), on=base), "2 blocks of the bottom course have their centres off it")
    refuses(lambda: dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=(0, 0)), "on = (0, 0): their upper faces must be level and beside each other")
    refuses(lambda: dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=(0, 1, 2)), "on = (0, 1, 2): must be the id of one body, or the ids of two")
    top = dem.wedge((1, 1, 1), stone(), center=(20, 0, 0))
    refuses(lambda: dem.block((1, 1, 1), stone(), on=top), f"on = {top}: that ConvexBlock has no level upper face")
    refuses(lambda: dem.from_yade(base, stone()), "body: its shape is a Box: must be a body, or the id of one, whose shape is a Polyhedra")
    refuses(lambda: dem.from_yade(999, stone()), "body: there is no such body")
    assert len(O.bodies) == 3


@pytest.mark.parametrize("method", ("localised", "wall"))
@pytest.mark.parametrize("sides", (6, 24))
def test_rigid_drum_stands(sides, method):
    """It keeps its place to the tolerance of the solver, and its base bears its weight."""
    base = dem.base((3, 3, 0.2), stone())
    id = dem.drum(0.5, 0.8, stone(), sides=sides, on=base)
    O.engines = dem.engines(model="spatial", method=method)
    O.run(20, True)
    state = O.bodies[id].state
    assert (state.pos - Vector3(0, 0, 0.4)).norm() < 1e-9 and state.vel.norm() < 1e-9
    weight = 9.81 * state.mass
    assert np.allclose(dem.reactions(base)["force"].sum(axis=0), [0, 0, weight], rtol=0, atol=1e-9 * weight)


def test_recorded_blocks_have_their_shapes(tmp_path):
    """An arch on its base is recorded without an engine of the joints: the corners of the history are those of dem.geometry, also after loading and after a
    block has been erased."""
    base = dem.base((9, 9, 0.2), stone())
    ids = dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=base)
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines, O.dt = [recorder], 1e-3
    O.step()
    O.save(str(tmp_path / "a.xml"))
    O.reset()
    O.load(str(tmp_path / "a.xml"))
    wanted = {id: dem.geometry(id) for id in [base, *ids]}
    O.bodies.erase(ids[3])
    O.step()
    h = dem.wall_history(O.engines[0])
    assert h.ids.tolist() == [base, *ids] and h.convex.tolist() == [False] + [True] * 7
    for row, id in enumerate(h.ids.tolist()):
        count = len(wanted[id].vertices)
        assert np.allclose(h.corners(0)[row, :count], wanted[id].vertices, rtol=0, atol=1e-14) and h.shapes.loops[row] == wanted[id].faces
    assert h.bases.tolist() == [0] * 8 and results.fallen(h)[-1].tolist() == [False] * 4 + [True] + [False] * 3


def test_checks_of_blocks_know_convex_ones():
    """An arch on its base neither overlaps nor floats; a voussoir that is moved does. Two arches 0.5 m apart are two structures, 1 cm apart one."""
    base = dem.base((9, 9, 0.2), stone())
    ids = dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=base)
    assert dem.check_blocks() == [] and dem.structures() == [ids]
    box = dem.block((0.5, 0.5, 0.5), stone(), on=base)
    assert dem.check_blocks() == [] and dem.structures() == [ids, [box]]
    other = dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=base, at=(0, 1))
    assert dem.structures() == [ids, [box], other]
    for id in other:
        O.bodies[id].state.pos -= Vector3(0, 0.49, 0)
    assert dem.structures() == [ids + other, [box]]
    O.bodies[ids[3]].state.pos -= Vector3(0, 0, 0.05)
    refuses(dem.check_blocks, f"overlapping blocks: {ids[2]} and {ids[3]} (by", f"{ids[3]} and {ids[4]} (by")
    O.bodies[ids[3]].state.pos += Vector3(0, 0, 1)
    refuses(dem.check_blocks, f"floating blocks, which no chain of supports joins to a prescribed body: {ids[3]}")


def test_depth_of_an_overlap():
    """Two wedges with upright faces against each other, 2 cm deep."""
    for x in (0, 0.98):
        dem.wedge((1, 1, 1), stone(), top=0.5, shift=0.25 if x == 0 else -0.25, center=None, orientation=None)
        O.bodies[len(O.bodies) - 1].state.pos += Vector3(x, 0, 0)
    refuses(lambda: dem.check_blocks(floating=False), "overlapping blocks: 0 and 1 (by 0.02 m)")


@pytest.mark.parametrize("rubble_size", (0.35, 0.5))
def test_rubble_fits_together(rubble_size):
    """No stone overlaps another, and each is joined to the base."""
    base = dem.base((9, 9, 0.2), stone())
    ids = dem.rubble_wall(2, 1.5, 0.8, rubble_size, stone(), on=base, seed=5)
    assert dem.check_blocks() == [] and dem.structures() == [ids]


def test_vaults_and_domes_fit_together():
    base = dem.base((20, 20, 0.2), stone())
    dem.barrel_vault(4, 2, 0.3, 9, 3, 4, stone(), on=base)
    dem.dome(2, 0.2, 4, 10, stone(), on=base, at=(6, 6))
    dem.column(4, [0.5, 0.48, 0.46, 0.44, 0.42], 0.5, stone(), on=base, at=(-6, 6))
    dem.arch(3, 2, 0.3, 9, 0.5, stone(), on=base, shape="pointed", at=(-6, -6))
    assert dem.check_blocks() == [] and len(dem.structures()) == 4


def test_seeds_that_are_drawn_are_accepted():
    """A wall of rubble without a seed prints one that makes it again."""
    for _ in range(5):
        O.reset()
        seed = int(re.search(r"seed=(\d+)", said_by(dem.rubble_wall, 1.0, 0.5, 0.4, 0.4, stone()))[1])
        corners = [dem.geometry(b.id).vertices for b in O.bodies]
        O.reset()
        again = dem.rubble_wall(1.0, 0.5, 0.4, 0.4, stone(), seed=seed)
        assert all(np.array_equal(one, dem.geometry(id).vertices) for one, id in zip(corners, again, strict=True))


def test_tilted_and_overturned():
    """The right trapezoid of the tables: critical angles .336675 and .502843 rad about its two edges; its lower edge stays where it was."""
    base = dem.base((9, 9, 0.2), stone())
    for angle, down in ((-0.33, False), (-0.34, True), (0.50, False), (0.51, True)):
        id = dem.prism(TRAPEZOID, 1.0, stone(), axis="y", on=base)
        x = dem.geometry(id).vertices[:, 0]
        dem.tilt(id, angle)
        assert dem.angle(id) == pytest.approx(angle) and bottom(id) == pytest.approx(0, abs=1e-14)
        corner = dem.geometry(id).vertices[dem.geometry(id).vertices[:, 2].argmin()]
        assert corner[0] == pytest.approx(x.max() if angle > 0 else x.min(), abs=1e-14) and dem.overturned() == ([id] if down else [])
        dem.tilt(id, -2 * angle)
        assert dem.angle(id) == pytest.approx(-angle) and bottom(id) == pytest.approx(0, abs=1e-14)
        O.bodies.erase(id)
    # Its principal axes are turned in its section, so that no edge of its base is along the other one.
    id = dem.prism(TRAPEZOID, 1.0, stone(), axis="y", on=base)
    refuses(lambda: dem.tilt(id, 0.03, "x"), "its own x axis, a principal axis of inertia, is inclined by", "it must be level")


def test_outline_of_a_mechanism():
    """A wedge as one sees it along y is its triangle or trapezoid; along x its rectangle: with corners about the centre of mass."""
    id = dem.wedge((1, 2, 3), stone(), top=0.4)
    corners = np.array([tuple(v) for v in O.bodies[id].shape.vertices])
    for across, area in ((1, 3 * 0.7), (0, 6)):
        outline = mechanism._silhouette(corners, across)
        plane = np.delete(outline, across, axis=1)
        x, z = plane.T
        assert len(outline) == 4 and 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1)) == pytest.approx(area) and not outline[:, across].any()


def test_a_recorder_of_convex_blocks_wants_their_base():
    base = dem.base((9, 9, 0.2), stone())
    ids = dem.arch(2, 1, 0.2, 7, 0.5, stone(), on=base)
    assert f"add {base} where it moves" in said_by(check_recorder, dem.WallRecorder(iterPeriod=1, ids=ids))
    assert said_by(check_recorder, dem.WallRecorder(iterPeriod=1, ids=[base, *ids])) == ""


@pytest.mark.parametrize("seed", range(40))
def test_gaps_of_stones_that_are_apart_are_not_negative(seed):
    """Stones of rubble without their short edges touch some neighbours nowhere: faces of neither separate these, and their crossed edges do."""
    base = dem.base((9, 9, 0.2), stone())
    dem.rubble_wall(1.5, 1, 0.6, 0.3, stone(), on=base, seed=seed)
    dem.check_blocks(floating=False)


def test_joints_of_a_vault_in_running_bond():
    """n courses of m and m + 1 blocks, m = 3: 2 and 3 head joints in them, 2 m bed joints between two courses, 2 m with the base."""
    base = dem.base((9, 9, 0.2), stone())
    dem.barrel_vault(3, 1.5, 0.3, 5, 3, 3, stone(), on=base)
    recorder = dem.WallRecorder(iterPeriod=1)
    O.engines, O.dt = [recorder], 1e-3
    O.step()
    table = results.joints(dem.wall_history(recorder))
    assert len(table) == (3 * 2 + 2 * 3) + 4 * 6 + 2 * 3 and table["opening"].max() < 1e-14
    beds = table[np.abs(table["normal"][:, 1]) < 0.5]
    assert beds["area"].sum() == pytest.approx(6 * 3 * 0.3)  # six joints of the arch over the length
