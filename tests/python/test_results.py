"""Histories made by hand, whose openings, slips, drifts, falls and pictures are known."""

import base64
import math
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from masonry import _pose, results
from masonry.results import view

UPRIGHT = [1.0, 0, 0, 0]
# Of sums of a few numbers of order one.
ROUND = 1e-13


def turn(angle, axis):
    return np.array([math.cos(angle / 2), *(math.sin(angle / 2) * np.asarray(axis, dtype=float))])


def about_edge(center, pivot, rotation):
    """Where the centre goes when the block turns about a point."""
    return pivot + _pose.matrices(rotation) @ (np.asarray(center) - pivot)


def history(sizes, positions, orientations=None, free=None, **given):
    """positions: (s, n, 3); the first block is the base unless `free` says otherwise."""
    positions = np.asarray(positions, dtype=float)
    samples, blocks = positions.shape[:2]
    orientations = np.tile(UPRIGHT, (samples, blocks, 1)) if orientations is None else orientations
    free = [False] + [True] * (blocks - 1) if free is None else free
    return results.WallHistory(0.5 * np.arange(samples), 10 + np.arange(blocks), sizes, free, positions, orientations, **given)


def rocking(angles, axis=(0, 1, 0), shift=(0, 0, 0), frame=None):
    """A block 0.6 x 0.5 x 2 on a base 2 x 2 x 0.2 that moves by `shift` a sample; it turns about its edge. frame: everything is turned by it."""
    frame = np.array(UPRIGHT) if frame is None else frame
    world, positions, orientations = _pose.matrices(frame), [], []
    for k, angle in enumerate(angles):
        rotation = turn(angle, axis)
        side = np.cross(axis, [0, 0, 1]) * math.copysign(1, angle)
        pivot = side * [0.3, 0.25, 0]
        block = about_edge([0, 0, 1.0], pivot, rotation)
        positions.append([world @ p + k * np.asarray(shift) for p in ([0, 0, -0.1], block)])
        orientations.append([frame, _pose.product(frame, rotation)])
    return history([[2, 2, 0.2], [0.6, 0.5, 2]], positions, np.array(orientations))


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


def test_a_file_gives_the_same_bits_back(tmp_path):
    h = rocking([0, 0.1, 0.05])
    h.save(tmp_path / "h.npz")
    again = results.WallHistory.load(tmp_path / "h.npz")
    for name in ("time", "ids", "sizes", "free", "position", "orientation"):
        assert np.array_equal(getattr(h, name), getattr(again, name)), name
    np.savez(tmp_path / "other.npz", time=[0])
    with pytest.raises(ValueError, match="is no WallHistory"):
        results.WallHistory.load(tmp_path / "other.npz")
    for damage in (b"", b"PK", b"a line of text\n", (tmp_path / "h.npz").read_bytes()[:-100]):
        (tmp_path / "damaged.npz").write_bytes(damage)
        with pytest.raises(ValueError, match="path = .*damaged.npz: is no WallHistory"):
            results.WallHistory.load(tmp_path / "damaged.npz")


def test_a_csv_has_a_line_a_sample(tmp_path):
    h = rocking([0, 0.1, 0.05])
    h.to_csv(tmp_path / "h.csv")
    table = np.genfromtxt(tmp_path / "h.csv", delimiter=",", skip_header=1)
    assert (tmp_path / "h.csv").read_text().splitlines()[0] == "time (s),drift" and np.array_equal(table, np.column_stack([h.time, h.drift()]))
    energies = np.arange(21.0).reshape(3, 7)
    h = history(h.sizes, h.position, h.orientation, energies=energies)
    h.to_csv(tmp_path / "h.csv")
    table = np.genfromtxt(tmp_path / "h.csv", delimiter=",", skip_header=1)
    assert (tmp_path / "h.csv").read_text().startswith("time (s),drift,kinetic (J),potential (J),") and np.array_equal(table[:, 2:9], energies)
    assert np.array_equal(table[:, 9], h.energy["error"])
    h.to_csv(tmp_path / "h.csv", ids=h.ids)
    table = np.genfromtxt(tmp_path / "h.csv", delimiter=",", names=True, deletechars="")
    assert len(table.dtype.names) == 10 + 2 * 5 and not any(table[f"{name}_of_10_({unit})"].any() for name, unit in (("displacement_x", "m"), ("rotation", "rad")))
    # About its edge by 0.1: the centre 0.3 inwards and 1 above.
    assert abs(table["displacement_x_of_11_(m)"][1] - (math.sin(0.1) + 0.3 * (1 - math.cos(0.1)))) < ROUND
    assert abs(table["rotation_of_11_(rad)"][1] - 0.1) < ROUND and abs(table["lean_of_11_(rad)"][2] - 0.05) < ROUND


