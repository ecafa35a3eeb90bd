"""ensemble.run: finds what is missing, has it computed, and gathers the table."""

import os
import sys
from collections.abc import Iterable
from pathlib import Path

from .._given import is_whole, positive_given, shown
from .cases import clear, keys, load_all, path_of, read
from .slices import asked, slice_given
from .submitting import run_missing
from .table import make_table, tidied, write_tables

# Failed cases that the error names.
_NAMED = 10


class CasesFailed(RuntimeError):
    """Some cases have no result. Its attribute `table` has the others; None: there are none."""

    def __init__(self, message, table):
        super().__init__(message)
        self.table = table


def run(script, cases, folder, function="run", processes=None, time_limit=None, progress=None, executor=None, slice=None, gather=False, units=None,
        dimensions=None):
    """Calls the function `function(case)` of a Python file inside YADE, one process a case, and returns the table of what came out.

    script        path of the file; importing it must not run anything
    cases         dicts of numbers, strings, None, and lists of them (which the table has as text, as it has None), all with the same keys: what the
                  function is given
    folder        one .npz file a finished case, and the tables ensemble.nc, ensemble.csv and ensemble.npz; made if it is not there
    processes     how many run at once on this machine; None: one for each core that this process may use. Each has one thread.
    time_limit    s of wall clock after which a case is stopped, and counts as failed unless its result is there; None: no limit
    progress      a progress bar (tqdm); None: where stderr is a terminal
    executor      where the cases run: any executor of concurrent.futures, for instance mpi4py.futures.MPIPoolExecutor() or the get_executor() of a Dask
                  Client. Its workers start YADE; script, folder and masonry must be on a file system that they share. None: on this machine.
    slice         'k/n' or (k, n): computes only the cases k, k + n, k + 2n, ... and returns their table, without writing tables. Several slices may run
                  in one folder at a time. 'slurm': the slice of the Slurm array job that this is, or all cases outside of one.
    gather        True: computes nothing and makes the tables of what is there; an error tells how many cases are missing
    units         {name: unit} for the columns and arrays in ensemble.nc; those of results.CollapseReport.numbers() are known
    dimensions    {array: name of its dimension, or a list of them} for arrays that the function returns; see ensemble.dataset()

    The function returns a dict of numbers (and, if it likes, arrays: ensemble.result() and ensemble.dataset() read them), the same keys for every case; where a
    case lacks one, NaN or an empty text stands in the tables, and a line tells. A name that is a key of the cases, too, has `_result` behind it there.
    Results are kept: a later call computes only cases that have none, or whose values, script, files named in them or masonry package
    have changed since, or whose file is damaged or that of another case, which a line tells. Other files that the function reads, and modules beside the script, are not looked into.
    The tables have the same bytes wherever and in whatever order the cases ran.

    Table: a structured array, one row a case in the order of `cases`: what the case says, then what its numbers are. None for a slice without a case.
    Raises ValueError for cases that cannot be told apart or written down; RuntimeError, after all the others have run, for cases that failed (their
    output is in the folder as .log): its attribute `table` has the others, as have the tables in the folder; FileNotFoundError where there is no
    script or no YADE. What is finished when it is interrupted (Ctrl-C) is kept.
    """
    script, folder = Path(script).resolve(strict=True), Path(folder)
    cases = _checked(cases)
    if processes is not None and not is_whole(processes, 1):
        raise ValueError(f"processes = {shown(processes)}: must be a whole number, at least 1, or None")
    if time_limit is not None:
        positive_given("time_limit", time_limit, ", in s, or None")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise ValueError(f"executor = {shown(executor)}: must be an executor of concurrent.futures, with a method submit, or None")
    if executor is not None and processes is not None:
        raise ValueError(f"processes = {shown(processes)}: must be None with an executor, which has its own")
    if slice is not None and gather:
        raise ValueError(f"slice = {shown(slice)}: must be None with gather=True, which takes all cases")
    part = slice_given(slice) if slice is not None else None if gather else asked.slice
    gather = gather or slice is None and asked.gather
    found = keys(script, function, cases)
    if len(set(found)) < len(found):
        raise ValueError(f"case = {next(c for c, k in zip(cases, found) if found.count(k) > 1)}: stands there twice")
    if part:
        cases, found = cases[part[0] - 1::part[1]], found[part[0] - 1::part[1]]
    folder.mkdir(parents=True, exist_ok=True)
    outcomes = load_all(folder, found, cases)
    missing = [(case, key) for case, key in zip(cases, found) if outcomes[key] is None]
    failures = []
    if missing and not gather:
        try:
            failures = run_missing(script, function, missing, len(cases), folder, executor, int(processes or len(os.sched_getaffinity(0))), time_limit, progress)
        except KeyboardInterrupt:
            kept = sum(read(path_of(folder, key), case) is not None for case, key in zip(cases, found))
            raise KeyboardInterrupt(f"interrupted: {kept} of {len(cases)} cases are kept in {folder}; run again to go on") from None
        outcomes.update(load_all(folder, [key for _, key in missing], [case for case, _ in missing]))
    told = [case for case, *_ in failures]
    without = [(case, folder / f"case_{key}.log") for case, key in missing if outcomes[key] is None and case not in told]
    failures += [(case, _why_without(log, gather), "") for case, log in without]
    finished = [(case, outcomes[key]) for case, key in zip(cases, found) if outcomes[key] is not None]
    done, returned = zip(*finished) if finished else ((), ())
    returned = tidied(done, returned) if finished else []
    table = make_table(done, returned) if finished else None
    if finished and not part:
        write_tables(folder, table, returned, len(cases[0]), script, function, units or {}, dimensions or {})
        clear(folder, {key for key in found if outcomes[key] is not None})
    if failures:
        raise _failed(failures, table, len(cases), folder, part, gather)
    if part and part is asked.slice:
        print(f"masonry.ensemble: slice {part[0]}/{part[1]}: its {len(cases)} cases are in {folder}")
        sys.exit(0)
    return table


