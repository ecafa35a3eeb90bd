"""Collapse multipliers against statics, mechanisms, and what a TiltTable leaves behind. mu: tangent of the friction angle."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from masonry import dem
from masonry.dem import tilting
from rocking_scene import refuses
from scipy.optimize import linprog
from yade import O, Quaternion, Vector3

# Bisection ends within 1e-3 of the multiplier; the mean of the bracket is off by at most half of that, and a trial by _REST.
CLOSE = 1e-3


def ground(mu, **attributes):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(mu), restitution=0, **attributes)
    return dem.base((4, 4, 0.2), stone), stone


def bond_wall(courses, mu):
    """Blocks 0.40 x 0.175 m, five long, on a fixed course; the lowest free course starts with a half block."""
    base, stone = ground(mu)
    ids = dem.wall(courses + 1, 5, (0.40, 0.20, 0.175), stone, base)
    for id in ids[:5]:
        O.bodies[id].dynamic = False


def found(**options):
    result = dem.TiltTable(**options).bisect(progress=False)
    low, high = result.bracket
    assert low <= result.multiplier <= high and high - low <= CLOSE * high, result
    assert not result.doubts, result
    return result


def marks(result, kind):
    return [(int(j["id1"]), int(j["id2"])) for j in result.joints if j[kind]]


@pytest.mark.parametrize("n", (1, 2, 4))
@pytest.mark.parametrize("options", ({}, {"load": "turned"}, {"direction": "-x"}, {"gravity": 1.62}))
def test_stacks(n, options):
    """N blocks of width 2 b and height 2 a turn about the edge of their base at b / (n a), whichever way they are loaded."""
    exact = 0.6 / (n * 0.4)
    base, stone = ground(2.0)
    ids = dem.stack(n, (0.6, 0.5, 0.4), stone, base)
    result = found(**options)
    assert abs(result.multiplier / exact - 1) < CLOSE
    assert marks(result, "opens") == [(base, ids[0])] and marks(result, "slides") == [], result.joints
    assert result.blocks == ids


@pytest.mark.parametrize("direction, aside, half", (("x", 0.05, 0.3), ("-x", -0.05, 0.3), ("y", 0.05, 0.25), ("-y", -0.05, 0.25)))
def test_two_blocks(direction, aside, half):
    """The upper one 0.1 aside: both turn about the edge that their common centre, 0.05 aside and 0.4 above it, is farther from or nearer to."""
    base, stone = ground(2.0)
    lower = dem.block((0.6, 0.5, 0.4), stone, on=base)
    dem.block((0.6, 0.5, 0.4), stone, center=(0.1, 0, 0.6) if "x" in direction else (0, 0.1, 0.6))
    result = found(direction=direction)
    assert abs(result.multiplier / ((half - aside) / 0.4) - 1) < CLOSE and marks(result, "opens") == [(base, lower)]


@pytest.mark.parametrize("mu", (0.2, 0.6))
def test_a_block_that_slides(mu):
    """It does so at mu; the joint slides and stays closed."""
    base, stone = ground(mu)
    block = dem.block((0.6, 0.5, 0.4), stone, on=base)
    result = found()
    assert abs(result.multiplier / mu - 1) < CLOSE
    assert marks(result, "slides") == [(base, block)] and marks(result, "opens") == [], result.joints
    # Each trial has a time of its own, and what does not move at all is at rest after two looks.
    assert all(abs(t.time - 2 * tilting._LOOK * dem.TiltTable()._dt) < 1e-12 for t in result.trials if t.verdict == "rest"), result.trials


def test_the_slow_ramp():
    """The same multiplier, from below by at most the stairs between two looks."""
    base, stone = ground(2.0)
    dem.stack(2, (0.6, 0.5, 0.4), stone, base)
    table = dem.TiltTable()
    result = table.ramp(progress=False)
    stair = 0.02 * tilting._LOOK * table._dt / table._unit
    assert -2 * stair < result.multiplier - 0.75 <= 1e-9 and result.bracket[1] > 0.75
    before = result.trials[0].time - tilting._LOOK * table._dt  # the last stair was put on; by 0.02 in sqrt(height / gravity), 0.8 m
    assert math.isclose(result.bracket[1], 0.02 * before / math.sqrt(0.8 / 9.81), rel_tol=1e-9), result
    assert marks(result, "opens") == [(0, 1)], result.joints


def test_a_block_that_slides_and_leans_on_another():
    """A block that slides at 0.3 over a gap of half a millimetre, then leans on one as heavy that slides at 0.6: the two stand up to 0.45,
    but for the share v of a weight that friction between them moves from one to the other: m = 0.45 + 0.15 v, and |v| is at most 0.3 of the
    push m - 0.3 (1 - v): 1.75 %."""
    base, stone = ground(0.6)
    slippery = dem.BlockMat(density=2000, frictionAngle=math.atan(0.3), restitution=0)
    first = dem.block((0.6, 0.5, 0.4), slippery, on=base)
    second = dem.block((0.6, 0.5, 0.4), stone, center=(0.6005, 0, 0.2))
    result = found()
    assert abs(result.multiplier / 0.45 - 1) < 0.0175 + CLOSE and result.blocks == [first, second]
    assert marks(result, "opens") == [] and marks(result, "slides") == [(base, first), (base, second)], result.joints  # also where 0.5 mm were closed before
    moved = max(t.moved for t in result.trials if t.verdict == "rest")  # the gap, and a slip until friction between the two holds them
    assert 4.99e-4 < moved < 8e-4, result.trials
    remark, = result.remarks
    assert f"{1e3 * moved:.2g} mm" in remark and "come to rest against others" in remark and "0.8 mm (share)" in remark and remark in str(result)


def test_a_rest_of_blocks_that_have_moved():
    """A block that has slid by a tenth of `share` and rests on what it has stood on all along is jammed. It has come to rest where it leans on one that it did
    not touch before; less than a hundredth of `share` is no movement."""
    base, stone = ground(0.5)
    block = dem.block((0.6, 0.5, 0.4), stone, on=base)
    dem.block((0.6, 0.5, 0.4), stone, center=(0.6 + 8e-5, 0, 0.2))
    table = dem.TiltTable()
    for way, jammed in ((6e-6, False), (4e-5, True), (8e-5, False)):
        integrator = table._begin(0.3)  # the friction coefficient is 0.5: the block stands, and leans on the other where it touches it
        O.bodies[block].state.pos += Vector3(way, 0, 0)
        if way == 8e-5:
            O.bodies[block].state.vel = Vector3(1e-3, 0, 0)
        O.step()
        assert table._is_jammed(table._free_start) == jammed and integrator.failures == 0, way


def wall_with_openings(length, height, openings, seed=None):
    """Blocks of 0.4 x 0.2 m, mu 0.65; in another order with a seed."""
    base, stone = ground(0.65)
    ids = dem.wall(length=length, height=height, size=(0.4, 0.2, 0.2), material=stone, on=base, openings=openings)
    if seed is None:
        return
    layout = [(2 * O.bodies[id].shape.extents, O.bodies[id].state.pos) for id in ids]
    ground(0.65)
    for k in np.random.default_rng(seed).permutation(len(layout)):
        dem.block(tuple(layout[k][0]), stone, center=tuple(layout[k][1]))


@pytest.mark.parametrize("wall", ((1.2, 1.0, []), (1.2, 1.2, [(0.4, 0.4, 0.4, 0.4)]), (1.6, 2.0, [(0.6, 0.6, 0.4, 0.8)]), (2.4, 2.2, [(0.6, 0.6, 1.2, 1.0)])))
def test_symmetric_walls_in_any_order(wall):
    """A wall that is its own mirror image collapses at one multiplier towards x and -x, in whatever order its blocks are listed, within what the
    bisection leaves open."""
    multipliers = []
    for direction in ("x", "-x"):
        for seed in (None, 1):
            wall_with_openings(*wall, seed)
            multipliers.append(found(direction=direction).multiplier)
            assert O.engines[-1].method == "wall" and O.engines[-1].localisedBlocks == 0
    assert max(multipliers) <= (1 + CLOSE) * min(multipliers), multipliers


def test_a_symmetric_wall_in_space():
    """It collapses in its plane, where the planar model has it collapse, towards both sides."""
    multipliers = []
    for options in ({}, {"model": "spatial"}, {"model": "spatial", "direction": "-x"}):
        wall_with_openings(1.2, 1.2, [(0.4, 0.4, 0.4, 0.4)])
        multipliers.append(found(**options).multiplier)
    assert max(multipliers) <= (1 + CLOSE) * min(multipliers), multipliers


def test_a_wall_with_a_window_against_compliant_joints():
    """These have one answer, but for what their stiffness and the speed of the load make of it (5 %). The delay falls with the root of the speed: 0.460, 0.446 and 0.437 at 0.4, 0.2
    and 0.1 a second, towards 0.417."""
    wall_with_openings(1.6, 2.0, [(0.6, 0.6, 0.4, 0.8)])
    result, compliant = found(), collapse_of_compliant_joints((1, 0, 0))
    print(f"rigid blocks {result.multiplier:.4f}, compliant joints {compliant:.3f}")
    assert abs(result.multiplier / compliant - 1) < 0.05


@pytest.mark.parametrize("courses, bound", ((6, 0.64286), (10, 0.58000)))
def test_running_bond(courses, bound):
    """Associative limit analysis gives an upper bound of a block wall's multiplier; low friction: all slides at mu."""
    bond_wall(courses, 0.65)
    result = found()
    assert 0.95 * bound < result.bracket[0] and result.bracket[1] <= bound, result
    assert any(result.joints["opens"])


