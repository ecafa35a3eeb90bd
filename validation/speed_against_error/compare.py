"""Speed against error of one rocking block: runs every solver that is there and judges all by the same measure.

    compare.py <build folder> [--only <part of a runner's name>]

Writes results/speed_against_error.csv and results/speed_against_error.png, prints the table.
"""
import argparse
import csv
import datetime
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import measures
import numpy as np
import plot

HERE = Path(__file__).resolve().parent
RESULTS = HERE.parents[1] / "results"
ENGINE_STEPS = (1 / 60, 1 / 240, 1e-3, 2.5e-4, 1e-4, 2.5e-5)  # s
YADE_SCRIPTS = ("yade_masonry.py", "yade_clump.py", "yade_polyhedra.py")
IN_TURN, TURNS = ("yade_masonry.py", "rocking_bullet_double"), 3  # a shared machine changes its pace: those whose ratio is asked for run in turn
DRIVERS = {"rocking_bullet_double": "libbullet-dev", "rocking_bullet": "libbullet-dev", "rocking_ode": "libode-dev"}
VERSIONED = ("yade", "libbullet-dev", "libode-dev", "python3-scipy", "g++")


class Skipped(Exception):
    """A solver that is not installed; says what to do."""


class Stopped(Exception):
    """A solver that ended with an error; holds its last words."""


class Row(NamedTuple):
    solver: str
    settings: str  # "<series>" or "<series>; <what varies within it>"
    time_step: float  # s; 0: none
    cpu: float  # CPU seconds per simulated second
    history: measures.Rocking
    peak_error: float
    time_error: float

    @property
    def series(self):
        return f"{self.solver}, {self.settings.split(';')[0]}"


def row(solver, settings, time_step, cpu, history, reference):
    return Row(solver, settings, time_step, cpu, history, *measures.errors(history, reference))


def theory(reference):
    """masonry.simulate, a thousand blocks in one call."""
    try:
        import masonry
    except ImportError as error:
        raise Skipped(f"the package masonry cannot be imported ({error}): build it, and set PYTHONPATH to its folder") from error
    block = masonry.RockingBlock(measures.HALF_WIDTH, measures.HALF_HEIGHT, gravity=measures.GRAVITY)
    angles = np.full(1000, measures.START_ANGLE)
    seconds = []
    for _ in range(5):
        start = time.process_time()
        history = masonry.simulate(block, initial_angle=angles, t_end=measures.DURATION)
        seconds.append((time.process_time() - start) / len(angles) / measures.DURATION)
    # a block let go starts at its first peak, which is given
    found = measures.Rocking(history.impact_times[0][: measures.COUNT], history.peak_angles[0][1 : measures.COUNT + 1])
    return [row("masonry theory", "event-driven; a thousand blocks a call", 0.0, statistics.median(seconds), found, reference)]


