"""A row of the tables, and the ways to run a scene: two methods, in the plane and in space."""

import contextlib
import io
from dataclasses import dataclass, field

import peers
from masonry import dem
from yade import O

MODES = [(method, model) for method in ("localised", "wall") for model in ("planar", "spatial")]
IN_SPACE = [mode for mode in MODES if mode[1] == "spatial"]
BULLET = [("Bullet", "hulls")] if peers.has_bullet() else []  # beside our own in some cases; its deviations are shown and not judged


@dataclass
class Row:
    """A right value and what the runs gave. allowed: relative deviation of `localised` and of `wall`."""

    case: str
    what: str
    right: float
    allowed: tuple
    found: dict = field(default_factory=dict)  # by mode

    def _good(self, mode):
        return abs(self.found[mode] - self.right) <= self.allowed[mode[0] == "wall"] * (abs(self.right) or 1)

    def holds(self):
        own = [mode for mode in self.found if mode not in BULLET]
        return bool(own) and all(self._good(mode) for mode in own)

    def __str__(self):
        values = [f"{self.found[mode]:.6g}" if mode in self.found else "-" for mode in MODES + BULLET]
        allowed = " / ".join(f"{share:g}" for share in self.allowed)
        return f"| {self.case} | {self.what} | {self.right:.6g} | {' | '.join(values)} | {allowed} | {'yes' if self.holds() else 'NO'} |"


def rows(case, measure, wanted, modes=MODES):
    """A Row for each of `wanted`: (what, right value, allowed). measure(mode) returns the values, one for each."""
    made = [Row(case, *one) for one in wanted]
    for mode in modes:
        for row, value in zip(made, measure(mode), strict=True):
            row.found[mode] = float(value)
    return made


def start(mode, step=1.0, **options):
    """Sets the engines of the scene; the method steps few blocks, too. step: share of the default time step."""
    if mode in BULLET:
        return peers.start()
    method, model = mode
    with contextlib.redirect_stdout(io.StringIO()):
        O.engines = dem.engines(method=method, model=model, **options)
    integrator = O.engines[-1]
    integrator.wallsOnly = method == "wall"
    O.dt *= step
    integrator.onTrouble = "stop"
    return integrator


def collapse(mode, direction="x", **options):
    """Multiplier of the weight at which the scene collapses."""
    if mode in BULLET:
        return peers.collapse(direction)
    result = dem.TiltTable(direction=direction, method=mode[0], model=mode[1], **options).bisect(tolerance=2e-4, progress=False)
    assert not result.doubts, result.doubts
    return result.multiplier
