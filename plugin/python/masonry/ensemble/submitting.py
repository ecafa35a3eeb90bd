"""The missing cases through an executor: all are submitted, and all are ended when the run is."""

import os
import shutil
import signal
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from pathlib import Path

from .._progress import wanted
from .cases import code, plain
from .worker import compute


@contextmanager
def termination():
    """A queue's SIGTERM and a closing terminal's SIGHUP end the run as Ctrl-C does, unless the program has a way of its own."""
    main = threading.current_thread() is threading.main_thread()
    taken = [number for number in (signal.SIGTERM, signal.SIGHUP) if main and signal.getsignal(number) is signal.SIG_DFL]
    for number in taken:
        signal.signal(number, lambda number, frame: sys.exit(128 + number))
    try:
        yield
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def _going_on(folder):
    """Path of a file that is there for as long as the run goes on: workers on any machine look at it."""
    handle, path = tempfile.mkstemp(prefix=".run_", dir=folder)
    os.close(handle)
    try:
        yield path
    finally:
        Path(path).unlink(missing_ok=True)


def _failure(future):
    """What compute() has returned, or that its worker is lost."""
    try:
        return future.result()
    except Exception as error:  # each executor has its own
        return f"its worker was lost ({type(error).__name__}: {error})", ""


def run_missing(script, function, missing, total, folder, executor, processes, time_limit, progress):
    """[(case, why, last lines of its output)] of those that failed. executor: None for threads of this process, `processes` of them."""
    from tqdm import tqdm

    if executor is None and shutil.which("yade") is None:
        raise FileNotFoundError("there is no YADE: install it with `apt install yade`")
    failures, folder = [], folder.resolve()
    # The pool is left last: its threads end when the file has vanished.
    with termination(), ThreadPoolExecutor(processes) if executor is None else nullcontext(executor) as pool, _going_on(folder) as going_on, \
            tqdm(total=total, initial=total - len(missing), desc="ensemble", unit="case", disable=not wanted(progress)) as bar:
        common = {"script": str(script), "function": function, "code": code(script), "folder": str(folder), "going_on": going_on, "time_limit": time_limit}
        waiting = {pool.submit(compute, {**common, "case": plain(case), "key": key}): case for case, key in missing}
        try:
            for future in as_completed(waiting):
                failed = _failure(future)
                if failed:
                    failures.append((waiting[future], *failed))
                    bar.set_postfix(failed=len(failures))
                bar.update()
        finally:
            for future in waiting:
                future.cancel()
    order = [case for case, _ in missing]
    return sorted(failures, key=lambda failure: order.index(failure[0]))
