"""What is run: the paper's data, the grid of blocks, and the one measure of error. Plain Python: read inside YADE and outside."""
import math
from dataclasses import asdict, dataclass

GRAVITY = 9.81                  # m/s^2
IMPULSE = 0.0125 * GRAVITY      # m/s: the paper's 2I = 0.25 g for 0.1 s
RESTITUTIONS = (0.6, 0.7, 0.8)  # the paper's
BASES = (0.4, 0.6, 0.8, 1.2)    # 2b, m; the text names 0.4, 0.6 and 1.2
SLENDERNESS = (3, 4, 5, 6.5, 8, 9, 10, 12)
STABILISED = 1e-3   # runs last until the angular velocity is this near (relative) to its limit
TIME_TOLERANCE = 1e-2  # the tolerance of Fig. 8
RIGID, COMPLIANT = "planar", "compliant"


def half_cycles(restitution, tolerance=STABILISED):
    """First half cycle i with 1 - w_i/w* = (1+C)/2 C^(i-1) <= tolerance (Eqs 7 and 10)."""
    return 1 + math.ceil(math.log(2 * tolerance / (1 + restitution)) / math.log(restitution))


def relative_error(value, reference):
    """The one measure of error: |value - reference| / |reference|."""
    return abs(value / reference - 1)


@dataclass(frozen=True)
class Case:
    """One block under the resonant train of Dirac pulses (duration 0), or of rectangular ones of `duration` (s). model: dem.engines' name
    for it; time step, or stiffness of the joints, are those that dem.engines chooses."""
    two_b: float
    slenderness: float
    restitution: float
    impulse: float = IMPULSE
    duration: float = 0.0
    model: str = RIGID

    @property
    def half_cycles(self):
        return half_cycles(self.restitution)

    @property
    def key(self):
        return ",".join(str(v) for v in asdict(self).values())


def grid(model=RIGID):
    return [Case(two_b, lam, c, model=model) for c in RESTITUTIONS for two_b in BASES for lam in SLENDERNESS]


def convergence():
    """Ever smaller impulses."""
    steps = [(c, k) for c in RESTITUTIONS for k in ((2, 4, 8) if c == 0.8 else (1, 2, 4, 8))]
    return [Case(0.6, 5, c, IMPULSE / k) for c, k in steps]


# The stated pulse, 0.25 g for 0.1 s, on a block that its first half (0.125 g) can lift: slenderness above 8.
FINITE_DURATION = 0.1  # s
FINITE = Case(1.2, 10, 0.6, duration=FINITE_DURATION)


def all_cases():
    return list(dict.fromkeys(grid() + convergence() + [FINITE] + grid(COMPLIANT)))
