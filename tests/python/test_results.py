"""Openings, slips, drifts, falls and reports of histories made by hand."""

import math

import numpy as np
import pytest
from histories import ROUND, UPRIGHT, about_edge, history, rocking, turn
from masonry import _pose, results


@pytest.mark.parametrize("axis, width", [((0, 1, 0), 0.6), ((1, 0, 0), 0.5)])
@pytest.mark.parametrize("frame", [UPRIGHT, turn(0.7, (0, 0, 1)), turn(0.2, (1, 0, 0))])
def test_a_rocking_block_opens_its_joint_by_2b_sin_angle(axis, width, frame):
    angles = np.array([0, 0.05, -0.11, 0.02])
    h = rocking(angles, axis, shift=(0.3, 0.1, 0), frame=np.asarray(frame))
    for k, angle in enumerate(angles):
        joint, = results.joints(h, time=h.time[k])
        assert abs(joint["opening"] - width * math.sin(abs(angle))) < ROUND
        assert joint["slip"] < ROUND  # it turns about its edge
    most, = results.joints(h)
    assert (most["id1"], most["id2"]) == (10, 11) and abs(most["area"] - 0.3) < ROUND
    assert abs(most["opening"] - width * math.sin(0.11)) < ROUND and most["opening_time"] == h.time[2]
    assert np.allclose(h.rotation[:, 1], np.abs(angles), rtol=0, atol=ROUND) and (h.rotation[:, 0] == 0).all()


def test_the_end_of_a_run_between_two_samples():
    """Times up to the end of the run have the last sample, but not those long after a recorder has stopped."""
    for end, latest in ((1.0, "1"), (1.3, "1.3"), (9.0, "1.5")):
        h = history([[2, 2, 0.2], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [0, 0, 0.2]]] * 3, end=end)
        assert h.sample(min(end, 1.5)) == 2
        with pytest.raises(ValueError, match=f"^time = 9.1: must be from 0 to {latest} s"):
            h.sample(9.1)


def test_a_sliding_block_slips_by_its_way_over_the_base():
    way = np.array([0, 0.04, 0.07, 0.05])
    base = np.array([[0, 0, -0.1], [1, 0, -0.1], [2, 0.5, -0.1], [0, 0, -0.1]])
    block = base + [0, 0, 0.3] + way[:, None] * [0.6, 0.8, 0]
    h = history([[2, 2, 0.2], [0.6, 0.5, 0.4]], np.stack([base, block], axis=1))
    most, = results.joints(h)
    assert abs(most["slip"] - 0.07) < ROUND and most["slip_time"] == h.time[2] and most["opening"] < ROUND
    assert abs(results.joints(h, time=1.4)["slip"][0] - 0.05) < ROUND
    assert abs(h.drift().max() - 0.07 / 0.4) < ROUND


def test_a_block_that_turns_on_its_joint_slips_by_the_corner_that_goes_farthest():
    """Gaps of 1e-8 m, as solvers leave them, do not choose the corner."""
    for still in ([0.3, 0.25, 0], [-0.3, 0.25, 0]):
        for lean in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
            rotation = _pose.product(turn(1e-7, lean), turn(0.1, (0, 0, 1)))
            block = about_edge([0, 0, 1.0], np.array(still), rotation)
            h = history([[2, 2, 0.2], [0.6, 0.5, 2]], [[[0, 0, -0.1], [0, 0, 1]], [[0, 0, -0.1], block]],
                        np.array([[UPRIGHT, UPRIGHT], [UPRIGHT, rotation]]))
            for joint in (results.joints(h)[0], results.joints(h, time=0.5)[0]):
                assert abs(joint["slip"] - 2 * math.sin(0.05) * math.hypot(0.6, 0.5)) < 1e-6, (still, lean, joint)