def test_running_bond_that_slides():
    bond_wall(6, 0.3)
    result = found()
    assert abs(result.multiplier / 0.3 - 1) < CLOSE
    assert not any(result.joints["opens"]) and all(id1 <= 5 < id2 for id1, id2 in marks(result, "slides")), result.joints


@pytest.mark.parametrize("options", ({}, {"load": "turned"}))
def test_out_of_plane(options):
    """The wall turns about the edge of its base at thickness / height."""
    base, stone = ground(0.7)
    ids = dem.wall(3, 2, (0.40, 0.15, 0.20), stone, base)
    result = found(direction="y", **options)
    assert abs(result.multiplier / (0.15 / 0.60) - 1) < CLOSE
    assert O.engines[-1].chosenModel == "spatial"
    assert marks(result, "opens") == [(base, ids[0]), (base, ids[1])], result.joints


def statically_possible(table, direction, mu, sides=16):
    """The largest multiplier that any forces within Coulomb's cones (circumscribed by 16 planes) balance."""
    blocks = [b for b in O.bodies if b.dynamic]
    row, points = {b.id: 6 * k for k, b in enumerate(blocks)}, [(i, j, n, p) for i, j, n, all in table._joints for p in all]
    balance, cones = np.zeros((6 * len(blocks), 3 * len(points) + 1)), np.zeros((sides * len(points), 3 * len(points) + 1))
    turns = 2 * np.pi * np.arange(sides) / sides
    for k, (id1, id2, normal, point) in enumerate(points):
        one = np.roll(normal, 1)  # the normals of this wall are along the axes
        axes = np.array([normal, one, np.cross(normal, one)])
        for id, side in ((id1, -1), (id2, 1)):
            if id in row:
                arm = point - np.array(O.bodies[id].state.pos)
                balance[row[id]:row[id] + 6, 3 * k:3 * k + 3] = side * np.hstack([axes, np.cross(arm, axes)]).T
        cones[sides * k:sides * (k + 1), 3 * k:3 * k + 3] = np.stack([np.full(sides, -mu), np.cos(turns), np.sin(turns)], axis=1)
    weight = np.zeros(6 * len(blocks))
    for body in blocks:
        mass = body.state.mass / blocks[0].state.mass
        balance[row[body.id]:row[body.id] + 3, -1], weight[row[body.id] + 2] = mass * np.array(direction), mass
    found = linprog(-np.eye(3 * len(points) + 1)[-1], cones, np.zeros(len(cones)), balance, weight, [(0, None), (None, None), (None, None)] * len(points) + [(0, None)])
    assert found.status == 0, found.message
    return -found.fun


