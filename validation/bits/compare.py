"""Table of two files of measure.py, and of the scenes that one build runs in several ways: python compare.py FILE OTHER. Status 1 where bits differ."""

import json
import sys

import numpy as np

PARTS = ("state", "energies", "impacts")


def rows(path):
    with open(path) as file:
        return {row["scene"]: row for row in map(json.loads, file)}


def compared(one, other):
    """What the table says of two runs: a verdict, since when they differ, and the largest distance of two positions."""
    if one.get("error") != other.get("error"):
        return f"differs: {one.get('error') or other.get('error')}", "", ""
    different = [(ours, theirs) for ours, theirs in zip(one["looks"], other["looks"]) if any(ours[part] != theirs[part] for part in PARTS)]
    if not different:
        return "same" + (" error" if "error" in one else ""), "", ""
    parts = [part for part in PARTS if any(ours[part] != theirs[part] for ours, theirs in different)]
    counts = one["looks"][-1]["count"], other["looks"][-1]["count"]
    number = f" ({counts[0]} and {counts[1]})" if counts[0] != counts[1] else ""
    apart = max(np.max(np.linalg.norm(np.subtract(ours["positions"], theirs["positions"]), axis=1) / one["sizes"]) for ours, theirs in different)
    return f"differs: {', '.join(parts)}{number}", f"{different[0][0]['time']:.2f}", f"{apart:.1e}"


def main(path, other_path):
    ours, theirs = rows(path), rows(other_path)
    table = [(name, *(compared(row, theirs[name]) if name in theirs else ("not in the other", "", ""))) for name, row in ours.items()]
    table += [(f"{name} (here)", *compared(row, ours[name.rpartition("; ")[0]])) for name, row in ours.items() if "; " in name]
    print("| scene | bits | since (s) | largest distance, of a block's size |\n| --- | --- | --- | --- |")
    for line in table:
        print(f"| {' | '.join(line)} |")
    same = sum(verdict.startswith("same") for _, verdict, *_ in table)
    print(f"\n{same} of {len(table)} the same")
    return same < len(table)


sys.exit(main(*sys.argv[1:]))
