"""One scene under many motions: each case in a YADE process of its own, only what is missing computed, and what the cases say together.

    # shaken.py: the scene
    def run(case):                                  # in YADE; case: a dict of plain values
        ...
        return results.collapse(dem.wall_history(recorder)).numbers()

    # study.py: plain Python
    from masonry import ensemble
    cases = [{"seed": seed, "scale": scale} for scale in (0.2, 0.4) for seed in range(50)]
    table = ensemble.run("shaken.py", cases, "results/study")
    print(ensemble.statistics(table, by="scale"))
"""

import csv
import hashlib
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ._files import read_npz, written
from ._given import array_given, is_whole, number_given, positive_given, shown

_RUN_CASE = Path(__file__).with_name("_run_case.py")
# Lines of what a failed case has said that the error repeats, and failed cases that it names.
_TAIL, _NAMED = 15, 10


def _plain(case):
    """The case as JSON, NumPy's numbers as Python's."""
    def convert(value):
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        raise TypeError

    try:
        return json.dumps(case, sort_keys=True, default=convert)
    except TypeError:
        raise ValueError(f"case = {shown(case)}: must be a dict of numbers, strings, None, and lists of them") from None


def _contents(paths):
    digest = hashlib.sha256()
    for path in paths:
        digest.update(hashlib.sha256(Path(path).read_bytes()).digest())
    return digest.hexdigest()


