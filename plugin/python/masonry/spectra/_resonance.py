"""The stabilised phase under the resonant train of pulses, for blocks and for elastic oscillators.

Every pulse comes when the system passes its position of rest: for the block right after an impact, which multiplies its speed by C; for the
oscillator at u = 0, where the half period since the pulse before has multiplied its speed by E = exp(-pi z/sqrt(1 - z^2)). So both follow Eq. 7 of
Casapulla and Maione, w_i = C w_(i-1) + 2 w_1, and the speed grows to 2/(1 - C) times the first. The displacement of the oscillator is proportional to its
speed, and so is amplified by 2/(1 - E); the rotation of a block grows with the square of the speed, and is amplified by 4/(1 - C)^2 (Eq. 13), or by more under
gravity, whose moment falls as the block tilts.
"""

import numpy as np

from .. import closed_form
from .._given import array_given, shown
from .._optional import needs
from ..block import RockingBlock
from ._grid import UNITS, Spectrum, outer


def half_cycle(block, speed):
    """(peak angle, duration) of a free half cycle under gravity that starts with that angular velocity (rad/s, without sign) from the upright position; the
    arguments broadcast. Where the block overturns the peak is infinite and the duration NaN.

    With D = (w/2p)^2 and k^2 = sin^2(alpha/2) - D: peak = alpha - 2 asin k; the duration is (2/p) S R_F(1 - S^2, 1 - (1 - k^2) S^2, 1),
    S^2 = D/(sin^2(alpha/2) (1 - k^2)), R_F being Carlson's integral; the block overturns where k^2 <= 0."""
    with needs("python3-scipy", "a half cycle"):
        from scipy.special import elliprf

    d = (np.asarray(speed) / (2 * block.frequency_parameter)) ** 2
    lift = np.sin(np.divide(block.critical_angle, 2)) ** 2
    overturns = lift <= d
    d = np.where(overturns, 0, d)
    k2 = lift - d
    s2 = d / (lift * (1 - k2))
    # alpha - 2 asin k, without the difference: tan of half of it from sin(alpha/2) and k
    peak = 2 * np.arcsin(d / (np.sqrt(lift * (1 - k2)) + np.sqrt(k2 * (1 - lift))))
    duration = 2 / block.frequency_parameter * np.sqrt(s2) * elliprf(1 - s2, 1 - (1 - k2) * s2, 1.0)
    return np.where(overturns, np.inf, peak)[()], np.where(overturns, np.nan, duration)[()]


def resonance(width, slenderness, restitution, impulse=0.0125 * 9.81, damping=0.05, gravity=9.81):
    """The resonance spectra of Casapulla and Maione: the stabilised phase of blocks under the resonant train of pulses I, -2I, +2I, ..., beside that of elastic
    oscillators, each of which gets every pulse when it passes its position of rest.

    width         whole width 2b, m
    slenderness   height over width
    restitution   C, below 1
    impulse       I, m/s; the default is the paper's, 0.0125 g s
    damping       ratio of the oscillator, at least 0 and below 1

    Each may be a list, which is a dimension of the Spectrum that comes back. Its values:

    period, ratio, amplification      T* (s), theta*/alpha and theta*/theta_1 of the closed form (constant restoring moment; Eqs 11 to 13)
    gravity_period, gravity_ratio, gravity_amplification      the same under gravity, exact; NaN, infinite and infinite where the block overturns
    oscillator_amplification          u*/u_1 of the oscillator, whatever its period; infinite without damping
    """
    dims, coords, arrays = outer(width=width, slenderness=slenderness, restitution=restitution, impulse=impulse, damping=damping)
    z, c = array_given("damping", arrays["damping"]), array_given("restitution", arrays["restitution"])
    for name, value in (("damping", z), ("restitution", c)):
        if not (np.all(value >= 0) and np.all(value < 1)):
            raise ValueError(f"{name} = {shown(value.ravel().tolist())}: must be at least 0 and below 1")
    block = RockingBlock.from_size(arrays["width"], np.multiply(arrays["width"], arrays["slenderness"]), gravity)
    limit = closed_form.stabilised(block, arrays["impulse"], c)
    peak, duration = half_cycle(block, limit.angular_velocity)
    first, _ = half_cycle(block, closed_form.single_pulse(block, arrays["impulse"]).angular_velocity)
    kept = np.exp(-np.pi * z / np.sqrt(1 - z**2))
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {"period": limit.period, "ratio": limit.ratio, "amplification": limit.amplification,
                  "gravity_period": 2 * duration, "gravity_ratio": peak / block.critical_angle,
                  "gravity_amplification": np.where(np.isinf(peak), np.inf, peak / first), "oscillator_amplification": 2 / (1 - kept)}
    fixed = {"quantity": "stabilised phase under the resonant train", **{name: value for name, value in arrays.items() if name not in dims}}
    return Spectrum(dims, coords, values, {**UNITS, "gravity_period": "s"}, {**fixed, "gravity": gravity})