def test_what_moves_in_flight_is_no_slip():
    h = history([[2, 2, 0.2], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [x, 0, 0.2 + z]] for x, z in ((0, 0), (0.01, 0), (0.5, 0.3), (0.02, 0))])
    most, = results.joints(h)
    assert abs(most["slip"] - 0.02) < ROUND and abs(most["opening"] - 0.3) < ROUND
    # Nor is it where the block has slid off, and lies as high as the joint once was.
    h = history([[1, 1, 0.2], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [x, 0, 0.2]] for x in (0, 0.79, 0.81, 3.0)])
    assert abs(results.joints(h)["slip"][0] - 0.79) < ROUND


def test_a_joint_counts_until_one_of_its_blocks_has_fallen():
    """The upper of two blocks slides, opens its joint by 0.1 m, comes back, and falls: from then on it is 0.3 m lower, and 7 m away in the end."""
    places = [[0, 0.6], [0.02, 0.7], [0.03, 0.6], [0.5, 0.3], [7.0, -3.0]]
    h = history([[4, 4, 0.2], [0.6, 0.5, 0.4], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [0, 0, 0.2], [x, 0, z]] for x, z in places])
    assert results.fallen(h)[:, 2].tolist() == [False] * 3 + [True] * 2
    lower, upper = results.joints(h)
    assert abs(upper["opening"] - 0.1) < ROUND and upper["opening_time"] == 0.5 and abs(upper["slip"] - 0.03) < ROUND and lower["opening"] == 0
    for sample, counts in enumerate((True, True, True, False, False)):
        at = results.joints(h, time=h.time[sample])
        assert np.isfinite(at["opening"]).tolist() == [True, counts] and at["opening"][0] == 0
    # A block that leans beyond its critical angle and comes back has not fallen; one that leans from the start, as in an arch, is a block like any other.
    critical = math.atan(0.3)
    leaning = results.joints(rocking([0, 1.2 * critical, 0.5 * critical]))
    assert abs(leaning["opening"][0] - 0.6 * math.sin(1.2 * critical)) < ROUND
    slope = turn(0.5, (0, 1, 0))
    arch = rocking([0, 0.1], frame=slope)
    assert results.fallen(arch)[:, 1].all() and abs(results.joints(arch)["opening"][0] - 0.6 * math.sin(0.1)) < ROUND


def test_joints_are_the_faces_that_touch():
    # Side by side with a gap, beside each other, across a corner, lying in the air; a square on a square turned by 45 degrees: an octagon.
    size = np.array([[4, 4, 0.2], [1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]])
    place = [[[0, 0, -0.1], [-1.5, 0, 0.5], [-0.5, 0, 0.5], [1.0, 0, 0.5], [1.0, 0, 1.5]]]
    turned = np.tile(UPRIGHT, (1, 5, 1))
    turned[0, 4] = turn(math.pi / 4, (0, 0, 1))
    table = results.joints(history(size, place, turned))
    assert [(j["id1"], j["id2"]) for j in table] == [(10, 11), (10, 12), (10, 13), (11, 12), (13, 14)]
    assert np.allclose(table["area"], [1, 1, 1, 1, 2 * (math.sqrt(2) - 1)], rtol=0, atol=1e-12)
    assert np.allclose(table["normal"], [[0, 0, 1]] * 3 + [[1, 0, 0], [0, 0, 1]], rtol=0, atol=1e-12)
    assert np.allclose(table["center"], [[-1.5, 0, 0], [-0.5, 0, 0], [1, 0, 0], [-1, 0, 0.5], [1, 0, 1]], rtol=0, atol=1e-12)
    assert len(results.joints(rocking([2 * math.atan(0.3), 0]))) == 0  # on its edge, its centre as high as that of a block that stands
    for lap, count in ((0, 2), (0.9e-6, 2), (1.1e-6, 3)):  # the two blocks share an edge: no joint; nor is less than a millionth of a face
        corner = history(size[:3], [[[0, 0, -0.1], [-1, 0, 0.5], [0, 1 - lap, 0.5]]])
        assert len(results.joints(corner)) == count, lap


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0.6, 0, 0.8), (-0.48, 0.8, 0.36)])
def test_joints_are_the_same_from_every_side(axis):
    """Bricks in running bond, whose corners lie on edges and corners of others up to round-off: the whole scene turned."""
    place = np.array([[0, 0, -0.1]] + [[0.4 * x + 0.2 * (z % 2), 0, 0.1 + 0.2 * z] for z in range(4) for x in range(-2, 3)])
    sizes = np.array([[4, 2, 0.2]] + [[0.4, 0.2, 0.2]] * 20)
    upright, frame = results.joints(history(sizes, place[None])), turn(1.1, axis)
    table = results.joints(history(sizes, (place @ _pose.matrices(frame).T)[None], np.tile(frame, (1, 21, 1))))
    assert len(table) == 5 + 16 + 27 and np.array_equal(table[["id1", "id2"]], upright[["id1", "id2"]])
    assert np.allclose(table["area"], upright["area"], rtol=0, atol=1e-12)
    for name in ("center", "normal"):
        assert np.allclose(table[name], upright[name] @ _pose.matrices(frame).T, rtol=0, atol=1e-12), name


