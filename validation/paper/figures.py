"""The figures. A restitution has one colour, a base 2b another, in all of them; solid: closed form; dashed: exact under gravity;
open circles: YADE; crosses: YADE, overturned, with the half cycle in which."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

import claims
import judge
import masonry
import theory
from cases import BASES, FINITE, FINITE_DURATION, GRAVITY, IMPULSE, RESTITUTIONS, TIME_TOLERANCE, Case, convergence, grid, relative_error

C_COLOURS = dict(zip(RESTITUTIONS, ("#0072b2", "#d55e00", "#009e73")))
BASE_COLOURS = dict(zip(BASES, ("#cc3311", "#ee9900", "#228833", "#3355bb")))
CURVE = np.linspace(3, 12, 1801)
POINT = dict(marker="o", mfc="white", ms=4.5, mew=1.1, ls="none", zorder=5)
STYLE = {"font.size": 9, "axes.titlesize": 10, "legend.fontsize": 8, "axes.grid": True, "grid.alpha": 0.25, "grid.linewidth": 0.5,
         "axes.spines.top": False, "axes.spines.right": False, "savefig.dpi": 160, "lines.linewidth": 1.4, "legend.frameon": False}


def _save(figure, out, name):
    figure.savefig(out / name, bbox_inches="tight")
    plt.close(figure)


def _kinds(closed_colour="0.2", overturned=True):
    """Legend entries for the kinds of lines and points."""
    entries = [Line2D([], [], color=closed_colour, label="closed form (paper)"), Line2D([], [], color="0.4", ls="--", label="exact, real gravity"),
               Line2D([], [], color="0.4", **POINT, label="YADE")]
    cross = Line2D([], [], color="0.4", marker="x", ls="none", ms=5, label="YADE: overturns in the half cycle named")
    return entries + [cross] * overturned


def _legend(figure, entries, columns):
    """Below the panels."""
    figure.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=columns)


def _bases():
    return [Line2D([], [], color=colour, label=f"$2b$ = {b} m") for b, colour in BASE_COLOURS.items()]


def _rows(table, restitution, two_b):
    return [r for r in judge.select(table, grid()) if r["restitution"] == restitution and r["two_b"] == two_b]


def _points(axes, rows, x, y, colour):
    stable = [r for r in rows if not r["overturn_half_cycle"]]
    axes.plot([r[x] for r in stable], [r[y] for r in stable], color=colour, **POINT)


def over_slenderness(table, out, name, quantity, label, closed, exact):
    """Figs 4 and 8: one panel a restitution. The closed form depends on lambda only."""
    figure, panels = plt.subplots(1, 3, figsize=(10, 3.6), layout="constrained")
    for axes, c in zip(panels, RESTITUTIONS):
        limit = closed(c)
        axes.plot(CURVE, limit, color=C_COLOURS[c], lw=2)
        for b, colour in BASE_COLOURS.items():
            axes.plot(CURVE, exact(b, c), color=colour, ls="--")
            _points(axes, _rows(table, c, b), "slenderness", quantity, colour)
        axes.set(title=f"$C$ = {c}", xlabel=r"slenderness $\lambda$", xlim=(2.7, 12.3), ylim=(0, 1.45 * np.max(limit)), xticks=range(3, 13))
    panels[0].set_ylabel(label)
    _legend(figure, _kinds(overturned=False) + _bases(), 7)
    _save(figure, out, name)


def figure_4(table, out):
    over_slenderness(table, out, "figure_4_period.png", "period", "stabilised period $T^*$ (s)",
                     lambda c: theory.closed(1.0, CURVE, c).period, lambda b, c: theory.exact(b, CURVE, c).period)


def figure_8(table, out):
    over_slenderness(table, out, "figure_8_time_to_stabilise.png", "time_to_stabilise", f"time until $w$ is within {TIME_TOLERANCE:.0%} of $w^*$ (s)",
                     lambda c: masonry.closed_form.time_to_stabilise(theory.block(1.0, CURVE), IMPULSE, c, TIME_TOLERANCE),
                     lambda b, c: theory.time_to_stabilise(b, CURVE, c))


def resonance_spectrum(table, out, number, c):
    """Figs 5 to 7: against the period, as in the paper, and against the slenderness, where overturned blocks have a place."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained", sharey=True)
    for i, (b, colour) in enumerate(BASE_COLOURS.items()):
        closed, exact, rows = theory.closed(b, CURVE, c), theory.exact(b, CURVE, c), _rows(table, c, b)
        standing = np.where(closed.ratio <= 1, closed.ratio, np.nan)
        for axes, x_closed, x_exact, name in ((left, closed.period, exact.period, "period"), (right, CURVE, CURVE, "slenderness")):
            axes.plot(x_closed, standing, color=colour)
            axes.plot(x_exact, exact.ratio, color=colour, ls="--")
            _points(axes, rows, name, "ratio", colour)
        height = 1.07 + 0.07 * i
        for r in (r for r in rows if r["overturn_half_cycle"]):
            right.plot(r["slenderness"], height, "x", color=colour, ms=5)
            right.annotate(str(r["overturn_half_cycle"]), (r["slenderness"], height), xytext=(4, 0), textcoords="offset points", fontsize=7,
                           color=colour, va="center")
    for axes in (left, right):
        axes.axhline(1, color="0.3", lw=0.8)
    left.text(0.01, 1.01, r"$\theta^* = \alpha$", transform=left.get_yaxis_transform(), fontsize=8, va="bottom")
    longest = np.nanmax([np.nanmax(theory.exact(b, CURVE, c).period) for b in BASES])
    left.set(xlabel="stabilised period $T^*$ (s)", ylabel=r"$\theta^*/\alpha$", ylim=(0, 1.34), yticks=np.arange(0, 1.01, 0.2),
             xlim=(0, 1.05 * min(longest, 1.6 * 0.1 * 12 / (1 - c))))
    right.set(xlabel=r"slenderness $\lambda$", xlim=(2.7, 12.5), xticks=range(3, 13))
    figure.suptitle(f"Fig. {number}: resonance spectra, $C$ = {c}")
    _legend(figure, _kinds() + _bases(), 4)
    _save(figure, out, f"figure_{number}_spectrum_C{c}.png")


