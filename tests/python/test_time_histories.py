"""Histories of joints and of structures from motions and forces made by hand."""
import math

import numpy as np
import pytest
from histories import ROUND, history, rocking, turn
from masonry import results

ROWS = [("sample", int), ("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)]


def sliding(base=(0.0, 0.0), steps=(0.0, 0.02, 0.05, 0.03), force=(-6.0, 2.0, 20.0), swapped=False):
    """A block of 0.6 x 0.5 x 2 m that slides by those ways along x over a base that moves by `base` a sample, under a constant force on it."""
    positions, rows = [], []
    for k, way in enumerate(steps):
        moved = k * np.array([*base, 0])
        positions.append([[0, 0, -0.1] + moved, [way, 0, 1.0] + moved])
        sign = -1.0 if swapped else 1.0
        rows.append((k, 11, 10, sign * np.array(force), moved + [way, 0, 0]) if swapped else (k, 10, 11, force, moved + [way, 0, 0]))
    return history([[2, 2, 0.2], [0.6, 0.5, 2]], positions, forces=np.array(rows, dtype=ROWS))


@pytest.mark.parametrize("base", ((0, 0), (0.3, -0.2)))
@pytest.mark.parametrize("swapped", (False, True))
def test_a_sliding_block(base, swapped):
    """Forces of the joint; friction takes the force along the way times the way, there and back; the motion of the base takes none of it."""
    found = results.joint_history(sliding(base, swapped=swapped), 11, 10)
    assert np.abs(found["slip"] - [0, 0.02, 0.05, 0.03]).max() < ROUND and found["closed"].all() and np.abs(found["opening"]).max() < ROUND
    assert np.abs(found["normal"] - 20).max() < 20 * ROUND and np.abs(found["shear"] - math.hypot(6, 2)).max() < 20 * ROUND
    assert np.abs(found["friction_work"] - 6 * np.array([0, 0.02, 0.05, 0.03])).max() < 20 * ROUND  # a force that does not turn with the way gives back
    assert found.numbers["largest slip while closed (m)"] == pytest.approx(0.05) and "blocks 10 and 11" in str(found)


def test_a_rocking_block():
    """Opening 2 b sin(a); the force along the axis of the first block; a block that turns about its edge dissipates nothing by sliding there."""
    angles = [0, 0.05, 0.1, 0.02]
    still = rocking(angles)
    forces = [(k, 10, 11, (1.0, 0, 10.0), (0.3, 0, 0)) for k in range(4)]
    found = results.joint_history(results.WallHistory(still.time, still.ids, still.sizes, still.free, still.position, still.orientation, forces=np.array(forces, dtype=ROWS)))
    assert np.abs(found["opening"] - 0.6 * np.sin(angles)).max() < ROUND and np.abs(found["friction_work"]).max() < 10 * ROUND
    assert np.isnan(results.joint_history(still)["normal"]).all()


def test_the_joint_that_is_shown():
    """The one that opened most; where none has opened, the one that slid most, and the title says so."""
    assert results.joint_history(rocking([0, 0.05])).title == "joint of the blocks 10 and 11"
    assert results.joint_history(sliding()).title == "joint of the blocks 10 and 11 (no joint opened, this one slid most)"
    assert results.joint_history(rocking([0, 0])).title.endswith("(no joint opened or slid)")


def test_joints_that_are_not_there():
    still = rocking([0, 0.05])
    with pytest.raises(ValueError, match="must be two blocks that touch"):
        results.joint_history(still, 10, 12)
    with pytest.raises(ValueError, match="give both, or none"):
        results.joint_history(still, 10)
    apart = history([[2, 2, 0.2], [0.6, 0.5, 2]], [[[0, 0, -0.1], [0, 0, 3.0]]])
    with pytest.raises(ValueError, match="it has no joints"):
        results.joint_history(apart)


def leaning(angle, axis):
    """One block that turns by an angle about its centre."""
    return history([[2, 2, 0.2], [0.6, 0.5, 2]], [[[0, 0, -0.1], [0, 0, 1.0]]] * 2, np.array([[[1, 0, 0, 0]] * 2, [[1, 0, 0, 0], turn(angle, axis)]], dtype=float),
                   about={"materials": [{"density": 2000, "ids": [11]}], "model": {"gravity": [0, 0, -9.81]}})


def test_drift_with_its_sign_and_the_weight():
    """The top, 1 m above the centre, goes by sin(angle), over the height of 2 m; towards +x for positive turns about y, towards -y for those about x."""
    for angle in (0.1, -0.1):
        along = results.structure_history(leaning(angle, (0, 1, 0)))
        assert abs(along["drift_x"][1] - math.sin(angle) / 2) < ROUND and abs(along["drift_y"][1]) < ROUND
        assert abs(results.structure_history(leaning(angle, (1, 0, 0)))["drift_y"][1] + math.sin(angle) / 2) < ROUND
        assert along.numbers["residual drift along x"] == along["drift_x"][1]
        assert abs(abs(along["drift_x"][1]) - leaning(angle, (0, 1, 0)).drift()[1]) < ROUND
    moved = sliding(base=(0.5, 0), force=(-6, 2, 20))
    found = results.structure_history(moved, weight=60.0)
    assert np.abs(found["drift_x"] - np.array([0, 0.02, 0.05, 0.03]) / 2).max() < ROUND
    assert found.numbers["largest base shear along x (N)"] == -6 and found.numbers["the same over the weight (V/W along x)"] == -0.1
    assert np.abs(found["vertical"] - 20).max() == 0
    known = leaning(0.1, (0, 1, 0))
    known.forces = np.array([(1, 10, 11, (1177.2, 0, 5), (0, 0, 0))], dtype=ROWS)
    assert abs(results.structure_history(known).numbers["the same over the weight (V/W along x)"] - 1177.2 / (2000 * 0.6 * 9.81)) < ROUND
    known.about["masses"] = [{"mass": 2400.0, "ids": [11]}]  # with 1200 kg that dem.add_mass has added
    assert abs(results.structure_history(known).numbers["the same over the weight (V/W along x)"] - 1177.2 / (2400 * 9.81)) < ROUND
    with pytest.raises(ValueError, match="weight = 0"):
        results.structure_history(moved, weight=0)
    with pytest.raises(ValueError, match="base = 11: must be the id of a prescribed body"):
        results.structure_history(moved, base=11)


def test_forces_of_ties():
    """A strut: its largest tension and compression, each from its sample. A tie that broke between two samples carried its strength; one that was slack, nothing."""
    from masonry.results.wall_history import TIES

    shaken = rocking([0, 0.01, 0.02, 0.01])
    shaken.ties = np.zeros((4, 3), dtype=TIES)
    shaken.ties["body1"], shaken.ties["body2"], shaken.ties["strength"] = 10, 11, (np.inf, 1200.0, 900.0)
    shaken.ties["force"] = [(0, 0.5, 0), (6100, 0.56, 0), (-14900, 0, 0), (20, 0, 0)]
    shaken.ties["broken"][2:, 1] = True
    table = results.ties(shaken)
    assert table["force"].tolist() == [6100, 1200, 0] and table["compression"].tolist() == [14900, 0, 0] and table["broken_time"][1] == 1.0
    assert table["force_time"][:2].tolist() == [0.5, 1.0] and table["compression_time"][0] == 1.0 and np.isnan([table["force_time"][2], *table["compression_time"][1:]]).all()


def test_platens_are_no_base():
    """The forces of platens that push are none of the base."""
    pushed = sliding()
    pushed.about["motions"] = [{"kind": "push", "ids": [10]}]
    assert np.abs(results.base_reactions(pushed)["force"]).max() == 0
    assert np.abs(results.base_reactions(pushed, base=10)["force"]).max() == 20


def test_volumes():
    """Of a box as a box and as a convex block, and of a tetrahedron whose origin is outside of it."""
    from masonry._pose import BOX_FACES
    from masonry._shapes import Shapes, box_corners

    tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3.0]]) + [5, 5, 5], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    boxes = history([[1, 2, 3], [0.5, 0.5, 1]], [[[0, 0, 0], [0, 0, 9]]])
    assert boxes.volumes.tolist() == [6, 0.25]
    both = history([[1, 2, 3], [1, 2, 3]], [[[0, 0, 0], [0, 0, 9]]], shapes=Shapes.of([(box_corners([1, 2, 3]), BOX_FACES), tetrahedron]))
    assert np.abs(both.volumes - [6, 1]).max() < 1e-12