@pytest.mark.parametrize("posture", [UPRIGHT, turn(0.4, (1, 0, 0))])
def test_movement_is_relative_to_the_base_also_where_it_turns(posture):
    frame = turn(0.3, (0, 0, 1))
    start = rocking([0.0, 0.1], frame=np.asarray(posture))
    moved = np.stack([start.position[0], start.position[1] @ _pose.matrices(frame).T + [3, 2, 1]])
    turned = np.stack([start.orientation[0], _pose.product(frame, start.orientation[1])])
    h = history(start.sizes, moved, turned)
    assert np.allclose(h.displacement, start.displacement, rtol=0, atol=1e-12)
    assert np.allclose(h.rotation, start.rotation, rtol=0, atol=1e-7) and abs(h.rotation[1, 1] - 0.1) < 1e-12
    assert np.allclose(results.joints(h)["opening"], results.joints(start)["opening"], rtol=0, atol=1e-12)


def test_fallen_is_lower_by_half_a_height_or_beyond_the_critical_angle():
    critical = math.atan(0.6 / 2)
    h = rocking([0, 0.99 * critical, 1.01 * critical, 0.5 * critical, 1.2 * critical, 1.4 * critical])
    assert results.fallen(h)[:, 1].tolist() == [False, False, True, False, True, True] and not results.fallen(h)[:, 0].any()
    report = results.collapse(h, excursion=0.1)
    assert report.collapsed and report.time == 2.0 and report.fallen.tolist() == [11]  # it came back from the first excursion
    assert report.peak_drift == h.drift()[2] and report.peak_drift_time == 1.0 and report.first_excursion == h.time[h.drift() >= 0.1][0]
    assert report.residual_drift == h.drift()[-1]
    assert results.collapse(h, excursion=h.drift()[2]).first_excursion == 1.0  # reached, not exceeded
    assert "collapsed at 2 s" in str(report) and report.numbers()["fallen"] == 1
    assert np.allclose(h.lean[:, 1], h.rotation[:, 1], rtol=0, atol=1e-12)
    for axis, critical in (((1, 0, 0), math.atan(0.5 / 2)), (np.array([-0.5, 0.6, 0]) / math.hypot(0.5, 0.6), math.atan(math.hypot(0.5, 0.6) / 2))):
        assert results.fallen(rocking([0, 0.999 * critical, 1.001 * critical, 3.0], axis))[:, 1].tolist() == [False, False, True, True]
    # A slab that lies on its side from the start: its height is the size that stands upright; whatever the round-off of its quaternion.
    for yaw in range(50):
        turned = _pose.product(turn(yaw, (0, 0, 1)), turn(math.pi / 2, (0, 1, 0)))
        lying = history([[9, 9, 0.2], [0.6, 0.5, 0.2]], [[[0, 0, -0.1], [0, 0, 0.3]]] * 2, np.array([[UPRIGHT, turned]] * 2))
        assert not results.fallen(lying).any() and (lying.lean < 1e-7).all(), yaw
    stands = results.collapse(rocking([0, 0.1, 0.05]))
    assert not stands.collapsed and math.isnan(stands.time) and len(stands.fallen) == 0 and "stands" in str(stands)
    for drop, lies in ((0.19, False), (0.21, True)):
        h = history([[2, 2, 0.2], [0.6, 0.5, 0.4]], [[[0, 0, -0.1], [0, 0, 0.2]], [[0, 0, 0.9], [2, 0, 1.2 - drop]]])
        assert results.collapse(h).collapsed == lies  # the base has gone up with it
    # Two of three blocks are a collapse: the time is that of the second.
    z = np.array([[0.2, 0.6, 1.0], [0.2, 0.6, 0.2], [0.2, 0.2, 0.2]])
    h = history([[2, 2, 0.2]] + [[0.6, 0.5, 0.4]] * 3, [[[0, 0, -0.1], *([0.1 * k, 0, v] for v in row)] for k, row in enumerate(z)])
    assert results.collapse(h).time == 0.5 and results.collapse(h, blocks=2).time == 1.0 and not results.collapse(h, blocks=3).collapsed
    assert results.collapse(h).fallen.tolist() == [13, 12]
    # The peak drift is that before the collapse: by the second sample the top has moved by 0.1 of a height of 1.2.
    assert results.collapse(h).peak_drift == 0 and abs(results.collapse(h, blocks=2).peak_drift - 0.1 / 1.2) < ROUND


