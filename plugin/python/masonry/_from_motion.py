"""Accelerations of a base whose displacements or velocities are given at equal steps.

The displacement is a cubic spline u = sum c_k B(t/dt - k) on the given instants, the velocity, where that is given, a quadratic one with knots there too. In
either case the acceleration is linear between the instants: the motion that the compiled code integrates exactly. With k from -1 on,

    given u:  u_k = (c_{k-1} + 4 c_k + c_{k+1})/6,  v_k = (c_{k+1} - c_{k-1})/(2 dt),  a_k = (c_{k-1} - 2 c_k + c_{k+1})/dt^2
    given v:  v_k = (c_{k-1} + c_k)/2,              a_k = (c_k - c_{k-1})/dt

The base is at rest at the first instant: u_0 = v_0 = 0. The last displacement is met exactly, and the base is at rest again there; the last velocity is met
exactly. In between, rounded samples must not be interpolated: numbers with four decimals of a metre, at steps of 0.01 s, would have accelerations of 1 m/s^2
that are nothing but rounding. The spline is therefore the smoothest one (least sum of the squared fourth differences of the displacement's coefficients)
among those that differ from the samples by what rounding leaves: a root mean square of resolution/sqrt(12), and nowhere more than the resolution. This is a
penalised spline (Eilers and Marx 1996, Statistical Science 11(2), 89-121); its weight follows from the discrepancy principle (Morozov 1966). Samples without a
resolution are interpolated.
"""

import math

import numpy as np

from ._optional import needs

# Weight of the roughness against the sum of squared residuals: the least interpolates; the largest smooths over 30 samples, beyond which the normal
# equations lose their digits.
_LEAST, _MOST = 1e-12, 1e12
# Differences of the displacement's coefficients, which are those of the velocity's of one order less.
_ROUGHNESS = 4
# How a sample follows from the coefficients around it: displacements, velocities.
_STENCILS = {2: (1 / 6, 4 / 6, 1 / 6), 1: (1 / 2, 1 / 2)}
# Relative to the range of the samples, the finest step between values that counts as their resolution: finer ones are those of double precision.
_FINEST = 1e-12
# A velocity that does not begin at rest: relative to the largest.
_AT_REST = 1e-3


def resolution_of(values):
    """The step of which all values are multiples, but for one offset: that of rounding or of a converter; 0 where there is none."""
    values = np.asarray(values, dtype=float)
    extent = np.ptp(values)
    if extent == 0:
        return 0.0
    for power in range(math.ceil(math.log10(extent)), math.floor(math.log10(_FINEST * extent)), -1):
        multiples = values / 10.0**power
        if np.abs(multiples).max() < 1e15 and np.all(np.abs(multiples - np.round(multiples)) < 1e-3):
            return float(np.gcd.reduce(np.round(multiples).astype(np.int64))) * 10.0**power
    gaps = np.diff(np.unique(values))
    gaps = gaps[gaps > 1e-9 * extent]
    step = gaps.min()
    return float(step) if len(gaps) > 1 and np.all(np.abs(gaps / step - np.round(gaps / step)) < 1e-3) else 0.0


def _bands(matrix):
    """Upper bands of a symmetric matrix, as scipy.linalg.solveh_banded takes them."""
    result = np.zeros((_ROUGHNESS + 2, matrix.shape[0]))
    for k in range(_ROUGHNESS + 2):
        result[-1 - k, k:] = matrix.diagonal(k)
    return result


class _Spline:
    """Coefficients c of the spline as functions of the free ones y, c = E y + f, and the two sums of squares. order: 2 for displacements, 1 for velocities,
    derivatives of which are the accelerations."""

    def __init__(self, values, order):
        with needs("python3-scipy", "a record of velocities or displacements"):
            from scipy import sparse
        count = len(values)
        size = count + order
        sampled = sparse.diags(_STENCILS[order], range(order + 1), shape=(count, size), format="csr")
        expand, self.fixed = sparse.lil_matrix((size, size - 2 * order)), np.zeros(size)
        expand.setdiag(1, -order)
        # The first coefficients and the last ones follow from what is known there: no displacement and no velocity first; the last value last.
        if order == 2:
            expand[0, 0], expand[1, 0] = 1, -0.5
            expand[-2, -1], expand[-1, -1] = -0.5, 1
            self.fixed[-2] = 1.5 * values[-1]
        else:
            expand[0, 0], expand[-1, -1] = -1, -1
            self.fixed[-1] = 2 * values[-1]
        self.expand, self.values, self.sampled = expand.tocsr(), values, sampled
        difference = sparse.identity(size, format="csr")
        for _ in range(_ROUGHNESS - 2 + order):
            difference = difference[1:] - difference[:-1]
        fit, rough = (sampled @ self.expand).tocsr(), (difference @ self.expand).tocsr()
        self.fit, self.rough = _bands((fit.T @ fit).tocsr()), _bands((rough.T @ rough).tocsr())
        self.fit_side = fit.T @ (values - sampled @ self.fixed)
        self.rough_side = -rough.T @ (difference @ self.fixed)

    def solve(self, weight):
        """(coefficients, residuals) with that weight of the roughness."""
        from scipy.linalg import solveh_banded

        y = solveh_banded(self.fit + weight * self.rough, self.fit_side + weight * self.rough_side)
        coefficients = self.expand @ y + self.fixed
        return coefficients, self.sampled @ coefficients - self.values

    def smoothest(self, resolution):
        """(coefficients, residuals) of the largest weight whose residuals are those of rounding."""
        low, high = math.log10(_LEAST), math.log10(_MOST)
        best = self.solve(_LEAST)
        while resolution > 0 and high - low > 0.05:
            middle = (low + high) / 2
            found = self.solve(10**middle)
            rounding = np.sqrt(np.mean(found[1]**2)) <= resolution / math.sqrt(12) and np.abs(found[1]).max() <= resolution
            low, high, best = (middle, high, found) if rounding else (low, middle, best)
        return best


def accelerations(values, dt, quantity, resolution=None):
    """(accelerations at the given instants, largest difference of the motion from the values). values: m or m/s, dt apart; quantity: 'displacement' or
    'velocity'; resolution: of the values; None: found from them."""
    order = {"velocity": 1, "displacement": 2}[quantity]
    if len(values) < 8:
        raise ValueError(f"{quantity} has {len(values)} samples: must be at least 8")
    for k in np.flatnonzero(~np.isfinite(values))[:1]:
        raise ValueError(f"{quantity}[{k}] = {values[k]}: must be finite")
    resolution = resolution_of(values) if resolution is None else resolution
    if order == 1 and abs(values[0]) > max(_AT_REST * np.abs(values).max(), resolution):
        raise ValueError(f"velocity[0] = {values[0]:g}: must be 0, because the base starts from rest; put the way to that velocity before it")
    coefficients, residuals = _Spline(values - values[0] if order == 2 else values, order).smoothest(resolution)
    return np.diff(coefficients, order) / dt**order, float(np.abs(residuals).max())
