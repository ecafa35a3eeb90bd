"""Base shear, overturning moment and lines of thrust of histories made by hand, whose sums are known."""

import math

import numpy as np
import pytest
from masonry import results
from test_results import ROUND, history, rocking

ROWS = [("sample", int), ("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)]


def two_blocks(**given):
    """A base (10) that moves by 0.5 m a sample, and two blocks (11, 12) side by side on it."""
    positions = [[[0.5 * k, 0, -0.1], [0.5 * k - 0.5, 0, 0.5], [0.5 * k + 0.5, 0, 0.5]] for k in range(3)]
    forces = np.array([(1, 10, 11, (1, 2, 30), (0, 0, 0)), (1, 10, 12, (-4, 0, 50), (1.1, 0.1, 0)), (1, 11, 12, (7, 0, 0), (0.5, 0, 0.5)),
                       (2, 11, 10, (-1, 0, -20), (0.5, 0, 0))], dtype=ROWS)
    return history([[4, 2, 0.2], [0.5, 0.5, 1], [0.5, 0.5, 1]], positions, forces=forces, **given)


def test_base_reactions_are_the_sums_over_the_joints_with_the_base():
    table = results.base_reactions(two_blocks())
    assert np.isnan(table["force"][0]).all() and np.isnan(table["moment"][0]).all()
    assert np.array_equal(table["force"][1], [-3, 2, 80])  # the joint between the blocks is inside
    # About (0.5, 0, 0), which has moved with the base: r x F of (-0.5, 0, 0) and of (0.6, 0.1, 0).
    moment = np.cross([-0.5, 0, 0], [1, 2, 30]) + np.cross([0.6, 0.1, 0], [-4, 0, 50])
    assert np.abs(table["moment"][1] - moment).max() < ROUND * 50
    assert np.array_equal(table["force"][2], [1, 0, 20])  # block 1 of that joint is the free one
    about = results.base_reactions(two_blocks(), about=(0, 0, 1))
    assert np.abs(about["moment"][1] - (moment + np.cross([0, 0, -1], [-3, 2, 80]))).max() < ROUND * 50


def test_base_reactions_without_a_base_are_refused():
    h = two_blocks()
    alone = results.WallHistory(h.time, h.ids[1:], h.sizes[1:], h.free[1:], h.position[:, 1:], h.orientation[:, 1:],
                                forces=h.forces[(h.forces["id1"] != 10) & (h.forces["id2"] != 10)])
    with pytest.raises(ValueError, match="no prescribed body was recorded.*WallRecorder.ids"):
        results.base_reactions(alone)
    assert len(results.thrust(alone)) == 1  # between the two
    for bad in (11, 7, "base"):
        with pytest.raises(ValueError, match=r"base = .* must be the id of a prescribed body of the history, among \[10\]"):
            results.base_reactions(h, base=bad)


def test_forces_of_a_body_that_is_not_there_are_refused(tmp_path):
    h = two_blocks()
    with pytest.raises(ValueError, match="^forces: they name the body 10, which is not among the ids"):
        results.WallHistory(h.time, h.ids[1:], h.sizes[1:], h.free[1:], h.position[:, 1:], h.orientation[:, 1:], forces=h.forces)
    h.forces["id2"] = 77
    h.save(tmp_path / "wall.npz")
    with pytest.raises(ValueError, match="wall.npz: is no WallHistory, or a damaged one: forces: they name the body 77"):
        results.WallHistory.load(tmp_path / "wall.npz")


def test_each_base_has_its_own_reactions():
    """Moments: about the middle of the foot of what stands there, or a given point, which goes along with the base."""
    from test_results import on_two_bases

    h = on_two_bases()
    h.forces = np.array([(1, 10, 12, (1, 0, 50), (7.1, 0, 0)), (1, 11, 13, (2, 0, 70), (4, -5, 0)), (1, 13, 14, (0, 0, 9), (4, -5, 1))], dtype=ROWS)
    one, other, both = (results.base_reactions(h, base=base)[1] for base in (10, 11, None))
    assert one["force"].tolist() == [1, 0, 50] and other["force"].tolist() == [2, 0, 70] and both["force"].tolist() == [3, 0, 120]
    assert np.abs(one["moment"] - [0, -5, 0]).max() < 50 * ROUND and np.abs(other["moment"]).max() < 70 * ROUND
    at = [results.base_reactions(h, about=(0, 0, 1), base=base)["moment"][1] for base in (10, 11, None)]
    assert np.abs(at[0] - [0, -6, 0]).max() < 120 * ROUND and np.abs(at[1] - [0, -2 - 4 * 70, 0]).max() < 700 * ROUND
    assert np.abs(at[2] - at[0] - at[1]).max() < 700 * ROUND


def test_thrust_is_that_of_the_sample():
    h = two_blocks()
    assert len(results.thrust(h, time=0.5)) == 3 and len(results.thrust(h, time=0.0)) == 0
    last = results.thrust(h)
    assert len(last) == 1 and np.array_equal(last["force"][0], [-1, 0, -20])


def test_without_recorded_forces_it_says_how_to_record_them():
    for act in (results.base_reactions, results.thrust):
        with pytest.raises(ValueError, match="recordForces=True"):
            act(rocking([0, 0.1]))


def test_forces_are_kept_in_files(tmp_path):
    h = two_blocks()
    h.save(tmp_path / "wall.npz")
    assert results.WallHistory.load(tmp_path / "wall.npz").forces.tobytes() == h.forces.tobytes()


def test_thrust_is_drawn_where_the_joint_was_at_first(tmp_path):
    """The block above turns with the one below: the point comes back to the middle of the joint, and the force is turned back."""
    from masonry.results import forces, pictures

    h = rocking([0, 0.2])
    center, rotation = h.position[1, 1], h.orientation[1, 1]
    upward = np.array([math.sin(0.2), 0, math.cos(0.2)])  # of the block
    h.forces = np.array([(1, 11, 10, tuple(-5 * upward), tuple(center - upward))], dtype=ROWS)
    points, pushes = forces.thrust_at_first(h, h.time[1])
    assert np.abs(points[0]).max() < ROUND and np.abs(pushes[0] - [0, 0, -5]).max() < 5 * ROUND, (points, pushes, rotation)
    figure = pictures.joints_figure(h, time=h.time[1])
    third = [axes for axes in figure.axes if axes.get_title().startswith("thrust")]
    assert len(third) == 1 and "at most 0.005 kN" in third[0].get_title()
    line = third[0].collections[-1].get_segments()[0]
    assert np.abs(line[:, 0]).max() < ROUND and abs(np.ptp(line[:, 1]) - 2 * 2) < ROUND  # 2 heights of the only block, upright
    results.draw_joints(h, tmp_path / "joints.png")
    assert (tmp_path / "joints.png").read_bytes()[:4] == b"\x89PNG"


def test_a_picture_without_a_time_is_of_the_largest_drift_before_a_block_falls():
    """The block lies on its side in the end, where the drift is larger."""
    from masonry.results import pictures

    h = rocking([0, 0.1, 0.2, 1.0, 1.5])  # it falls beyond atan(0.6 / 2) = 0.29
    assert results.collapse(h).collapsed and h.drift().argmax() > 2
    assert "t = 1.000 s" in pictures.shape_figure(h).axes[0].get_title()


@pytest.mark.parametrize("angle, unit", [(0.02, "(mm)"), (0.2, "(m)")])
def test_small_movement_has_its_scale_in_millimetres(angle, unit):
    from masonry.results import pictures

    figure = pictures.shape_figure(rocking([0, angle]))
    figure.draw_without_rendering()
    bar = figure.axes[1]
    assert unit in bar.get_ylabel()
    most = np.linalg.norm(rocking([0, angle]).displacement[1, 1]) * (1e3 if unit == "(mm)" else 1)
    shown = [float(label.get_text()) for label in bar.get_yticklabels()]
    assert 0.5 * most < max(shown) < 1.5 * most