def test_an_erased_block_has_fallen_and_is_drawn_no_more(tmp_path):
    h = rocking([0, 0.1, 0.1])
    h.position[2, 1] = h.orientation[2, 1] = np.nan
    assert results.fallen(h)[:, 1].tolist() == [False, False, True]
    assert abs(results.joints(h)["opening"][0] - 0.6 * math.sin(0.1)) < ROUND
    results.draw(h, tmp_path / "shape.png", time=1.0)
    assert b'NumberOfCells="1"' in (results.write_paraview(h, tmp_path / "h.pvd").parent / "h/h_000002.vtu").read_bytes()


@pytest.mark.parametrize("frame", [UPRIGHT, turn(0.2, (1, 0, 0))])
def test_a_base_that_is_erased_stays_where_it_was(frame, tmp_path):
    h, kept = (rocking([0, 0.1, 0.1, 0.1], frame=np.asarray(frame)) for _ in range(2))
    h.position[2:, 0] = h.orientation[2:, 0] = np.nan
    report = results.collapse(h)
    assert np.array_equal(h.drift(), kept.drift()) and np.array_equal(h.displacement[:, 1], kept.displacement[:, 1])
    assert not report.collapsed and report.residual_drift == kept.drift()[-1]
    results.draw(h, tmp_path / "shape.png")


def test_a_wall_without_its_base_says_so():
    h = rocking([0, 0.1], shift=(0.4, 0, 0))
    whole, alone = results.collapse(h), results.collapse(results.WallHistory(h.time, h.ids[1:], h.sizes[1:], h.free[1:], h.position[:, 1:], h.orientation[:, 1:]))
    assert whole.from_base and "NOT RELATIVE" not in str(whole) and not alone.from_base and "NOT RELATIVE TO THE BASE" in str(alone)


TWO_BASES = [[2, 2, 0.2], [2, 2, 0.2], [0.6, 0.5, 1], [0.6, 0.5, 0.5], [0.6, 0.5, 0.5]]


