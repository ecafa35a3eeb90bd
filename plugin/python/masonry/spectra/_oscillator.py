"""Elastic oscillators under the motions of the package, exact in time.

An oscillator of circular frequency w and damping ratio z < 1 under a base acceleration a follows u'' + 2 z w u' + w^2 u = -a, u relative to the
base. With the complex number l = -z w + i w_d, w_d = w sqrt(1 - z^2), and q' = l q - a it is u = Im(q)/w_d and u' = Im(l q)/w_d. Over a piece
with a = a_0 + b t + Im(c exp(i W t)), t from its start,

    q(t) = e^(l t) q_0 - t [a_0 f_1(l t) + b t f_2(l t)] - [c g(i W) - c* g(-i W)]/(2 i),   g(x) = (e^(x t) - e^(l t))/(x - l),

with f_1(x) = (e^x - 1)/x and f_2(x) = (e^x - 1 - x)/x^2 (Nigam and Jennings 1969 for b alone). A jump of the base velocity by V takes V off q.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from .._arrays import restore
from .._given import array_given, shown
from .._optional import needs
from .._progress import steps
from ..history import warn_of_doubt
from ..motions import HalfSine, PulseTrain, Record, Rectangular, Sine
from ._grid import UNITS, Spectrum, outer

# Samples of the response for each period of the oscillator or of a sine. Between two of them lies at most one turning point worth finding, and Newton's
# iteration from the chord of the velocities has converged to round-off after four steps: the first error is below (2 pi/40)^2 of the interval.
_SAMPLES, _NEWTON = 40, 4
# Samples of one response that memory holds, a kilobyte each.
_MOST = 10**7


def oscillator_peak(motion, period, damping=0.05):
    """Largest displacement relative to the base, without sign, m, of elastic oscillators that start at rest: during the motion and after it. period (s)
    and damping (ratio, 0 <= damping < 1) broadcast.

    motion: one Record, Sine, HalfSine, Rectangular or PulseTrain with times and Dirac pulses."""
    warn_of_doubt(motion)
    period, damping = _oscillators_given(period, damping)
    shape = np.broadcast_shapes(period.shape, damping.shape)
    largest = _peak_under_record if isinstance(motion, Record) else _peak_under_pieces
    source = _samples(motion) if isinstance(motion, Record) else _pieces(motion)
    oscillators = [_Oscillator(t, z) for t, z in zip(np.broadcast_to(period, shape).ravel(), np.broadcast_to(damping, shape).ravel())]
    # Threads, for NumPy and SciPy compute without Python's lock.
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        return restore(np.array(list(pool.map(lambda one: largest(source, one), oscillators))), shape)


def response(motion, period, damping=0.05, progress=False):
    """Response spectra of elastic oscillators that start at rest: a Spectrum over the motions, periods and damping ratios that are lists, with the
    largest `displacement` u relative to the base (m), `pseudo_velocity` w u (m/s) and `pseudo_acceleration` w^2 u (m/s^2), w = 2 pi/period.

    motion     one motion as of oscillator_peak(), or a list of them: the dimension `record`
    period     s;  damping: ratio, at least 0 and below 1
    progress   a progress bar (tqdm); None: where stderr is a terminal

    The response to a record is exact for accelerations that are linear between its samples, also between samples and after the end of the record. All cores
    that the process may use get oscillators."""
    _oscillators_given(period, damping)
    many = isinstance(motion, (list, tuple))
    motions = list(motion) if many else [motion]
    dims, coords, arrays = outer(period=period, damping=damping)
    u = np.array([oscillator_peak(one, arrays["period"], arrays["damping"]) for one in steps(motions, progress, "response", "record")])
    fixed = {"quantity": "elastic oscillator", **{name: value for name, value in arrays.items() if name not in dims}}
    if many:
        dims, coords = ("record", *dims), {"record": np.array([_name(one, k) for k, one in enumerate(motions)]), **coords}
    else:
        u, fixed["motion"] = u[0], repr(motion)
    w = 2 * math.pi / arrays["period"]
    values = {"displacement": u, "pseudo_velocity": w * u, "pseudo_acceleration": w**2 * u}
    return Spectrum(dims, coords, values, {**UNITS, "displacement": "m", "pseudo_velocity": "m/s", "pseudo_acceleration": "m/s^2"}, fixed)


def _oscillators_given(period, damping):
    """Both as arrays; ValueError unless they are those of oscillators."""
    periods, ratios = array_given("period", period), array_given("damping", damping)
    if not (np.all(periods > 0) and np.all(np.isfinite(periods))):
        raise ValueError(f"period = {shown(period)}: must be positive and finite, in s")
    if not (np.all(ratios >= 0) and np.all(ratios < 1)):
        raise ValueError(f"damping = {shown(damping)}: must be at least 0 and below 1, a ratio: 0.05 for 5 %")
    return periods, ratios


def _name(motion, k):
    return getattr(motion, "name", "") or f"{k + 1}"


def _f1(x):
    """(e^x - 1)/x"""
    x = np.asarray(x, dtype=complex)
    safe = np.where(x == 0, 1, x)
    return np.where(x == 0, 1, np.expm1(safe) / safe)


def _f2(x):
    """(e^x - 1 - x)/x^2: the series where the difference would lose digits; its 16 terms are complete to round-off up to |x| = 1."""
    x = np.asarray(x, dtype=complex)
    small = np.abs(x) < 1
    near, far = np.where(small, x, 0), np.where(small, 1, x)
    series = np.zeros_like(near)
    for n in range(17, 1, -1):
        series = (near * series + 1) / n
    return np.where(small, series, (np.expm1(far) - far) / far**2)


@dataclass(frozen=True)
class _Piece:
    """A piece of base motion: a jump of the velocity, then the acceleration a + b t + Im(c e^(i W t))."""
    start: float
    jump: float = 0.0
    a: float = 0.0
    b: float = 0.0
    c: complex = 0.0
    frequency: float = 0.0  # W, rad/s

    def acceleration(self, t):
        return self.a + self.b * t + np.imag(self.c * np.exp(1j * self.frequency * t))


class _Oscillator:
    def __init__(self, period, damping):
        self.period = period
        self.w = 2 * math.pi / period
        self.damping = damping
        self.damped = self.w * math.sqrt(1 - damping**2)
        self.l = complex(-damping * self.w, self.damped)

    def linear(self, q, a, b, t):
        """q after the time t under a + b t."""
        x = self.l * t
        return np.exp(x) * q - t * (a * _f1(x) + b * t * _f2(x))

    def along(self, q, piece, t):
        """q after the time t of a piece, from q right after its jump."""
        q = self.linear(q, piece.a, piece.b, t)
        if piece.c == 0:
            return q
        rotating = [self._rotating(x, t) for x in (1j * piece.frequency, -1j * piece.frequency)]
        return q - (piece.c * rotating[0] - np.conj(piece.c) * rotating[1]) / 2j

    def _rotating(self, x, t):
        """g(x) = (e^(x t) - e^(l t))/(x - l), without the difference near resonance."""
        apart = x - self.l
        near = np.abs(apart * t) < 1
        return np.where(near, t * np.exp(self.l * t) * _f1(np.where(near, apart * t, 0)),
                        (np.exp(x * t) - np.exp(self.l * t)) / (apart if apart != 0 else 1))

    def displacement(self, q):
        return np.imag(q) / self.damped

    def velocity(self, q):
        return np.imag(self.l * q) / self.damped

    def largest(self, q, length, state, acceleration):
        """Largest |u| over intervals of that length that begin with the values q (the last one ends the last interval). state(k, t) and
        acceleration(k, t): q and the base acceleration a time t after the beginning of the intervals k."""
        u, v = np.abs(self.displacement(q)), self.velocity(q)
        largest, speed = u.max(), np.abs(v)
        reach = np.maximum(u[1:], u[:-1]) + length * np.maximum(speed[1:], speed[:-1])  # u gets no further between samples
        k = np.flatnonzero((v[1:] * v[:-1] < 0) & (reach >= largest))
        if len(k):
            t = length * v[k] / (v[k] - v[k + 1])
            for _ in range(_NEWTON):
                now = state(k, t)
                u, speed = self.displacement(now), self.velocity(now)
                change = -2 * self.damping * self.w * speed - self.w**2 * u - acceleration(k, t)
                t = np.clip(t - speed / np.where(change == 0, np.inf, change), 0, length)
            largest = max(largest, np.abs(self.displacement(state(k, t))).max())
        return largest

    def largest_when_free(self, q):
        """Largest |u| of free vibration from q on: at its beginning, or at the first turning point, within a period."""
        phase = np.angle(self.l * q)  # of u', which turns when its phase is a multiple of pi
        t = (-phase % math.pi) / self.damped
        return max(abs(self.displacement(q)), abs(self.displacement(q * np.exp(self.l * t))))


def _samples(record):
    """(dt, accelerations with scale and baseline) of a record; the last one is the limit from the left, for the record is zero after it."""
    if record.shape:
        raise ValueError(f"motion = {shown(record)}: must be one motion, of single numbers")
    times = record.dt * np.arange(len(record.samples))
    a = record.acceleration(times)
    a[-1] = 2 * record.acceleration((times[-1] + times[-2]) / 2) - a[-2]
    return record.dt, a


def _parts(length, shortest, oscillator, pieces=1):
    """Parts of each piece of that length of a motion, so that each has a share of the shortest period; ValueError where these are too many."""
    parts = max(1.0, _SAMPLES * length / shortest)
    if not parts * pieces <= _MOST:
        raise ValueError(f"period = {oscillator.period:g}: must be longer, or the motion shorter or slower: the response has more than {_MOST // _SAMPLES} periods")
    return math.ceil(parts)


def _peak_under_record(source, oscillator):
    with needs("python3-scipy", "a response spectrum"):
        from scipy.signal import lfilter

    dt, a = source
    parts = _parts(dt, oscillator.period, oscillator, len(a))
    h = dt / parts
    if parts > 1:
        a = np.interp(np.arange((len(a) - 1) * parts + 1), np.arange(len(a)) * parts, a)
    slope = np.diff(a) / h
    forcing = oscillator.linear(0, a[:-1], slope, h)
    q = np.concatenate([[0], lfilter([1], [1, -np.exp(oscillator.l * h)], forcing)])
    during = oscillator.largest(q, h, lambda k, t: oscillator.linear(q[k], a[k], slope[k], t), lambda k, t: a[k] + slope[k] * t)
    return max(during, oscillator.largest_when_free(q[-1]))


def _pieces(motion):
    """The pieces of a motion; the last one is without acceleration and without end."""
    if getattr(motion, "shape", None) != ():
        raise ValueError(f"motion = {shown(motion)}: must be one motion, of single numbers")
    if isinstance(motion, Sine):
        w = 2 * math.pi * motion.frequency
        return [_Piece(0.0, c=complex(motion.amplitude), frequency=w), _Piece(motion.cycles / motion.frequency)]
    if isinstance(motion, HalfSine):
        return [_Piece(0.0, c=complex(motion.amplitude), frequency=math.pi / motion.duration), _Piece(motion.duration)]
    if isinstance(motion, Rectangular):
        return [_Piece(0.0, a=motion.amplitude), _Piece(motion.duration)]
    if isinstance(motion, PulseTrain) and motion.times is not None and motion.pulse_shape == "dirac":
        times = motion.times
        jumps = motion.impulse * np.where(np.arange(len(times)) == 0, 1, 2) * (-1.0) ** np.arange(len(times))
        if motion.assembly:
            jumps[-1] /= 2
        return [_Piece(float(t), jump=float(jump)) for t, jump in zip(times, jumps)]
    raise ValueError(f"motion = {shown(motion)}: must be a Record, Sine, HalfSine, Rectangular, or a PulseTrain with times and Dirac pulses")


def _peak_under_pieces(pieces, oscillator):
    q, largest = 0j, 0.0
    for piece, end in zip(pieces, [*(after.start for after in pieces[1:]), math.inf]):
        q -= piece.jump
        if math.isinf(end):
            break
        length = end - piece.start
        shortest = min(oscillator.period, 2 * math.pi / piece.frequency if piece.frequency else math.inf)
        parts = _parts(length, shortest, oscillator)
        h, first = length / parts, q
        starts = h * np.arange(parts + 1)
        path = oscillator.along(first, piece, starts)
        largest = max(largest, oscillator.largest(path, h, lambda k, t: oscillator.along(first, piece, starts[k] + t),
                                                  lambda k, t: piece.acceleration(starts[k] + t)))
        q = path[-1]
    return max(largest, oscillator.largest_when_free(q))