def _texts(value):
    """The strings in a plain value, those in lists too."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [text for item in value for text in _texts(item)]
    return [value] if isinstance(value, str) else []


def _keys(script, function, cases):
    """A name for each case: of its values, of the files that they name, of the script and of this package as it is installed."""
    package = Path(__file__).parent
    code = _contents([script, *sorted(f for f in package.rglob("*") if f.suffix in (".py", ".so") and f != Path(__file__))])
    keys, named = [], {}
    for case in map(_plain, cases):
        files = [text for text in _texts(json.loads(case)) if os.path.isfile(text)]
        named.update({file: _contents([file]) for file in files if file not in named})
        keys.append(hashlib.sha256(json.dumps([code, function, case, [named[file] for file in files]]).encode()).hexdigest()[:20])
    return keys


def run(script, cases, folder, function="run", processes=None, time_limit=None, progress=True):
    """Calls the function `function(case)` of a Python file inside YADE, one process a case, and returns the table of what came out.

    script        path of the file; importing it must not run anything
    cases         dicts of numbers, strings, None, and lists of them (which the table has as text, as it has None), all with the same keys: what the
                  function is given
    folder        one .npz file a finished case, and the tables ensemble.csv and ensemble.npz; made if it is not there
    processes     how many run at once; None: one a core. Each has one thread.
    time_limit    s of wall clock after which a case is stopped, and counts as failed unless its result is there; None: no limit
    progress      a progress bar (tqdm)

    The function returns a dict of numbers (and, if it likes, arrays: ensemble.result() reads them), the same keys for every case.
    Results are kept: a later call computes only cases that have none, or whose values, script, files named in them or masonry package
    have changed since, or whose file is damaged, which a line tells. Other files that the function reads, and modules beside the script, are not looked into.

    Table: a structured array, one row a case in the order of `cases`: what the case says, then what its numbers are.
    Raises ValueError for cases that cannot be told apart or written down; RuntimeError, after all the others have run, for cases that failed (their
    output is in the folder as .log): its attribute `table` has the others, as have the tables in the folder; FileNotFoundError where there is no
    script or no YADE. What is finished when it is interrupted (Ctrl-C) is kept.
    """
    script, folder = Path(script).resolve(strict=True), Path(folder)
    if not isinstance(cases, Iterable):
        raise ValueError(f"cases = {shown(cases)}: must be a list of dicts")
    cases = list(cases)
    if not cases:
        raise ValueError("cases: must have at least one")
    for case in cases:
        if not isinstance(case, dict):
            raise ValueError(f"case = {shown(case)}: must be a dict of numbers, strings, None, and lists of them")
        if case.keys() != cases[0].keys():
            raise ValueError(f"case = {case}: must have the same keys as the first, {', '.join(cases[0])}")
    if processes is not None and not is_whole(processes, 1):
        raise ValueError(f"processes = {shown(processes)}: must be a whole number, at least 1, or None")
    if time_limit is not None:
        positive_given("time_limit", time_limit, ", in s, or None")
    keys = _keys(script, function, cases)
    if len(set(keys)) < len(keys):
        raise ValueError(f"case = {next(c for c, k in zip(cases, keys) if keys.count(k) > 1)}: stands there twice")
    folder.mkdir(parents=True, exist_ok=True)
    outcomes = {key: _load(_path(folder, key)) for key in keys}
    missing = [(case, key) for case, key in zip(cases, keys) if outcomes[key] is None]
    try:
        failures = _run_missing(script, function, missing, len(cases), folder, int(processes or os.cpu_count()), time_limit, progress) if missing else []
    except KeyboardInterrupt:
        kept = sum(_read(_path(folder, key)) is not None for key in keys)
        raise KeyboardInterrupt(f"interrupted: {kept} of {len(cases)} cases are kept in {folder}; run again to go on") from None
    outcomes.update({key: _load(_path(folder, key)) for _, key in missing})
    told = [case for case, *_ in failures]
    failures += [(case, "its result has vanished since it was computed", "") for case, key in missing if outcomes[key] is None and case not in told]
    finished = [(case, outcomes[key]) for case, key in zip(cases, keys) if outcomes[key] is not None]
    table = _table(*zip(*finished)) if finished else None
    if finished:
        with written(folder / "ensemble.npz") as beside:
            np.savez(beside, table=table)
        with written(folder / "ensemble.csv") as beside, open(beside, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([table.dtype.names, *table.tolist()])
    if failures:
        raise _failed(failures, table, len(cases), folder)
    return table


def _failed(failures, table, total, folder):
    kept = f"none is kept in {folder}" if table is None else \
        f"{len(table)} are kept in {folder}: their table is ensemble.csv and ensemble.npz there, and the attribute `table` of this error"
    named = [f"{case}: {why}" for case, why, _ in failures[:_NAMED]] + ([f"and {len(failures) - _NAMED} more"] if len(failures) > _NAMED else [])
    error = RuntimeError("\n".join([f"{len(failures)} of {total} cases failed; {kept}", *named, "The first said:", failures[0][2]]))
    error.table = table
    return error


def result(script, case, folder, function="run"):
    """What the function returned for one case that has been run: a dict of numbers and arrays. KeyError: it has not, is out of date or damaged."""
    outcome = _load(_path(Path(folder), _keys(Path(script).resolve(strict=True), function, [dict(case)])[0]))
    if outcome is None:
        raise KeyError(f"{case} has no result in {folder}")
    return outcome


def _path(folder, key):
    return folder / f"case_{key}.npz"


def _load(path):
    """What a case returned; None where it has no file, or a damaged one, which a line tells."""
    outcome = _read(path)
    if outcome is None and path.exists():
        print(f"masonry.ensemble: {path} is damaged: its case counts as not yet computed")
    return outcome


def _read(path):
    """What a case returned; None where it has no file, or a damaged one."""
    try:
        found = read_npz(path, "result")
    except (FileNotFoundError, ValueError):
        return None
    return {name: value if value.ndim else value.item() for name, value in found.items() if name != "case"}


@contextmanager
def _termination():
    """What a queue sends before it kills (SIGTERM), and a terminal that closes (SIGHUP), end the run as Ctrl-C does, unless the program has a way
    of its own."""
    main = threading.current_thread() is threading.main_thread()
    taken = [number for number in (signal.SIGTERM, signal.SIGHUP) if main and signal.getsignal(number) is signal.SIG_DFL]
    for number in taken:
        signal.signal(number, lambda number, frame: sys.exit(128 + number))
    try:
        yield
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


def _run_missing(script, function, missing, total, folder, processes, time_limit, progress):
    """[(case, why, last lines of its output)] of those that failed."""
    from tqdm import tqdm

    yade = shutil.which("yade")
    if yade is None:
        raise FileNotFoundError("there is no YADE: install it with `apt install yade`")
    package = str(Path(__file__).parents[1])
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive",
                   "PYTHONPATH": os.pathsep.join([package, str(script.parent), os.environ.get("PYTHONPATH", "")])}
    running, lock, stopped, failures = set(), threading.Lock(), threading.Event(), []

    def one(case, key, bar):
        log, path = folder / f"case_{key}.log", _path(folder, key)
        own = log.with_suffix(f".{os.getpid()}.log")  # another run of the same case may be at work in the folder
        arguments = json.dumps({"script": str(script), "function": function, "case": json.loads(_plain(case)), "path": str(path.resolve()),
                                "parent": os.getpid()})
        with lock:
            if stopped.is_set():
                return
            with open(own, "w", encoding="utf-8") as output:
                process = subprocess.Popen([yade, "-j1", "-n", "-x", str(_RUN_CASE), arguments], env=environment, stdin=subprocess.DEVNULL,
                                           stdout=output, stderr=subprocess.STDOUT)
            running.add(process)
        try:
            process.wait(time_limit)
            why = f"it ended with status {process.returncode}"
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            why = f"it was stopped after {time_limit:g} s"
        if _read(path) is not None:  # it is done, however it ended
            why = ""
        elif path.exists():
            why += ", and its result cannot be read"
        with lock:
            running.discard(process)
            if why and not stopped.is_set():
                os.replace(own, log)
                said = log.read_text(encoding="utf-8", errors="replace").splitlines()[-_TAIL:]
                failures.append((case, f"{why}: {log}", "\n".join(said)))
                bar.set_postfix(failed=len(failures))
            else:
                own.unlink()
            bar.update(not stopped.is_set())

    with _termination(), tqdm(total=total, initial=total - len(missing), desc="ensemble", unit="case", disable=not progress) as bar, \
            ThreadPoolExecutor(processes) as pool:
        waiting = [pool.submit(one, case, key, bar) for case, key in missing]
        try:
            for future in waiting:
                future.result()
        except BaseException:  # interrupted: what runs is ended, what is finished is kept
            with lock:
                stopped.set()
                for process in running:
                    process.kill()
            for future in waiting:
                future.cancel()
            raise
    return failures


def _cell(value):
    """A value of a case as the table has it: a number or text."""
    value = value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value
    return str(value) if value is None or isinstance(value, (list, tuple, dict)) else value


def _table(cases, outcomes):
    for case, outcome in zip(cases, outcomes):
        if outcome.keys() != outcomes[0].keys():
            raise ValueError(f"case = {case}: returned {', '.join(outcome)}, and the first {', '.join(outcomes[0])}: must be the same for every case")
    numbers = [name for name, value in outcomes[0].items() if np.ndim(value) == 0]
    both = set(cases[0]) & set(numbers)
    if both:
        raise ValueError(f"{', '.join(sorted(both))}: must not be a key of the case and of what the function returns")
    columns = {name: np.array([_cell(case[name]) for case in cases]) for name in cases[0]}
    columns.update({name: np.array([outcome[name] for outcome in outcomes]) for name in numbers})
    table = np.zeros(len(cases), dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        table[name] = column
    return table


# --- statistics ---


def _check_confidence(confidence):
    if not 0 < number_given("confidence", confidence) < 1:
        raise ValueError(f"confidence = {confidence}: must be above 0 and below 1")


def fraction(events, confidence=0.95):
    """(share of True, lower and upper end of its confidence interval), by Clopper and Pearson: the interval holds the true probability in at least
    `confidence` of all ensembles. events: bools, one a case, at least one."""
    from scipy.stats import binomtest

    _check_confidence(confidence)
    events = np.asarray(events).ravel()
    if not len(events) or not np.isin(events, (0, 1)).all():
        raise ValueError("events: must be True or False, at least one")
    events = events.astype(bool)
    interval = binomtest(int(events.sum()), len(events)).proportion_ci(confidence, method="exact")
    return float(events.mean()), float(interval.low), float(interval.high)


def quantile(values, probability, confidence=0.95):
    """(quantile, lower and upper end of its confidence interval) of numbers of which some may be infinite.

    The quantile is the ceil(n probability)-th of the n values in order, so that infinite ones (a collapse has no largest drift) take part. The
    interval's ends are values of the sample, or infinite where the sample is too small to bound it: the number of values below the
    true quantile is binomial, whatever their distribution, and on either side at most (1 - confidence)/2 is left out.
    probability: above 0 and below 1. Raises ValueError for NaN.
    """
    from scipy.stats import binom

    _check_confidence(confidence)
    if not 0 < number_given("probability", probability) < 1:
        raise ValueError(f"probability = {probability}: must be above 0 and below 1")
    values = np.sort(np.asarray(values, dtype=float).ravel())
    if not len(values) or np.isnan(values).any():
        raise ValueError(f"values: must be at least one number, without NaN; {int(np.isnan(values).sum())} of {len(values)} are NaN")
    count, outside = len(values), (1 - confidence) / 2
    padded = np.concatenate([[-math.inf], values, [math.inf]])
    # K, the number of values below the quantile, is binomial. The r-th value is above the quantile when K < r: the lower end is the largest r with
    # P(K < r) <= outside; it is below when K >= r: the upper end is the least r with P(K >= r) <= outside. r = 0 and n + 1: infinity.
    ranks = np.arange(count + 2)
    low = np.flatnonzero(binom.cdf(ranks - 1, count, probability) <= outside)[-1]
    high = np.flatnonzero(binom.sf(ranks - 1, count, probability) <= outside)[0]
    middle = math.ceil(count * probability * (1 - 1e-12))
    return float(values[max(middle, 1) - 1]), float(padded[low]), float(padded[high])


def statistics(table, by=None, probabilities=(0.16, 0.5, 0.84), confidence=0.95, event="collapsed", value="peak_drift"):
    """How often the event happened and how large the value was: a structured array, one row for each value of the column `by` (of a list of
    columns: for each combination of their values that occurs), or one for the whole table. Columns: those of `by`; cases; fraction, fraction_low,
    fraction_high (fraction()); and for each probability quantile_0.5, quantile_0.5_low, quantile_0.5_high (quantile()), where cases with the event
    count as infinite: quantiles are those of all cases, and infinite where more than that share has collapsed.

    table         of run(); its columns `event` (bool) and `value` (numbers) are those of results.CollapseReport.numbers()
    """
    by = [] if by is None else list(by) if isinstance(by, (list, tuple)) else [by]
    for name in (*by, event, value):
        if name not in table.dtype.names:
            raise ValueError(f"{shown(name)}: is no column of the table, which has {', '.join(table.dtype.names)}")
    chances = array_given("probabilities", probabilities)
    if chances.ndim != 1:
        raise ValueError(f"probabilities = {shown(probabilities)}: must be a list of numbers above 0 and below 1")
    made = [*by, "cases", *(f"fraction{end}" for end in ("", "_low", "_high")), *(f"quantile_{p:g}{end}" for p in chances for end in ("", "_low", "_high"))]
    twice = [name for name in dict.fromkeys(made) if made.count(name) > 1]
    if twice:
        raise ValueError(f"by = {by}, probabilities = {probabilities}: would make two columns {shown(twice[0])}: must all differ")
    groups, member = np.unique(table[by], return_inverse=True) if by else ([()], np.zeros(len(table), dtype=int))
    rows = []
    for number, group in enumerate(groups):
        part = table[member == number]
        happened = part[event].astype(bool)
        numbers = np.where(happened, np.inf, part[value])
        for name, column in ((event, part[event]), (value, numbers)):
            if np.isnan(column).any():
                which = " with " + ", ".join(f"{n} = {v}" for n, v in zip(by, group)) if by else ""
                raise ValueError(f"column {shown(name)}: {int(np.isnan(column).sum())} of {len(part)} cases{which} are NaN: "
                                 f"must be numbers{f', but where {event} is True' if name == value else ''}")
        row = [*group, len(part), *fraction(happened, confidence)]
        for probability in chances:
            row += quantile(numbers, probability, confidence)
        rows.append(tuple(row))
    kinds = [table.dtype[name] for name in by] + [int] + [float] * (len(made) - len(by) - 1)
    return np.array(rows, dtype=list(zip(made, kinds)))
