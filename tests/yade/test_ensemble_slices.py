"""Slices that run in one folder at a time, gathered: the bytes of one run; the command; an array of Slurm."""

import tempfile
from pathlib import Path

from ensemble_programs import PYTHON, STUDY, end, start, tables

with tempfile.TemporaryDirectory() as root:
    root = Path(root).resolve()
    end(PYTHON, STUDY, root / "local", "local")
    folder = root / "slices"
    command = [PYTHON, "-m", "masonry", "ensemble", STUDY, folder, "local"]
    early = start(*command, "--gather")
    said = early.communicate()[0]
    assert early.returncode == 1 and "masonry: 2 of 2 cases are missing; none is kept" in said and "no result yet" in said and "Traceback" not in said, said
    assert list(folder.iterdir()) == []
    # Two tasks of an array that is numbered from 4 in steps of 2, and a third slice that has nothing to do.
    array = {"SLURM_ARRAY_TASK_COUNT": "2", "SLURM_ARRAY_TASK_MIN": "4", "SLURM_ARRAY_TASK_MAX": "6", "SLURM_ARRAY_TASK_STEP": "2"}
    tasks = [start(*command, SLURM_ARRAY_TASK_ID=number, **array) for number in ("4", "6")]
    for number, (task, count) in enumerate(zip(tasks, (1, 1)), 1):
        said = task.communicate(timeout=250)[0]
        assert task.returncode == 0 and f"slice {number}/2: its {count} cases are in {folder}" in said, said
    assert "slice 4/4: its 0 cases" in end(*command, "--slice", "4/4")
    assert len(list(folder.iterdir())) == 2  # results, no tables
    end(*command, "--gather")
    assert tables(folder) == tables(root / "local")
    # Run plainly, the study finds everything done.
    for table in folder.glob("ensemble.*"):
        table.unlink()
    end(PYTHON, STUDY, folder, "local")
    assert tables(folder) == tables(root / "local")
print("ensemble: slices")
