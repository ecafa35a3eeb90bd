"""Buildings: closed forms of their geometry, points of space, joints and supports looked at from outside, rest, and plans that are refused."""

import math
import time

import numpy as np
import pytest
from masonry import dem
from masonry.dem.coursing import Coursing
from masonry.dem.plans import read_plan
from rocking_scene import quiet_engines, refuses
from yade import O

GRAVITY = 9.81
# m: far above the round-off of coordinates, far below a joint or a piece.
NEAR = 1e-6


def stone():
    return dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))


def house(**changes):
    """Two storeys of 6.3 x 3.9 m in axes, walls of 0.3 m: all lengths are odd multiples of half a brick, so that corners need no cut brick."""
    given = dict(plan={"south": ((0, 0), (6.3, 0)), "north": ((0, 3.9), (6.3, 3.9)), "west": ((0, 0), (0, 3.9)), "east": ((6.3, 0), (6.3, 3.9))},
                 brick=(0.6, 0.3, 0.3), storeys=[2.4, 2.4], material=stone(), at=(-3.15, -1.95))
    given.update(changes)
    if "on" not in given:
        given["on"] = dem.base((12, 10, 0.5), stone())
    return dem.building(**given)


def boxes(ids):
    """Lowest and highest corners (n, 3) of blocks that are not turned."""
    centers = np.array([tuple(O.bodies[id].state.pos) for id in ids])
    half = np.array([tuple(O.bodies[id].shape.extents) for id in ids])
    return centers - half, centers + half


def straight_joints(low, high, lap):
    """Pairs of places of head joints that are nearer to each other than the lap in courses on top of each other. A head joint is where two blocks share a
    vertical face."""
    courses = {}
    for k, z in enumerate(np.round(low[:, 2] / NEAR)):
        courses.setdefault(z, []).append(k)
    joints = {}
    for rows in courses.values():
        for axis in (0, 1):
            (start, end), (a, b) = (low[rows, axis], high[rows, axis]), (low[rows, 1 - axis], high[rows, 1 - axis])
            left, right = np.maximum(a[:, None], a), np.minimum(b[:, None], b)
            for i, j in np.argwhere((np.abs(end[:, None] - start) < NEAR) & (right - left > NEAR)):
                key = axis, round(low[rows[i], 2] / NEAR)
                joints.setdefault(key, []).append((end[i], left[i, j], right[i, j], high[rows[i], 2]))
    found = []
    for (axis, _), lower in joints.items():
        above = np.array(joints.get((axis, round(lower[0][3] / NEAR)), np.zeros((0, 4))))
        for place, a, b, top in lower:
            over = (np.minimum(above[:, 2], b) - np.maximum(above[:, 1], a) > NEAR) & (np.abs(above[:, 0] - place) < lap - NEAR)
            found += [(place, other, top) for other in above[over, 0]]
    return found


# --- walls at an angle ---


@pytest.mark.parametrize("along", ((0, 1), (-1, 0), (0, -2), (3, 4), (-0.5, 1)))
def test_a_wall_at_an_angle(along):
    """It is the wall along x, turned about the place `at`: corner by corner."""
    base = dem.base((12, 12, 0.5), stone())
    given = dict(length=3.2, height=1.2, size=(0.4, 0.3, 0.2), material=stone(), openings=[(0.6, 0.4, 0.6, 0.4)])
    straight = dem.wall(on=base, at=(0, 0), **given)
    low, high = boxes(straight)
    for id in straight:
        O.bodies.erase(id)
    turned = dem.wall(on=base, at=(1.0, -0.5), along=along, **given)
    assert len(turned) == len(straight)
    x, y = np.array(along) / math.hypot(*along)
    frame = np.array([(x, y, 0), (-y, x, 0), (0, 0, 1)])
    for k, id in enumerate(turned):
        corners = np.array(dem.bodies.world_shape(O.bodies[id])[0])
        expected = np.array([[p, q, r] for p in (low[k, 0], high[k, 0]) for q in (low[k, 1], high[k, 1]) for r in (low[k, 2], high[k, 2])]) @ frame + (1.0, -0.5, 0)
        apart = np.abs(corners[:, None] - expected).max(axis=2).min(axis=1)
        assert apart.max() < 1e-12, (id, apart)
    assert dem.check_blocks(1e-9) == []


