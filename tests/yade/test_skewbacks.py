"""Skewbacks that arches, flat arches and vaults have cut in their abutments: places, masses, thrust, and what is refused."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from masonry import dem
from masonry.dem import abutments, voussoirs
from rocking_scene import quiet_engines, refuses, stone
from scipy.spatial import ConvexHull
from test_convex_blocks import inertia_of
from yade import O, Quaternion, Vector3

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "validation" / "convex"))

import statics  # noqa: E402

LONG, DEEP, HIGH = 1.2, 0.8, 1.5  # of a pier, m


def piers(clear, turn=0.0, fixed=True):
    """Ids of two boxes on a base, `clear` m apart, left and right along a direction in plan."""
    base, along = dem.base((30, 30, 0.2), material()), np.array([math.cos(turn), math.sin(turn)])
    ids = [dem.block((LONG, DEEP, HIGH), material(), on=base, at=side * (clear + LONG) / 2 * along) for side in (-1, 1)]
    for id in ids:
        O.bodies[id].state.ori = O.bodies[id].state.refOri = Quaternion(Vector3.UnitZ, turn)
        O.bodies[id].dynamic = not fixed
    return ids


def material():
    return stone(noSlip=False, frictionAngle=0.6)


def segment(on, depth=DEEP, **options):
    return dem.arch(3, 0.8, 0.3, 11, depth, material(), on=on, **options)


def flat(on, depth=DEEP, **options):
    return dem.flat_arch(2, 0.4, 7, 1.6, depth, material(), on=on, **options)


def vault(on, depth=DEEP, **options):
    return dem.barrel_vault(3, 0.8, 0.3, 9, depth, 2, material(), on=on, **options)


def wedge_of(span, rise, thickness):
    """(height, length, m) of a skewback of a circular arch: its joint leans by the half angle of the arch from upright."""
    half = math.atan2(span / 2, (span**2 / 4 - rise**2) / (2 * rise))
    return thickness * math.cos(half), thickness * math.sin(half)


# Maker, distance of the abutments, height and length of the skewback, by hand.
KINDS = {"arch": (segment, 3, wedge_of(3, 0.8, 0.3)), "flat arch": (flat, 2, (0.4, 0.25)), "vault": (vault, 3, wedge_of(3, 0.8, 0.3))}
on_kinds = pytest.mark.parametrize("make, clear, wedge", KINDS.values(), ids=KINDS)


def placed(id, x, side, z):
    """The block, moved so that its face towards the opening, on its right if side = -1, is at x, and its lower face at z."""
    low, high = dem.geometry(id).vertices.min(axis=0), dem.geometry(id).vertices.max(axis=0)
    O.bodies[id].state.pos += Vector3(x - (high if side < 0 else low)[0], 0, z - low[2])
    return id


def world_gaps(a, b):
    """Distances of the corners of a block from the nearest corners of another."""
    return np.linalg.norm(dem.geometry(a).vertices[:, None] - dem.geometry(b).vertices[None], axis=2).min(axis=1)


@pytest.mark.parametrize("turn", (0, 0.5, math.pi))
@on_kinds
def test_a_skewback_is_the_joint_of_the_arch(make, clear, wedge, turn):
    """Volume and place by hand: a box less a triangular prism. The corners of the joint are those of the first voussoir."""
    left, right = piers(clear, turn)
    colour = O.bodies[left].shape.color
    ids = make((left, right))
    assert ids[0] == left and ids[-1] == right and dem.check_blocks() == [] and O.bodies[left].shape.color == colour
    high, long = wedge
    back = Quaternion(Vector3.UnitZ, -turn)
    for id, side in ((left, -1), (right, 1)):
        body, found = O.bodies[id], dem.geometry(id)
        assert found.volume == pytest.approx(DEEP * (LONG * HIGH - high * long / 2), rel=1e-12) and not body.dynamic
        corners = np.array([tuple(back * Vector3(v)) for v in found.vertices]) * [side, 1, 1]
        wanted = [(clear / 2, 0), (clear / 2 + LONG, 0), (clear / 2, HIGH - high), (clear / 2 + long, HIGH), (clear / 2 + LONG, HIGH)]
        assert len(corners) == 10 and all(np.abs(corners[:, [0, 2]] - place).max(axis=1).min() < 2e-15 for place in wanted)
        assert body.state.mass == pytest.approx(2000 * found.volume)
        assert np.allclose(found.inertia, inertia_of(found.vertices, 2000), rtol=0, atol=1e-11 * np.abs(found.inertia).max())
    for a, b in ((ids[0], ids[1]), (ids[-1], ids[-2])):
        assert (world_gaps(a, b) < 2e-15).sum() == (4 if make is not vault else 2)


def test_corners_of_the_joint_are_those_of_the_voussoir_to_the_bit():
    """In the axes of the arch, from which both blocks are made. The piers stand at odd places and are turned."""
    ids = piers(3, 0.3)
    for id in ids:
        O.bodies[id].state.pos += Vector3(0.1, 0.7, 1 / 3)
    blocks = voussoirs.arch_layout(3, 0.8, 0.3, 11, DEEP)
    _, _, cut = abutments.skewbacks(ids, 0.0, voussoirs.springing(blocks), DEEP)
    for (_, corners), block in zip(cut, (blocks[0], blocks[-1])):
        joint = {(x, z) for x, _, z in corners.tolist()} & {(x, z) for x, _, z in block.tolist()}
        assert len(joint) == 2 and len(corners) == 10


def test_an_arch_by_its_middle_line():
    """The ends of its intrados are on the inner faces, at the distance that the error says."""
    ids = piers(3)
    said = refuses(lambda: segment(ids, measured="middle"), "on = (1, 2): their inner faces are 3 m apart: must be 2.", "the distance between the ends of the intrados")
    clear = 3 - wedge_of(3, 0.8, 0.3)[1]
    assert float(said.split("must be ")[1].split(" m")[0]) == pytest.approx(clear, abs=1e-9)
    O.reset()
    assert len(segment(piers(clear), measured="middle")) == 13 and dem.check_blocks() == []


def test_convex_abutments_and_a_row_of_arches():
    """Three piers with battered outer faces, which are stones of piles, bear two arches: the middle one gets two skewbacks."""
    base = dem.base((30, 9, 0.2), material())
    below = [dem.block((2, DEEP, 1), material(), on=base, at=(x, 0)) for x in (-4.2, 0, 4.2)]
    outlines = [[(-0.8, 0), (0.6, 0), (0.6, 1), (-0.5, 1)], [(-0.6, 0), (0.6, 0), (0.6, 1), (-0.6, 1)], [(-0.6, 0), (0.8, 0), (0.5, 1), (-0.6, 1)]]
    on = [placed(dem.prism(outline, DEEP, material(), axis="y"), x, side, 1) for outline, x, side in zip(outlines, (-3.6, -0.6, 3.6), (-1, 1, 1))]
    volumes = [dem.geometry(id).volume for id in on]
    high, long = wedge_of(3, 0.8, 0.3)
    ids = segment(on[:2]) + segment(on[1:])
    assert [dem.geometry(id).volume for id in on] == pytest.approx([v - k * DEEP * high * long / 2 for v, k in zip(volumes, (1, 2, 1))], rel=1e-12)
    assert dem.check_blocks() == [] and dem.structures() == [sorted({*below, *on, *ids})]


def test_two_ribs_on_the_same_abutments():
    """An arch that is less deep than its abutments takes the edge along all of their depth; a second one beside it finds the cut."""
    on = piers(3)
    first = segment(on, 0.3, at=(0, -0.25))
    was = dem.geometry(on[0]).vertices
    assert len(segment(on, 0.3, at=(0, 0.25))) == len(first) == 13
    assert np.abs(dem.geometry(on[0]).vertices - was).max() < 1e-15 and dem.check_blocks() == []
    assert np.ptp([O.bodies[id].state.pos[1] for id in first[1:-1]]) < 1e-15


LAYOUTS = {segment: voussoirs.arch_joints(3, 0.8, 0.3, 11)[0], flat: voussoirs.flat_arch_joints(2, 0.4, 7, 1.6), vault: voussoirs.arch_joints(3, 0.8, 0.3, 9)[0]}


def thrust_by_statics(make):
    """Least and largest H/W with the joint lines of the layout; the sum over the length of a vault obeys those of an arch."""
    joints = LAYOUTS[make]
    numbers = [None, *range(len(joints) - 1), None]
    return statics.thrust(statics.Structure(voussoirs.profiles(joints), [(numbers[k], numbers[k + 1], outer, inner) for k, (inner, outer) in enumerate(joints)]), math.tan(0.6))


def forces(ids, ends):
    """(2, 3): forces of the left and of the right abutment on the other blocks, over the weight of these."""
    others = [id for id in ids if id not in ends]
    weight = 9.81 * sum(O.bodies[id].state.mass for id in others)
    return np.array([found["force"][np.isin(found["id"], others)].sum(axis=0) for found in map(dem.reactions, ends)]) / weight


@pytest.mark.parametrize("fixed", (True, False))
@on_kinds
def test_it_stands_and_pushes_as_statics_allow(make, clear, wedge, fixed):
    ids = make(piers(clear, fixed=fixed))
    places = [O.bodies[id].state.pos for id in ids]
    O.engines = quiet_engines(model="auto")
    dem.run(1, progress=False)
    assert max((O.bodies[id].state.pos - was).norm() for id, was in zip(ids, places)) < (1e-7 if make is vault else 1e-11) and O.engines[-1].failures == 0
    assert O.engines[-1].chosenModel == ("spatial" if make is vault else "planar")
    left, right = forces(ids, (ids[0], ids[-1]))
    least, largest = thrust_by_statics(make)
    assert (left + right)[[0, 2]] == pytest.approx([0, 1], abs=1e-6) and least < left[0] < largest


@pytest.mark.parametrize("springers", (False, True))
@pytest.mark.parametrize("make, clear", ((segment, 3), (flat, 2)), ids=("arch", "flat arch"))
def test_it_pushes_as_on_springers(make, clear, springers):
    """Abutments, or springers, that have moved 0.05 mm apart each leave the least thrust alone."""
    ids = make(None if springers else piers(clear), springers=springers)
    O.engines = quiet_engines(model="auto")
    O.engines[-1].onTrouble = "continue"
    for speed, seconds in ((1e-4, 0.5), (0, 0.5)):
        for id, side in ((ids[0], -1), (ids[-1], 1)):
            O.bodies[id].dynamic, O.bodies[id].state.vel = False, Vector3(side * speed, 0, 0)
        dem.run(seconds, progress=False)
    least, _ = thrust_by_statics(make)
    assert forces(ids, (ids[0], ids[-1])) == pytest.approx(np.array([(least, 0, 0.5), (-least, 0, 0.5)]), abs=3e-4)


def test_added_mass_stays(tmp_path):
    """Of an abutment: so many kg. Files keep the shape."""
    left, right = piers(3, fixed=False)
    dem.add_mass(left, 500)
    ids = segment((left, right))
    body, other = O.bodies[left], O.bodies[right]
    assert body.state.mass == pytest.approx(other.state.mass + 500, rel=1e-12)
    assert tuple(body.state.inertia) == pytest.approx(tuple(other.state.inertia * (body.state.mass / other.state.mass)), rel=1e-9)
    was = {id: (dem.geometry(id).vertices, O.bodies[id].state.mass) for id in ids}
    O.save(str(tmp_path / "arch.xml"))
    O.reset()
    O.load(str(tmp_path / "arch.xml"))
    assert all(np.array_equal(dem.geometry(id).vertices, corners) and O.bodies[id].state.mass == mass for id, (corners, mass) in was.items())


def scene():
    return len(O.materials), [(type(b.shape).__name__, tuple(b.state.pos), tuple(b.state.ori), b.state.mass, tuple(b.state.inertia)) for b in O.bodies]


def test_what_is_refused_leaves_the_scene_as_it_was():
    on = piers(3)
    base, (left, right) = 0, on

    def refused(act, *words):
        was = scene()
        refuses(act, *words)
        assert scene() == was

    refused(lambda: segment(base), "an arch gets skewbacks in two abutments, on=(left, right), or level feet by springers=True")
    refused(lambda: segment((left, left)), "must be level and beside each other")
    refused(lambda: segment((left, right, base)), "must be the id of one body, or the ids of two, left and right")
    refused(lambda: segment((left, 99)), "on = 99: there is no such body")
    refused(lambda: segment((left, base)), "must be level and beside each other")
    refused(lambda: flat(on), "on = (1, 2): their inner faces are 3 m apart: must be 2 m, the distance between the ends of the intrados")
    refused(lambda: segment(on, at=(0.1, 0)), "at = (0.1, 0): its x must be 0 where the arch has skewbacks")
    refused(lambda: segment(on, at=(0, math.nan)), "must be two finite numbers, in m")
    refused(lambda: segment(on, 1.0), "on = 1: its skewback reaches from -0.4 to 0.4 m along y, from the middle of the arch: must be within it, from -0.5 to 0.5 m; springers=True")
    refused(lambda: segment(on, 0.6, at=(0, 0.2)), "on = 1: its skewback reaches from -0.6 to 0.2 m along y")
    refused(lambda: dem.arch(3, 0.8, 2.0, 11, 0.5, material(), on=on), "on = 1: its skewback is 1.114 m high and 1.661 m long: must be below 1.5 m, the height of its inner face, and below 1.2 m")
    refused(lambda: dem.flat_arch(3, 1.6, 5, 9, 0.5, material(), on=on), "on = 1: its skewback is 1.6 m high and 0.2667 m long: must be below 1.5 m")
    dem.tie(left, (-2, 0, 1), dem.block((1, 1, 1), material(), center=(0, 9, 9)), (0, 9, 9), 1e6)
    refused(lambda: segment(on), "on = 1: a tie is fixed to that body: must be made after the arch")


def test_other_bodies_are_refused():
    left, right = piers(3)
    O.bodies[right].state.ori = Quaternion(Vector3.UnitZ, 0.1)
    refuses(lambda: segment((left, right)), "on = (1, 2): their inner faces are 0.1 rad off each other: must be parallel")
    O.bodies[right].state.ori = Quaternion(Vector3.UnitX, 0.1)
    refuses(lambda: segment((left, right)), "on = 2: its upper face leans by 0.1 rad: must be level")
    O.bodies[right].state.ori = Quaternion.Identity
    for outline, words in (([(0, 0), (2, 0), (1.5, HIGH), (0.5, HIGH)], "that body has no upright face that looks at the other abutment"),
                           ([(0, 0), (2, 0), (2, HIGH), (0.1, HIGH), (0, HIGH - 0.3)], "the joint does not end on its inner and on its upper face")):
        other = placed(dem.prism(outline, DEEP, material(), axis="y"), 1.5, 1, 0)
        refuses(lambda: segment((left, other)), f"on = {other}: {words}")
    both = dem.union([dem.block((1, 1, 0.5), material(), center=(2, 0, z)) for z in (0.25, 0.75)], material())
    refuses(lambda: segment((left, both)), f"on = {both}: that body is a union of 2 parts: must be a Box or one convex block")


def test_a_body_that_has_run_is_refused():
    on = piers(3, fixed=False)
    O.engines = quiet_engines(model="auto")
    O.step()
    refuses(lambda: segment(on), "on = 1: that body has been in 1 steps: must be in none before a skewback is cut in it; springers=True makes stones for it instead")
    assert all(type(O.bodies[id].shape).__name__ == "Box" for id in on)