# --- seen from the side and from afar ---


def test_the_view_is_across_the_plane_of_motion():
    assert np.allclose(view.View(rocking([0, 0.1])).towards, [0, -1, 0])
    assert view.View(rocking([0, 0.1])).label() == "x (m)" and view.View(rocking([0, 0.1], (1, 0, 0))).label() == "y (m)"
    assert np.allclose(view.View(rocking([0, 0.1], (1, 0, 0))).towards, [1, 0, 0])
    yawed = view.View(rocking([0, 0.1], frame=turn(0.7, (0, 0, 1))))
    assert np.allclose(yawed.towards, [math.sin(0.7), -math.cos(0.7), 0]) and yawed.from_side
    both = rocking([0, 0.1])
    both.position[1, 1, 1] += 0.01
    assert view.plane_normal(both) is None and not view.View(both).from_side
    assert view.View(both, (0, -2, 0)).label() == "x (m)"


def facade(move, blocks=1, samples=2):
    """Blocks 2 x 0.3 x 3 side by side along x on a base; move: (n, 3) of the blocks in all samples but the first."""
    place = np.array([[0, 0, -0.1]] + [[2.0 * k, 0, 1.5] for k in range(blocks)])
    return history([[40, 20, 0.2]] + [[2, 0.3, 3]] * blocks, [place, *[place + np.vstack([[0, 0, 0], np.broadcast_to(move, (blocks, 3))])] * (samples - 1)])


@pytest.mark.parametrize("move", [(0, 0, 0), (1e-7, 0, 0), (0, 1e-7, 0), (1e-7, 2e-7, -1e-7), (0, 0, 0.01)])
def test_a_facade_that_has_not_moved_sideways_is_seen_from_its_front(move):
    # 1e-7 m is less than 1e-6 of its size, 3 m.
    h = facade(move)
    assert np.allclose(view.View(h).towards, [0, -1, 0])
    quarter = turn(math.pi / 2, (0, 0, 1))
    turned = history(h.sizes, h.position @ _pose.matrices(quarter).T, np.tile(quarter, (2, 2, 1)))
    assert np.allclose(view.View(turned).towards, [1, 0, 0])


