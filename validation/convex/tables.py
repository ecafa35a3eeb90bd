"""Prints the tables of all cases. Run by ./run."""

import os
import sys
import time

import arches
import rolling
import sliding
import structures
import tipping
from rows import BULLET, COMPLIANT, MODES

OUT = os.environ.get("CONVEX_OUT", "results/convex")
MODULES = [rolling, sliding, tipping, arches, structures]


def main(wanted):
    head = ["case", "quantity", "right value", *(f"`{method}`, {model}" for method, model in MODES + COMPLIANT), *(f"{program} {shapes}" for program, shapes in BULLET), "allowed", "holds"]
    if not BULLET:
        print("Bullet is left out: install libbullet-dev, and build the target convex_bullet.")
    print("| " + " | ".join(head) + " |\n" + "| --- " * len(head) + "|")
    begun, good = time.process_time(), True
    for case in (case for module in MODULES for case in module.CASES if not wanted or case.__name__.split("_")[0] in wanted):
        for row in case():
            good &= row.holds()
            print(row, flush=True)
    if not wanted:
        os.makedirs(OUT, exist_ok=True)
        rolling.draw(OUT)
        tipping.draw(OUT)
    print(f"\n{time.process_time() - begun:.0f} CPU s; {'all rows hold' if good else 'NOT ALL ROWS HOLD'}", flush=True)
    return 0 if good else 1


os._exit(main(sys.argv[1:]))  # yade -x would end with status 0
