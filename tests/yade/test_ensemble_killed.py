"""Killed at random moments, the driver, a worker or a case, and resumed: no process stays, and the table has the same bytes."""

import os
import random
import time

import pytest
from ensemble_programs import MPI, PYTHON, STUDY, end, has, kill, none_stays, processes, start, tables

# In the place of yade: it starts at once, so that there is time for many kills. test_ensemble.py kills runs of the real one.
YADE = "#!/bin/sh\nexec /usr/bin/python3 \"$4\" \"$5\"\n"
SCENE = "import numpy, time\ndef run(case):\n\ttime.sleep(0.3)\n\treturn {'twice': 2 * case['scale'], 'drift': numpy.arange(case['scale'] * 100)}\n"


def killed_and_resumed(command, kind, folder, scene, path, victims, draw):
    """Kills one of `victims(processes)` at random moments, each later than the one before, until a run ends by itself; how often it did."""
    kills, longest = 0, 0.5
    while True:
        process = start(*command, STUDY, folder, kind, scene, PATH=path)
        time.sleep(draw.uniform(0, longest))
        while not (found := victims(processes(folder))) and process.poll() is None:
            time.sleep(0.02)
        if found:
            kill(draw.choice(found))
            kills += 1
        longest *= 2
        process.communicate(timeout=250)
        none_stays(folder)
        if process.returncode == 0:
            return kills


def drivers(found):
    return [pid for pid, line in found.items() if "ensemble_study" in line]


def cases(found):
    return [pid for pid, line in found.items() if "_run_case.py" in line]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The scene, the PATH with the other yade, and the tables of a run that nobody kills."""
    root = tmp_path_factory.mktemp("whole").resolve()
    scene, yade = root / "quick.py", root / "bin" / "yade"
    scene.write_text(SCENE)
    yade.parent.mkdir()
    yade.write_text(YADE)
    yade.chmod(0o755)
    path = f"{yade.parent}:{os.environ['PATH']}"
    end(PYTHON, STUDY, root / "out", "local", scene, PATH=path)
    return scene, path, tables(root / "out")


@pytest.mark.parametrize("name, kind, command, victims", (("driver", "local", [PYTHON], drivers), ("case", "local", [PYTHON], cases), ("rank", "mpi", MPI, drivers)))
def test_killed_and_resumed(name, kind, command, victims, whole, tmp_path):
    if kind == "mpi" and not has("mpi4py"):
        pytest.skip("there is no mpi4py")
    scene, path, expected = whole
    folder = tmp_path.resolve() / name
    kills = killed_and_resumed(command, kind, folder, scene, path, victims, random.Random(1))
    print(f"killed {kills} times")
    assert kills > 0
    assert tables(folder) == expected
    assert not list(folder.glob(".case_*")), list(folder.iterdir())
