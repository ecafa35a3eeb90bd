"""One case on the machine that computes it: any executor calls compute(), which starts YADE and waits for it."""

import json
import os
import platform
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from .cases import RUN_CASE, code, path_of, read

# Lines of what a failed case has said that the error repeats; s between two looks at whether the run still goes on.
_TAIL, _LOOK = 15, 0.25
# MPI's launchers set these variables; with them YADE would count itself as one of their processes.
_OF_MPI = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "HYDI_", "MPI_LOCAL")


def compute(job):
    """(why it failed, the last lines of its output), or None when the result is in the folder or the run has been ended. job, a dict of plain values:

    script        path of the script, and `function` in it
    code          what cases.code() gave for it where the run was started
    case, key     JSON text, and the name of its result
    folder        for the result, and for the output of a case that fails
    going_on      a file that is there for as long as the run goes on; when it vanishes, the case is ended
    time_limit    s, or None
    """
    if not os.path.exists(job["going_on"]):
        return None
    here, folder = platform.node(), Path(job["folder"])
    yade = shutil.which("yade")
    if yade is None:
        return f"there is no YADE on {here}: install it with `apt install yade`", ""
    try:
        same = code(job["script"]) == job["code"]
    except FileNotFoundError:
        return f"there is no {job['script']} on {here}: script, folder and masonry must be on a file system that all machines share", ""
    if not same:
        return f"{job['script']} or masonry has changed since the run was started, or is another one on {here}", ""
    handle, own = tempfile.mkstemp(prefix=f".case_{job['key']}.", suffix=".log", dir=folder)  # another run of the same case may be at work in the folder
    path, log = path_of(folder, job["key"]), folder / f"case_{job['key']}.log"
    try:
        with open(handle, "wb") as output:
            why = _run_yade(yade, job, path, output)
        if why is None or read(path, json.loads(job["case"])) is not None:  # it is done, however it ended
            return None
        if path.exists():
            why += ", and its result cannot be read"
        os.replace(own, log)
        os.chmod(log, 0o644)
        return f"{why}: {log}", "\n".join(log.read_text(encoding="utf-8", errors="replace").splitlines()[-_TAIL:])
    finally:
        Path(own).unlink(missing_ok=True)


def _run_yade(yade, job, path, output):
    """How YADE has ended, in words; None when the run has been ended before."""
    package = str(Path(__file__).parents[2])
    environment = {name: value for name, value in os.environ.items() if not name.startswith(_OF_MPI)}
    environment.update(OMP_NUM_THREADS="1", OMP_WAIT_POLICY="passive",
                       PYTHONPATH=os.pathsep.join([package, str(Path(job["script"]).parent), os.environ.get("PYTHONPATH", "")]))
    arguments = json.dumps({"script": job["script"], "function": job["function"], "case": json.loads(job["case"]), "path": str(path), "parent": os.getpid()})
    process = subprocess.Popen([yade, "-j1", "-n", "-x", str(RUN_CASE), arguments], env=environment, stdin=subprocess.DEVNULL, stdout=output,
                               stderr=subprocess.STDOUT)
    end = None if job["time_limit"] is None else time.monotonic() + job["time_limit"]
    try:
        while True:
            wait = _LOOK if end is None else max(0, min(_LOOK, end - time.monotonic()))
            try:
                return f"it ended with status {process.wait(wait)}"
            except subprocess.TimeoutExpired:
                if not os.path.exists(job["going_on"]):
                    return None
                if end is not None and time.monotonic() >= end:
                    return f"it was stopped after {job['time_limit']:g} s"
    finally:
        process.kill()
        process.wait()
