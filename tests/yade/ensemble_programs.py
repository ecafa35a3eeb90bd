"""Programs that the tests of ensembles start, and what they leave."""

import os
import signal
import subprocess
import time
from pathlib import Path

import masonry

PYTHON = "/usr/bin/python3"
STUDY = str(Path(__file__).with_name("ensemble_study.py"))
ENVIRONMENT = {**{name: value for name, value in os.environ.items() if not name.startswith(("OMPI_", "PMIX_", "SLURM_"))},
               "PYTHONPATH": os.pathsep.join([str(Path(masonry.__file__).parents[1]), str(Path(__file__).parent)])}
MPI = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "3", PYTHON, "-m", "mpi4py.futures"]


def start(*command, **more):
    return subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**ENVIRONMENT, **more})


def end(*command, **more):
    """What a program has said; an AssertionError unless it ends well."""
    process = start(*command, **more)
    try:
        said = process.communicate(timeout=280)[0]
    finally:
        process.kill()
    assert process.returncode == 0, said
    return said


def tables(folder):
    return {ending: (Path(folder) / f"ensemble.{ending}").read_bytes() for ending in ("npz", "csv", "nc")}


def has(package):
    return subprocess.run([PYTHON, "-c", f"import {package}"], env=ENVIRONMENT, stderr=subprocess.DEVNULL).returncode == 0


def processes(folder):
    """{pid: command line} of the processes that name the folder, but this one; zombies have no command line."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            except OSError:  # it has ended
                continue
            if str(folder) in line:
                found[int(entry.name)] = line
    return found


def none_stays(folder, seconds=60):
    """AssertionError when a process that names the folder still runs after so long."""
    limit = time.monotonic() + seconds
    while left := processes(folder):
        assert time.monotonic() < limit, left
        time.sleep(0.1)


def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
