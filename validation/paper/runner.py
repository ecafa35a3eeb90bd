"""Runs cases in YADE, two processes at most, and keeps what is finished: a second call runs only what is missing."""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import threading
from dataclasses import asdict
from pathlib import Path

import masonry
import theory
from cases import COMPLIANT
from tqdm import tqdm

HERE = Path(__file__).resolve().parent
PROCESSES = min(2, os.cpu_count())


def _stamp():
    """Of the plugin and of the scripts that a result depends on: results of another build are not reused. The model is in Case.key."""
    plugin = Path(masonry.__file__).parent
    files = [plugin / "_yade.so", *sorted((plugin / "dem").glob("*.py")), HERE / "cases.py", HERE / "yade_runs.py"]
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).hexdigest()[:16]


def _expected_cost(case):
    """Compliant joints first: they take the longer."""
    return case.model == COMPLIANT, theory.history(case).impact_times.max(initial=0)


def _read(store, stamp):
    if not store.exists():
        return {}
    # A line without its end: the run was stopped while writing it.
    runs = [json.loads(line) for line in store.read_text().splitlines(keepends=True) if line.endswith("\n")]
    return {r["key"]: r for r in runs if r["stamp"] == stamp}


def run(cases, store, fresh):
    """What yade_runs.py reports, by Case.key. store: a file of one JSON line a finished case."""
    stamp = _stamp()
    runs = {} if fresh else _read(store, stamp)
    store.write_text("".join(json.dumps(r) + "\n" for r in runs.values()))
    missing = sorted((c for c in cases if c.key not in runs), key=_expected_cost, reverse=True)
    if not missing:
        return runs
    yade = shutil.which("yade")
    if yade is None:
        sys.exit("validation/paper needs YADE: install it with `apt install yade`.")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])}
    lock, failures = threading.Lock(), []

    def work(share, bar):
        arguments = json.dumps([asdict(c) for c in share])
        process = subprocess.Popen([yade, "-j1", "-n", "-x", str(HERE / "yade_runs.py"), arguments], env=environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        said = []
        for line in process.stdout:
            if not line.startswith("RESULT "):
                said.append(line)
                continue
            result = {**json.loads(line[len("RESULT "):]), "stamp": stamp}
            with lock, store.open("a") as file:
                file.write(json.dumps(result) + "\n")
                runs[result["key"]] = result
                bar.update()
        if any(c.key not in runs for c in share):
            failures.append("".join(said[-20:]))
        process.wait()

    with tqdm(total=len(cases), initial=len(cases) - len(missing), desc="YADE", unit="case", disable=None) as bar:  # drawn in terminals only
        threads = [threading.Thread(target=work, args=(missing[i::PROCESSES], bar)) for i in range(PROCESSES)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    if failures:
        sys.exit("YADE stopped before its last case:\n" + failures[0])
    return runs
