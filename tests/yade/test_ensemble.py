"""Ensembles: each case is what the exact block does; a second call computes what is missing or has changed, and gives the same numbers."""

import math
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import ensemble_scene
import numpy as np
from masonry import ensemble
from masonry.ensemble import cases as of_cases
from masonry.ensemble import study as driver
from rocking_scene import refuses, said_by

import masonry

computed = []
run_missing = driver.run_missing


def watched(script, function, missing, *rest):
    computed.append([case["scale"] for case, _ in missing])
    return run_missing(script, function, missing, *rest)


driver.run_missing = watched


def study(cases, script, folder):
    computed.clear()
    return ensemble.run(script, cases, folder, processes=2, progress=False)


with tempfile.TemporaryDirectory() as folder:
    script, out = Path(folder) / "scene.py", Path(folder) / "out"
    shutil.copy(ensemble_scene.__file__, script)
    scales = [0.32, 0.1, 1.0]
    cases = [{"scale": s, "name": f"sine {s}"} for s in scales]
    table = study(cases, script, out)
    assert computed == [scales] and table["scale"].tolist() == scales and table["name"][1] == "sine 0.1"

    # The exact block: whether it overturns. The middle of its top is b inwards of the pivot and 2a above it: turned by an angle t it has moved by
    # 2a sin(t) + b (1 - cos(t)), which grows with t up to beyond the critical angle; the drift is that over the height 2a.
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
            assert abs(row["peak_drift"] - drift) < 2e-5 + 1e-4 * drift, (row["peak_drift"], drift)
    assert table["collapsed"].tolist() == [False, False, True] and table["peak_drift"][1] < 1e-6 < table["peak_drift"][0]
    found = ensemble.statistics(table)
    assert found["fraction"][0] == 1 / 3 and found["quantile_0.5"][0] == table["peak_drift"][0] and found["quantile_0.84"][0] == math.inf

    # Files: numbers and arrays of a case, the tables.
    one = ensemble.result(script, cases[0], out)
    assert one["peak_drift"] == table["peak_drift"][0] == one["drift"].max()
    assert np.load(out / "ensemble.npz")["table"].tobytes() == table.tobytes()
    read = np.genfromtxt(out / "ensemble.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert read["peak_drift"].tolist() == table["peak_drift"].tolist() and read["name"].tolist() == table["name"].tolist()

    # Nothing is missing; one is; the order is another and one case new; a case with another value is another case.
    assert study(cases, script, out).tobytes() == table.tobytes() and computed == []
    next(out.glob(f"case_{of_cases.keys(script.resolve(), 'run', cases)[0]}.npz")).unlink()
    assert study(cases, script, out).tobytes() == table.tobytes() and computed == [[0.32]]
    for damage in (b"", b"PK", b"a line of text\n", (out / f"case_{of_cases.keys(script.resolve(), 'run', cases)[0]}.npz").read_bytes()[:-200]):
        damaged = out / f"case_{of_cases.keys(script.resolve(), 'run', cases)[0]}.npz"
        damaged.write_bytes(damage)
        refuses(lambda: ensemble.result(script, cases[0], out), "no result", kind=KeyError)
        again = []
        assert f"{damaged} is damaged" in said_by(lambda: again.append(study(cases, script, out)))
        assert again[0].tobytes() == table.tobytes() and computed == [[0.32]]
    changed = study([cases[2], {"scale": 0.2, "name": "sine 0.1"}, cases[0]], script, out)
    assert computed == [[0.2]] and changed["peak_drift"].tolist()[::2] == table["peak_drift"].tolist()[::-2]

    # Another script, another package or another file that a case names: another result.
    keys = of_cases.keys(script, "run", cases)
    script.write_text(script.read_text() + "# changed\n")
    assert not set(keys) & set(of_cases.keys(script, "run", cases))
    record = Path(folder) / "record.txt"
    for given in (str(record), [str(record)], [[0.5, "x"], {"x": str(record)}]):
        names = []
        for text in ("0 1 0", "0 2 0", "0 1 0"):
            record.write_text(text)
            names += of_cases.keys(script, "run", [{"scale": 1, "record": given}])
        assert names[0] != names[1] and names[0] == names[2], given

    # A case that fails is told, with what it said; the others are kept.
    refuses(lambda: study([{"scale": -1}, {"scale": 0.1}], script, out), "1 of 2 cases failed", "{'scale': -1}", "this case is made to fail", kind=RuntimeError)
    assert computed == [[-1, 0.1]]
    refuses(lambda: study([{"scale": -1}, {"scale": 0.1}], script, out), "1 of 2 cases failed", kind=RuntimeError)
    assert computed == [[-1]]
    refuses(lambda: ensemble.run(script, [{"scale": 0.3}], out, processes=1, time_limit=0.05, progress=False), "stopped after 0.05 s", "none is kept", kind=RuntimeError)
    refuses(lambda: ensemble.result(script, {"scale": 0.3}, out), "no result", kind=KeyError)
    # All that failed are named, and the others are in the table of the error and of the folder. What fails at once
    # begins with the one that is stopped: 20 s are enough for it on a busy machine. The last one hangs when its result is there: it is done.
    slow = Path(folder) / "slow.py"
    slow.write_text("import atexit, time\ndef run(case):\n\ttime.sleep(case['scale'])\n\tif case['scale'] == 0.5: atexit.register(time.sleep, 100)\n"
                    "\treturn {'twice': 2 * case['scale']} if case['scale'] else {}\n")
    try:
        ensemble.run(slow, [{"scale": w} for w in (0, 100, 0.25, 0.5)], out, processes=2, time_limit=20, progress=False)
        raise AssertionError("cases that failed are not told")
    except RuntimeError as error:
        for words in ("2 of 4 cases failed", "2 are kept", "{'scale': 100}: it was stopped after 20 s", "{'scale': 0}: it ended with status 1", "returned {}"):
            assert words in str(error), (words, str(error))
        assert error.table["twice"].tolist() == [0.5, 1] and np.load(out / "ensemble.npz")["table"].tobytes() == error.table.tobytes()
    # Whatever ends the program also ends its cases: Ctrl-C, the signals of a queue or a closing terminal, and a kill that nothing can catch.
    def lives(pid):  # a zombie does not
        try:
            return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
        except FileNotFoundError:
            return False

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
        waiting, started, ended = Path(folder) / "waiting.py", Path(folder) / f"started_{number}", Path(folder) / f"ended_{number}"
        waiting.write_text("import os, pathlib, time\ndef run(case):\n\tpathlib.Path(case['to']).write_text(str(os.getpid()))\n\ttime.sleep(60)\n")
        program = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a shell may have started the tests without it
        program += f"from masonry import ensemble\nensemble.run({str(waiting)!r}, [{{'to': {str(started)!r}}}], {str(ended)!r}, progress=False)"
        process = subprocess.Popen(["/usr/bin/python3", "-c", program], stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "PYTHONPATH": str(Path(masonry.__file__).parents[1])})
        while not (started.exists() and started.read_text()):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(number)
        said = process.communicate(timeout=30)[1]
        assert process.returncode != 0 and "ensemble:" not in said  # no progress bar
        assert number == signal.SIGKILL or not list(ended.iterdir())
        assert number != signal.SIGINT or f"KeyboardInterrupt: interrupted: 0 of 1 cases are kept in {ended}; run again" in said, said
        end = time.monotonic() + 30
        while number == signal.SIGKILL and lives(int(started.read_text())) and time.monotonic() < end:
            time.sleep(0.05)  # its end is the kernel's work, and takes what it takes
        assert not lives(int(started.read_text())), f"the case goes on after signal {number}"
    # Two runs of the same cases in one folder at the same time: both have all rows, and leave one table and no logs.
    both = Path(folder) / "both"
    quick = Path(folder) / "quick.py"
    quick.write_text("import time\ndef run(case):\n\ttime.sleep(0.2)\n\treturn {'twice': 2 * case['scale']}\n")
    program = (f"from masonry import ensemble\ntable = ensemble.run({str(quick)!r}, [{{'scale': k}} for k in range(4)], {str(both)!r}, processes=2, progress=False)\n"
               "print(table['twice'].tolist())")
    runs = [subprocess.Popen(["/usr/bin/python3", "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             env={**os.environ, "PYTHONPATH": str(Path(masonry.__file__).parents[1])}) for _ in range(2)]
    for process in runs:
        printed, said = process.communicate(timeout=200)
        assert process.returncode == 0 and printed.strip() == "[0, 2, 4, 6]", (printed, said)
    assert np.load(both / "ensemble.npz")["table"]["twice"].tolist() == [0, 2, 4, 6] and len(list(both.iterdir())) == 4 + 3, list(both.iterdir())
print("ensemble: exact blocks, resuming, failures, ends")
