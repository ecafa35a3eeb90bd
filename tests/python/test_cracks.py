"""Cracks of histories made by hand: tables, time lines, files, pictures, and histories of before."""

import base64
import csv
import json
import xml.etree.ElementTree

import numpy as np
import pytest
from histories import ROUND, history
from masonry import results
from masonry.results.bonds import BONDS, DAMAGE, bond_table
from masonry.results.history_tables import TIES
from masonry.results.reporting import view3d



def cracking(**given):
    """Two blocks 1 x 0.5 x 0.4 on a base, at 0, 0.5 and 1 s, whose joints crack; energies are 2 J and 4 J times the mean damage."""
    bonds = np.zeros(2, dtype=BONDS)
    bonds["body1"], bonds["body2"], bonds["center"], bonds["area"] = [10, 11], [11, 12], [[0, 0, 0], [0, 0, 0.4]], [0.5, 0.25]
    bonds["cracked"], bonds["broken"] = [0.3, 0.7], [0.8, np.nan]
    damage = np.zeros((3, 2), dtype=DAMAGE)
    damage["damage"] = [[0, 0], [0.5, 0], [1, 0.125]]
    damage["worst"] = [[0, 0], [0.75, 0.01], [1, 0.25]]
    damage["by_tension"] = [[0, 0], [1, 0], [1, 0.25]]
    damage["energy_tension"], damage["energy_shear"] = damage["damage"] * [2, 1], damage["damage"] * [0, 3]
    damage["opening"], damage["slip"] = damage["damage"] * [1e-3, 0], damage["damage"] * [0, 1e-3]
    for name in set(bonds.dtype.names) & set(damage.dtype.names):
        bonds[name] = damage[name][-1]
    bonds["mode"] = ["tension", "shear"]
    positions = np.array([[[0, 0, -0.1], [0, 0, 0.2], [0, 0, 0.6]]] * 3)
    positions[2, 1:, 2] += 0.1
    return history([[2, 2, 0.2], [1, 0.5, 0.4], [1, 0.5, 0.4]], positions, **{**dict(bonds=bonds, damage=damage, energies=np.zeros((3, 7))), **given})


def test_the_table_at_an_instant():
    own = cracking()
    last = results.cracks(own)
    assert (last.table == own.bonds).tolist() == [True, False]  # the second has NaN
    assert last["mode"].tolist() == ["tension", "shear"] and last.energy == 2.5 and last.mean_damage == pytest.approx((0.5 + 0.125 * 0.25) / 0.75, rel=ROUND)
    assert last.cracked["body1"].tolist() == [10, 11] and len(last) == 2
    assert "2 of 2 joints cracked by 1 s: 1 in tension, 1 in shear, 1 broken; the first at 0.3 s, of bodies 10 and 11; 2.5 J" in str(last)
    middle = results.cracks(own, 0.5)
    assert middle["damage"].tolist() == [0.5, 0] and middle["mode"].tolist() == ["tension", "shear"] and middle.energy == 1
    assert middle["cracked"][0] == 0.3 and np.isnan(middle["cracked"][1]) and np.isnan(middle["broken"]).all()
    assert middle.cracked["body2"].tolist() == [11]  # a largest D of 0.01 is no crack
    assert str(results.cracks(own, 0)) == "0 of 2 joints cracked by 0 s"


def test_the_time_line():
    table = results.cracks(cracking()).timeline
    assert table["time"].tolist() == [0, 0.5, 1] and table["tension"].tolist() == [0, 1, 1] and table["shear"].tolist() == [0, 0, 1]
    assert table["broken"].tolist() == [0, 0, 1] and table["energy_tension"].tolist() == [0, 1, 2.125] and table["energy_shear"].tolist() == [0, 0, 0.375]
    assert len(results.cracks(cracking(), 0.5).timeline) == 2


def test_cracks_are_in_the_balance_of_energies():
    energies = np.zeros((3, 7))
    energies[:, 6] = [0, 1, 2.5]  # the work of the base is what the cracks spend
    energy = cracking(energies=energies).energy
    assert energy["crackDissip"].tolist() == [0, 1, 2.5] and not energy["error"].any()