# Convergence as I -> 0.

def _differences(case):
    """|exact - closed form|/closed form of the stabilised phase: (theta*, T*)."""
    closed, exact = (f(case.two_b, case.slenderness, case.restitution, case.impulse) for f in (theory.closed, theory.exact))
    return relative_error(exact.ratio, closed.ratio), relative_error(exact.period, closed.period)


def _yade_differences(case, row):
    """The same of a run, at its last half cycle against the closed form of that half cycle."""
    b = theory.block(case.two_b, case.slenderness)
    s = masonry.closed_form.pulse_sequence(b, case.impulse, case.restitution, case.half_cycles)
    return relative_error(row["ratio"] * b.critical_angle, s.peak_angle[-1]), relative_error(row["period"], s.duration[-2:].sum())


def _slope(x, y):
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def convergence_table(table):
    """(rows, verdicts): relative difference from the closed form against the impulse; slopes over the smallest two impulses run in YADE."""
    rows, verdicts = [], []
    for c in RESTITUTIONS:
        chosen = [k for k in convergence() if k.restitution == c]
        for case in chosen:
            angle, period = _differences(case)
            yade_angle, yade_period = _yade_differences(case, judge.select(table, [case])[0])
            rows.append(dict(restitution=c, impulse=case.impulse, impulse_share=case.impulse / IMPULSE, exact_peak=float(angle), exact_period=float(period),
                             yade_peak=float(yade_angle), yade_period=float(yade_period)))
        smallest = [r for r in rows if r["restitution"] == c][-2:]
        for name, text in (("peak", "theta*"), ("period", "T*")):
            for source in ("exact", "yade"):
                slope = _slope([r["impulse"] for r in smallest], [r[f"{source}_{name}"] for r in smallest])
                verdicts.append((f"I -> 0, C = {c}: order in I of the difference of {text} from the closed form, {'YADE' if source == 'yade' else source}",
                                 f"{slope:.4f}", "2 +- 0.1", abs(slope - 2) <= 0.1))
    return rows, verdicts


