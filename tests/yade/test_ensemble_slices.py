"""Slices that run in one folder at a time, gathered: the bytes of one run; the command; an array of Slurm."""

import pytest
from ensemble_programs import PYTHON, STUDY, end, start, tables


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    folder = tmp_path_factory.mktemp("local") / "out"
    end(PYTHON, STUDY, folder, "local")
    return tables(folder)


def test_slices(local, tmp_path):
    folder = tmp_path.resolve() / "slices"
    command = [PYTHON, "-m", "masonry", "ensemble", STUDY, folder, "local"]
    early = start(*command, "--gather")
    said = early.communicate()[0]
    assert early.returncode == 1 and "masonry: 2 of 2 cases are missing; none is kept" in said and "no result yet" in said and "Traceback" not in said
    assert list(folder.iterdir()) == []
    # Two tasks of an array that is numbered from 4 in steps of 2, and a third slice that has nothing to do.
    array = {"SLURM_ARRAY_TASK_COUNT": "2", "SLURM_ARRAY_TASK_MIN": "4", "SLURM_ARRAY_TASK_MAX": "6", "SLURM_ARRAY_TASK_STEP": "2"}
    tasks = [start(*command, SLURM_ARRAY_TASK_ID=number, **array) for number in ("4", "6")]
    for number, (task, count) in enumerate(zip(tasks, (1, 1)), 1):
        said = task.communicate(timeout=250)[0]
        assert task.returncode == 0 and f"slice {number}/2: its {count} cases are in {folder}" in said
    assert "slice 4/4: its 0 cases" in end(*command, "--slice", "4/4")
    assert len(list(folder.iterdir())) == 2  # results, no tables
    end(*command, "--gather")
    assert tables(folder) == local
    # Run plainly, the study finds everything done.
    for table in folder.glob("ensemble.*"):
        table.unlink()
    end(PYTHON, STUDY, folder, "local")
    assert tables(folder) == local