def test_a_wall_along_y_moves_as_one_along_x():
    """Both rock in their planes under the same motion of the base along themselves."""
    drifts = []
    for along in ((1, 0), (0, 1), (1, 1)):
        O.reset()
        base = dem.base((6, 6, 0.5), stone())
        dem.wall(courses=4, per_course=2, size=(0.4, 0.3, 0.2), material=stone(), on=base, along=along)
        unit = np.array([*along, 0]) / math.hypot(*along)
        recorder = dem.WallRecorder(virtPeriod=0.01)
        O.engines = quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.4, times=[0.01], direction=unit), model="spatial", tolerance=1e-5, recorder=recorder)
        dem.run(0.12)
        drifts.append(dem.wall_history(recorder).drift())
    assert drifts[0].max() > 3e-3
    # The solver, with a tolerance of 1e-5, takes the sums in another order.
    assert all(np.abs(drift - drifts[0]).max() < 1e-5 * drifts[0].max() for drift in drifts[1:])


def test_a_direction_that_is_none():
    base = dem.base((4, 4, 0.5), stone())
    refuses(lambda: dem.wall(courses=2, per_course=2, size=(0.4, 0.3, 0.2), material=stone(), on=base, along=(0, 0)), "along = (0, 0)", "direction")


# --- geometry ---


def test_blocks_and_volume_of_four_walls():
    """Runs of 6.6 and 3.6 m, then of 6.0 and 4.2 m: 11 and 6, then 10 and 7 whole bricks, 34 in each course."""
    made = house()
    courses = 16
    assert len(made.ids) == courses * 34 and made.lintels == {} and made.floors == [[], []]
    assert all(sorted(np.round(2 * np.array(O.bodies[id].shape.extents), 9)) == [0.3, 0.3, 0.6] for id in made.ids)
    volume = 0.3 * 2 * (6.3 + 3.9) * 4.8
    assert abs(made.volume - volume) < 1e-9 * volume and abs(made.mass - 2000 * volume) < 1e-6 * volume
    assert abs(sum(O.bodies[id].state.mass for id in made.ids) - made.mass) < 1e-9 * made.mass
    assert dem.check_blocks(1e-8) == []
    low, high = boxes(made.ids)
    assert straight_joints(low, high, 0.3) == []  # half a brick, also through the corners
    assert sorted(sum(made.walls.values(), [])) == made.ids


def test_volume_with_openings_floors_and_gables():
    """Openings take their volume out, lintels none; a slab covers the rectangle of the outer faces; courses of a gable of height H over a length L, which lie below
    its edges, are L (1 - k h / H) long."""
    made = house(openings=[dem.Opening("south", x=2.4, width=1.1, height=2.1), dem.Opening("south", x=2.4, width=1.25, height=1.2, sill=0.9, storey=2),
                           dem.Opening("east", x=1.4, width=0.9, height=1.2, sill=0.9, storey=2), dem.Opening("north", x=1.3, width=0.9, height=2.4)],
                 floors=[dem.Slab(0.2, strips=4), dem.Beams(("south", "north"), (0.12, 0.2), number=5)], gables={"west": 1.8, "east": 1.8})
    walls = 0.3 * (2 * (6.3 + 3.9) * 4.8 - 1.1 * 2.1 - 1.25 * 1.2 - 0.9 * 1.2 - 0.9 * 2.4)
    slab, beams = 6.6 * 4.2 * 0.2, 5 * 0.12 * 0.2 * 4.2
    gables = 2 * 0.3 * 0.3 * sum(4.2 * (1 - k / 6) for k in range(1, 6))
    assert abs(made.volume - (walls + slab + beams + gables)) < 1e-8 * made.volume
    assert sorted(made.lintels) == [0, 1, 2]  # the one in the north wall is as high as its storey, and the slab lies over it
    assert [len(floor) for floor in made.floors] == [4, 5]
    assert dem.check_blocks(1e-8) == []
    assert straight_joints(*boxes(sum(made.walls.values(), [])), 0.6 / 8) == []
    low, high = boxes(made.ids)
    assert {round(high[made.ids.index(id), 2], 9) for id in made.top(1)} == {2.4} and {round(high[made.ids.index(id), 2], 9) for id in made.top(2)} == {5.0}


