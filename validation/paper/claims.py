"""What the paper's text states, and what its closed form and real gravity give. Typed in: the paper's own numbers, nothing else."""
from dataclasses import dataclass

import masonry
import numpy as np

import theory
from cases import BASES, FINITE_DURATION, GRAVITY, IMPULSE, RESTITUTIONS, TIME_TOLERANCE, half_cycles, relative_error

READ_OFF = 0.08  # relative: how far a number that was read off a small graph may lie from the curve
NAMED_BASES = (0.4, 0.6, 1.2)  # m, in the text
RANGE = (3, 12)  # of slenderness, in the figures


@dataclass
class Claim:
    where: str
    statement: str
    paper: str
    closed_form: str
    gravity: str
    verdict: str


def number(where, statement, paper, closed, gravity, computed):
    """A stated number. computed: the text had it from a formula, so it must agree in its last digit; else it was read off a graph."""
    digits = len(paper.partition(".")[2])
    if abs(closed - float(paper)) <= 0.5 * 10**-digits * (1 + 1e-9):
        verdict = "agrees"
    elif computed:
        verdict = "misprint: the closed form differs"
    else:
        verdict = "read off a graph" if relative_error(float(paper), closed) <= READ_OFF else "the closed form differs"
    return Claim(where, statement, paper, f"{closed:.6f}", gravity if isinstance(gravity, str) else f"{gravity:.6f}", verdict)


def _value(x):
    return "overturns" if np.isnan(x) else f"{float(x):.6f}"


def periods_and_ratios():
    text = {0.6: ("1.25", "0.25"), 0.7: ("1.67", "0.42"), 0.8: ("2.25", "0.95")}
    rows = []
    for name, which, computed in (("T* (s)", 0, True), ("theta*/alpha", 1, False)):
        for c, values in text.items():
            closed, exact = theory.closed(0.6, 5, c), theory.exact(0.6, 5, c)
            pair = (closed.period, exact.period) if which == 0 else (closed.ratio, exact.ratio)
            gravity = _value(pair[1])
            if gravity == "overturns":
                gravity += f" in half cycle {overturning_half_cycle(0.6, 5, c)}"
            rows.append(number("3.2, below Fig. 7", f"{name}, 2b = 0.6 m, lambda = 5, C = {c}", values[which], float(pair[0]), gravity, computed))
    quotient = float(theory.closed(0.6, 5, 0.8).ratio / theory.closed(0.6, 5, 0.6).ratio)
    rows.append(number("3.2, below Fig. 7", "ratio at C = 0.8 over that at C = 0.6: 'almost four times'", "4", quotient, "overturns at C = 0.8", True))
    return rows


def overturning_half_cycle(two_b, slenderness, restitution):
    n = half_cycles(restitution)
    h = masonry.simulate(theory.block(two_b, slenderness), masonry.PulseTrain(IMPULSE), restitution=restitution, half_cycles=n)
    return int(h.overturn_half_cycle)


def limits():
    rows = []
    for two_b, c, paper, period in ((0.4, 0.7, "7.5", "2.5"), (0.4, 0.8, "3.5", "1.75")):
        closed, exact = theory.critical_slenderness(two_b, c), theory.exact_critical_slenderness(two_b, c)
        where = f"3.2, Fig. {6 if c == 0.7 else 7}"
        rows.append(number(where, f"largest lambda without overturning, 2b = {two_b} m, C = {c}", paper, closed, exact, False))
        rows.append(number(where, f"the same as T* (s), 2b = {two_b} m, C = {c}", period, float(theory.closed(two_b, closed, c).period),
                           "infinite at the limit", False))
    return rows


def _crossing(two_b, c, limit):
    lam = limit(two_b, c)
    return f"2b = {two_b} m at lambda = {lam:.6f}" if RANGE[0] <= lam <= RANGE[1] else None


def safe_blocks():
    """Statements on which bases overturn within lambda 3..12."""
    statements = (("Fig. 5", 0.6, "all blocks of C = 0.6 reach the stabilised phase", NAMED_BASES),
                  ("Fig. 6", 0.7, "at C = 0.7 only 2b = 0.4 m is said to overturn", (0.6, 1.2)),
                  ("Fig. 7", 0.8, "at C = 0.8, 2b = 1.2 m is safe for every lambda", (1.2,)))
    rows = []
    for where, c, statement, bases in statements:
        closed, exact = ([x for b in bases if (x := _crossing(b, c, limit))]
                         for limit in (theory.critical_slenderness, theory.exact_critical_slenderness))
        rows.append(Claim(where, statement, "no overturning for " + ", ".join(f"2b = {b}" for b in bases),
                          "; ".join(closed) or "none overturns", "; ".join(exact) or "none overturns",
                          "the closed form differs" if closed else "agrees"))
    return rows