def cross(a, b):
    """Of vectors of the plane, which np.cross does not take in every version of NumPy."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def test_blocks_behind_are_drawn_first():
    """Boxes of a regular pattern, in any order: along a ray towards the viewer the last face drawn is that of the nearest box."""
    rng = np.random.default_rng(3)
    center = np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(3)], dtype=float)[rng.permutation(27)]
    sizes = np.where(rng.random((27, 1)) < 0.5, [1.0, 0.4, 0.9], [0.3, 1.0, 1.0])
    h = history(np.vstack([[9, 9, 1], sizes]), [np.vstack([[1, 1, -1], center])])
    seen = view.View(h, (0.5, -1, 0.4))
    polygons, rows, bright = seen.faces(h.corners(0))
    assert np.allclose(np.unique(bright.round(9)), [0.7, 0.9, 1])  # flanks, fronts, tops
    turned = history([[9, 9, 1], [1, 0.4, 0.9]], [[[1, 1, -1], [0, 0, 0]]], np.array([[UPRIGHT, turn(math.pi / 6, (0, 0, 1))]]))
    assert np.allclose(np.sort(seen.faces(turned.corners(0)[1:])[2]), [0.9 - 0.2 * math.cos(math.pi / 6), 0.9 - 0.2 / 2, 1], rtol=0, atol=1e-12)
    assert all(cross(p[1] - p[0], p[2] - p[1]) > 0 for p in polygons)  # counterclockwise: outsides
    assert np.allclose(np.column_stack([seen.frame, seen.towards]).T @ np.column_stack([seen.frame, seen.towards]), np.eye(3), rtol=0, atol=1e-12)
    assert np.array_equal(view.View(h, (0, 0, 1)).frame, np.eye(3)[:, :2])
    # Parallelograms; of a box three faces show, each as large as its part across the view.
    assert np.allclose(polygons[:, 0] + polygons[:, 2], polygons[:, 1] + polygons[:, 3], rtol=0, atol=1e-12)
    areas = np.bincount(rows, cross(polygons[:, 1] - polygons[:, 0], polygons[:, 2] - polygons[:, 1]))
    assert np.allclose(areas, (np.roll(h.sizes, 1, axis=1) * np.roll(h.sizes, 2, axis=1)) @ np.abs(seen.towards), rtol=1e-12)
    for towards in ((0.5, -1, 0.4), (0, -1, 0)):  # of no blocks, no faces
        assert not any(map(len, view.View(h, towards).faces(h.corners(0)[:0])))
    depth = h.position[0] @ seen.towards
    checked = 0
    for point in rng.uniform(*np.quantile(polygons.reshape(-1, 2), (0.2, 0.8), axis=0), size=(500, 2)):
        edges = np.roll(polygons, -1, axis=1) - polygons
        inside = (cross(edges, point - polygons) > 1e-9).all(axis=1)
        if not inside.any():
            continue
        # How near the box is where the ray leaves it: the least over its three slabs.
        origin, near = seen.frame @ point, []
        for k in range(len(sizes) + 1):
            with np.errstate(divide="ignore"):
                exits = (np.sign(seen.towards) * h.sizes[k] / 2 - (origin - h.position[0, k])) / seen.towards
            near.append(exits.min())
        hit = np.unique(rows[inside])
        assert rows[np.flatnonzero(inside)[-1]] == max(hit, key=lambda k: near[k])
        checked += 1
    assert checked > 300 and len(np.unique(depth)) > 1


@pytest.mark.parametrize("pairs, depth, order", [([], [3, 1, 2], [1, 2, 0]),  # the deepest first
                                                 ([(2, 1), (1, 0)], [1, 2, 3], [2, 1, 0]),  # but behind comes before in front
                                                 ([(0, 1), (1, 2), (2, 0), (0, 3)], [3, 1, 2, 0], [1, 2, 0, 3])])  # of a circle too, not of what is before it
def test_the_order_of_drawing(pairs, depth, order):
    behind, before = np.array(pairs, dtype=int).reshape(-1, 2).T
    assert view._sorted(behind, before, np.array(depth, dtype=float)).tolist() == order


@pytest.mark.parametrize("side", [1, -1])
def test_a_small_block_at_the_end_of_a_long_one_hides_it_or_is_hidden(side):
    """In front its middle is the deeper one, behind the nearer one."""
    h = history([[9, 9, 1], [4, 0.3, 0.3], [0.3, 0.3, 0.3]], [[[0, 0, -5], [0, 0, 0], [1.9 * side, -0.35 * side, 0]]])
    assert view.View(h, (-0.8, -1, 0.4)).faces(h.corners(0)[1:])[1].tolist() == [0, 0, 0, 1, 1, 1][::side]


def test_pictures_show_the_movement_enlarged(monkeypatch, tmp_path):
    from masonry.results import pictures
    from matplotlib.figure import Figure

    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    painter = pictures._Painter(h, [1], 3.0, "rotation", None, "")
    painter.paint(1)
    drawn = np.concatenate([path.vertices for path in painter._blocks.get_paths()])
    assert abs(drawn[:, 0].max() - h.corners(1, 3.0)[:, :, 0].max()) < ROUND and "3 times" in painter.figure.axes[0].get_title()
    # The upper right corner of the block: movement times three. Half of the smallest block where no factor is given.
    start, moved = h.corners(0)[1], h.corners(1)[1]
    assert np.allclose(h.corners(1, 3.0)[1] - start, 3 * (moved - start), rtol=0, atol=ROUND)
    for samples in ([1], [0, 1, 2]):
        assert abs(view.enlargement(h, samples, 0.5) * np.linalg.norm(moved - start, axis=1).max() - 0.25) < ROUND
    assert view.enlargement(rocking([0, 0.2]), [1], 0.5) == 1  # its top moves by 0.4 m
    for name, act in (("shape", results.draw), ("joints", results.draw_joints)):
        act(h, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
    # Where no time is given, the sample of the largest drift.
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: drawn.append(figure))
    results.draw(h, tmp_path / "shape.png", enlarge=1)
    drawn = np.concatenate([path.vertices for path in drawn[0].axes[0].collections[-1].get_paths()])
    assert abs(drawn[:, 0].max() - h.corners(1)[:, :, 0].max()) < ROUND


def test_what_solvers_leave_is_no_movement(tmp_path):
    from masonry.results import pictures

    for way, moved in ((2e-6, False), (4e-6, True)):  # 1e-6 of the size is 3e-6 m
        h = facade((way, 0, 0))
        painter = pictures._Painter(h, [1], None, "displacement", None, "")
        painter.paint(1)
        assert ("nothing moved" in painter.figure.axes[0].get_title()) != moved
        assert abs(painter._enlarge * (way / 0.15 if moved else 1) - 1) < 1e-9  # round-off of 1 m in 4e-6 m
        assert len(painter.figure.axes) == 1 + moved  # the scale
        results.draw_joints(h, tmp_path / "joints.png")


@pytest.mark.parametrize("moves, end, beyond", [([0.01, 0.02, 0.03, 0.02], 0.03, False),  # all stand
                                                ([0.01, 0.02, 0.03, 9.0], 0.03, True),  # one has fallen
                                                ([0.01, 7.0, 8.0, 9.0], 9.0, False),  # most have
                                                ([1e-7, 1e-7, 1e-7, 9.0], 9.0, False)])  # what stands has not moved
def test_colours_are_left_to_what_stands_and_to_a_heap(moves, end, beyond):
    from masonry.results import pictures

    # Those that have gone metres also lie by 2 m lower, which is more than half of their height.
    h = facade([[0, math.sqrt(m**2 - 4) if m > 1 else m, -2 if m > 1 else 0] for m in moves], blocks=4)
    assert results.fallen(h)[1, 1:].tolist() == [m > 1 for m in moves]
    painter = pictures._Painter(h, [1], 1.0, "displacement", None, "")
    label = painter.figure.axes[1].get_ylabel()
    assert abs(painter._map.norm.vmax - end) < 1e-12 and ("fallen" in label) == beyond
    painter = pictures._Painter(h, [1], 1.0, "displacement", (0, 0, 1), "")  # low: from above
    painter.figure.canvas.draw()
    label, canvas = painter.figure.axes[1].yaxis.label.get_window_extent(), painter.figure.bbox
    assert canvas.y0 <= label.y0 and label.y1 <= canvas.y1 and label.x1 <= canvas.x1, (label, canvas)  # nothing of it is cut off


@pytest.mark.parametrize("level, lacking, panels", [(1e6, 0, 1), (1e6, 1e-10, 1), (-1e6, 1e-10, 1), (1e6, 1e-3, 2)])
def test_a_balance_that_closes_by_definition_is_not_shown_as_its_error(tmp_path, monkeypatch, level, lacking, panels):
    """What is lost is booked as the impacts' but for `lacking` J; 1e-10 J is round-off of a potential energy of 1e6 J, above or below z = 0."""
    from matplotlib.figure import Figure

    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: drawn.append(figure))
    h = rocking([0, 0.1, 0])
    energies = np.array([[0, level, 0, 0, 0, 0, 0], [3, level + 5, 0, 1, 0, 2, 11], [0, level, 0, 2, 0, 5 + lacking, 7]])
    h = history(h.sizes, h.position, h.orientation, energies=energies)
    results.draw_energy(h, tmp_path / "energy.png")
    lines = {line.get_label(): line.get_ydata().tolist() for line in drawn[0].axes[0].lines}
    assert lines["work of the base"] == [0, 11, 7] and lines["potential, since the start"] == [0, 5, 0] and lines["dissipated by friction"] == [0, 1, 2]
    assert panels == 1 or drawn[0].axes[1].lines[0].get_ydata().tolist() == h.energy["error"].tolist()
    texts = [text.get_text() for text in drawn[0].axes[0].get_legend().get_texts()]
    assert len(drawn[0].axes) == panels and ("dissipated by impacts and numerically" in texts) == (panels == 1)
    assert drawn[0].axes[-1].get_xlabel() == "time (s)"