def collapse_of_compliant_joints(along, penetration=3e-5, rate=0.1):
    """The multiplier at which a block has gone farther than a hundredth of its width, where it grows by `rate` a second: joints with a stiffness
    have one answer, which depends on nothing but the load that has been."""
    O.engines = dem.engines(model="compliant", penetration=penetration)
    field, start, multiplier = O.engines[-1], {b.id: Vector3(b.state.pos) for b in O.bodies}, 0.0
    while max((b.state.pos - start[b.id]).norm() for b in O.bodies) < 2e-3:
        multiplier = max(0, rate * (O.time - 0.1))  # the weight comes to rest first
        field.gravity = 9.81 * (multiplier * Vector3(*along) - Vector3.UnitZ)
        for _ in range(20):
            O.step()
    return multiplier


@pytest.mark.parametrize("direction, along", (("y", (0, 1, 0)), ("-y", (0, -1, 0))))
def test_a_wall_with_a_corner(direction, along):
    """Friction that does not push apart gives way a tenth and more below the largest multiplier that any forces balance. Compliant joints, which give
    by 3e-5 of the width, tell where; under a faster load they would be late."""
    base, stone = ground(0.65)
    dem.return_wall(4, 2, 2, (0.4, 0.2, 0.2), stone, base)
    possible, result = statically_possible(dem.TiltTable(direction=direction), along, 0.65), found(direction=direction)
    assert O.engines[-1].method == "wall"
    compliant = collapse_of_compliant_joints(along)
    print(f"towards {direction}: compliant joints {compliant:.3f}, rigid blocks {result.multiplier:.3f}, forces possible up to {possible:.3f}")
    assert compliant < 0.9 * possible and abs(result.multiplier / compliant - 1) < 0.05