def test_asked_for_straight_joints():
    """bonded=False: the walls along y end at the faces of the others, one joint over the other in all courses at four corners and two faces of a T."""
    plan = {"south": ((0, 0), (6.3, 0)), "north": ((0, 3.9), (6.3, 3.9)), "west": ((0, 0), (0, 3.9)), "east": ((6.3, 0), (6.3, 3.9)), "middle": ((3.0, 0), (3.0, 3.9))}
    made = house(plan=plan, storeys=[1.2], bonded=False)
    low, high = boxes(made.ids)
    at = {(round(one, 6), round(top, 6)) for one, other, top in straight_joints(low, high, 0.6 / 8)}
    assert at == {(y - 1.95, z) for y in (0.15, 3.75) for z in (0.3, 0.6, 0.9)}
    O.reset()
    made = house(plan=plan, storeys=[1.2])
    assert straight_joints(*boxes(made.ids), 0.6 / 8) == []


def test_two_wythes():
    """Every sixth course goes through both leaves, and no other does; volumes are those of the walls; the leaves have no straight joint."""
    made = house(brick=(0.6, 0.15, 0.3), thickness=0.3)
    volume = 0.3 * 2 * (6.3 + 3.9) * 4.8
    assert abs(made.volume - volume) < 1e-9 * volume and dem.check_blocks(1e-8) == []
    low, high = boxes(made.ids)
    through = np.isclose(np.minimum(*(high - low)[:, :2].T), 0.3) & np.isclose(np.maximum(*(high - low)[:, :2].T), 0.3)
    assert {round(z / 0.3) + 1 for z in low[through, 2]} == {6, 12}


def test_beams_in_walls():
    """A beam of two courses passes through the walls on which it lies; what is around it fills the rest."""
    made = house(floors=[dem.Beams(("south", "north"), (0.2, 0.6), at=(1.5, 4.2)), None])
    low, high = boxes(made.floors[0])
    assert np.allclose(low, [[-1.75, -2.1, 2.4], [0.95, -2.1, 2.4]]) and np.allclose(high - low, [0.2, 4.2, 0.6])
    volume = 0.3 * 2 * (6.3 + 3.9) * 4.8 + 2 * 0.2 * 0.6 * 3.6
    assert abs(made.volume - volume) < 1e-8 * volume and dem.check_blocks(1e-8) == []


def test_a_lower_wall():
    """A garden wall is bonded with the house up to its own height; a window above it may stand over it. Walls are numbered where the plan is a list."""
    plan = [((0, 0), (6.3, 0)), ((3.0, 0), (3.0, -2.1))]
    made = house(plan=plan, storeys=[2.4], heights={1: 0.9}, openings=dem.Opening(0, x=2.6, width=0.8, height=0.9, sill=0.9))
    volume = 0.3 * (6.3 * 2.4 + (2.1 - 0.15) * 0.9 - 0.8 * 0.9)
    assert abs(made.volume - volume) < 1e-8 * volume and dem.check_blocks(1e-8) == []
    low, high = boxes(made.walls[1])
    assert abs(high[:, 2].max() - 0.9) < 1e-12 and abs(high[:, 1].max() - (0.15 - 1.95)) < 1e-9
    assert straight_joints(*boxes(made.ids), 0.6 / 8) == []


def test_walls_that_cross_and_bricks_of_their_own():
    """Two inner walls of thinner bricks cross each other and end on the outer walls: all are bonded."""
    plan = {"south": ((0, 0), (6.3, 0)), "north": ((0, 3.9), (6.3, 3.9)), "west": ((0, 0), (0, 3.9)), "east": ((6.3, 0), (6.3, 3.9)), "along": ((0, 1.8), (6.3, 1.8)),
            "across": ((2.9, 0), (2.9, 3.9))}
    inner, outer = (0.5, 0.2, 0.3), (0.6, 0.3, 0.3)
    made = house(plan=plan, storeys=[1.8], brick={name: inner if name in ("along", "across") else outer for name in plan})
    volume = 1.8 * (0.3 * 2 * (6.3 + 3.9) + 0.2 * ((6.3 - 0.3) + (3.9 - 0.3) - 0.2))
    assert abs(made.volume - volume) < 1e-8 * volume and dem.check_blocks(1e-8) == []
    assert straight_joints(*boxes(made.ids), 0.5 / 8) == []


