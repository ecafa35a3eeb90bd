"""First excursions of walls by the step of assemblies, beside converged Gauss-Seidel sweeps, with its CPU times.

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
    line = subprocess.run([bench, *words, *options], capture_output=True, text=True, check=True).stdout.splitlines()[-1]
    number = lambda key: float(re.search(key + r" ([-\d.e+naif]+)", line).group(1))  # noqa: E731
    return dict(mean=number("mean"), cpu=number(r"\(step"), its=number("its"), fac=number("fac"), rises=number("loss"), pen=number("pen"))


def compare(bench, cases, options):
    errors = []
    for name, case, wanted in cases:
        row = run(bench, case, options)
        errors.append(row["mean"] / wanted - 1)
        print(f"{name:34} {wanted:8.2f} {row['mean']:7.2f} {errors[-1]:+6.1%} {row['cpu']:6.3f} CPU s/s, iterations {row['its']:.1f}, factorisations {row['fac']:.2f}, "
              f"rises {row['rises']:.1e}, penetration {row['pen']:.2g} mm", flush=True)
    print(f"RMS {math.sqrt(sum(e * e for e in errors) / len(errors)):.1%}, worst {max(errors, key=abs):+.1%}, mean {sum(errors) / len(errors):+.1%}, of {len(errors)}")


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