def on_two_bases(apart=4.0, order=(0, 1, 2, 3, 4), turned=False):
    """A block on the base at x = 0, which goes along x, and two on each other on the base at x = `apart`, which goes along -y (turned: and turns about z
    by 0.3). Seen from their own base, the first goes by 0.02 m and the upper of the two by 0.03 m along x. order: in which the history has them."""
    start = np.array([[0, 0, -0.1], [apart, 0, -0.1], [0, 0, 0.5], [apart, 0, 0.25], [apart, 0, 0.75]])
    moved = start + np.array([[0, 0, 0], [0, 0, 0], [0.02, 0, 0], [0, 0, 0], [0.03, 0, 0]])
    spin = turn(0.3 if turned else 0, (0, 0, 1))
    turns = np.array([UPRIGHT, spin, UPRIGHT, spin, spin])
    second = np.array([apart, 0, 0])
    moved[[1, 3, 4]] = second + (moved[[1, 3, 4]] - second) @ _pose.matrices(spin).T + [0, -5, 0]
    moved[[0, 2]] += [7, 0, 0]
    order = list(order)
    return history(np.array(TWO_BASES)[order], np.array([start, moved])[:, order], np.array([np.tile(UPRIGHT, (5, 1)), turns])[:, order],
                   free=np.array([False, False, True, True, True])[order])


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (1, 0, 2, 3, 4), (4, 3, 1, 2, 0)])
@pytest.mark.parametrize("apart, turned", [(4.0, False), (4.0, True), (0.6, False)])  # the last: the blocks touch side by side, which joins no structures
def test_each_structure_is_measured_against_its_own_base(order, apart, turned):
    h = on_two_bases(apart, order, turned)
    if apart < 2:  # their bases would overlap
        h = history(np.where(np.array(TWO_BASES)[list(order)] == 2, 0.6, np.array(TWO_BASES)[list(order)]), h.position, h.orientation, free=h.free)
    row = [order.index(k) for k in range(5)]
    assert h.bases.tolist() == [row[own] for own in np.array([0, 1, 0, 1, 1])[list(order)]]
    assert np.allclose(h.displacement[1, row], [[0, 0, 0], [0, 0, 0], [0.02, 0, 0], [0, 0, 0], [0.03, 0, 0]], rtol=0, atol=1e-12)
    assert (h.rotation[1] < 1e-7).all() and abs(h.drift()[1] - 0.03) < 1e-12
    report = results.collapse(h)
    assert not report.collapsed and report.from_base and abs(report.peak_drift - 0.03) < 1e-12


def test_the_base_of_what_stands_on_several_bodies_on_none_or_against_one():
    def bases(*bodies):
        sizes, places, free = zip(*bodies)
        return history(sizes, [places], free=free).bases.tolist()

    slab, cube = (2, 2, 0.2), (1, 1, 1)
    left, right = (slab, (-1.5, 0, -0.1), False), (slab, (1.5, 0, -0.1), False)
    piers = [(cube, (x, 0, 0.5), True) for x in (-1.5, 1.5)]
    lintel = ((4, 1, 0.2), (0, 0, 1.1), True)
    assert bases(left, right, *piers) == [0, 1, 0, 1]
    assert bases(left, right, *piers, lintel) == [0, 0, 0, 0, 0]  # one structure: seen from one base, so also the other base
    pusher = (cube, (-2.5, 0, 0.5), False)
    assert bases(pusher, left, piers[0]) == [1, 1, 1]  # it only touches
    assert bases(((9, 9, 1), (0, 0, -0.7), False), left, piers[0]) == [1, 1, 1]  # the ground under the base
    assert bases((cube, (9, 0, 0.5), False), left, right, piers[1], (cube, (1.5, 0, 3), True)) == [2, 2, 2, 2, 2]  # those that touch nothing: the nearest block's
    assert bases(left, right, (cube, (1.5, 0, 3), True)) == [0, 1, 1]  # none stands: the nearest prescribed body
    hung = [(cube, (k, 0, 5), k not in (0, 4)) for k in range(5)]  # a row between two jaws
    assert bases(*hung) == [0, 0, 0, 0, 0] and bases(piers[0]) == [-1]
    assert bases(left, piers[0], *hung) == [0, 0, 2, 2, 2, 2, 2]  # whatever stands elsewhere