def test_a_turned_building_on_a_slab():
    """A slab can be the base of another building, at an angle."""
    below = house(floors=[None, dem.Slab(0.2)])
    (slab,) = below.floors[1]
    above = dem.building({"a": ((0, 0), (1.5, 0)), "b": ((0, 0), (0, 1.5))}, (0.6, 0.3, 0.3), [0.6], stone(), on=slab, along=(3, 4))
    corner = np.array(O.bodies[above.ids[0]].state.pos)
    assert abs(corner[2] - (4.8 + 0.2 + 0.15)) < 1e-12 and abs(O.bodies[above.ids[0]].state.ori[2] - math.sin(math.atan2(4, 3) / 2)) < 1e-12
    assert dem.check_blocks(1e-8) == []


def test_walls_on_walls():
    """A thinner storey stands on the walls of a thicker one, its plan in the middle of theirs; a parapet on one wall; faces at different heights are refused."""
    below = house(storeys=[1.2])
    above = house(storeys=[1.2], brick=(0.6, 0.2, 0.3), on=below.top(1))
    low, high = boxes(above.ids)
    assert abs(low[:, 2].min() - 1.2) < 1e-12 and np.allclose([low[:, :2].min(axis=0), high[:, :2].max(axis=0)], [(-3.25, -2.05), (3.25, 2.05)])
    parapet = dem.wall(courses=1, per_course=5, size=(0.6, 0.2, 0.2), material=stone(), on=above.top(1, wall="south"), at=(0.1, 0))
    assert np.allclose(boxes(parapet)[0].min(axis=0), [0.1 - 1.5, -1.95 - 0.1, 2.4]) and dem.check_blocks(1e-8) == []
    refuses(lambda: dem.wall(courses=1, per_course=5, size=(0.6, 0.2, 0.2), material=stone(), on=[*below.top(1), *above.top(1)]), "z = 2.4 m", "level")
    refuses(lambda: dem.wall(courses=1, per_course=5, size=(0.6, 0.2, 0.2), material=stone(), on=below.top(1)), "off it", "34 bodies")
    refuses(lambda: dem.wall(courses=1, per_course=5, size=(0.6, 0.2, 0.2), material=stone(), on=[]), "on = []")


# --- arches over openings ---

ARCHED = [dem.Opening("south", x=2.0, width=1.2, height=1.5, arch=dem.Arch(7, 3, rise=0.2)), dem.Opening("east", x=1.4, width=0.9, height=0.9, sill=0.6, arch=dem.Arch(5, 2)),
          dem.Opening("north", x=4.0, width=1.0, height=1.2, sill=0.3, storey=2, arch=dem.Arch(6, 2, rise=0.15))]


def under(arch, width):
    """Area between the springing line and the chords of an arc of that rise: 7 chords of a circle of the radius R = (w^2/4 + f^2)/(2 f) span 2 asin(w/2R)."""
    if not arch.rise:
        return 0.0
    radius = (width * width / 4 + arch.rise**2) / (2 * arch.rise)
    angle = 2 * math.asin(width / (2 * radius))
    return arch.number * radius**2 / 2 * math.sin(angle / arch.number) - radius**2 / 2 * math.sin(angle)


