"""As I -> 0 gravity tends to the constant moment: the limit in which a simulation must meet the closed form."""
import masonry
import numpy as np

import judge
import theory
from cases import IMPULSE, RESTITUTIONS, convergence, relative_error


def differences(case):
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


def table(yade):
    """(rows, verdicts): relative difference from the closed form against the impulse; slopes over the smallest two impulses run in YADE."""
    rows, verdicts = [], []
    for c in RESTITUTIONS:
        chosen = [k for k in convergence() if k.restitution == c]
        for case in chosen:
            angle, period = differences(case)
            yade_angle, yade_period = _yade_differences(case, judge.select(yade, [case])[0])
            rows.append(dict(restitution=c, impulse=case.impulse, impulse_share=case.impulse / IMPULSE, exact_peak=float(angle), exact_period=float(period),
                             yade_peak=float(yade_angle), yade_period=float(yade_period)))
        smallest = [r for r in rows if r["restitution"] == c][-2:]
        for name, text in (("peak", "theta*"), ("period", "T*")):
            for source in ("exact", "yade"):
                slope = _slope([r["impulse"] for r in smallest], [r[f"{source}_{name}"] for r in smallest])
                verdicts.append((f"I -> 0, C = {c}: order in I of the difference of {text} from the closed form, {'YADE' if source == 'yade' else source}",
                                 f"{slope:.4f}", "2 +- 0.1", abs(slope - 2) <= 0.1))
    return rows, verdicts