def test_a_film_has_the_frames_asked_for(tmp_path):
    from PIL import Image

    h = rocking([0, 0.1, -0.05, 0.02, 0.2], shift=(0.4, 0, 0))
    results.film(h, tmp_path / "h.gif", frames_per_second=4, progress=False)  # 2 s of motion
    with Image.open(tmp_path / "h.gif") as gif:
        durations = []
        for k in range(gif.n_frames):
            gif.seek(k)
            durations.append(gif.info["duration"])
    assert len(durations) == 5 and sum(durations) == 9 * 250  # frames of one sample are one, shown longer
    results.film(h, tmp_path / "slow.gif", start=0.5, end=1.0, frames_per_second=1, speed=0.5, progress=False)
    with Image.open(tmp_path / "slow.gif") as gif:
        assert gif.n_frames == 2
    results.film(h, tmp_path / "end.gif", end=1.5, frames_per_second=9, speed=2.7, progress=False)  # 5 times 2.7/9 s is 1.5 s and round-off
    for window in ((0.5, 0.5), (None, 0.0), (2.0, None), (0.4, 0.6)):  # one sample
        results.film(h, tmp_path / "still.gif", *window, progress=False)
        with Image.open(tmp_path / "still.gif") as gif:
            assert gif.n_frames == 1