def test_files(tmp_path):
    own = cracking()
    own.save(tmp_path / "wall.npz")
    back = results.WallHistory.load(tmp_path / "wall.npz")
    assert back.bonds.dtype == own.bonds.dtype and back.bonds.tobytes() == own.bonds.tobytes() and back.damage.tobytes() == own.damage.tobytes()
    results.cracks(back).save(tmp_path / "cracks.csv")
    with open(tmp_path / "cracks.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["mode"] for row in rows] == ["tension", "shear"] and [float(row["cracked (s)"]) for row in rows] == [0.3, 0.7]
    assert [float(row["center z (m)"]) for row in rows] == [0, 0.4] and float(rows[1]["damage (1)"]) == 0.125
    own.to_csv(tmp_path / "wall.csv")
    assert "crackDissip (J)" in (tmp_path / "wall.csv").read_text().splitlines()[0]


def test_histories_of_before_have_no_cracks(tmp_path):
    """A file without bonds and damage, as versions without mortar wrote it."""
    cracking().save(tmp_path / "wall.npz")
    with np.load(tmp_path / "wall.npz") as file:
        np.savez(tmp_path / "old.npz", **{name: file[name] for name in file if name not in ("bonds", "damage")})
    old = results.WallHistory.load(tmp_path / "old.npz")
    found = results.cracks(old)
    assert old.bonds is None and old.damage is None and len(found) == 0 and str(found) == "no joint has mortar" and "crackDissip" not in old.energy.dtype.names
    assert found.energy == 0 and np.isnan(found.mean_damage) and not found.timeline["tension"].any()
    with pytest.raises(ValueError, match="no joint of it has mortar"):
        found.picture(tmp_path / "cracks.png")
    results.report(old, tmp_path / "old.html")
    assert "Cracks of the mortar" not in (tmp_path / "old.html").read_text()


def test_pictures_and_reports(tmp_path):
    own = cracking()
    results.cracks(own).picture(tmp_path / "cracks.svg", view=(0, -1, 0), title="pier")
    assert "pier: 2 of 2 joints cracked at 1.000 s" in results.cracks(own).figure(title="pier").axes[0].get_title()
    results.cracks(own, 0).picture(tmp_path / "sound.png")
    results.report(own, tmp_path / "wall.html")
    text = (tmp_path / "wall.html").read_text()
    assert "Cracks of the mortar" in text and "2 of 2 joints cracked" in text and "Table of cracks" in text


def test_colours_are_those_of_the_damage():
    """Drawn last, on the top: the joint that is worst. Lines of D = 1 have the darkest colour of the scale, and those of sound joints are grey."""
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    for time, ends in ((None, (0.125, 1)), (0.5, (0, 0.5))):
        drawn = [one for one in results.cracks(cracking(), time).figure(view=(0, -1, 0)).axes[0].collections if isinstance(one, PolyCollection)][-1]
        for color, value in zip(drawn.get_facecolor(), ends):
            expected = colormaps["YlOrRd"](0.12 + 0.88 * value)[:3] if value else (0.85,) * 3
            assert np.abs(color[:3] - expected).max() < 0.02


def test_the_map_shows_the_face_of_a_wall():
    """1 m along x and 0.5 m along y: from the front; turned by a quarter: from the right.."""
    assert results.cracks(cracking()).figure().axes[0].get_xlabel() == "x (m)"
    own = cracking()
    turned = results.WallHistory(own.time, own.ids, own.sizes[:, [1, 0, 2]], own.free, own.position, own.orientation, bonds=own.bonds, damage=own.damage)
    assert results.cracks(turned).figure().axes[0].get_xlabel() == "y (m)"


def test_paraview(tmp_path):
    """Two rectangles a sample, fixed to the first bodies of their joints."""
    import base64

    results.write_paraview(cracking(), tmp_path / "wall.pvd")
    assert (tmp_path / "wall.pvd").read_text().count('part="2"') == 3

    def array(name, kind):
        element = next(one for one in tree.iter("DataArray") if one.get("Name") == name)
        return np.frombuffer(base64.b64decode(element.text)[8:], dtype=kind)

    tree = xml.etree.ElementTree.parse(tmp_path / "wall/wall_joints_000002.vtu")
    points = array("Points", "<f8").reshape(-1, 3)
    assert array("offsets", "<i8").tolist() == [4, 8] and array("types", "u1").tolist() == [7, 7]
    assert np.abs(points[:4, 2]).max() < ROUND and np.abs(points[4:, 2] - 0.5).max() < ROUND
    assert np.ptp(points[:4], axis=0)[:2] == pytest.approx([1, 0.5], abs=ROUND)
    assert array("damage", "<f8").tolist() == [1, 0.125] and array("mode", "<i8").tolist() == [1, 2]


def test_a_part_of_a_structure_keeps_its_joints():
    own = cracking(free=[False, True, True])
    assert results.cracks(own.on_base(10)).energy == 2.5


def test_a_part_of_a_structure_keeps_its_ties():
    """Those between its bodies; none: None."""
    own = cracking(free=[False, True, True])
    one, other, stranger = own.ids[0], own.ids[1], own.ids.max() + 1
    ties = np.zeros((len(own.time), 2), dtype=TIES)
    ties["body1"], ties["body2"], ties["force"] = [one, other], [other, stranger], [3.0, 5.0]
    for columns, forces in (([0, 1], [3.0]), ([1], None)):
        history = results.WallHistory(own.time, own.ids, own.sizes, own.free, own.position, own.orientation, ties=ties[:, columns])
        found = history.on_base(10).ties
        assert found is None if forces is None else found["force"][-1].tolist() == forces


def test_rows_of_the_engine_become_a_sorted_table():
    state = np.arange(26.0).reshape(2, 13)
    state[:, 6] = [0.5, 0.4]
    table, order = bond_table([5, 3, 1, 2], state)
    assert order.tolist() == [1, 0] and table["body1"].tolist() == [1, 3] and table["body2"].tolist() == [2, 5]
    assert table["center"][0].tolist() == [13, 14, 15] and table["mode"].tolist() == ["shear", "tension"] and table["broken"].tolist() == [25, 12]
    assert table["opening"][1] == 7 and table["energy_shear"][1] == 10 and table["area"][1] == 3


def test_bad_input(tmp_path):
    own = cracking()
    for changes in (dict(bonds=None), dict(damage=None), dict(damage=own.damage[:2]), dict(bonds=own.bonds[["body1", "body2"]])):
        with pytest.raises(ValueError, match="bonds, damage: must both be None"):
            cracking(**changes)
    with pytest.raises(ValueError, match="time = 3: must be from 0 to 1 s"):
        results.cracks(own, 3)
    with pytest.raises(ValueError, match="must be a WallHistory"):
        results.cracks(3)
    with pytest.raises(ValueError, match="must end in .csv"):
        results.cracks(own).save(tmp_path / "cracks.txt")
    with pytest.raises(KeyError, match="must be one of body1"):
        results.cracks(own)["width"]


def test_the_view_has_a_band_around_each_joint():
    """At the side faces of the joint, a little outside, in the axes of the block below; with the damage of each frame."""
    own = cracking()
    scene = json.loads(view3d.scene(own, 0.0))
    damage = np.frombuffer(base64.b64decode(scene["damage"]), dtype="<f4").reshape(len(scene["time"]), 2)
    assert np.array_equal(damage, own.damage["damage"])
    for band, top, (wide, deep), area in zip(scene["joints"], (0.1, 0.2), ((1, 0.5), (1, 0.5)), (0.5, 0.25)):
        corners = np.array(band["vertices"]).reshape(-1, 2, 3)
        assert len(corners) == 4 and np.allclose(corners[:, :, 2].mean(axis=1), top, atol=2e-6)
        assert np.allclose(np.ptp(corners[..., 2], axis=1), 0.08 * np.sqrt(area), atol=2e-6)
        out = 0.01 * np.sqrt(area)
        assert np.all(np.abs(corners[..., 0]) > wide / 2) and np.all(np.abs(corners[..., 0]) < wide / 2 + out) and np.all(np.abs(corners[..., 1]) < deep / 2 + out)
    assert [band["block"] for band in scene["joints"]] == [0, 1]
    assert "joints" not in json.loads(view3d.scene(cracking(bonds=None, damage=None), 0.0))