def displacement():
    """The train ends at rest. In the intervals dt_i = 2 lambda (I/g) s_i the base moves at +I, -I, ... in turn. Equal intervals would
    cancel in pairs; the growing ones leave the sum of I (dt_1 - dt_2 + ...), which tends to -+2 lambda (I/g) I/(1-C) after an even or odd
    number of half cycles."""
    lam, c, n = 5, 0.7, 200
    b = theory.block(0.6, lam)
    signs = (-1.0) ** np.arange(n)
    closed = IMPULSE * np.sum(signs * masonry.closed_form.pulse_sequence(b, IMPULSE, c, n).duration)
    gravity = masonry.simulate(b, masonry.PulseTrain(IMPULSE, half_cycles=n), restitution=c, half_cycles=n).base_displacement
    formula = -2 * lam * IMPULSE / GRAVITY * IMPULSE / (1 - c)
    return [Claim("2", f"base displacement after the train, lambda = {lam}, C = {c}, an even number ({n}) of half cycles (m)", "0",
                  f"{closed:.6f}; limit -2 lambda (I/g) I/(1-C) = {formula:.6f}", f"{float(gravity):.6f} (2b = 0.6 m)", "not zero: the intervals grow")]


def stabilisation():
    rows = []
    for c in RESTITUTIONS:
        n = half_cycles(c, TIME_TOLERANCE)
        closed = float(masonry.closed_form.time_to_stabilise(theory.block(1.2, 3), IMPULSE, c, TIME_TOLERANCE))
        gravity = float(theory.time_to_stabilise(1.2, 3, c))
        rows.append(Claim("3.2, Fig. 8", f"time to stabilise, lambda = 3, C = {c}", "no tolerance given",
                          f"{closed:.6f} s ({n} half cycles, w within {TIME_TOLERANCE:.0%})", f"{gravity:.6f} s (2b = 1.2 m)",
                          "needs a tolerance: Eq. 8 is asymptotic"))
    reached = [f"2b = {b} m: lambda <= {theory.critical_slenderness(b, 0.8):.6f}" for b in BASES]
    exact = [f"2b = {b} m: lambda <= {theory.exact_critical_slenderness(b, 0.8):.6f}" for b in BASES]
    rows.append(Claim("3.2, below Fig. 8", "which blocks stabilise at C = 0.8", "only lambda = 3", "; ".join(reached), "; ".join(exact),
                      "contradicts Fig. 7, where 2b = 1.2 m stabilises"))
    return rows


def general():
    lam = np.linspace(*RANGE, 91)
    grid = [(b, c) for b in BASES for c in RESTITUTIONS]
    closed = np.concatenate([np.atleast_1d(theory.closed(b, lam, c).ratio) for b, c in grid])
    exact = np.concatenate([np.atleast_1d(theory.exact(b, lam, c).ratio) for b, c in grid])
    larger = np.nanmax(exact / closed)
    smallest = np.nanmin(exact / closed)
    one = [float(theory.exact(b, 5, 0.6).period) for b in BASES]
    onset = np.array([np.tan(a / 2) / a for a in (theory.block(1.0, x).critical_angle for x in RANGE)])
    return [
        Claim("abstract, 3", "theta* is an upper bound of the rotation", "upper bound", "ratio 1 at overturning",
              f"theta* larger by a factor of {smallest:.4f} to {larger:.4f} for blocks that do not overturn", "no bound: gravity gives more"),
        Claim("3.2", "overturning begins at theta*/alpha", "1", "1",
              f"tan(alpha/2)/alpha = {onset.max():.6f} (lambda = 3) to {onset.min():.6f} (lambda = 12)", "twice the true energy"),
        Claim("3.1.2", "T* does not depend on the size (lambda = 5, C = 0.6)", "independent", f"{float(theory.closed(0.6, 5, 0.6).period):.6f} s",
              f"{min(one):.6f} s (2b = {BASES[int(np.argmin(one))]} m) to {max(one):.6f} s (2b = {BASES[int(np.argmax(one))]} m)",
              "true of the constant moment only"),
    ]


def finite_pulse():
    """The stated pulse against the Dirac pulse of the same impulse, stabilised phase."""
    lift = GRAVITY * FINITE_DURATION / (2 * IMPULSE)  # g/a_g
    lam = np.linspace(*RANGE, 37)
    all_blocks = np.concatenate([finite_reduction(b, c, lam) for c in RESTITUTIONS for b in BASES])
    lifted = finite_reduction(1.2, 0.6, lam)[lam > lift]

    def lowering(which, values):
        return Claim("3.2", f"theta* of pulses of {FINITE_DURATION} s, each right after an impact: {which}", "that of Dirac pulses", "-",
                     f"lower by {np.nanmin(values):.1%} to {np.nanmax(values):.1%}", "the finite pulse does less")

    return [Claim("3.2", "the pulse of 0.25 g for 0.1 s lifts a block at rest", "it does", "-",
                  f"only if lambda > g/a_g = {lift:g}; the first pulse, I in the same time, only if lambda > {2 * lift:g}", f"not below lambda = {lift:g}"),
            lowering(f"lambda {RANGE[0]} to {RANGE[1]}, all C and 2b of Figs 5-7", all_blocks),
            lowering(f"2b = 1.2 m, C = 0.6, lambda > {lift:g}", lifted)]


def finite_reduction(two_b, restitution, slenderness):
    """1 - theta*_finite/theta*_Dirac; NaN where the block overturns under Dirac pulses."""
    finite = theory.finite_ratio(two_b, slenderness, restitution, FINITE_DURATION)
    return 1 - finite / theory.exact(two_b, slenderness, restitution).ratio


def table():
    return (periods_and_ratios() + limits() + safe_blocks() + displacement() + stabilisation() + general() + finite_pulse())