def test_a_base_that_is_erased_leaves_the_other_structure_alone():
    h, kept = on_two_bases(), on_two_bases()
    h.position[1, 1] = h.orientation[1, 1] = np.nan  # its structure goes by 5 m where it stood
    assert np.array_equal(h.displacement[1, 2], kept.displacement[1, 2]) and abs(h.drift()[1] - math.hypot(5, 0.03)) < 1e-12


def test_drift_is_that_of_the_top():
    place = [[[0, 0, -0.1], [0, 0, 0.2], [0, 0, 0.6], [0.9, 0, 0.5]], [[1, 0, -0.1], [1.3, 0, 0.2], [1.01, 0.02, 0.6], [1.9, 0.05, 0.5]]]
    h = history([[2, 2, 0.2], [0.6, 0.5, 0.4], [0.6, 0.5, 0.4], [0.3, 0.5, 1.0]], place)
    # Height 1: of the slender pillar; the upper block ends at 0.8, which is its half height below it: no longer top.
    assert abs(h.drift()[1] - 0.05) < ROUND
    h = history([[2, 2, 0.2], [0.6, 0.5, 0.4], [0.6, 0.5, 0.4]], np.array(place)[:, :3])
    assert abs(h.drift()[1] - math.hypot(0.01, 0.02) / 0.8) < ROUND
    # Higher by 0.05 it is, though the pillar alone is the highest: it ends 0.15 below, and half its height is 0.2.
    raised = np.array(place)
    raised[:, 2] += [[0, 0, 0.05], [0.06, 0, 0.05]]
    h = history([[2, 2, 0.2], [0.6, 0.5, 0.4], [0.6, 0.5, 0.4], [0.3, 0.5, 1.0]], raised)
    assert abs(h.drift()[1] - math.hypot(0.07, 0.02)) < ROUND


@pytest.mark.parametrize("posture", [UPRIGHT, turn(math.pi, (1, 0, 0)), turn(math.pi / 2, (0, 1, 0))])
def test_a_pier_drifts_as_a_block_that_turns_alike(posture):
    """Width w and height 1; about its lower edge by an angle t the middle of its top goes sin(t) + w (1 - cos(t)) / 2 sideways."""
    width, angles = 0.25, (0, 0.1, -0.3)
    for blocks in (1, 4):
        size = np.abs(_pose.matrices(posture).T @ [width, 0.5, 1 / blocks])  # along the block's own axes, whichever is upright
        centers = [[0, 0, (k + 0.5) / blocks] for k in range(blocks)]
        place = [[about_edge(c, [math.copysign(width / 2, t), 0, 0], turn(t, (0, 1, 0))) for c in centers] for t in angles]
        turned = [[_pose.product(turn(t, (0, 1, 0)), posture)] * blocks for t in angles]
        drift = history([size] * blocks, place, np.array(turned), free=[True] * blocks).drift()
        assert np.allclose(drift, [math.sin(abs(t)) + width / 2 * (1 - math.cos(t)) for t in angles], rtol=0, atol=ROUND)


def test_energy_error_is_what_the_balance_lacks():
    energies = np.array([[0, 10, 0, 0, 0, 0, 0], [3, 11, 0.5, 1, 0.25, 2, 8.0], [1, 10, 0, 2, 1, 3, 6.5]])
    h = rocking([0, 0.1, 0], )
    h = history(h.sizes, h.position, h.orientation, energies=energies)
    assert np.allclose(h.energy["error"], [0, 17.75 - 8 - 10, 17 - 6.5 - 10], rtol=0, atol=ROUND)
    assert h.energy["impactDissip"].tolist() == [0, 2, 3] and np.isnan(rocking([0.0]).energy["error"]).all()


