"""The theoretical curves: closed form (constant moment), exact solution under gravity, finite pulses. All are ratios theta/alpha and
periods of blocks of base two_b (m) and slenderness under the train of impulse I (m/s); arrays broadcast."""
from dataclasses import dataclass

import masonry
import numpy as np
from scipy.optimize import brentq

from cases import GRAVITY, IMPULSE, TIME_TOLERANCE, half_cycles


def block(two_b, slenderness):
    return masonry.RockingBlock(np.divide(two_b, 2), np.multiply(two_b, slenderness) / 2, GRAVITY)


def closed(two_b, slenderness, restitution, impulse=IMPULSE):
    """The paper's stabilised phase: .period, .ratio, ..."""
    return masonry.closed_form.stabilised(block(two_b, slenderness), impulse, restitution)


@dataclass
class Stabilised:
    period: np.ndarray  #: s; NaN where the block overturns
    ratio: np.ndarray   #: peak angle over critical angle; NaN where it overturns


def exact(two_b, slenderness, restitution, impulse=IMPULSE):
    """The stabilised phase under real gravity: the speed w* of Eq. 10 is exact, peak and duration follow from energy."""
    b = block(two_b, slenderness)
    peak, duration = masonry.spectra.half_cycle(b, masonry.closed_form.stabilised(b, impulse, restitution).angular_velocity)
    return Stabilised(2 * duration, np.where(np.isfinite(peak), peak / b.critical_angle, np.nan))


def history(case, restoring="exact"):
    """The exact history of a case of Dirac pulses, half cycle by half cycle."""
    return masonry.simulate(block(case.two_b, case.slenderness), masonry.PulseTrain(case.impulse, half_cycles=case.half_cycles),
                            restitution=case.restitution, restoring=restoring, half_cycles=case.half_cycles)


def time_to_stabilise(two_b, slenderness, restitution):
    """Under gravity: end of the first half cycle whose speed is within TIME_TOLERANCE of its limit, s; NaN: it overturns."""
    n = half_cycles(restitution, TIME_TOLERANCE)
    h = masonry.simulate(block(two_b, slenderness), masonry.PulseTrain(IMPULSE), restitution=restitution, half_cycles=n)
    times = h.impact_times
    missing = np.full(np.shape(h.overturned), np.nan)
    return np.where(h.overturned, missing, times[..., n - 1] if times.shape[-1] >= n else missing)


def _root_in_slenderness(margin):
    return brentq(lambda lam: float(margin(lam)), 1.0, 1e3, xtol=1e-12)


def critical_slenderness(two_b, restitution):
    """Where the closed form starts to overturn: its ratio is 1."""
    return _root_in_slenderness(lambda lam: closed(two_b, lam, restitution).ratio - 1)


def exact_critical_slenderness(two_b, restitution):
    """Where the real block starts to overturn: w*^2 = 2 p^2 (1 - cos alpha)."""

    def margin(lam):
        b = block(two_b, lam)
        return closed(two_b, lam, restitution).angular_velocity ** 2 / (2 * b.frequency_parameter**2 * (1 - np.cos(b.critical_angle))) - 1

    return _root_in_slenderness(margin)


@dataclass
class FiniteTrain:
    """Half cycles along the first axis; NaN after overturning."""
    starts: list      #: s
    peak_ratio: list  #: theta/alpha
    pieces: list      #: History of each half cycle, from its own t = 0

    def angle(self, i, t):
        return self.pieces[i].sample(t)[0]


def finite_train(two_b, slenderness, restitution, duration, n, first="dirac"):
    """Resonant train of rectangular pulses 2I/duration, each starting right after an impact, chained half cycle by half cycle.
    first: 'dirac' (velocity jump I), or 'rectangular': I spread over the same duration, which must lift the block by itself."""
    b = block(two_b, slenderness)
    zero = np.zeros(np.shape(b.critical_angle))
    speed = zero - (masonry.closed_form.single_pulse(b, IMPULSE).angular_velocity if first == "dirac" else 0)
    train = FiniteTrain([], [], [])
    start, alive = zero, zero == 0
    for i in range(n):
        amplitude = (-1) ** i * IMPULSE / duration * (2 if i else 0 if first == "dirac" else 1)
        motion = masonry.Rectangular(amplitude, duration) if amplitude else None
        piece = masonry.simulate(b, motion, restitution=restitution, initial_velocity=speed, half_cycles=1)
        shape = alive.shape + (1,)
        impact, velocity = (np.resize(a, shape)[..., 0] if a.size else zero + np.nan for a in (piece.impact_times, piece.impact_velocities))
        alive = alive & ~piece.overturned & np.isfinite(impact)
        train.starts.append(start)
        peak = np.abs(piece.peak_angles[..., 0]) if piece.peak_angles.size else zero
        train.peak_ratio.append(np.where(alive, peak / b.critical_angle, np.nan))
        train.pieces.append(piece)
        if not alive.any():
            break
        start = start + np.where(alive, impact, np.nan)
        # An overturned block goes on as one at rest, which keeps its NaN.
        speed = np.where(alive, restitution * np.nan_to_num(velocity), 0.0)
    return train


def finite_ratio(two_b, slenderness, restitution, duration, n=60):
    """theta/alpha of half cycle n, when the train has stabilised; NaN: overturned."""
    train = finite_train(two_b, slenderness, restitution, duration, n)
    return train.peak_ratio[-1] if len(train.peak_ratio) == n else np.full(np.shape(slenderness), np.nan)
