"""The shaken wall in every program that is there: CPU time, drift, sink, first excursion, energy; what was asked for and whether it holds.

    compare.py <build folder> [--quick | --from <json> | --excursions [plane] [space] [key=value ...] | --rest | --reference]

Prints the tables; without an option and with --from, writes results/shaken_walls.csv, .json and .png. Ends with status 1 when something
that must hold does not.
"""
import argparse
import concurrent.futures
import csv
import datetime
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import scipy.integrate
import scipy.optimize

HERE = Path(__file__).resolve().parent
RESULTS = HERE.parents[2] / "results"
SMALL, LARGE = (10, 10), (32, 32)  # courses, blocks per course: 105 and 1,040 blocks
ALIKE = (0.98, 1.0, 1.02)  # g: of first excursions: a hundredth of the motion changes that of a corner by up to a tenth
# Courses, blocks per course, motion in g: walls in the plane of --excursions, with SMALL and LARGE.
OTHERS = [(courses, per_course, amplitude) for courses in (12, 16, 20, 24, 32) for per_course in (courses // 2, courses) for amplitude in (0.8, 1.0, 1.5)]
OTHERS += [(40, 20, 0.8), (40, 20, 1.0), (14, 14, 0.9), (14, 14, 1.2), (18, 9, 0.9), (18, 9, 1.2), (22, 22, 0.9), (28, 14, 0.9), (28, 14, 1.1), (28, 28, 0.9), (28, 28, 1.1),
           (24, 8, 0.7)]
REFERENCE = HERE / "gauss_seidel.json"  # first excursions as gauss_seidel.cpp finds them: written by --reference
# Structure (of yade_space.py), motion: g, angle from x, s: structures in space of --excursions.
STRUCTURES = [("wall", 1.0, 0, 0.6), ("wall", 0.5, 90, 0.6), ("wall", 0.8, 45, 0.6), ("return wall", 0.9, 0, 0.6), ("return wall", 0.9, 90, 0.6), ("return wall", 0.9, 45, 0.6),
              ("two wythes", 0.9, 0, 0.6), ("two wythes", 0.6, 90, 0.6), ("wall with an opening", 0.4, 90, 0.6), ("pier", 0.6, 45, 0.6), ("column", 0.6, 45, 0.8)]
IN_SPACE = dict(dt=5e-4, sweeps=1000)  # of gauss_seidel_space.cpp
# Structures of bricks and their courses: they are shaken with the named amplitude only.
BRICKS = {"60 courses of bricks": 60, "40 courses of bricks": 40, "32 courses of bricks": 32, "30 courses of bricks": 30, "brick corner": 30, "brick T": 30, "brick U": 30,
          "bricks with an opening": 36, "brick pillar": 30}
STRUCTURES += [("60 courses of bricks", 0.25, 0, 0.5), ("40 courses of bricks", 0.2, 45, 0.5), ("32 courses of bricks", 0.15, 90, 0.5), ("30 courses of bricks", 0.65, 0, 0.5),
               ("brick corner", 0.35, 0, 0.5), ("brick corner", 0.3, 45, 0.5), ("brick T", 0.3, 90, 0.5), ("brick U", 0.3, 90, 0.5), ("bricks with an opening", 0.5, 0, 0.5),
               ("brick pillar", 0.3, 45, 0.5)]
FINER = {"brick pillar": dict(dt=2.5e-4, sweeps=5274)}  # of gauss_seidel_space.cpp, where it has not converged with IN_SPACE and the sweeps of the courses
REFERENCE_SPACE = HERE / "gauss_seidel_space.json"  # of these, as gauss_seidel_space.cpp finds them: written by --reference
EXCURSIONS = {"excursion": "top course's mean", "thrown": "corner that is thrown out", "follows": "corner that follows"}
# CPU s per simulated s, drift and sink per joint in mm, of programs measured elsewhere (another machine; 2 Hz, 0.3 g): rest / shaken.
ELSEWHERE = [("Box2D 3, 8 substeps", 105, 0.069, 0.08, 1.9e-3), ("Box2D 3, 8 substeps", 1040, 0.65, 1.5, 5.2e-3), ("LMGC90 NLGS 1e-4", 105, 3.1, 0.011, 3e-4),
             ("LMGC90 NLGS 1e-4", 1040, 73, 0.19, 1.3e-3), ("Jolt", 105, 0.28, 0.37, 4.2e-3), ("Jolt", 1040, 4.5, 2.4, 1.4e-2)]


def by_yade(build, script, case, threads=1):
    """The JSON lines that a script in this folder prints."""
    environment = {**os.environ, "PYTHONPATH": str(build.resolve() / "python")}
    done = subprocess.run(["yade", f"-j{threads}", "-n", "-x", HERE / script, json.dumps(case)], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        raise RuntimeError(done.stdout[-2000:] + done.stderr[-2000:])
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def masonry(build, size, amplitude, rest, shaking, threads=1, **options):
    """Rows of the plugin, one for each phase."""
    case = dict(courses=size[0], per_course=size[1], amplitude=amplitude, rest=rest, shaking=shaking, threads=threads, **options)
    rows = by_yade(build, "yade_masonry.py", case, threads)
    for r in rows:
        name = f"{r.get('model', 'planar')}, C = {r['restitution']}" if r.get("restitution") is not None else r.get("model", "planar")
        r["solver"] = f"yade-masonry, {name}"
        print(f"  {r['solver']:32} {r['blocks']:6} blocks {amplitude:4} g {r['phase']:8} {r['cpu']:.4f} CPU s/s  drift {r['drift']:.2e} mm  sink {r['sink']:.1e} mm", flush=True)
    return rows


def peer(program, size, amplitude, rest, shaking, **environment):
    if not program.exists():
        print(f"  {program.name} is left out: apt install libbullet-dev libode-dev, then run this again")
        return []
    done = subprocess.run([program, *map(str, (*size, amplitude, rest, shaking))], capture_output=True, text=True, check=True, env={**os.environ, **environment})
    rows = []
    for line in done.stdout.splitlines():
        solver, phase, blocks, cpu, drift, sink = line.split(",")
        if phase == "rest" and not rest:
            continue
        rows.append(dict(solver=solver, phase={"shaken": "shaking"}.get(phase, phase), blocks=int(blocks), amplitude=amplitude, cpu=float(cpu), drift=float(drift),
                         sink=float(sink), rest=rest, shaking=shaking))
        print(f"  {solver:32} {blocks:>6} blocks {amplitude:4} g {rows[-1]['phase']:8} {float(cpu):.4f} CPU s/s  drift {float(drift):.2e} mm  sink {float(sink):.1e} mm", flush=True)
    return rows


def stock(size, seconds):
    done = subprocess.run(["yade", "-j1", "-n", "-x", HERE / "yade_polyhedra.py", *map(str, (*size, seconds))], capture_output=True, text=True, check=True)
    _, blocks, cpu, dt = next(line for line in done.stdout.splitlines() if line.startswith("stock,")).split(",")
    print(f"  stock YADE Polyhedra {blocks} blocks, dt = {dt} s: {float(cpu):.0f} CPU s/s", flush=True)
    return [dict(solver="stock YADE Polyhedra", phase="rest", blocks=int(blocks), amplitude=0, cpu=float(cpu), drift=math.nan, sink=math.nan)]


def in_turn(*runs, times=3):
    """Rows of several runs, done in turn some times over, with the medians of their CPU and wall-clock times, and half the range of each ('cpu_scatter', ...)."""
    rows = []
    for same in zip(*([row for run in runs for row in run()] for _ in range(times))):
        rows.append(dict(same[0]))
        for clock in {"cpu", "wall"} & set(same[0]):
            values = [row[clock] for row in same]
            rows[-1].update({clock: statistics.median(values), clock + "_scatter": (max(values) - min(values)) / 2})
    return rows


def run(build, quick):
    ours = lambda *a, **o: masonry(build, *a, **o)
    bullet = lambda size, seconds: peer(build / "validation/wall_bullet", size, 0.3, seconds, seconds)
    precisions = {"h = 1 ms": {}, "h = 0.25 ms": {"dt": 2.5e-4}, "in space": {"model": "spatial"}}
    excursions = lambda size: [row for role, how in precisions.items() for amplitude in ALIKE for row in ours(size, amplitude, 0, 0.5, fine=True, role=role, **how)]
    print("Rest, then 0.3 g: still walls; 1 g: walls that move; Bullet in turn with them", flush=True)
    rows = in_turn(lambda: ours(SMALL, 0.3, 5, 5), lambda: ours(SMALL, 1.0, 0, 5), lambda: bullet(SMALL, 2))
    rows += excursions(SMALL)
    if quick:
        return rows
    rows += excursions(LARGE)
    rows += in_turn(lambda: ours(LARGE, 0.3, 5, 5), lambda: ours(LARGE, 1.0, 0, 5), lambda: bullet(LARGE, 1))
    for restitution in (0.5, 0.9):
        rows += ours(SMALL, 0.3, 2, 2, restitution=restitution) + ours(SMALL, 1.0, 0, 2, restitution=restitution)
        rows += ours(LARGE, 0.3, 1, 1, restitution=restitution) + ours(LARGE, 1.0, 0, 1, restitution=restitution)
    print("A pillar that rocks on a wall that stands")
    for size in (SMALL, LARGE):
        rows += ours(size, 0.3, 0, 2, restitution=0.8, pillar=True, role="a pillar on top")
    print("Strict forces")
    for size, seconds in ((SMALL, 1), (LARGE, 0.2)):
        for strict in (False, True):
            rows += ours(size, 0.3, 0, seconds, strict=strict, role="forces " + ("strict" if strict else "as they come"))
    print("In space")
    rows += ours(SMALL, 0.3, 2, 2, model="spatial") + ours(SMALL, 1.0, 0, 2, model="spatial")
    rows += ours(LARGE, 0.3, 0.5, 0.5, model="spatial") + ours(LARGE, 1.0, 0, 0.5, model="spatial")
    print("Size")
    for size in ((20, 20), (45, 45), (64, 64), (100, 99)):
        rows += ours(size, 0.3, 0.5, 0.3, role="size")
    rows += ours((64, 20), 0.3, 0, 1, role="tall") + ours((100, 20), 0.2, 0, 0.5, role="tall")
    print("Threads")
    for size, seconds in ((SMALL, 10), (LARGE, 1)):
        rows += in_turn(*(lambda threads=threads: ours(size, 1.0, 0.5, seconds, threads=threads, role="threads") for threads in (1, 2)), times=5)
    print("Other programs, in this run")
    rows += peer(build / "validation/wall_ode", SMALL, 0.3, 1, 1) + peer(build / "validation/wall_ode", LARGE, 0.3, 0.25, 0.25)
    rows += peer(build / "validation/wall_bullet", SMALL, 0.3, 1, 1, ITERATIONS="50") + peer(build / "validation/wall_bullet", SMALL, 1.0, 0, 1)
    return rows + stock(SMALL, 0.03)


def sweeps_for(courses):
    """Gauss-Seidel sweeps a step, which grow as the square of the courses."""
    return max(1000, math.ceil(3000 * (courses / 32)**2))


def reference(build):
    """Adds to REFERENCE what is missing there: half the step and as many sweeps as the courses ask. Then to REFERENCE_SPACE."""
    cases = [dict(courses=courses, per_course=per_course, amplitude=amplitude, dt=5e-4, sweeps=sweeps_for(courses)) for courses, per_course, amplitude in OTHERS]
    cases += [dict(courses=size[0], per_course=size[1], amplitude=amplitude, dt=dt, sweeps=sweeps)
              for size, dt, sweeps in ((LARGE, 5e-4, 3000), (SMALL, 2.5e-4, 2000)) for amplitude in ALIKE]

    def result(case):
        command = [build / "validation/wall_gauss_seidel", *map(str, (case["courses"], case["per_course"], case["amplitude"], 0.005, 0.5, case["dt"], case["sweeps"]))]
        numbers = map(float, subprocess.run(command, capture_output=True, text=True, check=True).stdout.split(","))
        return case | dict(zip((*EXCURSIONS, "deepest"), numbers))

    add_missing(REFERENCE, cases, result)
    add_missing(REFERENCE_SPACE, list(map(in_reference, cases_in_space())), lambda case: in_space_by_gauss_seidel(build, case))


def add_missing(path, cases, result):
    """Adds to a file of rows those of the cases that it lacks."""
    found = json.loads(path.read_text()) if path.exists() else []
    missing = [case for case in cases if not any(case.items() <= row.items() for row in found)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for done in concurrent.futures.as_completed([pool.submit(result, case) for case in missing]):
            found.append(done.result())
            print(found[-1], flush=True)
            path.write_text("[\n" + ",\n".join(map(json.dumps, found)) + "\n]\n")


def by_gauss_seidel(size, amplitudes):
    """Rows of REFERENCE."""
    return [row for row in json.loads(REFERENCE.read_text()) if (row["courses"], row["per_course"]) == size and row["amplitude"] in amplitudes]


def summary_of(errors):
    """Root of the mean square, smallest and largest of relative errors, as cells of a table."""
    return f"{math.sqrt(statistics.mean(e**2 for e in errors)):.1%} | {min(errors):+.1%} | {max(errors):+.1%}"


def excursions_in_plane(build, settings):
    """Table: how far the mean of the top course of the walls of REFERENCE goes at 1 ms by the core alone, against Gauss-Seidel. `settings`: key=value of wall_bench."""
    def reached(row):
        command = [build / "validation/wall_bench", f"courses={row['courses']}", f"per={row['per_course']}", f"amp={row['amplitude']}", *settings]
        line = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1]
        numbers = {name: float(re.search(key + r" ([-\d.e+naif]+)", line)[1])
                   for name, key in dict(excursion="mean", cpu=r"\(step", iterations="its", factorisations="fac", rises="loss", deepest="pen").items()}
        return numbers | dict(error=1e-3 * numbers["excursion"] / row["excursion"] - 1)

    walls = sorted(json.loads(REFERENCE.read_text()), key=lambda row: (row["courses"], row["per_course"], row["amplitude"]))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        ours = list(pool.map(reached, walls))
    print("\n| courses | blocks a course | motion | 1 ms (mm) | Gauss-Seidel (mm) | difference | CPU s per s | iterations a step | factorisations a step | rises of energy, of the loss"
          " | penetration (mm) |\n" + "| --- " * 11 + "|")
    for row, here in zip(walls, ours):
        print(f"| {row['courses']} | {row['per_course']} | {row['amplitude']:g} g | {here['excursion']:.1f} | {1e3 * row['excursion']:.1f} | {here['error']:+.1%} | {here['cpu']:.3f} "
              f"| {here['iterations']:.0f} | {here['factorisations']:.2f} | {here['rises']:.0e} | {here['deepest']:.4f} |")
    groups = {"all": lambda row: True, "0.7 to 0.9 g": lambda row: row["amplitude"] <= 0.9, "0.98 to 1.5 g": lambda row: row["amplitude"] > 0.9,
              "28 to 40 courses": lambda row: row["courses"] >= 28}
    print("\n| walls in the plane | number | root of the mean square | smallest | largest |\n" + "| --- " * 5 + "|")
    for name, belongs in groups.items():
        errors = [here["error"] for row, here in zip(walls, ours) if belongs(row)]
        print(f"| {name} | {len(errors)} | {summary_of(errors)} |")


def cases_in_space():
    return [dict(structure=structure, amplitude=round(alike * amplitude, 6), angle=angle, seconds=seconds) for structure, amplitude, angle, seconds in STRUCTURES
            for alike in (ALIKE if structure not in BRICKS else (1.0,))]


def in_reference(case):
    """The case in space, with the step and the sweeps of its reference."""
    structure = case["structure"]
    return case | FINER.get(structure, IN_SPACE | dict(sweeps=sweeps_for(BRICKS.get(structure, 1))))


def excursions_in_space(places, heights):
    """Largest horizontal move, m, of the mean of the blocks whose tops are highest, and of a block; places: of every look and block, on the base."""
    places = np.array(places)
    tops = places[0, :, 2] + np.array(heights) / 2
    moves = (places - places[0])[:, :, :2]
    return dict(top=float(np.linalg.norm(moves[:, tops > tops.max() - 1e-6].mean(axis=1), axis=1).max()), largest=float(np.linalg.norm(moves, axis=2).max()))


def looks_by_gauss_seidel(build, scene, case):
    """What gauss_seidel_space.cpp prints, a row each 10 ms, of a scene in a file."""
    command = [build / "validation/wall_gauss_seidel_space", scene, *(str(case[key]) for key in ("amplitude", "angle", "seconds", "dt", "sweeps"))]
    return np.array([line.split() for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()], float)


def in_space_by_gauss_seidel(build, case):
    """The case, with what its structure does by gauss_seidel_space.cpp."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.txt"
        by_yade(build, "yade_space.py", dict(structure=case["structure"], scene=str(scene)))
        looks, heights = looks_by_gauss_seidel(build, scene, case), np.loadtxt(scene)[1:, 5]
    reached = excursions_in_space(looks[:, 3:].reshape(len(looks), -1, 3), heights) | dict(work=looks[-1, 1], deepest=looks[-1, 2])
    return case | {what: float(f"{value:.6g}") for what, value in reached.items()}


def closed_forms(build):
    """Table: one block by gauss_seidel_space.cpp: how far it slides in a sine of 1 g, and its natural restitution from its first two peaks."""
    def looks(block, **case):
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.txt"
            np.savetxt(scene, [(0, 0, -0.5, 20, 20, 1, 1, 0, 0, 0, 0), block])
            return looks_by_gauss_seidel(build, scene, case | IN_SPACE)

    friction, omega = 0.7, 4 * math.pi  # the base's velocity is g/omega (1 - cos omega t)
    begins = math.asin(friction) / omega
    faster = lambda t: 9.81 * ((math.cos(omega * begins) - math.cos(omega * t)) / omega - friction * (t - begins))  # base than block, m/s
    ends = scipy.optimize.brentq(faster, 0.2, 0.4)
    slides = looks((0, 0, 0.1, 1, 1, 0.2, 1, 0, 0, 0, 2000), amplitude=1, angle=30, seconds=0.4)
    width, height = 0.4, 1.0
    critical, radius = math.atan(width / height), math.hypot(width, height) / 2
    tilt = critical / 2
    rocks = looks((0, 0, radius * math.cos(critical - tilt), width, 0.5, height, math.cos(tilt / 2), 0, math.sin(tilt / 2), 0, 2000), amplitude=0, angle=0, seconds=1)
    z = rocks[:, 5] - 0.5 - height / 2
    peak = next(k for k in range(1, len(z)) if z[k - 1] < z[k] >= z[k + 1])
    a, b, c = z[peak - 1:peak + 2]
    rows = [("a block slides (mm)", 1e3 * np.linalg.norm(slides[:, 3:5], axis=1).max(), 1e3 * scipy.integrate.quad(faster, begins, ends)[0]),
            ("a block rocks: natural restitution", math.sqrt((b - (a - c)**2 / (8 * (a - 2 * b + c))) / z[0]), 1 - 1.5 * math.sin(critical)**2)]
    print("\n| one block by Gauss-Seidel | reached | closed form | difference |\n" + "| --- " * 4 + "|")
    for what, reached, wanted in rows:
        print(f"| {what} | {reached:.5g} | {wanted:.5g} | {reached / wanted - 1:+.3%} |")


def excursions_of_structures(build):
    """Table: structures in space at 1 ms, at the default tolerance and at 1e-5, against Gauss-Seidel; before it Gauss-Seidel against closed forms. Rows of structures are
    means over the motions of ALIKE; the last rows are of single motions."""
    closed_forms(build)
    known, cases = json.loads(REFERENCE_SPACE.read_text()), cases_in_space()
    tolerances = {"1 ms": None, "`tolerance` 1e-5": 1e-5}
    measured = {"top": ("top course's mean", "mm", 1e3), "largest": ("block that goes farthest", "mm", 1e3), "work": ("work of the base", "J", 1)}

    def ours(case, tolerance):
        row = by_yade(build, "yade_space.py", case | dict(tolerance=tolerance))[0]
        return row | excursions_in_space(row["places"], row["heights"])

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        rows = {name: list(pool.map(ours, cases, [tolerance] * len(cases))) for name, tolerance in tolerances.items()}
    print("\n| structure | motion | " + " | ".join(f"{what} ({unit}) | " + " | ".join(tolerances) for what, unit, _ in measured.values()) + " |\n" + "| --- " * 11 + "|")
    references = [next(row for row in known if in_reference(case).items() <= row.items()) for case in cases]
    for structure, amplitude, angle, _ in STRUCTURES:
        same = [k for k, case in enumerate(cases) if (case["structure"], case["angle"]) == (structure, angle)]
        cells = []
        for key, (_, _, scale) in measured.items():
            wanted = statistics.mean(references[k][key] for k in same)
            cells.append(f"{scale * wanted:.1f}")
            cells += [f"{statistics.mean(rows[name][k][key] for k in same) / wanted - 1:+.1%}" for name in tolerances]
        print(f"| {structure} | {amplitude:g} g {({0: 'along x', 90: 'along y', 45: 'diagonal'})[angle]} | " + " | ".join(cells) + " |")
    groups = {"structures of blocks": lambda structure: structure not in BRICKS, "all but the pillar": lambda structure: structure not in FINER, "all": lambda structure: True}
    print("\n| structures in space | quantity | tolerance | motions | root of the mean square | smallest | largest |\n" + "| --- " * 7 + "|")
    for name, belongs in groups.items():
        chosen = [k for k, case in enumerate(cases) if belongs(case["structure"])]
        for key, (what, *_) in measured.items():
            for tolerance in tolerances:
                errors = [rows[tolerance][k][key] / references[k][key] - 1 for k in chosen]
                print(f"| {name} | {what} | {tolerance} | {len(errors)} | {summary_of(errors)} |")


def walls_at_rest(build):
    """Table: walls shaken for half a second at 2 Hz whose base then stands, or goes on gently; how often they begin to move again."""
    def walls(sizes, amplitudes, model, after=0, held=4):
        return [dict(courses=c, per_course=p, amplitude=amplitude, model=model, after=after, held=held) for c, p in sizes for amplitude in amplitudes]

    square = lambda *courses: [(c, c) for c in courses]
    kinds = {"in the plane, the base stands": walls(square(6, 8, 10, 12, 16, 20, 24), (0.6, 0.9, 1.2), "planar"),
             "in space, the base stands": walls([(6, 6), (10, 5), (16, 6)], (0.8, 1.2), "spatial", held=3)}
    kinds |= {f"in the plane, the base goes on at {after} g": walls(square(8, 12, 16, 20), (0.9, 1.2), "planar", after) for after in (0.02, 0.1)}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        reached = {kind: pool.map(lambda case: by_yade(build, "yade_rest.py", case)[0], cases) for kind, cases in kinds.items()}
        print("| | courses | blocks a course | motion | moves on for (s) | set off again | at the end | fastest block (m/s) |\n" + "| --- " * 8 + "|")
        for kind, rows in reached.items():
            rows = reached[kind] = list(rows)
            for r in rows:
                print(f"| {kind} | {r['courses']} | {r['per_course']} | {r['amplitude']:g} g | {r['moving']:.2f} | {r['setOff']} | {r['ends']} | {r['fastest']:.1e} |", flush=True)
    print("\n| walls | set off again | twice or more | still at the end | fastest block then (m/s) |\n" + "| --- " * 5 + "|")
    for kind, rows in reached.items():
        fastest = max((r["fastest"] for r in rows if r["ends"] == "still"), default=math.nan)
        print(f"| {len(rows)} {kind} | {sum(r['setOff'] > 0 for r in rows)} | {sum(r['setOff'] > 1 for r in rows)} | {sum(r['ends'] == 'still' for r in rows)} | {fastest:.1e} |")


def verdicts(rows):
    """(what, asked, reached, holds) of what the rows can tell."""
    def find(**wanted):
        return next((r for r in rows if all(r.get(k) == v for k, v in wanted.items())), None)

    plain = {"solver": "yade-masonry, planar", "role": None}
    lines = []

    def line(what, asked, value, holds, text=None):
        lines.append((what, asked, text or f"{value:.3g}", bool(holds)))

    for blocks, cpu, drift, moving in ((105, 0.03, 1e-3, 0.10), (1040, 0.4, 1e-2, 0.7)):
        for phase in ("rest", "shaking"):
            r = find(**plain, blocks=blocks, amplitude=0.3, phase=phase)
            if r:
                line(f"{blocks} blocks, {'rest' if phase == 'rest' else '0.3 g'}: CPU s per s", f"{cpu}", r["cpu"], r["cpu"] <= cpu)
                line(f"{blocks} blocks, {'rest' if phase == 'rest' else '0.3 g'}: drift (mm)", f"{drift:g}", r["drift"], r["drift"] <= drift)
                line(f"{blocks} blocks, {'rest' if phase == 'rest' else '0.3 g'}: sink per joint (mm)", "1e-5", r["sink"], abs(r["sink"]) <= 1e-5)
        r = find(**plain, blocks=blocks, amplitude=1.0, phase="shaking")
        if r:
            line(f"{blocks} blocks, 1 g: CPU s per s", f"{moving}", r["cpu"], r["cpu"] <= moving)
            line(f"{blocks} blocks, 1 g: largest rise of energy in a tenth of a second, of the loss", "1e-3", max(0, r["rise"]) / r["lost"], r["rise"] <= 1e-3 * r["lost"])
            if "unbalanced" in r:
                share = abs(r["unbalanced"]) / r["work"]
                line(f"{blocks} blocks, 1 g: energy that the balance misses, of the work of the base", "1e-4", share, share <= 1e-4)
            if "deepest" in r:
                line(f"{blocks} blocks, 1 g: deepest penetration, of a block's height", "1e-5", r["deepest"] / 0.5, r["deepest"] <= 1e-5 * 0.5)
        for phase in ("rest", "shaking"):
            bullet = find(solver="Bullet double 10 iterations", blocks=blocks, amplitude=0.3, phase=phase)
            r = find(**plain, blocks=blocks, amplitude=0.3, phase=phase)
            if bullet and r:
                ratio = {105: 19, 1040: 28}[blocks]
                line(f"{blocks} blocks, {'rest' if phase == 'rest' else '0.3 g'}: CPU of Bullet over ours, same run", f"{ratio}", bullet["cpu"] / r["cpu"], bullet["cpu"] / r["cpu"] >= ratio)
        excursions = {role: [r for r in rows if r.get("role") == role and r["blocks"] == blocks] for role in ("h = 1 ms", "h = 0.25 ms", "in space")}
        excursions["Gauss-Seidel"] = by_gauss_seidel(SMALL if blocks == 105 else LARGE, ALIKE)
        if all(excursions.values()):
            for name, what in EXCURSIONS.items():
                x = {role: statistics.mean(r[name] for r in of) for role, of in excursions.items()}
                for role, other, bound in (("h = 1 ms", "Gauss-Seidel", 0.15), ("h = 1 ms", "h = 0.25 ms", 0.20), ("in space", "Gauss-Seidel", 0.15)):
                    difference = x[role] / x[other] - 1
                    line(f"{blocks} blocks, 1 g: first excursion, {what}, {role} against {other}", f"{bound:.0%}", difference, abs(difference) <= bound,
                         f"{difference:+.1%} ({1e3 * x[role]:.1f} mm)")
    poly, r = find(solver="stock YADE Polyhedra"), find(**plain, blocks=105, amplitude=0.3, phase="rest")
    if poly:
        line("105 blocks: CPU of stock YADE Polyhedra over ours, same run", "5000", poly["cpu"] / r["cpu"], poly["cpu"] >= 5000 * r["cpu"])
    sizes = sorted((r["blocks"], r["cpu"]) for r in rows if r.get("phase") == "rest" and (r.get("role") == "size" or (r["blocks"] in (105, 1040) and r.get("role") is None and
                   r["solver"] == plain["solver"] and r["amplitude"] == 0.3)))
    if len(sizes) > 3:
        within = [s for s in sizes if s[0] <= 4200]
        power = math.log(within[-1][1] / within[0][1]) / math.log(within[-1][0] / within[0][0])
        line(f"growth of CPU from {within[0][0]} to {within[-1][0]} blocks", "N^1.2", power, power <= 1.2, f"N^{power:.2f}")
        line(f"{sizes[-1][0]} blocks run", "yes", sizes[-1][1], True, f"{sizes[-1][1]:.1f} CPU s per s")
    for r in rows:
        if r["phase"] == "shaking" and (r.get("role") == "tall" or r.get("role") == "size" and r["courses"] == 100):
            line(f"{r['blocks']} blocks in {r['courses']} courses, {r['amplitude']} g: drift (mm; asked of 1040)", "0.01", r["drift"], r["drift"] <= 0.01,
                 f"{r['drift']:.2g}, {r['cpu']:.3g} CPU s per s")
    for blocks, drift in ((105, 1e-3), (1040, 1e-2)):
        r = find(role="a pillar on top", blocks=blocks)
        if r:
            line(f"{blocks} blocks, 0.3 g, a pillar that rocks on top: drift of the wall (mm; asked without it)", f"{drift:g}", r["drift"], r["drift"] <= drift,
                 f"{r['drift']:.2g}, {r['movingBlocks']} blocks move, {r['cpu']:.3g} CPU s per s")
    for blocks, bound in ((105, 1.0), (1040, 1.4)):
        one, two = (find(role="threads", blocks=blocks, threads=n, phase="shaking") for n in (1, 2))
        if one and two:
            line(f"{blocks} blocks, 1 g: two threads, times faster", f"{bound}", one["wall"] / two["wall"], one["wall"] >= bound * two["wall"],
                 f"{one['wall'] / two['wall']:.3g} (each scatters by {one['wall_scatter'] / one['wall']:.1%} and {two['wall_scatter'] / two['wall']:.1%})")
            line(f"{blocks} blocks: same bits with two threads", "yes", 0, one["bits"] == two["bits"], "yes" if one["bits"] == two["bits"] else "no")
    return lines


def figure(path, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picture, axes = plt.subplots(1, 2, figsize=(11, 5.2), sharey=True)
    for axis, blocks in zip(axes, (105, 1040)):
        shaken = [r for r in rows if r["phase"] == "shaking" and r["blocks"] == blocks and r["amplitude"] == 0.3 and r.get("role") is None]
        marks = {"yade-masonry, planar": ("o", "#c0392b"), "yade-masonry, planar, C = 0.5": ("s", "#c0392b"), "yade-masonry, planar, C = 0.9": ("^", "#c0392b"),
                 "yade-masonry, spatial": ("o", "#e67e22"), "Bullet double 10 iterations": ("D", "#2c3e50"), "Bullet double 50 iterations": ("d", "#2c3e50"),
                 "ODE QuickStep 20 iterations": ("v", "#2980b9")}
        for r in shaken:
            mark, colour = marks[r["solver"]]
            axis.plot(r["cpu"], r["drift"], mark, color=colour, label=r["solver"])
        for k, (name, count, cpu, drift, _) in enumerate(e for e in ELSEWHERE if e[1] == blocks):
            axis.plot(cpu, drift, "x+1"[k], color="#7f8c8d", label=f"{name} (measured elsewhere)")
        axis.set(xscale="log", yscale="log", xlabel="CPU s per simulated s", title=f"{blocks} blocks, 0.3 g at 2 Hz, step 1 ms")
        axis.grid(alpha=0.3)
    handles, labels = axes[0].get_legend_handles_labels()
    picture.subplots_adjust(left=0.07, right=0.99, top=0.93, bottom=0.28, wspace=0.05)
    picture.legend(handles, labels, loc="lower center", ncol=4, fontsize=8)
    axes[0].set_ylabel("sideways drift of the wall, mm")
    picture.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("--quick", action="store_true", help="105 blocks in the plane only, writes nothing")
    parser.add_argument("--from", dest="old", type=Path, help="tables and figure of a file written before")
    parser.add_argument("--excursions", nargs="*", metavar="WORD", help="first excursions against Gauss-Seidel only: 'plane' (by the core alone; key=value are its settings), "
                        "'space', without either both")
    parser.add_argument("--reference", action="store_true", help="compute what the files of Gauss-Seidel lack, an hour or two for all; no CPU times")
    parser.add_argument("--rest", action="store_true", help="whether walls that have been shaken rest, no CPU times")
    arguments = parser.parse_args()
    if arguments.excursions is not None:
        settings = [word for word in arguments.excursions if "=" in word]
        parts = [word for word in arguments.excursions if "=" not in word] or ["plane", "space"]
        if not {"plane", "space"}.issuperset(parts):
            parser.error("--excursions takes 'plane', 'space' and settings key=value")
        if "plane" in parts:
            excursions_in_plane(arguments.build, settings)
        if "space" in parts:
            excursions_of_structures(arguments.build)
        return 0
    if arguments.reference:
        return reference(arguments.build)
    if arguments.rest:
        return walls_at_rest(arguments.build)
    rows = json.loads(arguments.old.read_text()) if arguments.old else run(arguments.build, arguments.quick)
    RESULTS.mkdir(exist_ok=True)
    if not arguments.quick:
        (RESULTS / "shaken_walls.json").write_text(json.dumps(rows, indent=0))
        fields = ["solver", "blocks", "amplitude", "phase", "role", "threads", "dt", "tolerance", "cpu", "wall", "drift", "sink", *EXCURSIONS, "steps", "moving", "impacts", "solves", "velocityResidual", "forceResidual", "rise", "lost", "work", "unbalanced",
                  "memory", "bits"]
        with open(RESULTS / "shaken_walls.csv", "w", newline="") as out:
            writer = csv.DictWriter(out, fields, extrasaction="ignore")
            writer.writeheader()
            writer.writerows(rows)
        figure(RESULTS / "shaken_walls.png", rows)
    print("\n| program | blocks | motion | CPU s per s | drift (mm) | sink per joint (mm) | steps, moving ones | bytes per block |\n" + "| --- " * 8 + "|")
    for r in rows:
        motion = "rest" if r["phase"] == "rest" else f"{r['amplitude']:g} g"
        motion += f" ({r['role']}{', %d threads' % r['threads'] if r['role'] == 'threads' else ''})" if r.get("role") else ""
        modes = f"{r['steps']}, {r['moving']}" if "steps" in r else "-"
        print(f"| {r['solver']} | {r['blocks']} | {motion} | {r['cpu']:.3g} | {r['drift']:.2g} | {r['sink']:.2g} | {modes} | {r['memory']:.0f} |" if "memory" in r else
              f"| {r['solver']} | {r['blocks']} | {motion} | {r['cpu']:.3g} | {r['drift']:.2g} | {r['sink']:.2g} | - | - |")
    print("\n| blocks | forces | solves per step | velocity residual (m/s) | force residual (m/s) | CPU s per s |\n" + "| --- " * 6 + "|")
    for r in rows:
        if (r.get("role") or "").startswith("forces"):
            print(f"| {r['blocks']} | {r['role'][7:]} | {r['solves'] / r['steps']:.3g} | {r['velocityResidual']:.1e} | {r['forceResidual']:.1e} | {r['cpu']:.3g} |")
    lines = verdicts(rows)
    print("\n| what | asked | reached | |\n| --- | --- | --- | --- |")
    for what, asked, reached, holds in lines:
        print(f"| {what} | {asked} | {reached} | {'holds' if holds else '**missed**'} |")
    model = next(line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name"))
    print(f"\n{model}, {os.cpu_count()} logical processors, {datetime.date.today()}")
    return 0 if all(holds for *_, holds in lines) else 1


if __name__ == "__main__":
    sys.exit(main())