@pytest.mark.parametrize("along", ((1, 0), (0, -1), (3, 4)))
@pytest.mark.parametrize("wythes", (1, 2))
def test_arches_over_openings(along, wythes):
    """The wall is whole but for the openings and what is below the arches: volume, and one block around each point of the wall."""
    made = house(openings=ARCHED, floors=[dem.Slab(0.2, strips=4), None], along=along, at=(0, 0), brick=(0.6, 0.3 / wythes, 0.3), thickness=0.3, on=dem.base((20, 20, 0.5), stone()))
    assert [len(made.arches[k]) for k in range(3)] == [7, 5, 6] and made.lintels == {}
    walls = 0.3 * (2 * (6.3 + 3.9) * 4.8 - sum(one.width * one.height + under(one.arch, one.width) for one in ARCHED)) + 6.6 * 4.2 * 0.2
    assert abs(made.volume - walls) < 1e-8 * walls and abs(made.mass - 2000 * walls) < 1e-8 * 2000 * walls
    assert dem.check_blocks(1e-8) == []
    rng = np.random.default_rng(3)
    place, height = rng.uniform(0.4, 5.9, 2000), rng.uniform(0, 2.4, 2000)
    arch = ARCHED[0].arch
    chords = arch.joints(1.2, 0.9)[:, 0] + [2.6, 1.5]
    empty = (np.abs(place - 2.6) < 0.6) & (height < np.interp(place, *chords.T))
    x, y = np.array(along) / math.hypot(*along)
    points = np.column_stack([place, rng.uniform(-0.14, 0.14, 2000), height]) @ [(x, y, 0), (-y, x, 0), (0, 0, 1)]
    count = np.zeros(2000, dtype=int)
    for id in made.ids:
        corners, faces = dem.bodies.world_shape(O.bodies[id])
        inside = np.ones(2000, dtype=bool)
        for loop in faces:
            normal = np.cross(corners[loop[1]] - corners[loop[0]], corners[loop[2]] - corners[loop[1]])
            inside &= (points - corners[loop[0]]) @ normal < 0
        count += inside
    assert (count == ~empty).all(), points[count != ~empty][:3]


def test_arches_carry_a_wall():
    """At rest the base carries the weight, the joints around an arch carry the weight of its voussoirs, and the skewbacks lift it and press it together from both sides."""
    made = house(plan={"a": ((0, 0), (4.2, 0)), "b": ((0, 2.1), (0, -2.1))}, storeys=[2.7], openings=[dem.Opening("a", x=1.5, width=1.2, height=1.2, arch=dem.Arch(5, 2, rise=0.1))], at=(-2, 0))
    base = made.ids[0] - 1
    O.engines = quiet_engines(model="spatial", method="wall")
    dem.run(0.5)
    assert O.engines[-1].failures == 0 and dem.at_rest()
    force = dem.reactions(base)["force"].sum(axis=0)
    assert np.abs(force - [0, 0, made.mass * GRAVITY]).max() < 1e-3 * made.mass * GRAVITY, force
    arch = made.arches[0]
    weight = sum(O.bodies[id].state.mass for id in arch) * GRAVITY
    outside = {id: [(one["force"], one["point"]) for one in dem.reactions(id) if one["id"] not in arch] for id in arch}  # on the neighbours
    total = -sum(force for forces in outside.values() for force, _ in forces)
    assert np.abs(total - [0, 0, weight]).max() < 0.02 * weight, total  # the error of a contact force is up to a hundred times the tolerance, of 1e-3
    for id, inwards in ((arch[0], 1), (arch[-1], -1)):
        beside = [force for force, point in outside[id] if inwards * (point[0] - O.bodies[id].state.pos[0]) < 0 and point[2] < 1.8 - NEAR]
        assert -sum(force[2] for force in beside) > 0 and -inwards * sum(force[0] for force in beside) > 0, beside


# --- random plans ---

SIZES = [(0.6, 0.3, 0.2), (0.5, 0.2, 0.2), (0.4, 0.2, 0.2), (0.5, 0.15, 0.25)]


