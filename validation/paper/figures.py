"""The figures. A restitution has one colour, a base 2b another, in all of them; solid: closed form; dashed: exact under gravity;
open circles: YADE, rigid blocks; crosses: YADE, overturned, with the half cycle in which."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

import convergence
import judge
import masonry
import theory
from cases import BASES, FINITE, FINITE_DURATION, GRAVITY, IMPULSE, RESTITUTIONS, TIME_TOLERANCE, Case, grid

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
               Line2D([], [], color="0.4", **POINT, label="YADE, rigid blocks")]
    cross = Line2D([], [], color="0.4", marker="x", ls="none", ms=5, label="YADE: overturns in the half cycle named")
    return entries + [cross] * overturned


def _legend(figure, entries, columns):
    """Below the panels."""
    figure.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=columns)


def _bases():
    return [Line2D([], [], color=colour, label=f"$2b$ = {b} m") for b, colour in BASE_COLOURS.items()]


def _errors(table, cases, names):
    """The errors, for the title."""
    found = [f"{text} {judge.worst(judge.select(table, cases), name):.0e}" for text, name in names]
    return "YADE's worst relative error: " + ", ".join(found)


def _rows(table, restitution, two_b):
    return [r for r in judge.select(table, grid()) if r["restitution"] == restitution and r["two_b"] == two_b]


def _points(axes, rows, x, y, colour):
    stable = [r for r in rows if not r["overturn_half_cycle"]]
    axes.plot([r[x] for r in stable], [r[y] for r in stable], color=colour, **POINT)


def _curve(two_b, restitution):
    """Slenderness 3..12, dense where the real block starts to overturn."""
    limit = theory.exact_critical_slenderness(two_b, restitution)
    points = np.concatenate([CURVE, limit * (1 - np.geomspace(1e-9, 0.05, 200))])
    return np.unique(points[(points >= 3) & (points <= 12)])


def _crosses(axes, table, restitution, lowest):
    """The overturned blocks, one row a base, from the height `lowest` (share of the axes) up."""
    for i, (b, colour) in enumerate(BASE_COLOURS.items()):
        height = lowest + 0.052 * i
        for r in (r for r in _rows(table, restitution, b) if r["overturn_half_cycle"]):
            place = dict(xycoords=axes.get_xaxis_transform(), textcoords="offset points", fontsize=7, color=colour, va="center")
            axes.plot(r["slenderness"], height, "x", color=colour, ms=4.5, transform=axes.get_xaxis_transform())
            axes.annotate(str(r["overturn_half_cycle"]), (r["slenderness"], height), xytext=(4, 0), **place)


def over_slenderness(table, out, number, title, name, quantity, errors, label, closed, exact):
    """Figs 4 and 8: one panel a restitution. The closed form depends on lambda only."""
    figure, panels = plt.subplots(1, 3, figsize=(10, 4.2), layout="constrained")
    for axes, c in zip(panels, RESTITUTIONS):
        limit = closed(c)
        highest = 1.05 * max(np.max(limit), max(np.nan_to_num(r[quantity]) for b in BASES for r in _rows(table, c, b)))
        axes.plot(CURVE, limit, color="0.2", lw=2)
        for b, colour in BASE_COLOURS.items():
            curve = _curve(b, c)
            values = exact(b, curve, c)
            axes.plot(curve, np.where(values <= highest, values, np.nan), color=colour, ls="--")
            _points(axes, _rows(table, c, b), "slenderness", quantity, colour)
        _crosses(axes, table, c, 0.815)
        axes.set(title=f"$C$ = {c}", xlabel=r"slenderness $\lambda$", xlim=(2.7, 12.7), ylim=(0, highest / 0.78), xticks=range(3, 13))
    panels[0].set_ylabel(label)
    figure.suptitle(f"Fig. {number}: {title}. {_errors(table, grid(), errors)}", fontsize=10)
    _legend(figure, _kinds() + _bases(), 4)
    _save(figure, out, name)


def figure_4(table, out):
    over_slenderness(table, out, 4, "period of the stabilised phase", "figure_4_period.png", "period", [("$T^*$", "period_error")],
                     "stabilised period $T^*$ (s)", lambda c: theory.closed(1.0, CURVE, c).period,
                     lambda b, lam, c: theory.exact(b, lam, c).period)


def figure_8(table, out):
    def exact(b, lam, c):
        return np.where(np.isnan(theory.exact(b, lam, c).ratio), np.nan, theory.time_to_stabilise(b, lam, c))

    over_slenderness(table, out, 8, "time to stabilise", "figure_8_time_to_stabilise.png", "time_to_stabilise", [("time", "stabilisation_error")],
                     f"time until $w$ is within {TIME_TOLERANCE:.0%} of $w^*$ (s)",
                     lambda c: masonry.closed_form.time_to_stabilise(theory.block(1.0, CURVE), IMPULSE, c, TIME_TOLERANCE), exact)


def resonance_spectrum(table, out, number, c):
    """Figs 5 to 7: against the period, as in the paper, and against the slenderness, where overturned blocks have a place."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained", sharey=True)
    longest = theory.closed(1.0, 12, c).period
    for b, colour in BASE_COLOURS.items():
        rows, curve = _rows(table, c, b), _curve(b, c)
        closed, exact = theory.closed(b, CURVE, c), theory.exact(b, curve, c)
        standing = np.where(closed.ratio <= 1, closed.ratio, np.nan)
        longest = max([longest, *(r["period"] for r in rows if not r["overturn_half_cycle"])])
        for axes, x_closed, x_exact, name in ((left, closed.period, exact.period, "period"), (right, CURVE, curve, "slenderness")):
            axes.plot(x_closed, standing, color=colour)
            axes.plot(x_exact, exact.ratio, color=colour, ls="--")
            _points(axes, rows, name, "ratio", colour)
    for axes in (left, right):
        axes.axhline(1, color="0.3", lw=0.8)
    left.text(0.01, 1.01, r"$\theta^* = \alpha$", transform=left.get_yaxis_transform(), fontsize=8, va="bottom")
    left.set(xlabel="stabilised period $T^*$ (s)", ylabel=r"$\theta^*/\alpha$", ylim=(0, 1.32), yticks=np.arange(0, 1.01, 0.2), xlim=(0, 1.08 * longest))
    _crosses(right, table, c, 0.8)
    right.set(xlabel=r"slenderness $\lambda$", xlim=(2.7, 12.6), xticks=range(3, 13))
    cases = [case for case in grid() if case.restitution == c]
    errors = _errors(table, cases, [(r"$\theta^*$", "peak_error"), ("$T^*$", "period_error")])
    figure.suptitle(f"Fig. {number}: resonance spectra, $C$ = {c}. {errors}", fontsize=10)
    _legend(figure, _kinds() + _bases(), 4)
    _save(figure, out, f"figure_{number}_spectrum_C{c}.png")


