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
    assert np.abs(found["friction_work"] - 6 * np.array([0, 0.02, 0.05, 0.05])).max() < 20 * ROUND  # a force that does not turn with the way is no friction: nothing comes back
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


def bulging():
    """Three blocks on each other: the top goes by 0.01 m, the middle one by up to 0.05 m along -y, the lowest one by 0.02 m along x in the last sample, when the middle one falls."""
    ways = [[(0, 0), (0, 0), (0, 0)], [(0, 0.005), (0.001, -0.03), (0, 0.01)], [(0, 0.005), (0, -0.05), (0, 0.01)], [(0.02, 0), (0, -0.4), (0, 0)]]
    positions = [[[0, 0, -0.1]] + [[x, y, z - (2 if abs(y) > 0.1 else 0)] for (x, y), z in zip(row, (0.5, 1.5, 2.5))] for row in ways]
    return history([[2, 2, 0.2]] + [[0.6, 0.5, 1]] * 3, positions)


def test_the_largest_displacement_at_any_height(tmp_path):
    """Which drift, of the top alone, does not see: with sign, block and first height above the foot; a block that has fallen does not count."""
    found = results.structure_history(bulging())
    assert np.abs(found["drift_y"] - np.array([0, 0.01, 0.01, 0]) / 3).max() < ROUND
    assert np.abs(found["displacement_y"] - [0, -0.03, -0.05, 0]).max() < ROUND and np.abs(found["displacement_x"] - [0, 0.001, 0, 0.02]).max() < ROUND
    assert found["block_y"][1:3].tolist() == [12, 12] and found["block_x"].tolist()[1::2] == [12, 11]
    assert np.abs(found["height_y"][1:3] - 1.5).max() < ROUND and abs(found["height_x"][3] - 0.5) < ROUND
    assert found.numbers["largest displacement along y at any height (m)"] == pytest.approx(-0.05) and found.numbers["its block, along y"] == 12
    assert "its block, along y: 12\n" in str(found)
    results.report(bulging(), tmp_path / "r.html")
    assert "50 mm, block 12, 1.5 m above the foot" in (tmp_path / "r.html").read_text(encoding="utf-8").replace("-50", "50")


def dissipating():
    """The sliding block, with an impact of 0.5 J on the base and one of 0.25 J on a block 12 that touches nothing."""
    moving = sliding(steps=(0.0, 0.02, 0.05, 0.06))
    impacts = np.zeros(3, dtype=[(name, float) for name in ("time", "body", "support", "restitution_asked", "restitution", "velocity", "energy_lost", "friction_demand", "capped")])
    impacts["body"], impacts["support"], impacts["energy_lost"] = (11, 11, 12), (10, 10, 11), (0.3, 0.2, 0.25)
    return results.WallHistory(moving.time, moving.ids, moving.sizes, moving.free, moving.position, moving.orientation, forces=moving.forces, impacts=impacts,
                               energies=np.tile([0, 0, 0, 0.4, 0, 0.75, 0.0], (4, 1)))


def test_energy_by_joint(tmp_path):
    """Force times way of the sliding joint, impacts by their pairs; the most dissipating first; what the engine counts beside it."""
    found = results.joint_energies(dissipating())
    assert found.table[["id1", "id2"]].tolist() == [(10, 11), (11, 12)]
    assert np.allclose(found["friction"], [6 * 0.06, 0]) and np.allclose(found["impact"], [0.5, 0.25]) and np.isnan(found["crack"]).all()
    assert np.allclose(found["total"], [0.86, 0.25]) and found.engine["friction"] == 0.4
    assert "friction: 0.36 J in the joints (0.4 J in the balance of the whole scene)" in str(found) and "blocks 10 and 11: 0.86 J (friction 0.36, impact 0.5)" in str(found)
    found.save(tmp_path / "joints.csv")
    assert (tmp_path / "joints.csv").read_text().splitlines()[:2] == ["id1,id2,friction (J),impact (J),crack (J),total (J)", "10,11,0.36,0.5,nan,0.86"]
    results.report(dissipating(), tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "Energy by joint" in page and "friction 0.36 J (0.4 J in the balance of the whole scene)" in page
    with pytest.raises(ValueError, match="recordForces=True"):
        results.joint_energies(rocking([0, 0.05]))
    silent = dissipating()
    silent.forces = None
    assert "friction: 0.4 J in the balance of the whole scene, and not known of the joints" in str(results.joint_energies(silent))


def test_forces_of_ties():
    """A strut: its largest tension and compression, each from its sample. A tie that broke between two samples carried its strength; one that was slack, nothing."""
    from masonry.results.history_tables import TIES

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
