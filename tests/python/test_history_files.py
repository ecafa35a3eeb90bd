"""Files of histories: the same bits again, tables, ParaView; written whole or not at all."""

import base64
import math
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from histories import ROUND, history, rocking
from masonry import _files, _pose, results


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


def test_paraview_relative_to_the_base(tmp_path):
    h = rocking([0, 0.1, -0.05], shift=(0.4, 0, 0))
    results.write_paraview(h, tmp_path / "h.pvd", relative=True)
    points = decoded(ElementTree.parse(tmp_path / "h/h_000002.vtu").getroot().find(".//Points/DataArray"))
    assert np.allclose(points.reshape(2, 8, 3), h.corners(2), rtol=0, atol=ROUND)


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "some.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError):
        with _files.written(path) as beside:
            with open(beside, "w") as file:
                file.write("half of the new")
            assert path.read_text() == "old"
            1 / 0
    assert path.read_text() == "old" and [p.name for p in tmp_path.iterdir()] == ["some.txt"]
    with _files.written(path) as first, _files.written(path) as second:  # two at the same time do not meet
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
            with _files.written(wrong):
                pass


def test_writers_that_fail_leave_the_old_file(tmp_path, monkeypatch):
    h = rocking([0, 0.1, 0.05])
    calls = {"wall.npz": h.save, "wall.csv": h.to_csv, "shape.png": lambda path: results.draw(h, path), "joints.png": lambda path: results.draw_joints(h, path),
             "film.gif": lambda path: results.film(h, path, frames_per_second=1, progress=False), "wall.pvd": lambda path: results.write_paraview(h, path)}
    for name, write in calls.items():
        write(tmp_path / name)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert set(before) == set(calls)
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(_files.os, "replace", full)  # the last that can fail
    for name, write in calls.items():
        with pytest.raises(OSError, match="No space left"):
            write(tmp_path / name)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before
    assert not [path.name for path in tmp_path.rglob(".*")]


def column(name, kind=float, *shape):
    return (name, kind, *shape)


IMPACTS = [column(name) for name in ("time", "body", "support", "restitution_asked", "restitution", "velocity", "energy_lost", "friction_demand", "capped")]
FORCES = [column("sample", int), column("id1", int), column("id2", int), column("force", float, 3), column("point", float, 3)]


@pytest.mark.parametrize("name, value, words", [
    ("about", "[1]", r"about = \[1\]: must be a dict"), ("about", "5", "about = 5: must be a dict"), ("about", "[" * 100000, "is no WallHistory"),
    ("about", '{"materials": {}}', r"about\['materials'\] = {}: must be a list"), ("about", '{"notes": [""]}', r"about\['notes'\] = \[''\]: must be texts"),
    ("time", np.array(0.0), r"time has the shape \(\): must be"), ("sizes", np.full((2, 3), np.nan), "sizes: must be positive and finite"),
    ("impacts", np.zeros(3), "impacts: must be None or a structured array with the columns time, body, "),
    ("impacts", np.zeros(2, dtype=[(name, "U3") for name, _ in IMPACTS]), "impacts: must be None .* of numbers"),
    ("forces", np.zeros(3), "forces: must be None or a structured array with the columns sample, id1, id2, force, point"),
    ("forces", np.zeros(2, dtype=[(name, float) for name, *_ in FORCES]), "forces: they name the body 0"),
    ("forces", np.array([(1, 10, 99, [0] * 3, [0] * 3)], dtype=FORCES), "forces: they name the body 99, which is not among the ids of the history"),
    ("forces", np.array([(9, 10, 11, [0] * 3, [0] * 3)], dtype=FORCES), "forces: must be vectors of three components, at samples of the history"),
    ("ids", np.array("x"), "is no WallHistory"), ("motion", np.array(["a", "b"]), "is no WallHistory"), ("position", np.zeros(3, dtype=[("x", float)]), "is no WallHistory")])
def test_files_with_other_contents_are_told_in_a_sentence(tmp_path, name, value, words):
    path = tmp_path / "h.npz"
    rocking([0, 0.1, 0.05]).save(path)
    np.savez(path, **{**np.load(path), name: value})
    with pytest.raises(ValueError, match=words) as refused:
        results.WallHistory.load(path)
    assert str(refused.value).startswith(f"path = {path}: is no WallHistory, or a damaged one") and "\n" not in str(refused.value)


@pytest.mark.parametrize("about", [{"materials": [{}]}, {"motions": [{"kind": 5}]}, {"model": {"gravity": 5}}, {"model": {"tolerance": "x"}}, {"solver": {"worstResidual": "x"}}])
def test_a_report_of_what_masonry_has_not_written_is_refused(tmp_path, about):
    pytest.importorskip("jinja2")
    h = rocking([0, 0.1, 0.05])
    h.about.update(about)
    with pytest.raises(ValueError, match="about of the history: must be what masonry has written"):
        results.report(h, tmp_path / "h.html")


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