def convergence_figure(rows, out):
    """rows: convergence.table."""
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained", sharex=True, sharey=True)
    impulses = IMPULSE * np.geomspace(1 / 256, 1, 300)
    for axes, which, name, title in ((panels[0], 0, "peak", r"stabilised peak angle $\theta^*$"), (panels[1], 1, "period", "stabilised period $T^*$")):
        for c, colour in C_COLOURS.items():
            axes.loglog(impulses / IMPULSE, convergence.differences(Case(0.6, 5, c, impulses))[which], color=colour, ls="--")
            chosen = [r for r in rows if r["restitution"] == c]
            axes.loglog([r["impulse_share"] for r in chosen], [r[f"yade_{name}"] for r in chosen], color=colour, **POINT)
        guide = np.array([1 / 200, 1 / 50])
        axes.loglog(guide, 3 * guide**2, color="0.3", lw=1)
        axes.annotate("slope 2", (0.01, 3e-4), xytext=(-6, 4), textcoords="offset points", fontsize=8, ha="right")
        axes.set(title=title, xlabel="impulse / the paper's impulse")
    panels[0].set_ylabel("relative difference from the closed form")
    figure.suptitle(r"Real gravity tends to the closed form as $I \to 0$ ($2b$ = 0.6 m, $\lambda$ = 5)", fontsize=10)
    entries = [Line2D([], [], color="0.4", ls="--", label="exact, real gravity"), Line2D([], [], color="0.4", **POINT, label="YADE, rigid blocks")]
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