def test_a_wall_with_a_corner_that_slides():
    base, stone = ground(0.2)
    dem.return_wall(4, 2, 2, (0.4, 0.2, 0.2), stone, base)
    result = found(direction="y")
    assert abs(result.multiplier / 0.2 - 1) < CLOSE and not any(result.joints["opens"])


def test_how_far_a_trial_has_moved_the_blocks():
    """No corner has gone farther, and of a block that turns about its edge one has gone as far, but for what half
    its depth adds to its reach: 1 % of that, which is half of the way."""
    base, stone = ground(5.0)
    block = dem.block((0.6, 0.1, 0.4), stone, on=base)
    corners = [Vector3(x, y, z) for x in (-0.3, 0.3) for y in (-0.05, 0.05) for z in (-0.2, 0.2)]
    state, start = O.bodies[block].state, O.bodies[block].state.pos
    table = dem.TiltTable()
    moved = table.trial(2.0).moved
    way = max((state.pos + state.ori * corner - start - corner).norm() for corner in corners)
    assert 1e-3 * 0.1 < way <= moved < 1.01 * way


def test_a_load_that_is_just_too_large_or_too_small():
    """Where the load is too large by 2e-5 a block does not move by `share` within the hold of 3 sqrt(height / gravity), and is told by its speed at
    the first look after it: five steps of a twentieth of the time. Where it is too small by that the block stands, which is seen before."""
    base, stone = ground(5.0)
    dem.block((0.6, 0.1, 0.4), stone, on=base)
    table = dem.TiltTable()
    hold = 3 * math.sqrt(0.4 / 9.81)
    falls, stands = (table.trial(0.6 / 0.4 * (1 + excess)) for excess in (2e-5, -2e-5))
    soon = table.trial(0.6 / 0.4 * (1 + 1e-3))  # by `share`, 2e-3 of 0.1 m, well before: with the square of the time, which grows by a twentieth five times in a look
    assert soon.verdict == "collapse" and soon.time < hold / 2 and 2e-4 < soon.moved < 2 * 2e-4
    assert falls.verdict == "collapse" and falls.moved < 2e-3 * 0.1 and hold <= falls.time < (1 + tilting._LOOK * tilting._SHARE_OF_TIME) * hold
    assert stands.verdict == "rest" and stands.time < hold


@pytest.mark.parametrize("count", (1, 3))
def test_one_block_a_stack_and_a_column(count):
    """Two planes would do, and the pull's is taken; also with gravity that turns and on the slow ramp."""
    for options in ({"direction": "y"}, {"direction": "-y", "load": "turned"}, {"direction": "y", "model": "planar"}):
        base, stone = ground(0.9)
        ids = dem.stack(count, (0.5, 0.3, 1 / count), stone, base)
        result = found(**options)
        assert abs(result.multiplier / 0.3 - 1) < CLOSE and O.engines[-1].chosenModel == "planar", options
        assert O.engines[-1].along == Vector3.UnitY and marks(result, "opens") == [(base, ids[0])], options
    table = dem.TiltTable(direction="y")
    result = table.ramp(progress=False)
    assert -2 * 0.02 * tilting._LOOK * table._dt / table._unit < result.multiplier - 0.3 <= 1e-9


