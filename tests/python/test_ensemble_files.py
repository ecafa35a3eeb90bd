"""The files of an ensemble and its slices, without YADE: the results of the cases are written here as a case would write them."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from masonry import _build, ensemble
from masonry.ensemble.cases import keys, path_of, plain
from masonry.ensemble.slices import of_slurm, slice_given

CASES = [{"peak": peak, "seed": seed, "wall": wall} for peak, seed, wall in ((0.4, 1, "pier"), (0.4, 2**40, "façade"), (0.8, 7, ""))]
TIMES = np.arange(5) * 0.5


def study(folder, change=lambda outcome, row: outcome, cases=CASES):
    """(script, folder) with results: the drift of row k has 5 - k samples."""
    script = folder / "scene.py"
    script.write_text("# of stone: √2\n")
    results = folder / "out"
    results.mkdir()
    for row, (case, key) in enumerate(zip(cases, keys(script.resolve(), "run", cases))):
        outcome = {"collapsed": row == 1, "peak_drift": 0.1 * row, "fallen": row, "verdict": "stands", "drift": TIMES[:5 - row] + row, "time": TIMES[:5 - row],
                   "hits": np.arange(2 * row).reshape(row, 2), "lean": np.full((2, 3), row, dtype=np.float32)}
        np.savez_compressed(path_of(results, key), case=plain(case), **{name: np.asarray(value) for name, value in change(outcome, row).items()})
    return script, results


def gathered(folder, change=lambda outcome, row: outcome, **more):
    script, results = study(folder, change)
    more = {"units": {"peak": "m/s^2", "drift": "1", "time": "s"}, "dimensions": {"drift": "time", "hits": ("hit", "of")}, **more}
    return ensemble.run(script, CASES, results, gather=True, **more), results


def test_xarray_reads_the_table_and_the_arrays(tmp_path):
    xarray = pytest.importorskip("xarray")
    table, folder = gathered(tmp_path)
    with xarray.open_dataset(folder / "ensemble.nc") as data:
        assert dict(data.sizes) == {"case": 3, "time": 5, "hit": 2, "of": 2, "lean_0": 2, "lean_1": 3}
        for name in table.dtype.names:
            assert data[name].dims == ("case",) and data[name].values.tolist() == table[name].tolist(), name
        assert set(data.coords) == {"peak", "seed", "wall", "time"} and data["collapsed"].dtype == bool
        assert data["time"].values.tolist() == TIMES.tolist() and data["drift"].dims == ("case", "time")
        drift = data["drift"].values
        for row in range(3):
            assert drift[row, :5 - row].tolist() == (TIMES[:5 - row] + row).tolist() and np.isnan(drift[row, 5 - row:]).all()
        assert data["hits"].values[2].tolist() == [[0, 1], [2, 3]] and np.isnan(data["hits"].values[0]).all()
        assert (data["lean"].values == np.arange(3)[:, None, None]).all() and data["lean"].dtype == np.float32
        assert {name: data[name].attrs.get("units") for name in ("peak", "drift", "time", "peak_drift", "verdict")} == \
            {"peak": "m/s^2", "drift": "1", "time": "s", "peak_drift": "1", "verdict": None}
        assert data.attrs["masonry"] == _build.VERSION and data.attrs["source"] == "# of stone: √2\n" and data.attrs["function"] == "run"
        assert data["collapsed"].groupby("peak").mean().values.tolist() == [0.5, 0]
    assert ensemble.dataset(folder).identical(xarray.load_dataset(folder / "ensemble.nc"))
    assert ensemble.dataset(folder)["peak_drift"].to_dataframe()["wall"].tolist() == ["pier", "façade", ""]


def test_the_table_is_read_as_it_was_returned(tmp_path):
    table, folder = gathered(tmp_path)
    assert ensemble.load(folder).tobytes() == table.tobytes() and ensemble.load(str(folder)).dtype == table.dtype


# a study's cases, and what the function returns for each
NAMES = [{"α": 1, "a/b": 2, "k": 10**30}, {"α": 2, "a/b": 3, "k": 7}]
RETURNED = [{"a_b": 1.0, "β": 2.0, "_": 3.0, "é": np.arange(2.0)}, {"a_b": 4.0, "β": 5.0, "_": 6.0, "é": np.arange(2.0) + 1}]


def results_of(folder, cases, returned):
    """(script, folder) with results as the cases write them."""
    script, results = folder / "scene.py", folder / "out"
    script.write_text("")
    results.mkdir()
    for case, key, outcome in zip(cases, keys(script.resolve(), "run", cases), returned):
        np.savez_compressed(path_of(results, key), case=plain(case), **{name: np.asarray(value) for name, value in outcome.items()})
    return script, results


def test_columns_of_any_name_are_kept(tmp_path):
    script, folder = results_of(tmp_path, NAMES, RETURNED)
    table = ensemble.run(script, NAMES, folder, gather=True)
    assert table.dtype.names == ("α", "a/b", "k", "a_b", "β", "_") and table["k"].tolist() == [str(10**30), "7"]
    assert ensemble.load(folder).tolist() == table.tolist() and (folder / "ensemble.csv").read_text(encoding="utf-8").startswith("α,a/b,k,a_b,β,_\n")
    pytest.importorskip("xarray")
    data = ensemble.dataset(folder)
    found = {variable.attrs.get("long_name", name): variable.values.tolist() for name, variable in data.variables.items()}
    assert found == {**{name: table[name].tolist() for name in table.dtype.names}, "é": [[0, 1], [1, 2]]}
    assert set(data.coords) == {"__2", "a_b_2", "k"}


def test_tables_are_made_of_what_the_cases_have_returned(tmp_path, capsys):
    """Names that only some cases return, arrays of other dimensions and a name that is a key, too, lose no table: the cases have been computed."""
    cases = [{"x": 1, "seed": 1}, {"x": 1, "seed": 2}]
    script, folder = results_of(tmp_path, cases, [{"x": 0.5, "n": 3, "drift": np.zeros(3), "odd": np.zeros(2)}, {"x": 0.7, "late": True, "odd": np.zeros((2, 2))}])
    table = ensemble.run(script, cases, folder, gather=True)
    assert table.dtype.names == ("x", "seed", "x_result", "n", "late") and table["x_result"].tolist() == [0.5, 0.7]
    assert np.isnan(table["n"][1]) and table["n"][0] == 3 and np.isnan(table["late"][0]) and table["late"][1] == 1
    said = capsys.readouterr().out
    for words in ("x is a key of the cases and of what the function returns, which is x_result in the tables", "n is missing in 1 of 2 cases: it is nan there",
                  "odd is not in ensemble.nc: it has 1 or 2 dimensions"):
        assert words in said
    pytest.importorskip("xarray")
    assert set(ensemble.dataset(folder).variables) == {"x", "seed", "x_result", "n", "late", "drift"}


@pytest.mark.parametrize("case, words", [({"": 1}, "its key '' must be a text"), ({1: 2}, "its key 1 must be a text"), ({"a": "\ud800"}, "must be a dict of numbers"),
                                         ({"a": object()}, "must be a dict of numbers")])
def test_cases_that_no_table_can_hold_are_refused_first(tmp_path, case, words):
    script = tmp_path / "scene.py"
    script.write_text("")
    with pytest.raises(ValueError, match=words):
        ensemble.run(script, [case], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_results_of_another_case_are_not_taken(tmp_path, capsys):
    script, folder = study(tmp_path)
    first, second, third = (path_of(folder, key) for key in keys(script.resolve(), "run", CASES))
    third.write_bytes(second.read_bytes())
    first.unlink()
    first.mkdir()
    with pytest.raises(RuntimeError, match=r"2 of 3 cases are missing; 1 are kept") as error:
        ensemble.run(script, CASES, folder, gather=True)
    assert error.value.table["seed"].tolist() == [2**40]
    said = capsys.readouterr().out
    assert all(f"{path} is damaged, or of another case: its case counts as not yet computed" in said for path in (first, third))
    with pytest.raises(KeyError):
        ensemble.result(script, CASES[2], folder)


def test_whole_numbers_are_exact(tmp_path):
    xarray = pytest.importorskip("xarray")
    for name, value, kept in (("small", 2**31 - 1, 2**31 - 1), ("large", 2**53, 2.0**53), ("huge", 2**62 + 1, str(2**62 + 1))):
        (tmp_path / name).mkdir()
        _, folder = gathered(tmp_path / name, lambda outcome, row: {**outcome, "hash": value})
        assert xarray.load_dataset(folder / "ensemble.nc")["hash"].values.tolist() == [kept] * 3


def test_files_have_the_same_bytes_in_every_process(tmp_path):
    # Sets of names are in another order for another seed of the hashes.
    script, folder = study(tmp_path)
    program = f"from masonry import ensemble\nensemble.run({str(script)!r}, {CASES!r}, {str(folder)!r}, gather=True)"
    found = set()
    for seed in "123":
        subprocess.run([sys.executable, "-c", program], check=True, env={**os.environ, "PYTHONHASHSEED": seed})
        found.add(tuple((folder / f"ensemble.{ending}").read_bytes() for ending in ("npz", "nc", "csv")))
    assert len(found) == 1


def test_what_is_missing_is_told_and_the_rest_gathered(tmp_path):
    script, folder = study(tmp_path)
    path_of(folder, keys(script.resolve(), "run", CASES)[1]).unlink()
    with pytest.raises(RuntimeError, match=r"1 of 3 cases are missing; 2 are kept in .*\n.*'seed': 1099511627776.*: it has no result yet") as error:
        ensemble.run(script, CASES, folder, gather=True)
    assert error.value.table["seed"].tolist() == [1, 7] == ensemble.load(folder)["seed"].tolist()
    key = keys(script.resolve(), "run", CASES)[1]
    (folder / f"case_{key}.log").write_text("what it said")  # as compute() leaves it
    with pytest.raises(RuntimeError, match=rf"1 of 3 cases are missing, 1 of which failed; 2 are kept in .*\n.*: it failed: .*case_{key}.log"):
        ensemble.run(script, CASES, folder, gather=True)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_slices_are_the_cases_once(tmp_path, count):
    script, folder = study(tmp_path)
    parts = [ensemble.run(script, CASES, folder, slice=(number, count)) for number in range(1, count + 1)]
    seeds = [seed for part in parts if part is not None for seed in part["seed"].tolist()]
    assert sorted(seeds) == sorted(case["seed"] for case in CASES) and not list(folder.glob("ensemble.*"))


def test_an_array_job_of_slurm_tells_its_slice():
    def variables(number, least, most, count, step=1):
        return {f"SLURM_ARRAY_TASK_{name}": str(value) for name, value in (("ID", number), ("MIN", least), ("MAX", most), ("COUNT", count), ("STEP", step))}

    assert of_slurm({}) is None and slice_given("3/40") == (3, 40) == slice_given((3, 40.0))
    for least, step in ((0, 1), (1, 1), (4, 3)):
        found = [of_slurm(variables(least + step * k, least, least + 3 * step, 4, step)) for k in range(4)]
        assert found == [(1, 4), (2, 4), (3, 4), (4, 4)]
    with pytest.raises(ValueError, match="SLURM_ARRAY_TASK_ID = 5: the array of 3 tasks from 1 to 7 has gaps"):
        of_slurm(variables(5, 1, 7, 3))


def test_bad_input_is_refused(tmp_path):
    script, folder = study(tmp_path)

    def run(**more):
        return lambda: ensemble.run(script, CASES, folder, **more)

    for act, word in ((run(slice="0/4"), "slice = '0/4': must be like '3/40'"), (run(slice="5/4"), "slice = '5/4'"), (run(slice=(1.5, 4)), "slice ="),
                      (run(slice=3), "slice = 3"), (run(slice="1/4", gather=True), "must be None with gather"), (run(executor=4), "executor = 4"),
                      (run(executor=ThreadPoolExecutor(1), processes=2), "processes = 2: must be None with an executor"), (run(gather=True, dimensions={"none": "x"}), "dimensions: none is no array"),
                      (run(gather=True, dimensions={"drift": ("a", "b")}), "must be 1 names"), (run(gather=True, dimensions={"drift": "peak"}), "must not be a column"),
                      (run(gather=True, dimensions={"time": "drift"}), "drift: must be one array that all cases share")):
        with pytest.raises(ValueError, match=word):
            act()
    with pytest.raises(FileNotFoundError, match="there is no .*ensemble.nc: run the study"):
        ensemble.dataset(tmp_path)
    with pytest.raises(FileNotFoundError, match="there is no .*ensemble.npz: run the study"):
        ensemble.load(tmp_path)


@pytest.mark.parametrize("damage", [b"", b"CDF", b"a line of text\n", None])
def test_damaged_files_are_told_in_a_sentence(tmp_path, damage):
    _, folder = gathered(tmp_path)
    for name, read in (("ensemble.npz", ensemble.load), ("ensemble.nc", ensemble.dataset)):
        if name == "ensemble.nc":
            pytest.importorskip("xarray")
        path = folder / name
        path.write_bytes(path.read_bytes()[:200] if damage is None else damage)
        with pytest.raises(ValueError, match=f"path = .*{name}: is no table of an ensemble, or a damaged one"):
            read(folder)


def test_a_package_that_is_missing_is_named(tmp_path, monkeypatch, capsys):
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "scipy.io", None)
        table, folder = gathered(tmp_path)
    assert "apt install python3-scipy" in capsys.readouterr().out and sorted(f.name for f in folder.glob("*ensemble*")) == ["ensemble.csv", "ensemble.npz"]
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match="apt install python3-xarray"):
        ensemble.dataset(tmp_path)
