"""First excursions of walls by the one-method step and the two-mode step, beside converged Gauss-Seidel sweeps, with CPU times of the same run.

    suite.py <assembly_bench> [plane] [space] [key=value ...]

Walls and references are those of ../shaking (gauss_seidel.json, gauss_seidel_space.json). The bench builds the structures of one wythe only.
"""
import json
import math
import re
import subprocess
import sys
from pathlib import Path

SHAKING = Path(__file__).resolve().parents[1] / "shaking"
SPACE = {"wall": dict(courses=6, per=4, L=1, T=0.5, H=0.5), "column": dict(scene="column", courses=5, L=0.6, T=0.4, H=0.5)}


def run(bench, case, options):
    words = [f"{key}={value}" for key, value in case.items()]
    done = subprocess.run([bench, *words, "by=both", *options], capture_output=True, text=True, check=True)
    rows = {}
    for line in done.stdout.splitlines():
        number = lambda key: float(re.search(key + r" ([-\d.e+naif]+)", line).group(1))  # noqa: E731
        rows[line.split()[0]] = dict(mean=number("mean"), cpu=number(r"\(step"), its=number("its"), fac=number("fac"), rises=number("loss"), pen=number("pen"),
                                     work=number("base") if "base" in line else 0)
    return rows


def compare(bench, cases, options):
    errors = {"one": [], "two": []}
    for name, case, wanted in cases:
        rows = run(bench, case, options)
        for by, row in rows.items():
            errors[by].append(row["mean"] / wanted - 1)
        print(f"{name:34} {wanted:8.2f} " + "  ".join(f"{by} {row['mean']:7.2f} {row['mean'] / wanted - 1:+6.1%} {row['cpu']:6.3f} CPU s/s" for by, row in rows.items()),
              f" its {rows['one']['its']:.1f} fac {rows['one']['fac']:.2f} rises {rows['one']['rises']:.1e} / {rows['two']['rises']:.1e} pen {rows['one']['pen']:.2g} mm" if "one" in rows and "two" in rows else "", flush=True)
    for by, of in errors.items():
        if of:
            print(f"{by}: RMS {math.sqrt(sum(e * e for e in of) / len(of)):.1%}, worst {max(of, key=abs):+.1%}, mean {sum(of) / len(of):+.1%}, of {len(of)}")


bench, *rest = sys.argv[1:]
options = [word for word in rest if "=" in word]
if "plane" in rest:
    cases = []
    for row in json.loads((SHAKING / "gauss_seidel.json").read_text()):
        name = f"{row['courses']}x{row['per_course']} {row['amplitude']} g"
        cases.append((name, dict(courses=row["courses"], per=row["per_course"], amp=row["amplitude"]), 1e3 * row["excursion"]))
    small = [c for c in cases if "small" not in rest or c[1]["courses"] <= 24]
    compare(bench, small, options)
if "space" in rest:
    cases = []
    for row in json.loads((SHAKING / "gauss_seidel_space.json").read_text()):
        if row["structure"] in SPACE:
            name = f"{row['structure']} {row['amplitude']} g {row['angle']} deg"
            cases.append((name, dict(SPACE[row["structure"]], dim=3, amp=row["amplitude"], angle=row["angle"], rest=0, shake=row["seconds"]), 1e3 * row["top"]))
    compare(bench, cases, options)