def column():
    """A column of three blocks that stands up to 0.3 along y."""
    base, stone = ground(0.9)
    dem.stack(3, (0.5, 0.3, 1 / 3), stone, base)
    return dem.TiltTable(direction="y")


def test_the_scene_is_put_back_and_the_same_table_finds_the_same_bits_again():
    table = column()
    start = [(b.state.pos, b.state.ori) for b in O.bodies]
    first, again = table.bisect(progress=False), table.bisect(progress=False)
    assert first.bracket == again.bracket and np.array_equal(first.joints, again.joints)
    assert start == [(b.state.pos, b.state.ori) for b in O.bodies] and all(b.state.vel.norm() == 0 == b.state.angVel.norm() for b in O.bodies)


@pytest.fixture
def figures(monkeypatch):
    """Those that have been saved."""
    saved, save = [], Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda figure, *path, **options: saved.append(figure) or save(figure, *path, **options))
    return saved


def test_the_picture(figures, tmp_path):
    """The farthest moved corner is drawn 0.4 of the smallest size, 0.3, away; the joint below, 0.3 wide, as the triangle that its opening makes."""
    result, path = column().bisect(progress=False), str(tmp_path / "mechanism.png")
    result.draw(path)
    with open(path, "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
    figure, = figures
    wedge, = figure.axes[0].patches
    across, up = wedge.get_xy().T
    drawn = 0.4 * 0.3 / result._mechanism._moved.max() * result.joints["opening"].max()
    assert abs(abs(across[1:] @ up[:-1] - across[:-1] @ up[1:]) / (0.3 * drawn) - 1) < 1e-2


def test_the_words_of_a_doubt():
    table = column()
    trial = table.trial(0.5)
    doubtful = table._collapse(0.5, (0.4, 0.5), [tilting.Trial(0.4, "unclear", 0, 0, 0), tilting.Trial(0.5, "collapse", 0, 0, 3)], table._mechanism())
    assert trial.verdict == "collapse" and str(doubtful).count("NOT TO BE TRUSTED") == 2 and "in 3 steps" in str(doubtful) and "method='localised'" in str(doubtful)


def test_the_words_of_a_jam():
    """Only one that decides the multiplier is told of."""
    table = column()
    table.trial(0.5)
    trials = [tilting.Trial(0.4, "rest", 0, 0, 0), tilting.Trial(0.5, "jammed", 2e-4, 0, 0), tilting.Trial(0.6, "jammed", 3e-4, 0, 0)]
    remark, = table._collapse(0.45, (0.4, 0.5), trials, table._mechanism()).remarks
    assert remark == "at 0.5 blocks move by 0.2 mm and jam in joints that were closed before: taken for collapse"


def test_a_picture_of_a_portal(figures, tmp_path):
    """It leaves little room beside the blocks, 0.15 of their extent, however long one is; its legend hides none; a joint seen face on is an outline."""
    base, stone = ground(0.9)
    for place in (-0.8, 0.8):
        dem.block((0.2, 0.3, 1.0), stone, center=(place, 0, 0.5))
    dem.block((1.8, 0.3, 0.2), stone, center=(0, 0, 1.1))
    back = dem.block((0.2, 0.3, 1.0), stone, center=(0.8, 0.3, 0.5))  # behind a column: their joint is seen face on
    table, end_on = dem.TiltTable(model="spatial"), dem.TiltTable(direction="y", model="spatial")
    O.bodies[back].state.pos += Vector3(0, 0.001, 0)
    for one in (table, end_on):
        one._collapse(0.5, (0.4, 0.5), [], one._mechanism()).draw(str(tmp_path / "portal.png"))
    along_x, along_y = figures
    # Along x: the base, the far column, the beam, the near columns, of which the one that has moved is drawn 0.4 of 0.2 m away.
    paths = [path.vertices for path in along_y.axes[0].collections[0].get_paths()]
    assert np.allclose([path[:, 1].max() for path in paths], [0, 1, 1.2, 1, 1], atol=1e-6), paths
    assert np.allclose([paths[-1][:, 0].min(), paths[-1][:, 0].max()], np.array([0.15, 0.45]) + 0.4 * 0.2, atol=1e-6), paths[-1]
    O.bodies[1].state.pos += Vector3(0, 4e-5, 0)  # a 25th of that
    assert table._mechanism().moving() == [back]
    O.bodies[1].state.pos += Vector3(0, 2e-5, 0)
    assert table._mechanism().moving() == [1, back]
    axes, = along_x.axes
    assert axes.get_legend().get_window_extent().x0 >= axes.get_window_extent().x1 - 1
    assert np.allclose(axes.get_xlim(), (-0.9 - 0.27, 0.9 + 0.27), atol=1e-6) and np.allclose(axes.get_ylim(), (-0.27, 1.2 + 0.27), atol=1e-6)
    outline = max((patch.get_xy() for patch in axes.patches), key=lambda corners: np.ptp(corners[:, 1]))
    assert np.allclose([outline.min(axis=0), outline.max(axis=0)], [[0.7, 0], [0.9, 1.0]], atol=1e-6) and len(outline) == 5
    assert all(np.abs(np.diff(outline, axis=0)).min(axis=1) < 1e-6)  # four upright and level sides


def test_a_picture_of_a_joint_that_slides(figures, tmp_path):
    """It is a line on the side of its first block."""
    base, stone = ground(0.3)
    block = dem.block((0.6, 0.5, 0.4), stone, on=base)
    table = dem.TiltTable()
    O.bodies[block].state.pos += Vector3(0.001, 0, 0)
    table._collapse(0.3, (0.3, 0.3), [], table._mechanism()).draw(str(tmp_path / "slides.png"))
    line, = (line.get_xydata() for line in figures[0].axes[0].lines if len(line.get_xydata()))
    assert np.allclose(np.sort(line[:, 0]), [-0.3, 0.3], atol=1e-6) and np.allclose(line[:, 1], 0, atol=1e-6) and not figures[0].axes[0].patches, line


def test_the_title_counts_what_is_drawn(figures, tmp_path):
    """A joint that opens and slides is one red patch and no line."""
    base, stone = ground(0.3)
    lower = dem.block((0.6, 0.5, 0.4), stone, on=base)
    upper = dem.block((0.6, 0.5, 0.4), stone, on=lower)
    table = dem.TiltTable()
    dem.tilt(upper, 0.01)
    for id, way in ((lower, 0.002), (upper, 0.006)):
        O.bodies[id].state.pos += Vector3(way, 0, 0)
    table._collapse(0.3, (0.3, 0.3), [], table._mechanism()).draw(str(tmp_path / "both.png"))
    both = figures[0].axes[0]
    assert len(both.patches) == 1 and sum(len(line.get_xydata()) > 0 for line in both.lines) == 1
    assert "2 blocks move; 1 joints open (1 of them slide too), 1 slide closed" in both.get_title()


def test_the_slip_of_a_joint_on_which_a_block_turns():
    """The corner that goes farthest has the slip, whatever gaps of 1e-9 m its corners have."""
    base, stone = ground(0.5)
    block = dem.block((0.6, 0.5, 0.4), stone, on=base)
    table = dem.TiltTable(model="spatial")
    for lean in (Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)):
        turned, corner = Quaternion(lean, 1e-8) * Quaternion(Vector3(0, 0, 1), 1e-3), Vector3(0.3, 0.25, 0)
        O.bodies[block].state.ori, O.bodies[block].state.pos = turned, corner + turned * (Vector3(0, 0, 0.2) - corner)
        slip = table._mechanism().joints()["slip"][0]
        assert abs(slip / (1e-3 * math.hypot(0.6, 0.5)) - 1) < 1e-3, lean