def random_plan(rng):
    """Outer walls, often one or two inner ones and a lower one outside, floors, gables, and openings away from junctions and beams."""
    brick = SIZES[rng.integers(len(SIZES))]
    (long, wide), high = rng.uniform(3.5, 7, 2), brick[2]
    plan = {"south": ((0, 0), (long, 0)), "north": ((0, wide), (long, wide)), "west": ((0, wide), (0, 0)), "east": ((long, 0), (long, wide))}
    if rng.random() < 0.6:
        plan["cross"] = ((long * rng.uniform(0.4, 0.6), 0),) * 2
        plan["cross"] = (plan["cross"][0], (plan["cross"][0][0], wide))
    if rng.random() < 0.3:
        plan["garden"] = ((long, wide / 2), (long + 2, wide / 2))
    storeys = [high * int(rng.integers(8, 12)) for _ in range(rng.integers(1, 4))]
    openings = [dem.Opening(name, x=rng.uniform(0.9, 1.1), width=rng.uniform(0.3, 0.5), height=4 * high, sill=high * int(rng.integers(0, 4)), storey=k + 1)
                for name in plan if name not in ("garden", "north") for k in range(len(storeys)) if rng.random() < 0.7]
    floors = [(None, dem.Slab(0.15, strips=int(rng.integers(1, 5))), dem.Beams(("west", "east"), (0.1, high), number=int(rng.integers(1, 4))))[rng.integers(3 if "garden" not in plan else 2)]
              for _ in storeys]
    gables = {"west": 1.3, "east": 1.3} if rng.random() < 0.4 else None
    return dict(plan=plan, brick=brick, thickness=brick[1] * (2 if rng.random() < 0.2 else 1), storeys=storeys, openings=openings, floors=floors, gables=gables,
                heights={"garden": 1.0} if "garden" in plan else None, lap=None, bonded=True, header_every=None)


