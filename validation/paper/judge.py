"""YADE against the exact solution of the same half cycle: one row a case, and the verdicts that must hold."""
import masonry
import numpy as np

import theory
from cases import COMPLIANT, FINITE, GRAVITY, RIGID, TIME_TOLERANCE, all_cases, convergence, grid, half_cycles, relative_error

# Bounds on YADE's relative errors in blocks that do not overturn.
# Rigid, h = 2.5e-3 sqrt(R/g) (dem.engines): the trapezoidal rule changes periods, and the speed that a finite pulse gives, by (p h)^2/12 =
# (h/sqrt(R/g))^2/16 = 4e-7, which is twice that in a peak. Five times that, since errors grow near overturning.
RIGID_BOUND = 2e-6
# Compliant, penetration 1e-5: a hundred times that; the cases nearest to overturning set the factor. Speeds of Eq. 7: of the first hop, the
# smallest, the elastic energy of the joint is the largest share, so it needs more room.
COMPLIANT_BOUND, COMPLIANT_SPEED_BOUND = 1e-3, 4e-3
# Both find the impact inside the step and apply the restitution there: round-off only.
RESTITUTION_BOUND = 1e-9


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
               pulse_duration=case.duration, model=case.model, half_cycles=case.half_cycles,
               overturn_half_cycle=run["overturn_half_cycle"], exact_overturn_half_cycle=overturn)
    names = ("ratio", "exact_ratio", "period", "exact_period", "time_to_stabilise", "exact_time_to_stabilise", "base_displacement",
             "exact_base_displacement", "peak_error", "period_error", "stabilisation_error", "displacement_error", "speed_error")
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
        row["displacement_error"] = relative_error(run["base_displacement"], displacement)
    if not case.duration:
        speeds = masonry.closed_form.pulse_sequence(b, case.impulse, case.restitution, case.half_cycles).angular_velocity
        row["speed_error"] = float(np.max(relative_error(np.array(run["velocities"]), speeds[:len(run["velocities"])])))
    row.update(simulated_s=run["simulated_s"], cpu_s=run["cpu_s"], time_step=run["time_step"])
    return row


def rows(runs):
    return [compare(case, runs[case.key]) for case in all_cases()]


def select(table, cases):
    wanted = {(c.two_b, c.slenderness, c.restitution, c.impulse, c.model, c.duration) for c in cases}
    return [r for r in table if (r["two_b"], r["slenderness"], r["restitution"], r["impulse"], r["model"], r["pulse_duration"]) in wanted]


def worst(table, name):
    return float(np.nanmax([r[name] for r in table]))


def _bounded(text, value, bound):
    return text, f"{value:.2e}", f"<= {bound:.0e}", bool(value <= bound)


def spectra(table, model):
    """Figs 4 to 8 in YADE: (text, value, bound, holds)."""
    rows = select(table, grid(model))
    overturned = sum(r["exact_overturn_half_cycle"] > 0 for r in rows)
    same = sum(r["overturn_half_cycle"] == r["exact_overturn_half_cycle"] for r in rows)
    bound, speed_bound = (RIGID_BOUND, RIGID_BOUND) if model == RIGID else (COMPLIANT_BOUND, COMPLIANT_SPEED_BOUND)
    errors = (("peak angle of the last half cycle", "peak_error", bound),
              ("period of the last two half cycles", "period_error", bound),
              ("time to stabilise", "stabilisation_error", bound),
              ("base displacement at the end", "displacement_error", bound),
              ("speed before every impact, Eq. 7", "speed_error", speed_bound),
              ("restitution of every impact", "restitution_error", RESTITUTION_BOUND))
    return [(f"overturns or not, and in the same half cycle ({len(rows) - overturned} stable, {overturned} overturned)",
             f"{same} of {len(rows)}", f"{len(rows)}", same == len(rows)),
            *(_bounded(f"worst relative error: {text}", worst(rows, name), limit) for text, name, limit in errors)]


def cost(table, model):
    """(text, value) of the same runs, recorders included."""
    rows = select(table, grid(model))
    relative = [r["time_step"] / np.sqrt(theory.block(r["two_b"], r["slenderness"]).radius / GRAVITY) for r in rows]
    simulated, cpu = (sum(r[name] for r in rows) for name in ("simulated_s", "cpu_s"))
    steps = sum(r["simulated_s"] / r["time_step"] for r in rows)
    return [("time step over sqrt(R/g)", f"{min(relative):.1e}" if max(relative) < 1.01 * min(relative) else f"{min(relative):.1e} to {max(relative):.1e}"),
            (f"CPU s for {simulated:.0f} simulated s", f"{cpu:.1f}"), ("CPU us a step", f"{1e6 * cpu / steps:.1f}")]


def verdicts(table):
    """Of both models: spectra."""
    return [(f"YADE, {name}, Figs 4-8: {text}", *rest) for name, model in (("rigid", RIGID), ("compliant", COMPLIANT))
            for text, *rest in spectra(table, model)]


def other_verdicts(table):
    """(text, value, bound, holds)"""
    finite, small = select(table, [FINITE]), select(table, convergence())
    return [_bounded("YADE, finite pulse, relative error: peak angle of the last half cycle", worst(finite, "peak_error"), RIGID_BOUND),
            _bounded("YADE, I -> 0, worst relative error: peak angle", worst(small, "peak_error"), RIGID_BOUND),
            _bounded("YADE, I -> 0, worst relative error: period", worst(small, "period_error"), RIGID_BOUND),
            *theory_verdicts()]


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
