"""YADE against the exact solution of the same half cycle: one row a case, and the verdicts that must hold."""
import masonry
import numpy as np

import theory
from cases import FINITE, TIME_TOLERANCE, all_cases, convergence, grid, half_cycles, relative_error

# Bounds on YADE's relative errors in blocks that do not overturn. Stabilised phase: a hundred times the penetration (2e-6); the cases
# nearest to overturning, where errors grow, set that factor. Speeds of Eq. 7: the first hop is the smallest, and the joint's elastic energy the
# largest share of its own, so it needs more room.
STABILISED_BOUND = 2e-4
SPEED_BOUND = 1e-3


def exact_history(case):
    """(impact times, peaks, overturn half cycle, base displacement) of the exact solution, or of the chained finite pulses."""
    if not case.duration:
        h = theory.history(case)
        return h.impact_times, np.abs(h.peak_angles), int(h.overturn_half_cycle), float(h.base_displacement)
    train = theory.finite_train(case.two_b, case.slenderness, case.restitution, case.duration, case.half_cycles, first="rectangular")
    last = train.starts[-1] + train.pieces[-1].impact_times[0]
    peaks = np.array(train.peak_ratio) * theory.block(case.two_b, case.slenderness).critical_angle
    return np.array([*train.starts[1:], last], dtype=float), peaks, 0, np.nan


def compare(case, run):
    """The last half cycle: peak angle, period (two half cycles), speed; all as relative errors. NaN where the block overturns."""
    times, peaks, overturn, displacement = exact_history(case)
    b = theory.block(case.two_b, case.slenderness)
    row = dict(two_b=case.two_b, slenderness=case.slenderness, restitution=case.restitution, impulse=case.impulse,
               pulse_duration=case.duration, penetration=case.penetration, half_cycles=case.half_cycles,
               overturn_half_cycle=run["overturn_half_cycle"], exact_overturn_half_cycle=overturn)
    names = ("ratio", "exact_ratio", "period", "exact_period", "time_to_stabilise", "exact_time_to_stabilise", "peak_error", "period_error",
             "stabilisation_error", "speed_error",
             "restitution_error", "base_displacement", "exact_base_displacement")
    row.update(dict.fromkeys(names, np.nan))
    row["restitution_error"] = max(relative_error(c, case.restitution) for c in run["restitutions"])
    if not row["overturn_half_cycle"] and not overturn:
        found = np.array(run["impact_times"])
        n = half_cycles(case.restitution, TIME_TOLERANCE) - 1
        row.update(ratio=run["peaks"][-1] / b.critical_angle, exact_ratio=peaks[-1] / b.critical_angle,
                   period=found[-1] - found[-3], exact_period=times[-1] - times[-3],
                   time_to_stabilise=found[n], exact_time_to_stabilise=times[n],
                   base_displacement=run["base_displacement"], exact_base_displacement=displacement)
        row["peak_error"] = relative_error(row["ratio"], row["exact_ratio"])
        row["period_error"] = relative_error(row["period"], row["exact_period"])
        row["stabilisation_error"] = relative_error(found[n], times[n])
        if not case.duration:
            speeds = masonry.closed_form.pulse_sequence(b, case.impulse, case.restitution, case.half_cycles).angular_velocity
            row["speed_error"] = float(np.max(relative_error(np.array(run["velocities"]), speeds)))
    row.update(simulated_s=run["simulated_s"], cpu_s=run["cpu_s"], time_step=run["time_step"])
    return row


def rows(runs):
    return [compare(case, runs[case.key]) for case in all_cases()]


def select(table, cases):
    wanted = {(c.two_b, c.slenderness, c.restitution, c.impulse, c.penetration, c.duration) for c in cases}
    return [r for r in table if (r["two_b"], r["slenderness"], r["restitution"], r["impulse"], r["penetration"], r["pulse_duration"]) in wanted]


def worst(table, name):
    return float(np.nanmax([r[name] for r in table]))


def verdicts(table):
    """(text, value, bound, holds)"""
    result = []

    def bounded(text, value, bound):
        result.append((text, f"{value:.2e}", f"<= {bound:.2e}", bool(value <= bound)))

    figures = select(table, grid())
    stable = [r for r in figures if not r["exact_overturn_half_cycle"]]
    overturned = [r for r in figures if r["exact_overturn_half_cycle"]]
    same = sum(r["overturn_half_cycle"] == r["exact_overturn_half_cycle"] for r in figures)
    result.append((f"YADE overturns or not, and in the same half cycle ({len(stable)} stable, {len(overturned)} overturned)",
                   f"{same} of {len(figures)}", f"{len(figures)}", same == len(figures)))
    for text, name, bound in (("peak angle of the last half cycle", "peak_error", STABILISED_BOUND),
                              ("period of the last two half cycles", "period_error", STABILISED_BOUND),
                              ("time to stabilise", "stabilisation_error", STABILISED_BOUND),
                              ("speed before every impact, Eq. 7", "speed_error", SPEED_BOUND),
                              ("restitution of every impact", "restitution_error", SPEED_BOUND)):
        bounded(f"YADE, Figs 4-8, worst relative error: {text}", worst(figures, name), bound)
    bounded("YADE, finite pulse, relative error: peak angle of the last half cycle", worst(select(table, [FINITE]), "peak_error"), STABILISED_BOUND)
    small = select(table, convergence())
    bounded("YADE, I -> 0, worst relative error: peak angle", worst(small, "peak_error"), STABILISED_BOUND)
    bounded("YADE, I -> 0, worst relative error: period", worst(small, "period_error"), STABILISED_BOUND)
    return result + theory_verdicts()


def theory_verdicts():
    """Two routes to the same theoretical curve: event by event, 200 half cycles, and the formulas."""
    constant = exact = 0.0
    for case in grid():
        b = theory.block(case.two_b, case.slenderness)
        for restoring, reference in (("constant", theory.closed), ("exact", theory.exact)):
            h = masonry.simulate(b, masonry.PulseTrain(case.impulse), restitution=case.restitution, restoring=restoring, half_cycles=200)
            limit = reference(case.two_b, case.slenderness, case.restitution)
            if h.overturned:
                continue
            error = max(relative_error(abs(h.peak_angles[-1]) / b.critical_angle, limit.ratio),
                        relative_error(h.impact_times[-1] - h.impact_times[-3], limit.period))
            constant, exact = (max(constant, error), exact) if restoring == "constant" else (constant, max(exact, error))
    return [("closed form against masonry.simulate, constant moment, half cycle 200", f"{constant:.2e}", "<= 1e-09", constant <= 1e-9),
            ("formula under gravity against masonry.simulate, half cycle 200", f"{exact:.2e}", "<= 1e-09", exact <= 1e-9)]
