"""Rates of broken invariants of the random scenes, by model and kind, and how many of them say nothing."""

import json
import sys

path, scenes = sys.argv[1], int(sys.argv[2])
with open(path) as file:
    rows = [{"kind": "thrown", **r} for r in map(json.loads, file) if r["seed"] < scenes]
invariants = ("energy", "depth", "flight", "cone", "off", "work", "damage", "strength", "mirror", "reaction", "sink", "bits")
print(f"\nSeeds {min((r['seed'] for r in rows), default=0)} to {scenes - 1}.\n\n| scenes of | model | scenes | {' | '.join(invariants)} | broken without a word | CPU s |\n" + "| --- " * (len(invariants) + 5) + "|")
for kind, model in dict.fromkeys((r["kind"], r.get("model", "refused")) for r in sorted(rows, key=lambda r: (r["kind"] != "thrown", r["seed"]))):
    mine = [r for r in rows if (r["kind"], r.get("model", "refused")) == (kind, model)]
    silent = [r["seed"] for r in mine if r["broken"] and not r["said"]]
    print(f"| {kind} | {model} | {len(mine)} | {' | '.join(str(sum(k in r['broken'] for r in mine)) for k in invariants)} | {len(silent)} | {sum(r['cpu'] for r in mine):.0f} |")
    print(f"  silent seeds of {kind}, {model}: {silent[:40]}") if silent else None
