"""Thirty records, rigid blocks and compliant joints: do their statistics agree? Run by ./run."""
import itertools
import sys
from pathlib import Path

import numpy as np
from masonry import ensemble
from pier import LAWS

HERE, FOLDER = Path(__file__).resolve().parent, Path("results/pier_ensemble")
PEAK, MOTIONS = 0.45, 30  # g
COMPARED = ("localised", "compliant")
EARLY = 0.1  # s


def main():
    cases = [dict(law=law, peak=PEAK, seed=seed, restitution=0.8) for law in LAWS for seed in range(MOTIONS)]
    table = ensemble.run(str(HERE / "pier.py"), cases, str(FOLDER))
    motions = {law: table[table["law"] == law] for law in LAWS}
    rows = {law: ensemble.statistics(motions[law], by="peak", probabilities=(0.5,))[0] for law in LAWS}
    print("| law | collapsed of 30 | 95 % interval of the share | median of the peak drift, of the height | 95 % interval | moves earlier |\n" + "| --- " * 6 + "|")
    for law, row in rows.items():
        early = np.sum(motions["localised"]["first_excursion"] - motions[law]["first_excursion"] > EARLY)
        print(f"| {law} | {motions[law]['collapsed'].sum()} | {row['fraction_low']:.2f} to {row['fraction_high']:.2f} | {row['quantile_0.5']:.4f} | "
              f"{row['quantile_0.5_low']:.4f} to {row['quantile_0.5_high']:.4f} | {early} |")
    agree = True
    for one, other in itertools.combinations(COMPARED, 2):
        for name in ("fraction", "quantile_0.5"):
            a, b = rows[one], rows[other]
            inside = b[name + "_low"] <= a[name] <= b[name + "_high"] and a[name + "_low"] <= b[name] <= a[name + "_high"]
            agree &= bool(inside)
            print(f"{'holds' if inside else 'MISSED'}: {name} of '{one}' and of '{other}', each within the other's interval")
    draw(motions)
    return 0 if agree else 1


def draw(motions):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picture, axis = plt.subplots(figsize=(6.5, 4), layout="constrained")
    for (law, table), line in zip(motions.items(), ("k-", "C0-", "C0:")):
        drift = np.sort(np.where(table["collapsed"], np.inf, table["peak_drift"]))
        axis.step(np.append(drift[np.isfinite(drift)], 0.5), np.append(np.arange(1, np.isfinite(drift).sum() + 1), np.isfinite(drift).sum()) / len(drift),
                  line, where="post", label=law)
    axis.set(xlabel="peak drift, of the height", ylabel="share of the motions that stay below", xlim=(0, 0.5), ylim=(0, 1), title=f"Pier of four blocks, {MOTIONS} motions of {PEAK} g")
    axis.grid(alpha=0.3)
    axis.legend(loc="lower right", title="the rest collapse", fontsize=8)
    picture.savefig(FOLDER / "drift.png", dpi=110)


if __name__ == "__main__":
    sys.exit(main())
