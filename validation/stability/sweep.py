"""Runs the cases in YADE and appends one JSON line a run to a file; a run that is there is not repeated. Run by ./run."""

import json
import os

import convex_cases  # noqa: F401: its cases join CASES
from cases import CASES
from measures import run

QUICK = (None, 1.0)
SHARES = (1.0, 0.3, 0.1, 0.03, 0.01)


def main(path, quick, names, part, parts):
    done = set()
    if os.path.exists(path):
        with open(path) as file:
            done = {(r["case"], r["model"], r["share"]) for r in map(json.loads, file)}
    chosen = [case for case in CASES.values() if (case.quick or not quick) and (not names or case.name in names)]
    todo = [(case, model, share) for case in chosen for model in case.models for share in (QUICK if quick else (None, *SHARES))]
    for case, model, share in todo[part::parts]:
        if (case.name, model, share) in done:
            continue
        row = run(case, model, share)
        with open(path, "a") as file:
            file.write(json.dumps(row) + "\n")
        print(f"{row['verdict']:6} {case.name}, {model}, dt {row['dt']:.2g}: error {row['error']:.1e}, gain {row['gain']:.1e}, depth {row['depth']:.1e}, "
              f"{row['cpu']:.2f} CPU s {row['said'][:90]}", flush=True)


main(os.environ["STABILITY_ROWS"], os.environ.get("STABILITY_QUICK") == "1", os.environ.get("STABILITY_CASES", "").split(), *map(int, os.environ.get("STABILITY_PART", "0/1").split("/")))
