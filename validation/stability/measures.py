"""One run of one case: what is measured while it runs, and the verdict."""

import contextlib
import io
import math
import time
import warnings

from boxes import depth
from masonry import dem
from polyhedra import Solids, thickness
from yade import Box, O

# A run at the default step or below counts as right up to these limits: energy that appears, relative to the energy turned over, and depth, relative
# to the smaller half size. Compliant joints are deeper by what their springs give way under a landing.
MOST_GAIN, MOST_DEPTH = 1e-3, {"compliant": 2e-2}
OTHER_DEPTH = 1e-2
# Above the default step a run is less exact by the user's choice: it is wrong where any of the three is more than this.
MOST_AT_LARGE_STEPS = 5e-2
# Share of the half size: what is turned over in a scene at rest. MOST_GAIN of it is the overlap that dem.engines() lets blocks start with.
LEAST_FALL = 5e-2
MOST_STEPS = 400000  # of one run: above it a case is not run at that step

MODELS = {  # name: arguments of dem.engines()
    "planar": {"model": "planar", "method": "localised"},
    "spatial": {"model": "spatial", "method": "localised"},
    "wall": {"model": "planar", "method": "wall"},
    "wall in space": {"model": "spatial", "method": "wall"},
    "compliant": {"model": "compliant"},
}


def engine():
    return next(e for e in O.engines if isinstance(e, (dem.MoreauJeanIntegrator, dem.RockingJointEngine)))


def quiet_engines(*arguments, **options):
    with contextlib.redirect_stdout(io.StringIO()):
        return dem.engines(*arguments, **options)


def largest_step(default):
    """The largest step that dem.engines() accepts for the scene whose default step is given, s."""
    largest = engine().largestTimeStep
    return largest if math.isfinite(largest) else 4.9 * default


class Energies:
    """Kinetic, potential and elastic energy less the base's work must not rise. late: blocks stepped as walls, which stop in one step and rebound in the next: a dip
    of one step is none."""

    def __init__(self, work, late=False):
        self.work, self.late, self.last = work, late, -math.inf
        self.lowest, self.gain, self.kinetic, self.start = math.inf, 0.0, 0.0, None
        free = [b for b in O.bodies if b.dynamic]
        self.floor = LEAST_FALL * sum(b.state.mass * 9.81 * thickness(b) for b in free)

    def look(self):
        e = dem.energy()
        total = e["kinetic"] + e["potential"] + e.get("elastPotential", 0) - e["baseWork"] - self.work()
        self.start = total if self.start is None else self.start
        self.gain = max(self.gain, total - self.lowest)
        self.lowest = min(self.lowest, max(total, self.last) if self.late else total)
        self.last = total
        self.kinetic = max(self.kinetic, e["kinetic"])

    def relative_gain(self):
        """Relative to the largest kinetic energy, to what was lost, or to what lifts all blocks by LEAST_FALL, whichever is largest."""
        return self.gain / max(self.kinetic, self.start - self.lowest, self.floor)


def run(case, model, share=None):
    """One row of the table. share: step relative to the largest allowed one; None: the default step."""
    row = {"case": case.name, "model": model, "share": share, "dt": math.nan, "error": math.nan, "gain": math.nan, "depth": math.nan, "cpu": math.nan}
    said = []
    begin = time.process_time()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            O.reset()
            scene = case.build(**MODELS[model])
            O.engines = scene.engines()
            default = O.dt
            if share is not None:
                dt = share * largest_step(O.dt)
                O.reset()
                scene = case.build(**MODELS[model], dt=dt)
                O.engines = scene.engines()
            row.update(dt=O.dt, coarse=share is not None and dt > default)
            energies, deepest = Energies(scene.work), 0.0
            overlap = depth if all(isinstance(b.shape, Box) for b in O.bodies) else Solids().depth
            steps = max(1, math.ceil(scene.seconds / O.dt))
            if steps > MOST_STEPS:
                return {**row, "said": f"{steps} steps", "verdict": "not run"}
            look = max(1, steps // 200)  # the depth of some two hundred instants; energies of every step
            k = -1
            while O.time < scene.seconds - 1e-9 * O.dt and k < MOST_STEPS:  # a chosen step may be lowered
                k += 1
                O.step()
                energies.look()
                if scene.watch:
                    scene.watch()
                if k % look == 0:
                    deepest = max(deepest, overlap())
            deepest = max(deepest, overlap())
            row.update(gain=energies.relative_gain(), depth=deepest, error=scene.error())
            said += [str(w.message) for w in caught]
        said += ["failures"] * bool(engine().failures)
    except (RuntimeError, ValueError) as refused:
        said.append(f"refused: {refused}")
    row["cpu"] = time.process_time() - begin
    row["said"] = (said or [""])[0][:200]
    row["verdict"] = "right" if is_right(case, row) else "told" if said else "silent"
    return row


def is_right(case, row):
    error, depth = case.bound.get(row["model"], case.bound["any"]), MOST_DEPTH.get(row["model"], OTHER_DEPTH)
    least = MOST_AT_LARGE_STEPS if row.get("coarse") else 0
    return row["error"] <= max(error, least) and row["gain"] <= max(MOST_GAIN, least) and row["depth"] <= max(depth, least)
