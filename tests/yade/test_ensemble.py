"""Ensembles: each case is what the exact block does; a second call computes what is missing or has changed, and gives the same numbers."""

import contextlib
import math
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import ensemble_scene
import numpy as np
import pytest
from masonry import ensemble
from masonry.ensemble import cases as of_cases
from masonry.ensemble import study as driver
from rocking_scene import refuses, said_by

import masonry

SCALES = [0.32, 0.1, 1.0]
CASES = [{"scale": s, "name": f"sine {s}"} for s in SCALES]


@contextlib.contextmanager
def watched():
    """A list to which each study appends the scales of the cases that it computes; one that finds all done appends nothing."""
    run_missing, seen = driver.run_missing, []

    def run(script, function, missing, *rest):
        seen.append([case["scale"] for case, _ in missing])
        return run_missing(script, function, missing, *rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(driver, "run_missing", run)
        yield seen


@pytest.fixture
def computed():
    with watched() as seen:
        yield seen


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A script, the folder of a study that has computed CASES by it, its table, and what it has computed."""
    folder = tmp_path_factory.mktemp("done")
    script = folder / "scene.py"
    shutil.copy(ensemble_scene.__file__, script)
    with watched() as seen:
        table = study(CASES, script, folder / "out")
    return script, folder / "out", table, seen


@pytest.fixture
def copied(done, tmp_path):
    """The same to be changed. A result belongs to the text of its script, wherever that lies."""
    script, out, table, _ = done
    shutil.copytree(script.parent, tmp_path, dirs_exist_ok=True)
    return tmp_path / "scene.py", tmp_path / "out", table


def study(cases, script, folder):
    return ensemble.run(script, cases, folder, processes=2, progress=False)


def program(text, **more):
    """Starts a Python program outside YADE."""
    return subprocess.Popen(["/usr/bin/python3", "-c", text], stderr=subprocess.PIPE, text=True,
                            env={**os.environ, "PYTHONPATH": str(Path(masonry.__file__).parents[1])}, **more)


def test_all_cases_are_computed(done):
    _, _, table, computed = done
    assert computed == [SCALES] and table["scale"].tolist() == SCALES and table["name"][1] == "sine 0.1"


def test_each_case_is_what_the_exact_block_does(done):
    """Whether it overturns. The middle of its top is b inwards of the pivot and 2a above it: turned by an angle t it has moved by
    2a sin(t) + b (1 - cos(t)), which grows with t up to beyond the critical angle; the drift is that over the height 2a."""
    _, _, table, _ = done
    block = masonry.RockingBlock(ensemble_scene.HALF_WIDTH, ensemble_scene.HALF_WIDTH * ensemble_scene.SLENDERNESS)
    alpha = block.critical_angle
    for row in table:
        exact = masonry.simulate(block, ensemble_scene.record(row["scale"]), restitution=ensemble_scene.RESTITUTION, t_end=2.0)
        falls = bool(exact.overturned) or abs(exact.sample(2.0)[0]) > alpha
        assert row["collapsed"] == falls and row["fallen"] == row["collapsed"], row
        if not row["collapsed"]:
            angle = np.max(np.abs(exact.sample(np.arange(0, 2, 0.001))[0]))
            drift = math.sin(angle) + (1 - math.cos(angle)) / (2 * block.slenderness)
            # Samples 5 ms apart miss a peak by (2.5e-3 s)^2 / 2 of the acceleration there, below g: 3e-5 m of 2 m; the step by 1e-4 (validation/README.md).
            assert abs(row["peak_drift"] - drift) < 2e-5 + 1e-4 * drift
    assert table["collapsed"].tolist() == [False, False, True] and table["peak_drift"][1] < 1e-6 < table["peak_drift"][0]


def test_statistics(done):
    _, _, table, _ = done
    found = ensemble.statistics(table)
    assert found["fraction"][0] == 1 / 3 and found["quantile_0.5"][0] == table["peak_drift"][0] and found["quantile_0.84"][0] == math.inf


def test_files_hold_the_numbers_and_arrays_of_a_case_and_the_table(done):
    script, out, table, _ = done
    one = ensemble.result(script, CASES[0], out)
    assert one["peak_drift"] == table["peak_drift"][0] == one["drift"].max()
    assert np.load(out / "ensemble.npz")["table"].tobytes() == table.tobytes()
    read = np.genfromtxt(out / "ensemble.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert read["peak_drift"].tolist() == table["peak_drift"].tolist() and read["name"].tolist() == table["name"].tolist()


def first_file(script, out):
    return out / f"case_{of_cases.keys(script.resolve(), 'run', CASES)[0]}.npz"


def test_what_is_missing_is_computed(copied, computed):
    script, out, table = copied
    assert study(CASES, script, out).tobytes() == table.tobytes() and not computed
    first_file(script, out).unlink()
    assert study(CASES, script, out).tobytes() == table.tobytes() and computed == [[0.32]]


@pytest.mark.parametrize("damage", (b"", b"PK", b"a line of text\n", "cut"))
def test_what_is_damaged_is_computed_again(damage, copied, computed):
    script, out, table = copied
    damaged = first_file(script, out)
    damaged.write_bytes(damaged.read_bytes()[:-200] if damage == "cut" else damage)
    refuses(lambda: ensemble.result(script, CASES[0], out), "no result", kind=KeyError)
    again = []
    assert f"{damaged} is damaged" in said_by(lambda: again.append(study(CASES, script, out)))
    assert again[0].tobytes() == table.tobytes() and computed == [[0.32]]


def test_another_order_and_a_new_case(copied, computed):
    """A case with another value is another case."""
    script, out, table = copied
    changed = study([CASES[2], {"scale": 0.2, "name": "sine 0.1"}, CASES[0]], script, out)
    assert computed == [[0.2]] and changed["peak_drift"].tolist()[::2] == table["peak_drift"].tolist()[::-2]


def test_another_script_or_file_has_another_result(copied, tmp_path):
    """Another script, another package or another file that a case names."""
    script, _, _ = copied
    keys = of_cases.keys(script, "run", CASES)
    script.write_text(script.read_text() + "# changed\n")
    assert not set(keys) & set(of_cases.keys(script, "run", CASES))
    record = tmp_path / "record.txt"
    for given in (str(record), [str(record)], [[0.5, "x"], {"x": str(record)}]):
        names = []
        for text in ("0 1 0", "0 2 0", "0 1 0"):
            record.write_text(text)
            names += of_cases.keys(script, "run", [{"scale": 1, "record": given}])
        assert names[0] != names[1] and names[0] == names[2], given


def test_a_case_that_fails(computed, tmp_path):
    """It is told with what it said; the others are kept."""
    script = ensemble_scene.__file__
    refuses(lambda: study([{"scale": -1}, {"scale": 0.1}], script, tmp_path), "1 of 2 cases failed", "{'scale': -1}", "this case is made to fail",
            kind=RuntimeError)
    assert computed.pop() == [-1, 0.1]
    refuses(lambda: study([{"scale": -1}, {"scale": 0.1}], script, tmp_path), "1 of 2 cases failed", kind=RuntimeError)
    assert computed.pop() == [-1]


def test_a_case_that_is_stopped(tmp_path):
    script = ensemble_scene.__file__
    refuses(lambda: ensemble.run(script, [{"scale": 0.3}], tmp_path, processes=1, time_limit=0.05, progress=False), "stopped after 0.05 s", "none is kept",
            kind=RuntimeError)
    refuses(lambda: ensemble.result(script, {"scale": 0.3}, tmp_path), "no result", kind=KeyError)


def test_all_that_failed_are_named(tmp_path):
    """The others are in the table of the error and of the folder. What fails at once begins with the one that is stopped: 20 s are enough for it on a
    busy machine. The last one hangs when its result is there: it is done."""
    slow, out = tmp_path / "slow.py", tmp_path / "out"
    slow.write_text("import atexit, time\ndef run(case):\n\ttime.sleep(case['scale'])\n\tif case['scale'] == 0.5: atexit.register(time.sleep, 100)\n"
                    "\treturn {'twice': 2 * case['scale']} if case['scale'] else {}\n")
    with pytest.raises(RuntimeError) as failed:
        ensemble.run(slow, [{"scale": w} for w in (0, 100, 0.25, 0.5)], out, processes=2, time_limit=20, progress=False)
    for words in ("2 of 4 cases failed", "2 are kept", "{'scale': 100}: it was stopped after 20 s", "{'scale': 0}: it ended with status 1", "returned {}"):
        assert words in str(failed.value)
    table = failed.value.table
    assert table["twice"].tolist() == [0.5, 1] and np.load(out / "ensemble.npz")["table"].tobytes() == table.tobytes()


def lives(pid):  # a zombie does not
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("number", (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL))
def test_whatever_ends_the_program_ends_its_cases(number, tmp_path):
    """Ctrl-C, the signals of a queue or a closing terminal, and a kill that nothing can catch."""
    waiting, started, ended = tmp_path / "waiting.py", tmp_path / "started", tmp_path / "ended"
    waiting.write_text("import os, pathlib, time\ndef run(case):\n\tpathlib.Path(case['to']).write_text(str(os.getpid()))\n\ttime.sleep(60)\n")
    process = program("import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a shell may have started the tests without it
                      f"from masonry import ensemble\nensemble.run({str(waiting)!r}, [{{'to': {str(started)!r}}}], {str(ended)!r}, progress=False)")
    while not (started.exists() and started.read_text()):
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(number)
    said = process.communicate(timeout=30)[1]
    assert process.returncode != 0 and "ensemble:" not in said  # no progress bar
    assert number == signal.SIGKILL or not list(ended.iterdir())
    assert number != signal.SIGINT or f"KeyboardInterrupt: interrupted: 0 of 1 cases are kept in {ended}; run again" in said
    end = time.monotonic() + 30
    while number == signal.SIGKILL and lives(int(started.read_text())) and time.monotonic() < end:
        time.sleep(0.05)  # its end is the kernel's work, and takes what it takes
    assert not lives(int(started.read_text()))


def test_two_runs_of_the_same_cases_in_one_folder_at_the_same_time(tmp_path):
    """Both have all rows, and leave one table and no logs."""
    both, quick = tmp_path / "both", tmp_path / "quick.py"
    quick.write_text("import time\ndef run(case):\n\ttime.sleep(0.2)\n\treturn {'twice': 2 * case['scale']}\n")
    text = (f"from masonry import ensemble\ntable = ensemble.run({str(quick)!r}, [{{'scale': k}} for k in range(4)], {str(both)!r}, processes=2, progress=False)\n"
            "print(table['twice'].tolist())")
    for process in [program(text, stdout=subprocess.PIPE) for _ in range(2)]:
        printed, said = process.communicate(timeout=200)
        assert process.returncode == 0 and printed.strip() == "[0, 2, 4, 6]", said
    assert np.load(both / "ensemble.npz")["table"]["twice"].tolist() == [0, 2, 4, 6] and len(list(both.iterdir())) == 4 + 3