def test_options_that_cannot_be_meant():
    refuses(lambda: dem.TiltTable(direction="z"), "direction", "'z'")
    refuses(lambda: dem.TiltTable(load="angle"), "load", "'turned'")
    refuses(lambda: dem.TiltTable(model="compliant"), "model")
    refuses(lambda: dem.TiltTable(method="walls"), "method = 'walls'", "localised, wall")
    refuses(lambda: dem.TiltTable(hold=0), "hold = 0", "positive")


def test_multipliers_that_cannot_be_meant():
    base, stone = ground(0.5)
    dem.block((0.6, 0.5, 0.4), stone, on=base)
    table = dem.TiltTable()
    refuses(lambda: table.bisect(tolerance=1), "tolerance = 1")
    for bad in (-1, 30, 40):
        refuses(lambda: table.bisect(lower=bad), f"lower = {bad}", "above 0 and below 30")
    refuses(lambda: table.ramp(start=40), "start = 40", "from 0 to below 30")
    refuses(lambda: table.ramp(rate=0), "rate = 0")
    refuses(lambda: table.trial("a"), "multiplier = 'a'", "number")
    refuses(lambda: table.trial(math.nan), "multiplier = nan", "from -30 to 30")
    refuses(lambda: table.trial(54), "multiplier = 54", "from -30 to 30")