def _checked(cases):
    if not isinstance(cases, Iterable):
        raise ValueError(f"cases = {shown(cases)}: must be a list of dicts")
    cases = list(cases)
    if not cases:
        raise ValueError("cases: must have at least one")
    for case in cases:
        if not isinstance(case, dict):
            raise ValueError(f"case = {shown(case)}: must be a dict of numbers, strings, None, and lists of them")
        for name in case:
            if not (isinstance(name, str) and name):
                raise ValueError(f"case = {shown(case)}: its key {name!r} must be a text that is not empty: it names a column of the table")
        if case.keys() != cases[0].keys():
            raise ValueError(f"case = {case}: must have the same keys as the first, {', '.join(cases[0])}")
    return cases


def _why_without(log, gather):
    """Why a case that has not been run now has no result."""
    if not gather:
        return "its result has vanished since it was computed"
    return f"it failed: {log}" if log.exists() else "it has no result yet"


def _failed(failures, table, total, folder, part, gather):
    where = "the attribute `table` of this error" if part else "ensemble.nc, .csv and .npz there, and the attribute `table` of this error"
    kept = f"none is kept in {folder}" if table is None else f"{len(table)} are kept in {folder}: their table is {where}"
    named = [f"{case}: {why}" for case, why, _ in failures[:_NAMED]] + ([f"and {len(failures) - _NAMED} more"] if len(failures) > _NAMED else [])
    said = ["The first said:", failures[0][2]] if failures[0][2] else []
    ended = sum(why.startswith("it failed") for _, why, _ in failures)
    what = "failed" if not gather else "are missing" + (f", {ended} of which failed" if ended else "")
    return CasesFailed("\n".join([f"{len(failures)} of {total} cases {'of the slice ' if part else ''}{what}; {kept}", *named, *said]), table)


def result(script, case, folder, function="run"):
    """What the function returned for one case that has been run: a dict of numbers and arrays. KeyError: it has not, is out of date or damaged."""
    folder = Path(folder)
    outcome = None
    if folder.is_dir():
        outcome, = load_all(folder, keys(Path(script).resolve(strict=True), function, [dict(case)]), [case]).values()
    if outcome is None:
        raise KeyError(f"{case} has no result in {folder}")
    return outcome
