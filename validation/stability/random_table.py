"""Rates of broken invariants of the random scenes, by model and kind, and how many of them say nothing."""

import json
import sys

path, scenes = sys.argv[1], int(sys.argv[2])
with open(path) as file:
    rows = [r for r in map(json.loads, file) if r["seed"] < scenes]
kinds = ("energy", "depth", "flight", "cone", "off", "bits")
print(f"\nSeeds 0 to {scenes - 1}.\n\n| model | scenes | {' | '.join(kinds)} | broken without a word | CPU s |\n" + "| --- " * (len(kinds) + 4) + "|")
for model in dict.fromkeys(r.get("model", "refused") for r in sorted(rows, key=lambda r: r["seed"])):
    mine = [r for r in rows if r.get("model", "refused") == model]
    silent = [r["seed"] for r in mine if r["broken"] and not r["said"]]
    print(f"| {model} | {len(mine)} | {' | '.join(str(sum(k in r['broken'] for r in mine)) for k in kinds)} | {len(silent)} | {sum(r['cpu'] for r in mine):.0f} |")
    print(f"  silent seeds of {model}: {silent[:40]}") if silent else None
