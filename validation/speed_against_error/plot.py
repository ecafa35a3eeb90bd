"""The figure: CPU time against peak error, one line a series."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FLOOR = 1e-16  # of double precision: a peak without an error would have no place on the axis
STYLE = {  # one colour and marker a program, one line style a series of it
    "masonry theory": ("black", "*"),
    "yade-masonry rigid": ("tab:red", "o"),
    "yade-masonry compliant": ("tab:pink", "o"),
    "YADE clump of spheres": ("tab:orange", "v"),
    "YADE Polyhedra": ("tab:brown", "^"),
    "Bullet double": ("tab:blue", "s"),
    "Bullet float": ("tab:cyan", "D"),
    "ODE double": ("tab:green", "P"),
}
LINES = ("-", "--", ":")


def figure(path, rows, machine):
    drawn, axes = plt.subplots(figsize=(11, 6), layout="constrained")
    series = {}
    for row in rows:
        if math.isfinite(row.peak_error):
            series.setdefault(row.series, []).append(row)
    used = {}
    for name, members in series.items():
        solver = members[0].solver
        colour, marker = STYLE.get(solver, ("grey", "x"))
        line = LINES[used.get(solver, 0) % len(LINES)]
        used[solver] = used.get(solver, 0) + 1
        errors = [max(row.peak_error, FLOOR) for row in members]
        axes.plot([row.cpu for row in members], errors, line, color=colour, marker=marker, markersize=5, label=name)
    axes.set(xscale="log", yscale="log", xlabel="CPU seconds per simulated second, one block", ylabel="worst relative error of the first five peak angles")
    axes.grid(True, which="major", alpha=0.4)
    axes.set_title("One rocking block, 0.6 x 3.0 m, let go at half its critical angle: lower left is better\n" + machine, fontsize=10)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8, handlelength=4)
    drawn.savefig(path, dpi=150)
    plt.close(drawn)