def histories(command, reference, **options):
    """Rows of a program that prints `solver,settings,time step,cpu,file` for each run; its other output is let go."""
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Stopped(f"status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    rows = []
    for line in done.stdout.splitlines():
        if line.endswith(".f64"):
            solver, settings, time_step, cpu, file = line.split(",")
            history = measures.extract(*np.fromfile(file).reshape(-1, 2).T)
            rows.append(row(solver, settings, float(time_step), float(cpu), history, reference))
    return rows


def engine(program, reference, folder):
    if not program.exists():
        raise Skipped(f"its driver is not built: apt install {DRIVERS[program.name]}, then run this again")
    scene = (measures.HALF_WIDTH, measures.HALF_HEIGHT, measures.DEPTH, measures.START_ANGLE, measures.GRAVITY, measures.DURATION)
    return histories([program, folder, *map(repr, scene), *map(repr, ENGINE_STEPS)], reference)


def yade(script, build, reference, folder):
    if not shutil.which("yade"):
        raise Skipped("YADE is not installed: apt install yade, then run this again")
    path = f"{build.resolve() / 'python'}:{HERE}"
    return histories(["yade", "-n", "-x", "-j1", HERE / script, folder], reference, env={**os.environ, "PYTHONPATH": path})


def run_all(build, only):
    """Rows of all solvers, and the names of those that ended with an error."""
    reference = measures.exact()
    runners = {"masonry theory": lambda folder: theory(reference)}
    for script in YADE_SCRIPTS:
        runners[script] = lambda folder, script=script: yade(script, build, reference, folder)
    for name in DRIVERS:
        runners[name] = lambda folder, name=name: engine(build / "validation" / name, reference, folder)
    rows, stopped = [], []
    for name, runner in [*runners.items(), *((name, runners[name]) for _ in range(TURNS - 1) for name in IN_TURN)]:
        if only not in name:
            continue
        print(f"{name} ...", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            try:
                rows += runner(folder)
            except Skipped as reason:
                print(f"  skipped: {reason}")
            except Stopped as reason:
                print(f"  stopped: {reason}")
                stopped.append(name)
    return medians(rows), stopped


def medians(rows):
    """One row for each that was measured in turn, with the median of its times."""
    found = {}
    for r in rows:
        found.setdefault(r[:3], []).append(r)
    return [same[0]._replace(cpu=statistics.median(r.cpu for r in same)) for same in found.values()]


def cost_at(error, rows):
    """CPU seconds per simulated second at which a series reaches a peak error, between its time steps."""
    rows = sorted((r for r in rows if math.isfinite(r.peak_error)), key=lambda r: -r.peak_error)
    return math.exp(np.interp(-math.log(error), [-math.log(r.peak_error) for r in rows], [math.log(r.cpu) for r in rows]))


def print_ratios(rows):
    """Our time and error over tuned Bullet's: at 1 ms, and at equal errors."""
    ours = [r for r in rows if r.series == "yade-masonry rigid, planar"]
    bullet = [r for r in rows if r.series == "Bullet double, tuned"]
    if not ours or not bullet:
        return
    mine, its = (next(r for r in series if r.time_step == 1e-3) for series in (ours, bullet))
    print(f"\nplanar at 1e-3 s: {mine.cpu / its.cpu:.2f} of tuned Bullet's time, {mine.peak_error / its.peak_error:.2g} of its error")
    for error in (3e-3, 9e-4):
        coarsest = min((r for r in ours if r.peak_error <= error), key=lambda r: r.cpu)
        print(f"peak error {error:g}: Bullet takes {cost_at(error, bullet) / coarsest.cpu:.0f} times the time of our step of {coarsest.time_step:g} s")


def machine():
    """One line each: processor, date, versions."""
    models = [line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    lines = [f"processor: {models[0]}, {len(models)} logical", f"date: {datetime.date.today()}"]
    for package in VERSIONED:
        found = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
        lines.append(f"{package}: {found.stdout if found.returncode == 0 else 'not installed'}")
    return lines


def write_csv(path, rows, about):
    with open(path, "w", newline="") as out:
        out.writelines(f"# {line}\n" for line in about)
        numbers = range(1, measures.COUNT + 1)
        writer = csv.writer(out)
        writer.writerow(
            ["solver", "settings", "time_step_s", "cpu_s_per_simulated_s", "peak_error", "impact_time_error_s"]
            + [f"peak_{i}_rad" for i in numbers] + [f"impact_{i}_s" for i in numbers]
        )
        for r in rows:
            cells = [[*found, *[math.nan] * (measures.COUNT - len(found))] for found in (r.history.peaks, r.history.impacts)]
            writer.writerow([*r[:3], *(f"{x:.4g}" for x in (r.cpu, r.peak_error, r.time_error)), *(f"{x:.12g}" for x in sum(cells, []))])


def print_table(rows):
    print("\n| solver | settings | time step (s) | CPU s per s | peak error | impact error (s) |\n| --- | --- | --- | --- | --- | --- |")
    for r in rows:
        step = f"{r.time_step:.3g}" if r.time_step else "-"
        found = f"{r.peak_error:.2g} | {r.time_error:.2g}" if math.isfinite(r.peak_error) else "did not rock five times | -"
        print(f"| {r.solver} | {r.settings} | {step} | {r.cpu:.2g} | {found} |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("--only", default="", help="run only the solvers whose name holds this; writes no files")
    arguments = parser.parse_args()
    rows, stopped = run_all(arguments.build, arguments.only)
    about = machine()
    print_table(rows)
    print_ratios(rows)
    print("\n".join(["", *about]))
    if rows and not arguments.only:
        RESULTS.mkdir(exist_ok=True)
        write_csv(RESULTS / "speed_against_error.csv", rows, about)
        plot.figure(RESULTS / "speed_against_error.png", rows, about[0])
        print(f"\nwrote {RESULTS / 'speed_against_error.csv'} and {RESULTS / 'speed_against_error.png'}")
    return f"ended with an error: {', '.join(stopped)}" if stopped else 0


if __name__ == "__main__":
    sys.exit(main())