def test_bad_input_is_refused(tmp_path):
    h = rocking([0, 0.1])
    good = dict(time=[0, 1], ids=[1, 2], sizes=h.sizes, free=h.free, position=h.position, orientation=h.orientation)
    results.WallHistory(**good)
    for name, value, word in (("sizes", np.ones((3, 3)), "sizes has the shape"), ("time", [1, 1], "must increase"), ("free", [False, False], "free blocks"),
                              ("position", h.position * np.nan, "finite"), ("energies", np.ones((2, 3)), "energies has the shape")):
        with pytest.raises(ValueError, match=word):
            results.WallHistory(**{**good, name: value})
    path = tmp_path / "x.gif"
    for act, word in ((lambda: h.sample(7), "time = 7"), (lambda: results.collapse(h, blocks=2), "blocks = 2"),
                      (lambda: results.collapse(h, blocks=math.nan), "blocks = nan: must be"),
                      (lambda: results.collapse(h, blocks="two"), "blocks = 'two'"), (lambda: results.collapse(h, excursion="a"), "excursion = 'a'"),
                      (lambda: results.draw(h, path, view="front"), "view = 'front'"), (lambda: results.draw(h, path, view=(1, 0)), r"view = \(1, 0\): must be three"),
                      (lambda: h.to_csv("h.txt"), "must end in .csv"), (lambda: h.to_csv(tmp_path / "h.csv", ids=12), r"ids: 12 is no block .* among \[10, 11\]"), (lambda: results.collapse(h, excursion=0), "excursion = 0"), (lambda: h.save("h.txt"), "must end in .npz"),
                      (lambda: results.draw(h, path, color="red"), "color = 'red'"), (lambda: results.draw(h, path, enlarge=-1), "enlarge = -1"),
                      (lambda: results.draw(h, path, view=(0, 0, 0)), "view"), (lambda: results.draw_energy(h, path), "no energies"),
                      (lambda: results.film(h, "h.avi"), "must end in .gif or .mp4"), (lambda: results.film(h, path, frames_per_second=100), "frames_per_second"),
                      (lambda: results.film(h, path, speed=0), "speed = 0"), (lambda: results.film(h, path, start=0.5, end=0.0), "start"),
                      (lambda: results.write_paraview(h, "h.vtu"), "must end in .pvd"), (lambda: results.write_paraview(h, tmp_path / "h.pvd", every=0), "every = 0"),
                      (lambda: results.write_paraview(h, tmp_path / "h.pvd", every="a"), "every = 'a'"),
                      (lambda: h.sample("1"), "time = '1': must be a number"), (lambda: results.draw(h, path, enlarge="a"), "enlarge = 'a': must be a number"),
                      (lambda: results.film(h, path, frames_per_second="a"), "frames_per_second = 'a': must be a number"),
                      (lambda: results.film(h, path, speed="a"), "speed = 'a': must be a number"),
                      (lambda: results.film(h, path, start=-2), "^start = -2: must be from 0 to 0.5 s"), (lambda: results.film(h, path, end="x"), "^end = 'x'")):
        with pytest.raises(ValueError, match=word):
            act()
    for act in (results.collapse, results.fallen, results.joints, lambda h: results.draw(h, path), lambda h: results.draw_joints(h, path),
                lambda h: results.draw_energy(h, path), lambda h: results.film(h, path), lambda h: results.write_paraview(h, tmp_path / "h.pvd")):
        with pytest.raises(ValueError, match="history = 'recorder': must be a WallHistory"):
            act("recorder")


def test_an_erased_block_on_top_leaves_the_drift_of_the_others():
    place = [[[0, 0, -0.1], [0, 0, 0.2], [1, 0, 0.2]], [[0, 0, -0.1], [0.04, 0, 0.2], [1, 0, 0.2]]]
    h = history([[9, 9, 0.2], [0.6, 0.5, 0.4], [0.6, 0.5, 0.4]], place)
    h.position[1, 2] = h.orientation[1, 2] = np.nan
    assert abs(h.drift()[1] - 0.04 / 0.4) < ROUND


