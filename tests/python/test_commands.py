"""masonry spectrum and masonry fragility: the files they write hold what the package computes; mistakes are told in one sentence, with status 2."""

import csv
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import masonry
from masonry import __main__, spectra
from masonry.commands._given import numbers

RECORDS = [masonry.artificial_record(seed, 2.0, duration=4, frequency=1.5) for seed in range(6)]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with records r0.csv, ... and one of them as quake.AT2."""
    monkeypatch.chdir(tmp_path)
    for k, record in enumerate(RECORDS):
        rows = [f"{record.dt * i:.4f},{a!r}" for i, a in enumerate(record.samples.tolist())]
        (tmp_path / f"r{k}.csv").write_text("\n".join(["time,acceleration", *rows]) + "\n")
    for name, content in (("empty", b""), ("header", b"x,collapsed\n"), ("uneven", b"x,collapsed\n1,True,3\n2,False\n"), ("binary", bytes(range(256)))):
        (tmp_path / f"{name}.csv").write_bytes(content)
    values = "\n".join(f"{a / 9.80665:.9E}" for a in RECORDS[0].samples)
    (tmp_path / "quake.AT2").write_text(f"PEER\nTEST\nACCELERATION TIME HISTORY IN UNITS OF G\nNPTS= {len(RECORDS[0].samples)}, DT= .0100 SEC\n{values}\n")
    return tmp_path


@pytest.fixture
def command(folder, monkeypatch, capsys):
    """Runs the command: (status, what it printed, what it said of a mistake)."""
    def run(line):
        monkeypatch.setattr(sys, "argv", ["masonry", *shlex.split(line)])
        status = 0
        try:
            __main__.main()
        except SystemExit as end:
            status = end.code or 0
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


def table(path):
    """{first word of the column: its numbers}"""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    names = [re.sub(r" \(.*\)$", "", name) for name in next(csv.reader(lines[:1]))]
    columns = zip(*csv.reader(lines[1:]))
    return {name: [float({"True": 1, "False": 0}.get(value, value)) for value in column] for name, column in zip(names, columns)}


def picture(path):
    return path.read_bytes()[:4] == b"\x89PNG"


def test_rocking(command, folder):
    status, said, _ = command("spectrum rocking --motion sine --amplitude 1:8:5 --frequency 0.5:4:4 --width 0.4 --slenderness 5 -o out --quiet")
    expected = spectra.rocking(masonry.Sine, amplitude=np.linspace(1, 8, 5), frequency=np.linspace(0.5, 4, 4), width=0.4, slenderness=5)
    found = table(folder / "out.csv")
    assert status == 0 and f"{expected['overturned'].sum()} of 20 cases overturn" in said and "wrote out.csv and out.png" in said
    assert found["ratio"] == expected["ratio"].ravel().tolist() and found["overturned"] == expected["overturned"].ravel().astype(float).tolist()
    assert picture(folder / "out.png")


def test_rocking_under_a_record(command, folder):
    assert command("spectrum rocking r1.csv --unit m/s^2 --scale 0.5:3:4 --width 0.4,0.6 --slenderness 5 --restitution 0.8 --quiet")[0] == 0
    expected = spectra.rocking(masonry.Record.from_csv("r1.csv", "m/s^2", baseline="constant"), scale=np.linspace(0.5, 3, 4), width=[0.4, 0.6], slenderness=5,
                               restitution=0.8)
    assert table(folder / "rocking.csv")["ratio"] == expected["ratio"].ravel().tolist()


def test_overturning(command, folder):
    assert command("spectrum overturning --motion rectangular --duration 0.2,0.5 --width 0.4 --slenderness 5 --quiet")[0] == 0
    expected = [masonry.overturning_amplitude(masonry.RockingBlock(0.2, 1.0), masonry.Rectangular(1.0, duration))[0] for duration in (0.2, 0.5)]
    assert table(folder / "overturning.csv")["amplitude"] == expected and picture(folder / "overturning.png")


def test_response(command, folder):
    assert command("spectrum response quake.AT2 --baseline none --period 0.1,0.5 --damping 0.05 --quiet")[0] == 0
    record = masonry.Record.from_at2("quake.AT2")
    assert table(folder / "response.csv")["displacement"] == spectra.oscillator_peak(record, [0.1, 0.5], 0.05).tolist()


def test_resonance(command, folder):
    assert command("spectrum resonance --width 0.6 --slenderness 5:6:2 --restitution 0.7")[0] == 0
    assert table(folder / "resonance.csv")["gravity_ratio"] == spectra.resonance(0.6, [5, 6], 0.7)["gravity_ratio"].tolist()


def test_fragility(command, folder):
    line = " ".join(f"r{k}.csv" for k in range(6))
    status, said, _ = command(f"fragility {line} --unit m/s^2 --width 0.4 --height 2 --levels 0.5:8:16 --quiet")
    records = [masonry.Record.from_csv(f"r{k}.csv", "m/s^2", baseline="constant") for k in range(6)]
    curve = masonry.fragility(masonry.RockingBlock(0.2, 1.0), records, levels=np.linspace(0.5, 8, 16))
    assert status == 0 and str(curve) in said
    assert table(folder / "fragility.csv")["fit"] == curve.probability(curve.levels["measure"]).tolist() and picture(folder / "fragility.png")


def test_fragility_of_a_table(command, folder):
    rng = np.random.default_rng(0)
    peaks, seeds = np.tile([0.4, 0.8, 1.2, 1.6], 30), np.repeat(np.arange(30), 4)
    collapsed = peaks > np.exp(0.3 * rng.standard_normal(120))
    rows = [f"{seed},{peak},{fallen},0.1" for seed, peak, fallen in zip(seeds, peaks, collapsed)]
    (folder / "ensemble.csv").write_text("\n".join(["seed,peak,collapsed,peak_drift", *rows]) + "\n")
    status, said, _ = command("fragility --table ensemble.csv --measure peak --record seed -o out")
    assert status == 0 and str(masonry.Fragility(peaks, collapsed, "peak", records=seeds)) in said and picture(folder / "out.png")


@pytest.mark.parametrize("line, words", [
    ("fragility none.AT2 r1.csv --width 0.4 --height 2 --scales 1:2:3", "none.AT2"),
    ("rock none.AT2 --width 0.4 --height 2", "masonry: none.AT2: there is no such file or folder"), ("report none.npz", "masonry: none.npz: there is no such file or folder"),
    ("fragility r0.csv r1.csv --width 0.4 --height 2 --scales 1:2:3", "r0.csv: unit = None: must be given for a text file of columns"),
    ("fragility r0.csv --unit m/s^2 --width 0.4 --height 2 --scales 1:2:3", "must be at least two"),
    ("fragility r0.csv r1.csv --unit m/s^2 --width 0.4 --height 2", "scales, levels: must give one"),
    ("fragility r0.csv r1.csv --unit m/s^2 --scales 1:2:3", "give records, --width and --height, or --table"),
    ("fragility r0.csv r1.csv --unit m/s^2 --width 0.4 --height 2 --scales 1:2:3 --measure PGD", "measure = 'PGD'"),
    ("fragility --table r0.csv", "--table needs --measure"),
    ("fragility --table r0.csv --measure peak", "'peak': is no column of the table, which has time, acceleration"),
    ("spectrum rocking --width 0.4 --slenderness x", "argument --slenderness: 'x' is no list of numbers"),
    ("spectrum rocking --width 0.4 --slenderness 1:8:1000000000", "is no list of numbers: write 0.5, or 0.4,0.6,1.2, or 0.5:4:20, or 0.1:10:20:log, at most a million"),
    ("spectrum rocking --width 0.4 --slenderness 1:1e400:3", "is no list of numbers"), ("spectrum rocking --width nan --slenderness 5", "'nan' is no list of numbers"),
    ("spectrum rocking --motion sine --amplitude 1:8:10000 --frequency 1:8:10000 --width .4 --slenderness 5", "100000000 points of the grid must be at most 10000000"),
    ("spectrum rocking --motion sine --amplitude 1,1e38 --frequency 1 --width .4 --slenderness 5 --quiet", "acceleration of the base at 0 s = 1e+38: must be at most"),
    ("fragility --table none.csv --measure x", "none.csv"), ("fragility --table empty.csv --measure x", "empty.csv: has no rows"),
    ("fragility --table header.csv --measure x", "header.csv: has no rows"), ("fragility --table uneven.csv --measure x", "uneven.csv: must be a table in CSV"),
    ("fragility --table binary.csv --measure x", "binary.csv: must be a table in CSV"), ("report binary.csv", "is no WallHistory, or a damaged one"),
    ("fragility r0.csv r1.csv --unit m/s^2 --width 0.4 --height 2 --scales 1:2:3 --measure Sa(1.2.3)", "measure = 'Sa(1.2.3)'"),
    ("spectrum rocking --width 0.4 --slenderness 5", "give --motion or one record"),
    ("spectrum rocking --motion sine --amplitude 2 --width 0.4 --slenderness 5 --quiet", "missing a required argument: 'frequency'"),
    ("spectrum rocking r0.csv r1.csv --unit g --width 0.4 --slenderness 5", "2 records were given"),
    ("spectrum rocking --motion sine --amplitude 2 --frequency 1 --width -0.4 --slenderness 5 --quiet", "half_width"),
    ("spectrum response r0.csv --unit m/s^2 --period 0", "period = "),
    ("spectrum", "required: KIND"), ("nothing", "invalid choice: 'nothing'"), ("fragility --no", "--no"),
])
def test_mistakes_are_told_in_one_sentence(command, line, words):
    status, _, said = command(line)
    assert status == 2 and words in said and said.count("\n") == 1 and said.startswith("masonry"), said


def test_warnings_are_sentences(command, folder):
    """Peaks beyond those of earthquakes are asked about, without the file and line of this package."""
    (folder / "fast.csv").write_text("\n".join(["time,acceleration", *(f"{0.01 * k:.2f},{60 * (-1)**k}" for k in range(50))]))
    status, _, error = command("spectrum response fast.csv --unit m/s^2 --period 0.5,1 --baseline none --quiet")
    assert status == 0 and error == "masonry: The record 'fast.csv' reaches 60 m/s^2 before its scale, 6.12 g: is its unit right?\n"


def test_sizes_in_millimetres_are_asked_about(command, folder):
    status, _, error = command("rock quake.AT2 --width 400 --height 2000 --end 0.5")
    assert status == 0 and error == "masonry: The block measures 400 x 2000 m: sizes are in m.\n"
    assert command("rock quake.AT2 --width 0.4 --height 2 --end 0.5")[2] == "" and (folder / "rotation.csv").exists()


def test_lists_of_numbers():
    assert numbers("0.5") == 0.5
    assert numbers("0.4,0.6").tolist() == [0.4, 0.6]
    assert numbers("1:3:3").tolist() == [1, 2, 3]
    np.testing.assert_allclose(numbers("1:100:3:log"), [1, 10, 100])


# The examples of --help, word for word, with the records that are there.
@pytest.mark.parametrize("help", ["spectrum rocking", "spectrum overturning", "spectrum response", "spectrum resonance", "fragility"])
def test_examples_of_the_help_work(command, folder, help):
    status, said, _ = command(f"{help} --help")
    examples = [line.strip() for line in said.splitlines() if line.startswith("  masonry ")]
    assert status == 0 and examples
    for example in examples:
        if "--table" in example:
            continue  # test_fragility_of_a_table
        line = example.removeprefix("masonry ").replace("records/*.AT2", "--unit m/s^2 r0.csv r1.csv r2.csv")
        status, said, mistake = command(line + " --quiet")
        assert status == 0 and "wrote" in said, mistake


@pytest.mark.parametrize("line, bar", [("spectrum rocking --motion sine --amplitude 1:3:3 --frequency 2 --width 0.4 --slenderness 5", "rocking: 100%"),
                                       ("spectrum response r0.csv --unit m/s^2 --period 0.5,1", "response: 100%"),
                                       ("fragility r0.csv r1.csv --unit m/s^2 --width 0.4 --height 2 --scales 1:3:3", "fragility: 100%")])
def test_a_progress_bar_is_drawn_in_a_terminal_and_not_in_a_log(folder, line, bar):
    pytest.importorskip("tqdm")
    command = [sys.executable, "-m", "masonry", *shlex.split(line)]
    environment = {**os.environ, "PYTHONPATH": str(Path(masonry.__file__).parents[1])}
    run = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert run.returncode == 0 and run.stderr == ""
    for more, drawn in ((), True), (("--quiet",), False):
        here, there = os.openpty()
        assert subprocess.run([*command, *more], stdout=subprocess.DEVNULL, stderr=there, env=environment).returncode == 0
        os.write(there, b"\n")  # so that there is something to read
        said = os.read(here, 100000).decode()
        os.close(here)
        os.close(there)
        assert (bar in said) == drawn


def test_rock(command, folder):
    """The table is that of History.to_csv, and the line says what History says."""
    status, said, wrong = command("rock quake.AT2 --width 0.6 --height 3 --scale 1.4 -o block")
    assert status == 0 and not wrong and "stands" in said or "overturns" in said
    record = masonry.read_record("quake.AT2", baseline="constant").scaled(1.4)
    history = masonry.simulate(masonry.RockingBlock(0.3, 1.5), record)
    found = table(folder / "block.csv")
    assert picture(folder / "block.png") and np.allclose(found["angle"], history.angles, rtol=0, atol=1e-15, equal_nan=True)
    assert np.allclose(found["acceleration of the base"], record.acceleration(history.times))
    status, _, wrong = command("rock quake.AT2 --width 0 --height 3")
    assert status == 2 and "--width 0: must be positive" in wrong
    status, said, _ = command("rock quake.AT2 --width 0.6 --height 3 --end 1 -o short")
    assert status == 0 and "after 1 of" in said  # the record goes on


def test_the_baseline_high_pass(command, folder):
    status, _, wrong = command("rock quake.AT2 --width 0.6 --height 3 --baseline high-pass --corner 0.2 -o high")
    assert status == 0, wrong
    record = masonry.read_record("quake.AT2", baseline="high-pass", corner=0.2)
    history = masonry.simulate(masonry.RockingBlock(0.3, 1.5), record)
    assert np.allclose(table(folder / "high.csv")["angle"], history.angles, rtol=0, atol=1e-15, equal_nan=True)
    for more, words in (("--baseline high-pass", "masonry: --corner: must be given, in Hz"), ("--corner 1", "masonry: --corner 1: must be left out"), ("--order 3", "--order 3: must be left out")):
        status, _, wrong = command(f"rock quake.AT2 --width 0.6 --height 3 {more}")
        assert status == 2 and words in wrong, wrong


def test_times_of_a_history(folder):
    """They begin at 0, go on beyond the last impact, and belong to the angles; array input has none."""
    history = masonry.simulate(masonry.RockingBlock(0.3, 1.5), restitution=0.9, initial_angle=0.1, half_cycles=6)
    assert history.times[0] == 0 and history.impact_times[-1] < history.times[-1] < 1.1 * history.end_time + 1
    assert np.array_equal(history.angles, history.sample(history.times)[0], equal_nan=True) and history.angles[0] == 0.1
    assert np.array_equal(history.velocities, history.sample(history.times)[1], equal_nan=True)
    history.to_csv(folder / "few.csv", times=[0, 0.1])
    assert np.allclose(table(folder / "few.csv")["angle"], history.sample([0, 0.1])[0])
    several = masonry.simulate(masonry.RockingBlock(0.3, 1.5), initial_angle=np.array([0.1, 0.2]), half_cycles=2)
    for act in (lambda: several.times, lambda: several.to_csv(folder / "x.csv")):
        with pytest.raises(ValueError, match="must be of one block and one motion"):
            act()
