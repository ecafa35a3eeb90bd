"""The table of an ensemble, and the files that hold it."""

import csv
import hashlib
import platform
import warnings
from pathlib import Path

import numpy as np

from .. import _build
from .._files import read_npz, written
from . import netcdf


def _cell(value):
    """A value of a case as the table has it: a number or text."""
    value = value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value
    large = isinstance(value, int) and not -2**63 <= value < 2**63  # no integer of an array
    return str(value) if value is None or large or isinstance(value, (list, tuple, dict)) else value


def tidied(cases, outcomes):
    """The outcomes with the same names in every case: NaN, empty text or an empty array for what a case has not returned, and `_result` behind a name that is a
    key of the cases. A line tells of either."""
    known = dict.fromkeys(name for outcome in outcomes for name in outcome)
    names = {}
    for name in known:
        names[name] = name
        while names[name] in cases[0] or names[name] != name and names[name] in known:
            names[name] += "_result"
        if names[name] != name:
            print(f"masonry.ensemble: {name} is a key of the cases and of what the function returns, which is {names[name]} in the tables")
    missing = {}
    for name in known:
        found = [outcome[name] for outcome in outcomes if name in outcome]
        missing[name] = np.full((0,) * np.ndim(found[0]), np.nan) if np.ndim(found[0]) else "" if isinstance(found[0], str) else np.nan
        if len(found) < len(outcomes):
            print(f"masonry.ensemble: {name} is missing in {len(outcomes) - len(found)} of {len(outcomes)} cases: it is {missing[name]!r} there")
    return [{names[name]: outcome.get(name, missing[name]) for name in known} for outcome in outcomes]


def make_table(cases, outcomes):
    """A row a case: what the case says, and the numbers among what it returned, which tidied() has given the same names in every case."""
    numbers = [name for name in outcomes[0] if not any(np.ndim(outcome[name]) for outcome in outcomes)]
    columns = {name: np.array([_cell(case[name]) for case in cases]) for name in cases[0]}
    columns.update({name: np.array([outcome[name] for outcome in outcomes]) for name in numbers})
    table = np.zeros(len(cases), dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        table[name] = column
    return table


def write_tables(folder, table, outcomes, given, script, function, units, dimensions):
    """ensemble.npz, .csv and .nc. outcomes: what each case returned; given: how many columns are those of the cases."""
    with written(folder / "ensemble.npz") as beside, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that NumPy before 1.17 cannot read names of any letters
        np.savez(beside, table=table)
    with written(folder / "ensemble.csv") as beside, open(beside, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([table.dtype.names, *table.tolist()])
    arrays = {name: [outcome[name] for outcome in outcomes] for name in outcomes[0] if name not in table.dtype.names}
    text = script.read_bytes()
    attributes = {"title": "masonry.ensemble", "masonry": _build.VERSION, "yade": _build.YADE or "none", "python": platform.python_version(), "numpy": np.__version__,
                  "script": script.name, "script_sha256": hashlib.sha256(text).hexdigest(), "function": function, "source": text.decode(errors="replace")}
    try:
        with written(folder / "ensemble.nc") as beside:
            netcdf.write(beside, table, given, arrays, units, dimensions, attributes)
    except ImportError:
        print("masonry.ensemble: ensemble.nc is not written, which needs SciPy: install it with `apt install python3-scipy` and run this again")


def load(folder):
    """The table of a study, as run() returned it, from its folder. FileNotFoundError where there is none; ValueError where it is damaged."""
    path = _file(folder, "ensemble.npz")
    found = read_npz(path, "table of an ensemble")
    if "table" not in found:
        raise ValueError(f"path = {path}: is no table of an ensemble: must be a file that masonry has written")
    return found["table"]


def dataset(folder):
    """The study in a folder as an xarray.Dataset; xarray.open_dataset("<folder>/ensemble.nc") gives the same, and leaves the file open.

    The dimension `case` counts the rows of the table. What the cases say are coordinates, what the function returned are variables, arrays too: their
    further dimensions have the names that run(dimensions=...) gave. An array that is named as one of these dimensions is its coordinate, for instance
    `time` with dimensions={"drift": "time"}. Where the arrays of some cases are shorter than others, NaN (or the empty text) follows. Names with
    letters beyond those of English are spelled with _, and their attribute long_name has them. Attributes: units; versions of masonry, YADE, Python and
    NumPy; name, checksum and text of the script.
    Needs python3-xarray. Raises FileNotFoundError where there is no study, ValueError where its file is damaged.
    """
    try:
        import xarray
    except ImportError:
        raise ImportError("ensemble.dataset needs xarray: install it with `apt install python3-xarray`, or use ensemble.load()") from None
    path = _file(folder, "ensemble.nc")
    try:
        return xarray.load_dataset(path)
    except Exception as error:  # whatever the readers of xarray say of another file, or of one that was cut off
        raise ValueError(f"path = {path}: is no table of an ensemble, or a damaged one: must be a file that masonry has written ({str(error)[:100]})") from None


def _file(folder, name):
    path = Path(folder) / name
    if not path.is_file():
        raise FileNotFoundError(f"there is no {path}: run the study, or gather it with ensemble.run(..., gather=True)")
    return path