def test_a_quaternion_and_its_negative_are_one_rotation():
    h, other = rocking([0, 0.1, 0.2]), rocking([0, 0.1, 0.2])
    other.orientation[1:, 1] *= -1
    assert np.allclose(other.rotation, h.rotation, rtol=0, atol=ROUND)


def test_an_excursion_may_be_first_exceeded_after_collapse():
    critical = math.atan(0.3)
    h = rocking([0, 0.99 * critical, 1.2 * critical, 1.4 * critical])
    report = results.collapse(h, excursion=(h.drift()[2] + h.drift()[3]) / 2)
    assert report.collapsed and report.time == 1.0 and report.first_excursion == 1.5


def test_bases_that_touch_have_no_joint():
    h = history([[2, 2, 0.2], [2, 2, 0.2], [1, 1, 1]], [[[0, 0, -0.3], [0, 0, -0.1], [0, 0, 0.5]]], free=[False, False, True])
    assert [(j["id1"], j["id2"]) for j in results.joints(h)] == [(11, 12)]


def test_a_report_says_how_much_of_the_motion_has_been_run(tmp_path):
    """Samples at 0, 0.5, 1 s; the motion lasts from `start` to `last`; the run has come to `end`."""
    def upright(**given):
        return history([[2, 2, 0.2], [0.6, 0.5, 2]], [[[0, 0, -0.1], [0, 0, 1.0]]] * 3, **given)

    for motion, end, share, verdict, words in (
            ((0, 10), None, 0.1, "unfinished", "1 of 10 s of the motion"), ((0.5, 10.5), 1.43, 0.093, "unfinished", "0.93 of 10 s of the motion"),
            ((0, 10), 9.98, 0.998, "unfinished", "9.98 of 10 s"), ((0, 10), 9.9995, 1, "stands", "all 10 s of the motion"), ((0, 10), 12, 1, "stands", "all 10 s"),
            ((0, math.inf), 5, 0, "unfinished", "5 s of a motion without a known end"), ((math.nan, math.nan), 5, 1, "stands", "until 5 s, without a motion"),
            ((20, 30), 5, 0, "unfinished", "0 of 10 s"), (None, None, math.nan, "unknown", "not known")):
        report = results.collapse(upright(motion=motion, end=end))
        assert np.isclose(report.motion_run, share, rtol=1e-12, equal_nan=True) and report.verdict == verdict, (motion, end)
        assert words in str(report) and ("stands: " in str(report)) == (verdict == "stands"), str(report)
        assert np.isclose(report.numbers()["motion_run"], share, rtol=1e-12, equal_nan=True)
    # A file has it; one without it does not say.
    path = tmp_path / "wall.npz"
    upright(motion=(0, 10), end=1.5).save(path)
    loaded = results.WallHistory.load(path)
    assert loaded.motion.tolist() == [0, 10] and loaded.end == 1.5
    with np.load(path) as file:
        np.savez(path, **{name: file[name] for name in file.files if name not in ("motion", "end")})
    old = results.WallHistory.load(path)
    assert old.motion is None and old.end == 1.0 and results.collapse(old).verdict == "unknown"
    upright().save(path)
    assert results.WallHistory.load(path).motion is None
    fallen = history([[2, 2, 0.2], [0.6, 0.5, 2]], [[[0, 0, -0.1], [0, 0, z]] for z in (1.0, -0.2)], motion=(0, 10))
    assert results.collapse(fallen).verdict == "collapsed" and "0.5 of 10 s" in str(results.collapse(fallen))
    for given in ({"motion": [1, 2, 3]}, {"end": 0.9}, {"end": math.nan}):
        with pytest.raises(ValueError, match=next(iter(given))):
            upright(**given)