def finite_pulse_figure(table, history, out):
    """history: (time, angle) of the YADE run."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", width_ratios=(1.25, 1))
    case = FINITE
    b = theory.block(case.two_b, case.slenderness)
    t = np.linspace(0, 9, 4000)
    dirac = masonry.simulate(b, masonry.PulseTrain(IMPULSE), restitution=case.restitution, half_cycles=20)
    train = theory.finite_train(case.two_b, case.slenderness, case.restitution, FINITE_DURATION, 20, first="rectangular")
    left.plot(t, dirac.sample(t)[0] / b.critical_angle, color="0.2", label="Dirac pulses")
    left.plot(t, _finite_angle(train, t) / b.critical_angle, color="#aa3377", ls="--", label=f"rectangular, 0.25 g for {FINITE_DURATION} s")
    row = judge.select(table, [case])[0]
    history = np.array(history)
    history = history[history[:, 0] < t[-1]][::4]
    left.set(xlabel="time (s)", ylabel=r"$\theta/\alpha$", ylim=(-0.42, 0.3), xlim=(0, 9),
             title=fr"$2b$ = {case.two_b} m, $\lambda$ = {case.slenderness}, $C$ = {case.restitution}")
    left.plot(history[:, 0], history[:, 1] / b.critical_angle, color="#aa3377", label="YADE, rectangular", **POINT)
    left.legend(loc="lower left")
    slenderness = CURVE[::20]
    for c, colour in C_COLOURS.items():
        right.plot(CURVE, theory.exact(1.2, CURVE, c).ratio, color=colour)
        right.plot(slenderness, theory.finite_ratio(1.2, slenderness, c, FINITE_DURATION), color=colour, ls="--")
    right.plot(row["slenderness"], row["ratio"], color=C_COLOURS[case.restitution], **POINT)
    right.axvspan(2.7, 4, color="0.92", zorder=0)
    right.text(3.35, 0.97, "cannot lift a block at rest", fontsize=8, ha="center", va="top", rotation=90, transform=right.get_xaxis_transform())
    right.set(xlabel=r"slenderness $\lambda$", ylabel=r"stabilised $\theta^*/\alpha$", xlim=(2.7, 12.3), ylim=(0, 1), xticks=range(3, 13), title="$2b$ = 1.2 m")
    entries = [Line2D([], [], color=colour, label=f"$C$ = {c}") for c, colour in C_COLOURS.items()]
    entries += [Line2D([], [], color="0.4", label="Dirac"), Line2D([], [], color="0.4", ls="--", label="rectangular, 0.1 s"),
                Line2D([], [], color="0.4", **POINT, label="YADE, rectangular")]
    _legend(figure, entries, 6)
    errors = _errors(table, [case], [(r"$\theta^*$", "peak_error"), ("$T^*$", "period_error")])
    figure.suptitle(f"Dirac pulses and the stated pulse of the same impulse. {errors}", fontsize=10)
    _save(figure, out, "finite_pulse.png")


def draw_all(table, rows, history, out):
    with plt.rc_context(STYLE):
        figure_4(table, out)
        for number, c in zip((5, 6, 7), RESTITUTIONS):
            resonance_spectrum(table, out, number, c)
        figure_8(table, out)
        convergence_figure(rows, out)
        finite_pulse_figure(table, history, out)
