"""Does the answer depend on the numbers of the method? The same scene with a smaller step and with another tolerance, side by side."""

import contextlib
import io
import math
import time
from dataclasses import dataclass

from masonry._given import positive_given, shown
from masonry.dem.recording import wall_history
from masonry.dem.running import motion_end, run
from masonry.results import CollapseReport, collapse, cracks
from yade import O, wrapper

_TOLERANCE = 1e-5
# Samples of a run, for drifts and times of falls.
_SAMPLES = 500
# Mean damages of joints with mortar are the same where they differ by less than this.
_SAME_DAMAGE = 0.01
# Drifts are the same where they differ by less than this, of the height.
_SAME_DRIFT = 1e-4


@dataclass
class Run:
    """One of the runs that are compared. report: None where it failed, and `error` says why. failures: steps that missed the contact laws;
    cpu: of the process, s. damage: mean D over the area of all joints with mortar at the end; NaN: none has any."""

    name: str
    dt: float
    report: CollapseReport
    error: str
    failures: int
    cpu: float
    damage: float = math.nan

    @property
    def verdict(self):
        return self.report.verdict if self.report else "failed"


@dataclass
class Comparison:
    """What compare() found. runs: as given, with half the step, with another tolerance; doubts: why the answer cannot be trusted, empty: none."""

    runs: list
    doubts: list

    def __str__(self):
        rows = [("", "dt (s)", "verdict", "collapse (s)", "fallen", "peak drift", "residual", "failures", "CPU (s)")]
        bonded = any(math.isfinite(one.damage) for one in self.runs)
        rows = [(*rows[0], "mean damage")] if bonded else rows
        for one in self.runs:
            report = one.report
            found = (f"{report.time:.4g}" if report.collapsed else "", str(len(report.fallen)), f"{report.peak_drift:.3g}", f"{report.residual_drift:.3g}") if report else ("",) * 4
            rows.append((one.name, f"{one.dt:.3g}", one.verdict, *found, str(one.failures), f"{one.cpu:.3g}", *([f"{one.damage:.3g}"] if bonded else [])))
        widths = [max(map(len, column)) for column in zip(*rows)]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
        return "\n".join(lines + ([f"DO NOT TRUST: {doubt}" for doubt in self.doubts] or ["all runs agree"]))


def compare(scene_function, seconds=None, share=0.1, blocks=1, progress=None):
    """Runs a scene as given, with the step halved and, where blocks are rigid, with tolerance=1e-5; returns the Comparison, whose text
    is a table of the verdicts and drifts and says "do not trust" where they differ.

        def scene(**changes):
            base = dem.base(...)
            ...
            return dem.engines(motion, **changes)

        print(dem.compare(scene))

    scene_function    builds the scene in O, which has been reset, and returns what dem.engines(..., **changes) returned; changes: dt or tolerance
    seconds           how long each run is, s; None: to the end of the last motion
    share             drifts (peak and residual, WallHistory.drift) and times of collapse agree when they differ by less than this share of the largest, or
                      by 1e-4 of the height, and so do mean damages of joints with mortar (or by 0.01); above 0 and below 1
    blocks            so many fallen blocks are a collapse, as in results.collapse()
    progress          bars, as in dem.run()

    Runs that agree are no proof: a scene can be wrong at every step. The first run prints what dem.engines() prints. The scene is left
    as it is after the last run.
    """
    if not callable(scene_function):
        raise ValueError(f"scene_function = {shown(scene_function)}: must be a function that builds the scene and returns dem.engines(...)")
    if seconds is not None:
        positive_given("seconds", seconds)
    if not positive_given("share", share) < 1:
        raise ValueError(f"share = {share}: must be above 0 and below 1")
    runs = [_run(scene_function, "as given", {}, seconds, blocks, progress)]
    variants = [("half the step", {"dt": runs[0].dt / 2})]
    if any(isinstance(engine, wrapper.MoreauJeanIntegrator) for engine in O.engines):
        variants.append((f"tolerance {_TOLERANCE:g}", {"tolerance": _TOLERANCE}))
    for name, changes in variants:
        with contextlib.redirect_stdout(io.StringIO()):
            runs.append(_run(scene_function, name, changes, seconds, blocks, progress))
    return Comparison(runs, _doubts(runs, share))


def _run(scene_function, name, changes, seconds, blocks, progress):
    O.reset()
    engines = scene_function(**changes)
    places = {kind: [k for k, engine in enumerate(engines or ()) if isinstance(engine, kind)] for kind in (wrapper.MoreauJeanIntegrator, wrapper.NewtonIntegrator)}
    place = next((found[-1] for found in places.values() if found), None)  # of what moves the blocks
    if place is None:
        raise ValueError("scene_function returned no list of engines: it must return dem.engines(..., **changes)")
    if "dt" in changes and O.dt != changes["dt"]:
        raise ValueError(f"scene_function: O.dt is {O.dt:g} s where dt = {changes['dt']:g} s was asked for: it must give its **changes to dem.engines()")
    motions = [one for one in engines if isinstance(one, wrapper.BaseMotionEngine)] + list(getattr(engines[place], "motions", ()))
    if seconds is None and not motions:
        raise ValueError("seconds = None: must be given where the scene has no motion")
    length = seconds if seconds is not None else motion_end([one for one in motions if not one.dead], "seconds = None") - O.time
    recorder = wrapper.WallRecorder(virtPeriod=length / _SAMPLES)
    O.engines = [*engines[:place], recorder, *engines[place:]]
    dt, start, error = O.dt, time.process_time(), ""
    try:
        run(length, progress=progress)
    except RuntimeError as failure:
        if not changes:
            raise
        error = str(failure)
    failures = next(e.failures for e in O.engines if isinstance(e, (wrapper.MoreauJeanIntegrator, wrapper.RockingJointEngine)))
    spent = time.process_time() - start
    if error:
        return Run(name, dt, None, error, failures, spent)
    history = wall_history(recorder)
    return Run(name, dt, collapse(history, blocks), "", failures, spent, cracks(history).mean_damage)


def _doubts(runs, share):
    doubts = [f"the run with {one.name} failed: {one.error}" for one in runs if one.error]
    verdicts = {one.name: one.verdict for one in runs}
    if len(set(verdicts.values())) > 1:
        return doubts + ["the verdict depends on the method: " + ", ".join(f"{name} {verdict}" for name, verdict in verdicts.items())]
    if runs[0].verdict == "unfinished":
        doubts.append(f"nobody knows yet whether it stands, {runs[0].report.run}")
    for name in ("time",) if runs[0].report.collapsed else ("peak_drift", "residual_drift"):
        values = [getattr(one.report, name) for one in runs]
        apart, largest = max(values) - min(values), max(values)
        if apart > share * largest and (name == "time" or apart > _SAME_DRIFT):
            doubts.append(f"the {'time of collapse' if name == 'time' else name.replace('_', ' ')} depends on the method: from {min(values):.3g} to {largest:.3g}"
                          + (" s" if name == "time" else " of the height"))
    damages = [one.damage for one in runs]
    if max(damages) - min(damages) > max(share * max(damages), _SAME_DAMAGE):  # NaN: False
        doubts.append(f"the mean damage of the mortar depends on the method: from {min(damages):.3g} to {max(damages):.3g}")
    return doubts
