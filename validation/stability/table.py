"""Table and figure of the hard cases, from the rows that sweep.py has written. Ends with status 1 where a run is silently wrong."""

import json
import math
import sys

MODELS = ("planar", "spatial", "wall", "wall in space", "compliant")
COLOURS = dict(zip(MODELS, ("tab:red", "tab:orange", "tab:blue", "tab:cyan", "tab:green")))


def read(path):
    with open(path) as file:
        return [json.loads(line) for line in file]


def cell(rows):
    """Of one case and model: error at the default step, and the verdicts at the larger ones."""
    if not rows:
        return "-"
    default = next((r for r in rows if r["share"] is None), None)
    others = [r for r in rows if r["share"] is not None]
    text = "" if default is None else "not run" if default["verdict"] == "not run" else f"{default['error']:.0e} {default['verdict']}"
    wrong = [r for r in others if r["verdict"] in ("told", "silent")]
    if wrong:
        first = min(wrong, key=lambda r: r["share"])
        text += f"; from {first['share']:g}: {'SILENT' if any(r['verdict'] == 'silent' for r in wrong) else 'told'}"
    return text


def figure(path, rows, names):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    columns = 5
    lines = math.ceil((len(names) + 1) / columns)  # the legend has a place of its own
    drawn, axes = plt.subplots(lines, columns, figsize=(3.1 * columns, 2.3 * lines), layout="constrained", squeeze=False)
    for axis, name in zip(axes.flat, names):
        of_case = [r for r in rows if r["case"] == name and r["verdict"] != "not run"]
        for model in MODELS:
            points = sorted((r["dt"], r) for r in of_case if r["model"] == model and math.isfinite(r["dt"]) and math.isfinite(r["error"]))
            if not points:
                continue
            height = [min(max(r["error"], r["gain"], 1e-12), 1e2) for _, r in points]
            axis.plot([dt for dt, _ in points], height, "-", color=COLOURS[model], linewidth=1, label=model)
            for marker, verdict, size in (("o", "right", 3), ("s", "told", 4), ("X", "silent", 7)):
                chosen = [(dt, h) for (dt, r), h in zip(points, height) if r["verdict"] == verdict]
                if chosen:
                    axis.plot(*zip(*chosen), marker, color=COLOURS[model], markersize=size, markeredgecolor="black" if verdict == "silent" else COLOURS[model])
        told = [r["dt"] for r in of_case if r["verdict"] == "told" and math.isfinite(r["dt"])]
        if told:
            axis.axvspan(min(told), max(told) * 1.3, color="0.9", zorder=0)
        axis.set(xscale="log", yscale="log", ylim=(1e-13, 3e2))
        axis.set_title(name.replace("_", " "), fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.3)
    for axis in list(axes.flat)[len(names):]:
        axis.axis("off")
    handles = [plt.Line2D([], [], color=COLOURS[m], label=m) for m in MODELS]
    handles += [plt.Line2D([], [], color="k", marker=k, linestyle="none", label=text) for k, text in (("o", "right"), ("s", "wrong, and the run says so (shaded)"), ("X", "wrong without a word"))]
    axes.flat[-1].legend(handles=handles, loc="center", fontsize=7)
    drawn.supxlabel("time step, s", fontsize=9)
    drawn.supylabel("larger of error and energy gained, relative", fontsize=9)
    drawn.savefig(path, dpi=80)


def main(path, out):
    rows = read(path)
    names = list(dict.fromkeys(r["case"] for r in rows))
    print(f"\n| case | {' | '.join(MODELS)} |\n" + "| --- " * (1 + len(MODELS)) + "|")
    for name in names:
        print(f"| {name.replace('_', ' ')} | " + " | ".join(cell([r for r in rows if r["case"] == name and r["model"] == model]) for model in MODELS) + " |")
    print("\n| model | runs | right | wrong, told | wrong, silent | not run | CPU s |\n| --- | --- | --- | --- | --- | --- | --- |")
    for model in MODELS:
        mine = [r for r in rows if r["model"] == model]
        count = [sum(r["verdict"] == v for r in mine) for v in ("right", "told", "silent", "not run")]
        print(f"| {model} | {len(mine)} | {' | '.join(map(str, count))} | {sum(r['cpu'] for r in mine if math.isfinite(r['cpu'])):.0f} |")
    figure(f"{out}/stability.png", rows, names)
    silent = [r for r in rows if r["verdict"] == "silent"]
    for r in silent:
        print(f"SILENT: {r['case']}, {r['model']}, dt {r['dt']:.2g}: error {r['error']:.1e}, gain {r['gain']:.1e}, depth {r['depth']:.1e}")
    print(f"\n{len(rows)} runs, {len(silent)} wrong without a word; table and figure: {out}")
    return not silent


if not main(*sys.argv[1:]):
    raise SystemExit("yade-masonry: a hard case is wrong and does not say so: see the lines above.")
