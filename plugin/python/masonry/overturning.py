"""Amplitudes at which a block begins, or ceases, to overturn."""

import numpy as np

from . import _core
from ._given import shown, whole_given
from .history import case_arguments
from .motions import Motion, PulseTrain, Record

# Below its first threshold the bracket is scanned in steps of this share of it.
_FINE = 1e-3


def overturning_amplitude(block, shape, restitution=None, restoring="exact", bracket=None, samples=400, half_cycles=None, initial_angle=0.0,
                          initial_velocity=0.0):
    """All thresholds found in a bracket, in rising order: the block stands below the first, overturns between the first and the
    second, stands between the second and the third ... (the other way round if it overturns at the lower end).

    block          one block
    shape          a motion; its amplitude (impulse of a PulseTrain, scale of a Record) is what is varied and returned,
                   without its sign, which tells the direction
    bracket        (lower, upper) of that amplitude, lower >= 0. None: from half the amplitude that lifts the block to 40 times
                   that (acceleration), or 0.01 to 2 times the single velocity jump that overturns (PulseTrain): for a block that
                   starts upright and at rest
    samples        the bracket is scanned at so many amplitudes, each larger than the one before by the same factor (from lower = 0:
                   by the same difference), and up to the first change again in steps of a thousandth of it. Every change is
                   bisected to 1e-12 relative.
    half_cycles    for a resonant train without end: how many to wait for; None: 200

    So the first threshold is right unless a window narrower than a thousandth of it, in which the block overturns (or stands), lies below.
    Beyond it windows narrower than a step of the scan can be missed. Under long records there are windows of every width.
    """
    if block.shape:
        raise ValueError(f"block = {block}: must be one block, of single numbers")
    if not isinstance(shape, Motion) or shape.shape or not getattr(shape, "amplitude", 0) or (isinstance(shape, Record) and not shape.samples.any()):
        raise ValueError(f"shape = {shown(shape)}: must be one motion of single numbers that moves the base: its amplitude, impulse or scale is not 0")
    samples = whole_given("samples", samples, 2)
    unit = shape.scaled(1 / abs(shape.amplitude))
    lower, upper = _default_bracket(block, unit) if bracket is None else bracket
    if not 0 <= lower < upper < np.inf:
        raise ValueError(f"bracket = ({lower}, {upper}): must be 0 <= lower < upper, finite")
    endless = isinstance(shape, PulseTrain) and shape.times is None and shape.half_cycles is None
    half_cycles = 200 if endless and half_cycles is None else half_cycles

    def overturns(amplitudes):
        _, arguments = case_arguments(block, unit.scaled(amplitudes), restitution, restoring, initial_angle, initial_velocity, None, half_cycles)
        return _core.overturns(*arguments).astype(bool)

    scan = np.geomspace(lower, upper, samples) if lower > 0 else np.linspace(lower, upper, samples)
    result = overturns(scan)
    first = upper if np.all(result == result[0]) else scan[np.argmax(result != result[0])]
    fine, beyond = np.linspace(lower, first, 2 + int((first - lower) / (_FINE * first))), scan > first
    scan, result = np.append(fine, scan[beyond]), np.append(overturns(fine), result[beyond])
    change = np.flatnonzero(result[1:] != result[:-1])
    low, high, at_low = scan[change], scan[change + 1], result[change]
    while np.any(high - low > 1e-12 * high):
        middle = (low + high) / 2
        same = overturns(middle) == at_low
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2


def _default_bracket(block, unit):
    edges = (block.right, block.left)
    if isinstance(unit, PulseTrain):
        jumps = [edge.gravity * np.sqrt(2 * (1 - np.cos(edge.critical_angle))) / (edge.frequency_parameter * np.cos(edge.critical_angle)) for edge in edges]
        return 0.01 * min(jumps), 2 * max(jumps)
    largest = np.abs(unit.samples).max() if isinstance(unit, Record) else 1.0
    uplift = [edge.gravity / edge.slenderness / largest for edge in edges]
    return 0.5 * min(uplift), 40 * max(uplift)