def test_scenes_that_cannot_be_tilted():
    base, stone = ground(0.5)
    refuses(lambda: dem.TiltTable(), "no free block")
    block = dem.block((0.6, 0.5, 0.4), stone, on=base)
    O.bodies[block].state.pos += Vector3(2.01, 0, 0)  # its centre is beyond the edge of the base
    refuses(lambda: dem.TiltTable().bisect(progress=False), "do not stand")
    O.bodies[block].state.pos = Vector3(0, 0, 0.2)
    for side in (-1, 1):
        held = dem.block((0.6, 0.5, 0.4), stone, center=(0.6 * side, 0, 0.2))
        O.bodies[held].dynamic = False
    refuses(lambda: dem.TiltTable().bisect(progress=False), "held on all sides")
    refuses(lambda: dem.TiltTable().ramp(rate=2, progress=False), "held on all sides")


def test_ramps():
    base, stone = ground(0.5)
    dem.block((0.6, 0.5, 0.4), stone, on=base)
    refuses(lambda: dem.TiltTable().ramp(start=0.6, progress=False), "start = 0.6", "do not stand")
    fast, slow = (dem.TiltTable().ramp(rate=rate, progress=False) for rate in (20, 0.02))
    assert fast.bracket[0] < 0.5 < fast.bracket[1] and "smaller rate" in fast.doubts[0] and not slow.doubts, fast


@pytest.mark.parametrize("hold", (0.01, 0.03))
def test_a_hold_shorter_than_a_look(hold):
    # shorter than a look
    base, stone = ground(0.5)
    dem.block((0.6, 0.5, 0.4), stone, on=base)
    assert abs(dem.TiltTable(hold=hold).bisect(progress=False).multiplier / 0.5 - 1) < CLOSE


def test_stiff_joints():
    base, stone = ground(0.5, normalStiffness=1e9)
    dem.block((0.6, 0.5, 0.4), stone, on=base)
    refuses(lambda: dem.TiltTable(), "rigid", "stiffness")
    assert abs(dem.TiltTable(model="planar").bisect(progress=False).multiplier / 0.5 - 1) < CLOSE


@pytest.mark.parametrize("direction, multiplier", (((1, 1), math.sqrt(2) * 0.2 / 0.8), ((-2, 0), 0.2 / 0.8), ((math.cos(0.5), math.sin(0.5)), 0.2 / 0.8 / math.cos(0.5))))
def test_any_direction_in_plan(direction, multiplier):
    """A block of 0.4 x 0.4 x 1.6 m turns over its corner, at half the diagonal over half the height, where it is pulled along it; else over the edge that it is pulled
    towards most, at half the width over half the height and the share of the pull across that edge."""
    base, stone = ground(2.0)
    dem.block((0.4, 0.4, 1.6), stone, on=base)
    assert abs(found(direction=direction).multiplier / multiplier - 1) < CLOSE


def test_the_report_page(tmp_path):
    result, path = column().bisect(progress=False), tmp_path / "tilting.html"
    result.report(path, title="a column")
    page = path.read_text(encoding="utf-8")
    for text in ("a column", f"Collapse multiplier {result.multiplier:.4g}", "<svg", "Table of trials", "towards y", "0 – 1", "Mechanism"):
        assert text in page, text
    assert page.count("<tr>") >= len(result.trials) and "NaN" not in page and 'id="view"' not in page
    refuses(lambda: result.report(tmp_path / "tilting.txt"), ".html")
    for direction in ((0, 0), (1, 0, 0), (math.nan, 1), 3):
        refuses(lambda: dem.TiltTable(direction=direction), "direction")
