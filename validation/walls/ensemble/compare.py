"""Thirty records, two laws: do their statistics agree? Run by ./run."""
import sys
from pathlib import Path

from masonry import ensemble

HERE = Path(__file__).resolve().parent
LAWS, PEAKS, MOTIONS = ("rigid", "compliant"), (0.6,), 30


def main():
    cases = [dict(law=law, peak=peak, seed=seed, restitution=0.8) for law in LAWS for peak in PEAKS for seed in range(MOTIONS)]
    table = ensemble.run(str(HERE / "pier.py"), cases, "results/pier_ensemble")
    print("| law | peak (g) | motions | collapsed | 95 % interval | median of the peak drift (m) | 95 % interval |\n" + "| --- " * 7 + "|")
    rows = {}
    for law in LAWS:
        for row in ensemble.statistics(table[table["law"] == law], by="peak", probabilities=(0.5,)):
            rows[law, row["peak"]] = row
            print(f"| {law} | {row['peak']:g} | {row['cases']} | {row['fraction']:.2f} | {row['fraction_low']:.2f} to {row['fraction_high']:.2f} | "
                  f"{row['quantile_0.5']:.4f} | {row['quantile_0.5_low']:.4f} to {row['quantile_0.5_high']:.4f} |")
    agree = True
    for peak in PEAKS:
        for law in LAWS[:-1]:
            for name in ("fraction", "quantile_0.5"):
                one, other = rows[law, peak], rows["compliant", peak]
                inside = other[name + "_low"] <= one[name] <= other[name + "_high"] and one[name + "_low"] <= other[name] <= one[name + "_high"]
                agree &= bool(inside)
                print(f"{'holds' if inside else 'MISSED'}: {peak:g} g, {name} of '{law}' and of 'compliant', each within the other's interval")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
