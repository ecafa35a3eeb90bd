"""Closed form of Casapulla and Maione, Eqs 1-13: constant restoring moment, resonant train of base velocity jumps
I, -2I, +2I, ..., each just after an impact.

block: RockingBlock; impulse: I > 0, m/s; restitution: C in [0, 1]; None or NaN: the block's natural one. Arrays broadcast.
"""

from dataclasses import dataclass

import numpy as np

from . import _core
from ._given import whole_given
from ._arrays import columns, restore, shape_of
from .block import columns_of, restitution_of


@dataclass(frozen=True)
class SinglePulse:
    angular_velocity: np.ndarray  #: w1 = lambda A I/g, rad/s (Eq. 1)
    duration: np.ndarray          #: t1 = 2 lambda I/g, s: until the first impact (Eq. 6)
    peak_angle: np.ndarray        #: w1^2/(2A), rad (Eq. 5)


@dataclass(frozen=True)
class PulseSequence:
    """Half cycles 1..n along the last axis."""
    angular_velocity: np.ndarray  #: w_i = C w_{i-1} + 2 w1, rad/s (Eq. 7)
    duration: np.ndarray          #: 2 w_i/A, s (Eq. 9)
    end_time: np.ndarray          #: sum of the durations, s (Eq. 8)
    peak_angle: np.ndarray        #: w_i^2/(2A), rad


@dataclass(frozen=True)
class Stabilised:
    """Limit of the sequence; infinite for C = 1."""
    angular_velocity: np.ndarray  #: w* = 2 w1/(1-C), rad/s (Eq. 10)
    duration: np.ndarray          #: of a half cycle, 4 lambda (I/g)/(1-C), s (Eq. 11)
    period: np.ndarray            #: T* = two durations, s
    peak_angle: np.ndarray        #: 2 w1^2/(A (1-C)^2), rad (Eq. 12)
    amplification: np.ndarray     #: stabilised peak over first peak, 4/(1-C)^2 (Eq. 13)
    ratio: np.ndarray             #: peak angle over critical angle
    overturns: np.ndarray         #: ratio >= 1


def single_pulse(block, impulse):
    """First half cycle from rest."""
    shape = shape_of(np.empty(block.shape), impulse)
    return SinglePulse(*(restore(x, shape) for x in _core.single_pulse(columns_of(block, shape), *columns(shape, impulse))))


def pulse_sequence(block, impulse, restitution, n):
    """The first n half cycles, n >= 1."""
    restitution = restitution_of(block, restitution)
    shape = shape_of(np.empty(block.shape), impulse, restitution)
    result = _core.pulse_sequence(columns_of(block, shape), *columns(shape, impulse, restitution), whole_given("n", n, 1))
    return PulseSequence(*(restore(x, shape) for x in result))


def stabilised(block, impulse, restitution):
    """The phase that the sequence tends to."""
    restitution = restitution_of(block, restitution)
    shape = shape_of(np.empty(block.shape), impulse, restitution)
    result = [restore(x, shape) for x in _core.stabilised(columns_of(block, shape), *columns(shape, impulse, restitution))]
    return Stabilised(*result, overturns=result[-1] >= 1)


def time_to_stabilise(block, impulse, restitution, tolerance):
    """End time (Eq. 8, s) of the first half cycle whose angular velocity is within `tolerance` (relative, in (0, 1)) of the
    stabilised one: 1 - w_i/w* = (1+C)/2 C^(i-1). The limit itself is never reached, so the tolerance is part of the answer."""
    restitution = restitution_of(block, restitution)
    shape = shape_of(np.empty(block.shape), impulse, restitution, tolerance)
    return restore(_core.time_to_stabilise(columns_of(block, shape), *columns(shape, impulse, restitution, tolerance)), shape)