def test_files_and_pictures(tmp_path):
    found = results.joint_history(sliding())
    found.save(tmp_path / "joint.csv")
    lines = (tmp_path / "joint.csv").read_text().splitlines()
    assert lines[0] == "time (s),opening (m),slip (m),closed (1),normal (N),shear (N),point x (m),point y (m),point z (m),friction_work (J)"
    assert np.allclose(np.genfromtxt(lines[1:], delimiter=","), np.column_stack([found[name] for name in ("time", "opening", "slip", "closed", "normal", "shear")] +
                                                                               [found["point"], found["friction_work"]]))
    for one, name in ((found, "joint.png"), (results.structure_history(sliding()), "wall.svg"), (results.structure_history(leaning(0.1, (0, 1, 0))), "drift.png")):
        one.picture(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 5000
    with pytest.raises(ValueError, match=".csv"):
        found.save(tmp_path / "joint.txt")
    with pytest.raises(KeyError, match="must be one of time, opening"):
        found["angle"]


def test_the_report_has_them(tmp_path):
    """Drift along x and what remains of it, base shear over the weight of 2000 x 0.6 x 9.81 N, the joint that opened most."""
    still = rocking([0, 0.05, 0.1, 0.02])
    forces = np.array([(k, 10, 11, (1177.2 * k, 0, 11772.0), (0.3, 0, 0)) for k in range(4)], dtype=ROWS)
    about = {"materials": [{"density": 2000, "frictionAngle": 0.6, "restitution": None, "noSlip": False, "normalStiffness": None, "shearStiffness": None, "ids": [11]}],
             "model": {"gravity": [0, 0, -9.81]}, "motions": []}
    results.report(results.WallHistory(still.time, still.ids, still.sizes, still.free, still.position, still.orientation, forces=forces, about=about), tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    for words in ("The joint that opened most: blocks 10 and 11", "Drift along x: largest, and in the last sample", "Largest base shear along x", "0.3 of the weight"):
        assert words in page, words