@pytest.mark.parametrize("angles", [[0.1, 0.2], [0, 0], [0, 0.1]])
def test_a_map_without_joints_says_so(tmp_path, monkeypatch, angles):
    """A block that leans in the first sample has no joint with the base: that nothing opened would be wrong."""
    from matplotlib.figure import Figure

    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: drawn.append(figure))
    results.draw_joints(rocking(angles), tmp_path / "joints.png")
    titles = [axes.get_title() for axes in drawn[0].axes[:2]]
    assert [("no blocks touch at first" in t) for t in titles] == [angles[0] != 0] * 2
    assert ["nothing" in t for t in titles] == [angles == [0, 0], angles[0] == 0]


# --- ParaView ---


def decoded(node):
    kinds = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    data = base64.b64decode(node.text)
    assert int.from_bytes(data[:8], "little") == len(data) - 8
    return np.frombuffer(data[8:], kinds[node.get("type")]).reshape(-1, int(node.get("NumberOfComponents", 1)))


def test_paraview_files_hold_the_boxes(tmp_path):
    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    listed = ElementTree.parse(results.write_paraview(h, tmp_path / "wall.pvd", every=2)).getroot().findall(".//DataSet")
    assert [float(d.get("timestep")) for d in listed] == [0.0, 1.0]
    piece = ElementTree.parse(tmp_path / listed[1].get("file")).getroot().find(".//Piece")
    arrays = {node.get("Name"): decoded(node) for node in piece.iter("DataArray")}
    points = arrays["Points"].reshape(2, 8, 3)
    assert np.allclose(points.mean(axis=1), h.position[2], rtol=0, atol=ROUND)
    assert arrays["types"].ravel().tolist() == [12, 12] and arrays["id"].ravel().tolist() == [10, 11] and arrays["offsets"].ravel().tolist() == [8, 16]
    for box, center, axes, size in zip(arrays["connectivity"].reshape(2, 8), points.mean(axis=1), _pose.matrices(h.orientation[2]), h.sizes):
        local = (arrays["Points"][box] - center) @ axes / (size / 2)
        # VTK's hexahedron: a face around, then the opposite one.
        assert np.allclose(local, [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], rtol=0, atol=1e-12)
    assert np.allclose(arrays["rotation"].ravel(), [0, 0.05], rtol=0, atol=1e-12)
    # Corners have the way from the first sample, less that of the base.
    results.write_paraview(h, tmp_path / "all.pvd")
    first, last = (ElementTree.parse(tmp_path / f"all/all_{k:06d}.vtu").getroot().find(".//Piece") for k in (0, 2))
    way = decoded(last.find("Points/DataArray")) - decoded(first.find("Points/DataArray")) - [0.8, 0, 0]
    assert np.allclose(decoded(last.find("PointData/DataArray")), way, rtol=0, atol=ROUND) and np.abs(way).max() > 0.09