def convergence_figure(rows, verdicts, out):
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained", sharex=True, sharey=True)
    impulses = IMPULSE * np.geomspace(1 / 256, 1, 300)
    for axes, which, name, title in ((panels[0], 0, "peak", r"stabilised peak angle $\theta^*$"), (panels[1], 1, "period", "stabilised period $T^*$")):
        for c, colour in C_COLOURS.items():
            axes.loglog(impulses / IMPULSE, _differences(Case(0.6, 5, c, impulses))[which], color=colour, ls="--")
            chosen = [r for r in rows if r["restitution"] == c]
            axes.loglog([r["impulse_share"] for r in chosen], [r[f"yade_{name}"] for r in chosen], color=colour, **POINT)
        corner = np.array([1 / 200, 1 / 50])
        axes.loglog(corner, 0.3 * corner**2 * 8, color="0.3", lw=1)
        axes.annotate("slope 2", (corner[1], 2.4 * corner[1] ** 2), xytext=(4, -10), textcoords="offset points", fontsize=8)
        axes.set(title=title, xlabel="impulse / the paper's impulse")
    panels[0].set_ylabel("relative difference from the closed form")
    entries = [Line2D([], [], color="0.4", ls="--", label="exact, real gravity"), Line2D([], [], color="0.4", **POINT, label="YADE")]
    entries += [Line2D([], [], color=colour, label=f"$C$ = {c}") for c, colour in C_COLOURS.items()]
    _legend(figure, entries, 5)
    _save(figure, out, "convergence.png")


# Dirac against the stated finite pulse.

def _finite_angle(train, t):
    """theta(t) of the chained half cycles."""
    angle = np.zeros_like(t)
    for i, start in enumerate(train.starts):
        inside = (t >= start) & (t < (train.starts[i + 1] if i + 1 < len(train.starts) else np.inf))
        if inside.any():
            angle[inside] = train.angle(i, t[inside] - start)
    return angle


def finite_pulse_figure(table, out):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", width_ratios=(1.25, 1))
    case = FINITE
    b = theory.block(case.two_b, case.slenderness)
    t = np.linspace(0, 9, 4000)
    dirac = masonry.simulate(b, masonry.PulseTrain(IMPULSE), restitution=case.restitution, half_cycles=20)
    train = theory.finite_train(case.two_b, case.slenderness, case.restitution, FINITE_DURATION, 20, first="rectangular")
    left.plot(t, dirac.sample(t)[0] / b.critical_angle, color="0.2", label="Dirac pulses")
    left.plot(t, _finite_angle(train, t) / b.critical_angle, color="#aa3377", ls="--", label=f"rectangular, 0.25 g for {FINITE_DURATION} s")
    row = judge.select(table, [case])[0]
    left.set(xlabel="time (s)", ylabel=r"$\theta/\alpha$", ylim=(-0.4, 0.4),
             title=fr"$2b$ = {case.two_b} m, $\lambda$ = {case.slenderness}, $C$ = {case.restitution}; the exact solution")
    left.axhline(row["ratio"], color="#aa3377", lw=0.8, ls=":", label="YADE, rectangular: stabilised peak")
    left.legend(loc="lower left")
    for c, colour in C_COLOURS.items():
        right.plot(CURVE, theory.exact(1.2, CURVE, c).ratio, color=colour)
        lam, reduction = claims.finite_reduction(1.2, c)
        right.plot(lam, (1 - reduction) * theory.exact(1.2, lam, c).ratio, color=colour, ls="--")
    right.plot(row["slenderness"], row["ratio"], color=C_COLOURS[case.restitution], **POINT)
    right.axvspan(2.7, 4, color="0.92", zorder=0)
    right.text(3.35, 0.93, "cannot lift\na block at rest", fontsize=8, ha="center", va="top", transform=right.get_xaxis_transform())
    right.set(xlabel=r"slenderness $\lambda$", ylabel=r"stabilised $\theta^*/\alpha$", xlim=(2.7, 12.3), ylim=(0, 1), xticks=range(3, 13), title="$2b$ = 1.2 m")
    entries = [Line2D([], [], color=colour, label=f"$C$ = {c}") for c, colour in C_COLOURS.items()]
    entries += [Line2D([], [], color="0.4", label="Dirac"), Line2D([], [], color="0.4", ls="--", label="rectangular, 0.1 s"),
                Line2D([], [], color="0.4", **POINT, label="YADE, rectangular")]
    _legend(figure, entries, 6)
    _save(figure, out, "finite_pulse.png")


def draw_all(table, rows, verdicts, out):
    with plt.rc_context(STYLE):
        figure_4(table, out)
        for number, c in zip((5, 6, 7), RESTITUTIONS):
            resonance_spectrum(table, out, number, c)
        figure_8(table, out)
        convergence_figure(rows, verdicts, out)
        finite_pulse_figure(table, out)