def masonry_at(given, points):
    """Whether walls, without their openings, are at the points: closed form of the plan, up to the eaves."""
    half, z, inside = given["thickness"] / 2, 0.0, np.zeros(len(points), dtype=bool)
    for k, (height, floor) in enumerate(zip(given["storeys"], given["floors"])):
        in_storey = (points[:, 2] > z) & (points[:, 2] < z + height)
        for name, ends in given["plan"].items():
            start, end = np.array(ends, dtype=float)
            low, high = np.minimum(start, end) - half, np.maximum(start, end) + half
            if name == "garden":  # its end is free
                high[0] -= half
            top = math.floor(1.0 / given["brick"][2] + 1e-9) * given["brick"][2] if name == "garden" else math.inf
            here = in_storey & ((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1) & (points[:, 2] < top)
            along = (points[:, :2] - start) @ ((end - start) / np.linalg.norm(end - start))
            for opening in given["openings"]:
                if opening.wall == name and opening.storey == k + 1:
                    up = points[:, 2] - z
                    here &= ~((along > opening.x) & (along < opening.x + opening.width) & (up > opening.sill) & (up < opening.sill + opening.height))
            inside |= here
        z += height + (floor.thickness if isinstance(floor, dem.Slab) else 0)
    return inside, z


def test_random_plans():
    """Where a plan has masonry there is one block at each point, and none where it has none; blocks do not overlap, lap, and stand on others."""
    rng, accepted, refused = np.random.default_rng(57), 0, []
    begin = time.time()
    for _ in range(14):
        given = random_plan(rng)
        try:
            pieces = Coursing(read_plan(**given)).pieces
        except ValueError as error:
            refused.append(str(error))
            continue
        accepted += 1
        low, high = np.array([piece.low for piece in pieces]), np.array([piece.high for piece in pieces])
        walls = np.array([piece.kind in ("block", "lintel") for piece in pieces])
        ends = np.array(list(given["plan"].values()), dtype=float).reshape(-1, 2)
        top = sum(given["storeys"]) + sum(floor.thickness for floor in given["floors"] if isinstance(floor, dem.Slab))
        points = rng.uniform([*(ends.min(axis=0) - 0.5), 0], [*(ends.max(axis=0) + 0.5), top], (500, 3))
        lines = np.array([np.array(a) + rng.random() * (np.array(b) - a) for a, b in given["plan"].values() for _ in range(60)])
        points = np.concatenate([points, np.column_stack([lines + rng.uniform(-0.3, 0.3, lines.shape), rng.uniform(0, top, len(lines))])])
        around = ((points[:, None] > low) & (points[:, None] < high)).all(axis=2).astype(int)
        beams = around[:, [piece.kind == "beam" for piece in pieces]].sum(axis=1) > 0
        expected, _ = masonry_at(given, points)
        count = around[:, walls].sum(axis=1)
        assert (count[~beams] == expected[~beams]).all(), (given, points[~beams][count[~beams] != expected[~beams]][:3])
        assert (around.sum(axis=1) <= 1).all()
        if given["thickness"] == given["brick"][1]:
            assert straight_joints(low[walls], high[walls], given["brick"][0] / 8) == [], given
    print(f"{accepted} of 14 plans in {time.time() - begin:.1f} s; {refused}")
    # Openings may come too near to an inner wall; such plans are refused with the place.
    assert accepted >= 8 and all("wall" in error for error in refused)


# --- at rest ---


def test_a_house_stands():
    """Two seconds at rest: nothing moves, and the base carries the weight."""
    made = house(plan={"south": ((0, 0), (3.5, 0)), "north": ((0, 2.5), (3.5, 2.5)), "west": ((0, 0), (0, 2.5)), "east": ((3.5, 0), (3.5, 2.5))}, brick=(1.0, 0.5, 0.4),
                 storeys=[2.0, 1.6], at=(-1.75, -1.25), openings=[dem.Opening("south", x=1.2, width=1.0, height=1.6), dem.Opening("east", x=0.8, width=0.8, height=0.8, sill=0.4, storey=2)],
                 floors=dem.Slab(0.2, strips=2), gables={"west": 0.8})
    base = made.ids[0] - 1
    recorder = dem.WallRecorder(virtPeriod=0.25)
    O.engines = quiet_engines(model="auto", recorder=recorder)
    dem.run(2)
    assert O.engines[-1].failures == 0 and dem.at_rest()
    force = dem.reactions(base)["force"].sum(axis=0)
    assert np.abs(force - [0, 0, made.mass * GRAVITY]).max() < 1e-3 * made.mass * GRAVITY, force
    assert dem.wall_history(recorder).drift().max() < 1e-6


# --- what is refused ---

BAD = [
    (dict(plan={"a": ((0, 0), (3, 1))}), ("plan['a']", "along x or y")),
    (dict(brick=(250, 120, 300)), ("brick of wall 'south' = (250, 120, 300): extent = 300: must be from 0.001 to 100, in m",)),
    (dict(brick=(25, 12, 30)), ("plan['south']", "its brick is 25 m long", "half a brick long at least", "in m")),
    (dict(plan={"a": ((0, 0), (3, 0)), "b": ((1, 0.1), (1, 3))}), ("'a' and 'b' overlap near (1, 0)", "axes")),
    (dict(plan={"a": ((0, 0), (3, 0)), "b": ((1, 0.2), (1, 3))}), ("'a' and 'b' leave a gap of 0.05 m near (1, 0)",)),
    (dict(plan={"a": ((0, 0), (3, 0)), "b": ((2.5, 0.1), (5, 0.1))}), ("'a' and 'b' overlap at (2.75",)),
    (dict(plan={"a": ((0, 0), (3, 0)), "b": ((3, 0), (5, 0))}), ("'a' and 'b' overlap at (3, 0)", "must be one")),
    (dict(plan=[]), ("plan has 0 walls",)),
    (dict(thickness=0.4), ("thickness of wall 'south' = 0.4", "0.3 m, or twice")),
    (dict(thickness={"south": 0.3, "attic": 0.3}), ("there is no wall 'attic'",)),
    (dict(storeys=[2.5]), ("storeys[0] = 2.5", "whole number of courses of 0.3 m")),
    (dict(storeys=2.4), ("storeys = 2.4", "list")),
    (dict(openings=[dem.Opening("porch", x=1, width=1, height=0.9)]), ("openings[0]: wall = 'porch'", "'south'")),
    (dict(openings=[("south", 1, 1, 1)]), ("openings[0]", "dem.Opening")),
    (dict(openings=[dem.Opening("south", x=1, width=1, height=1)]), ("openings[0]: height = 1", "courses of 0.3 m")),
    (dict(openings=[dem.Opening("south", x=1, width=1, height=1.8, sill=0.9)]), ("sill = 0.9, height = 1.8", "2.4 m of storey 1")),
    (dict(openings=[dem.Opening("south", x=0.2, width=1, height=0.9)]), ("openings[0] in wall 'south' from (0.2, 0)", "'west' at (0, 0)", "0.15 m")),
    (dict(openings=[dem.Opening("south", x=1, width=1, height=0.9), dem.Opening("south", x=1.5, width=1, height=0.9)]), ("openings[1] in wall 'south'", "another opening")),
    (dict(openings=[dem.Opening("south", x=1, width=1, height=0.9), dem.Opening("south", x=2.2, width=1, height=0.9)]), ("openings[1]", "lintel", "farther apart")),
    (dict(openings=[dem.Opening("south", x=6, width=1, height=0.9)]), ("from (6, 0) to (7, 0)", "within the wall", "(6.3, 0)")),
    (dict(openings=[dem.Opening("south", x=2, width=1, height=0.9, arch=3)]), ("openings[0]: arch = 3", "dem.Arch")),
    (dict(openings=[dem.Opening("south", x=2, width=1, height=0.9, arch=dem.Arch(5, 2, rise=0.3))]), ("arch: rise = 0.3", "0 to 0.2 m")),
    (dict(openings=[dem.Opening("south", x=2, width=1, height=0.9, arch=dem.Arch(1, 2))]), ("arch: number = 1",)),
    (dict(openings=[dem.Opening("south", x=2, width=1, height=0.9, bearing=0.3, arch=dem.Arch(5, 2))]), ("bearing = 0.3", "skewbacks")),
    (dict(openings=[dem.Opening("south", x=0.4, width=1, height=0.9, arch=dem.Arch(5, 2))]), ("its arch from", "needs 0.15 m of wall")),
    (dict(openings=[dem.Opening("south", x=2, width=1, height=2.1, arch=dem.Arch(5, 2))], floors=dem.Slab(0.2)), ("its arch takes courses 8 to 9", "below the slab")),
    (dict(openings=[dem.Opening(["south"], x=1, width=1, height=0.9)]), ("openings[0]: wall = ['south']",)),
    (dict(openings=3), ("openings = 3", "list")),
    (dict(plan={"a": ((0, 0), (3, 0))}, openings=[dem.Opening("a", x=0.1, width=1, height=0.9)]), ("the end of the wall at (0, 0)",)),
    (dict(floors=dem.Slab(0.2), heights=dict.fromkeys(("south", "north", "west", "east"), 1.2)), ("floors[0]: no wall reaches",)),
    (dict(floors=dem.Beams(("south", "north"), (0.1, 0.3), at=2)), ("floors[0]: at = 2",)),
    (dict(floors=[dem.Slab(0.2)]), ("floors = ", "a list of 2")),
    (dict(floors=dem.Slab(-0.2)), ("floors[0]: thickness = -0.2",)),
    (dict(floors=dem.Beams(("south", "west"), (0.1, 0.3), number=2)), ("floors[0]", "'south' and 'west'", "parallel")),
    (dict(floors=[dem.Beams(("south", "north"), (0.1, 0.2), number=2), None]), ("floors[0]: size = (0.1, 0.2)", "courses of 0.3 m", "'south'")),
    (dict(floors=[dem.Slab(0.2, areas=[((0, 0), (6.3, 2))]), None]), ("stands on nothing",)),
    (dict(gables={"attic": 1.0}), ("gables = ", "'south'")),
    (dict(heights={"south": -1}), ("heights['south'] = -1",)),
    (dict(lap=0.5), ("lap = 0.5", "0.3 m")),
    (dict(lap=0.3, plan={"a": ((0, 0), (6, 0)), "b": ((2.0, 0), (2.0, 3))}), ("wall 'a', course", "lap by 0.3 m")),
    (dict(brick={"south": (0.6, 0.3, 0.3)}), ("brick: there is none for wall 'north'",)),
    (dict(at=(3, 0)), ("off it",)),
    (dict(material=1), ("material = 1",)),
]


@pytest.mark.parametrize("changes, words", BAD)
def test_a_bad_plan(changes, words):
    base = dem.base((12, 10, 0.5), stone())
    refuses(lambda: house(on=base, **changes), *words)
    assert len(O.bodies) == 1  # nothing has been made