def test_names_of_paraview_files_may_have_any_letters(tmp_path):
    h = rocking([0, 0.1])
    path = results.write_paraview(h, tmp_path / 'pier "A" & <é>.pvd')
    listed = ElementTree.fromstring(path.read_bytes()).findall(".//DataSet")
    assert len(listed) == 2 and all((tmp_path / one.get("file")).is_file() for one in listed)


# --- input that cannot be meant ---


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


def test_paraview_relative_to_the_base(tmp_path):
    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    results.write_paraview(h, tmp_path / "h.pvd", relative=True)
    points = decoded(ElementTree.parse(tmp_path / "h/h_000002.vtu").getroot().find(".//Points/DataArray"))
    assert np.allclose(points.reshape(2, 8, 3), h.corners(2), rtol=0, atol=ROUND)


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


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    from masonry._files import written

    path = tmp_path / "some.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError):
        with written(path) as beside:
            with open(beside, "w") as file:
                file.write("half of the new")
            assert path.read_text() == "old"
            1 / 0
    assert path.read_text() == "old" and [p.name for p in tmp_path.iterdir()] == ["some.txt"]
    with written(path) as first, written(path) as second:  # two at the same time do not meet
        assert first != second
        for name, text in ((first, "first"), (second, "second")):
            with open(name, "w") as file:
                file.write(text)
    assert path.read_text() == "first" and len(list(tmp_path.iterdir())) == 1  # the last to end
    plain = tmp_path / "plain"
    plain.write_text("")
    assert path.stat().st_mode == plain.stat().st_mode  # as any file that is opened
    for kind, wrong, words in ((FileNotFoundError, tmp_path / "nowhere" / "some.txt", "no file can be written in the folder .*nowhere: No such file or directory"),
                               (NotADirectoryError, path / "some.txt", "no file can be written in the folder .*some.txt: Not a directory"),
                               (IsADirectoryError, tmp_path, "is a folder: must be the name of a file")):
        with pytest.raises(kind, match=f"^path = .*: {words}$"):
            with written(wrong):
                pass


def test_writers_that_fail_leave_the_old_file(tmp_path, monkeypatch):
    h = rocking([0, 0.1, 0.05])
    calls = {"wall.npz": h.save, "wall.csv": h.to_csv, "shape.png": lambda path: results.draw(h, path), "joints.png": lambda path: results.draw_joints(h, path),
             "film.gif": lambda path: results.film(h, path, frames_per_second=1, progress=False), "wall.pvd": lambda path: results.write_paraview(h, path)}
    for name, write in calls.items():
        write(tmp_path / name)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert set(before) == set(calls)
    from masonry import _files

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(_files.os, "replace", full)  # the last that can fail
    for name, write in calls.items():
        with pytest.raises(OSError, match="No space left"):
            write(tmp_path / name)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before
    assert not [path.name for path in tmp_path.rglob(".*")]


def test_any_damage_of_a_saved_history_is_told_in_our_words(tmp_path):
    path = tmp_path / "wall.npz"
    rocking([0, 0.1, 0.05]).save(path)
    whole, random = path.read_bytes(), np.random.default_rng(43)
    told = 0
    for _ in range(300):
        damaged = bytearray(whole[:random.integers(0, len(whole) + 1)])
        for at in random.integers(0, max(len(damaged), 1), 20) if damaged else ():
            damaged[at] = random.integers(0, 256)
        path.write_bytes(damaged)
        try:
            results.WallHistory.load(path)
        except ValueError as error:  # nothing else comes out
            assert str(error).startswith(f"path = {path}: is no WallHistory"), error
            told += 1
    assert told > 250
