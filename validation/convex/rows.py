"""A row of the tables, and the ways to run a scene: two methods, in the plane and in space, and compliant joints."""

import contextlib
import io
import math
from dataclasses import dataclass, field

import numpy as np
import peers
from masonry import dem
from yade import O, Vector3
from yade.wrapper import NewtonIntegrator

MODES = [(method, model) for method in ("localised", "wall") for model in ("planar", "spatial")]
IN_SPACE = [mode for mode in MODES if mode[1] == "spatial"]
COMPLIANT = [("compliant", "spatial")]  # joints with the stiffness that dem.engines() chooses
BULLET = [("Bullet", "hulls")] if peers.has_bullet() else []  # beside our own in some cases; its deviations are shown and not judged


@dataclass
class Row:
    """A right value and what the runs gave. allowed: relative deviation of `localised`, of `wall` and, where the case has them, of compliant joints."""

    case: str
    what: str
    right: float
    allowed: tuple
    found: dict = field(default_factory=dict)  # by mode

    def _good(self, mode):
        return abs(self.found[mode] - self.right) <= self.allowed[("localised", "wall", "compliant").index(mode[0])] * (abs(self.right) or 1)

    def holds(self):
        own = [mode for mode in self.found if mode not in BULLET]
        return bool(own) and all(self._good(mode) for mode in own)

    def __str__(self):
        values = [f"{self.found[mode]:.6g}" if mode in self.found else "-" for mode in MODES + COMPLIANT + BULLET]
        allowed = " / ".join(f"{share:g}" for share in self.allowed)
        return f"| {self.case} | {self.what} | {self.right:.6g} | {' | '.join(values)} | {allowed} | {'yes' if self.holds() else 'NO'} |"


def rows(case, measure, wanted, modes=MODES):
    """A Row for each of `wanted`: (what, right value, allowed). measure(mode) returns the values, one for each. Compliant joints run where three deviations
    are allowed."""
    made = [Row(case, *one) for one in wanted]
    for mode in [*modes, *(COMPLIANT if len(made[0].allowed) == 3 else [])]:
        for row, value in zip(made, measure(mode), strict=True):
            row.found[mode] = float(value)
    return made


def start(mode, step=1.0, **options):
    """Sets the engines of the scene; the method steps few blocks, too. step: share of the default time step."""
    if mode in BULLET:
        return peers.start()
    method, model = mode
    with contextlib.redirect_stdout(io.StringIO()):
        O.engines = dem.engines(model=method, **options) if mode in COMPLIANT else dem.engines(method=method, model=model, **options)
    if mode in COMPLIANT:
        return next(engine for engine in O.engines if isinstance(engine, NewtonIntegrator))  # which has the gravity
    integrator = O.engines[-1]
    integrator.wallsOnly = method == "wall"
    O.dt *= step
    integrator.onTrouble = "stop"
    return integrator


def collapse(mode, direction="x", **options):
    """Multiplier of the weight at which the scene collapses."""
    if mode in BULLET:
        return peers.collapse(direction)
    if mode in COMPLIANT:
        return compliant_collapse(direction, **options)
    result = dem.TiltTable(direction=direction, method=mode[0], model=mode[1], **options).bisect(tolerance=2e-4, progress=False)
    assert not result.doubts, result.doubts
    return result.multiplier


def compliant_collapse(direction, load="force", **options):
    """The same with compliant joints; gravity may also turn. dem.TiltTable knows rigid blocks alone."""
    pull = Vector3(1 if direction == "x" else -1, 0, 0)

    def set_pull(newton, multiplier):
        along = multiplier * pull - Vector3.UnitZ
        newton.gravity = 9.81 * (along / along.norm() if load == "turned" else along)

    return compliant_limit(set_pull, **options)


def compliant_limit(set_load, ramp=0.5, hold=1.5, share=5e-3, tolerance=1e-3):
    """Factor of a load at which the scene falls with compliant joints, by bisection: set_load(newton, factor) is called while the factor grows smoothly for
    `ramp` s, and a block that has then moved by `share` of the least extent of any within `hold` s falls."""
    free = [body.id for body in O.bodies if body.dynamic]
    limit = share * min(np.ptp(peers.local_vertices(O.bodies[id]), axis=0).min() for id in free)
    O.saveTmp("before the load")

    def falls(factor):
        O.loadTmp("before the load")
        begin, newton = [O.bodies[id].state.pos for id in free], start(COMPLIANT[0])
        steps = round(ramp / O.dt / 50)
        for k in range(1, steps + 1):
            set_load(newton, (1 - math.cos(math.pi * k / steps)) / 2 * factor)
            O.run(50, True)
        for _ in range(10):
            O.run(round(hold / O.dt / 10), True)
            if max((O.bodies[id].state.pos - before).norm() for id, before in zip(free, begin, strict=True)) > limit:
                return True
        return False

    low, high = 0.0, 1.0
    while not falls(high):
        low, high = high, 2 * high
    while high - low > tolerance:
        middle = (low + high) / 2
        low, high = (low, middle) if falls(middle) else (middle, high)
    return (low + high) / 2
