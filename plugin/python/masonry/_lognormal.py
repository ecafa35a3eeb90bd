"""The lognormal fragility curve P(x) = Phi(ln(x/m)/beta) of maximum likelihood, and what the data do not say.

With t = ln x the curve is Phi(b_0 + b_1 t), b_1 = 1/beta, b_0 = -ln m/beta: a probit regression, whose log-likelihood is concave, so that Newton's
iteration finds its one maximum. There is one where a history that stands has a larger x than one that collapses; otherwise the likelihood grows
without bound in b_1 (complete separation).

Intervals are those of the profile likelihood: a value belongs to the interval where twice the loss of log-likelihood against the best fit is below the
quantile of chi^2. Histories of one record under several scales are not independent. The loss is then multiplied by the variance that the
likelihood states over the one that the scatter between the records shows, where that is larger (Chandler and Bate 2007, Biometrika 94, 167-183; the
second is the sandwich variance with the correction of Mancl and DeRouen 2001, Biometrics 57, 126-134, for few records), and the quantile is that
of Student's t^2 with one degree of freedom less than there are records.
"""

import math

import numpy as np

_STEPS = 100


class NoMaximum(Exception):
    """The likelihood has no maximum that can be told from none."""


class LognormalFit:
    """x > 0: measures; collapsed: bools; groups: whole numbers 0, 1, ... of what belongs together, or None. All of one length, with overlap."""

    def __init__(self, x, collapsed, groups=None):
        t = np.log(x)
        self._origin, self._unit = t.mean(), t.std()
        t, place = np.unique((t - self._origin) / self._unit, return_inverse=True)
        self._t = t
        self._collapsed = np.bincount(place, collapsed, len(t))
        self._stands = np.bincount(place, ~collapsed, len(t))
        b = self._best()
        self._b, self._largest = b, self._likelihood(b[0] + b[1] * t)[0]
        share = collapsed.mean()
        self._without_slope = len(x) * (share * math.log(share) + (1 - share) * math.log(1 - share))
        design = np.array([np.ones_like(t), t])
        _, slope, curvature = self._likelihood(b[0] + b[1] * t)
        self._stated = np.linalg.inv(-(design * curvature) @ design.T)
        self._shown, self._freedom = self._stated, math.inf
        if groups is not None:
            self._shown = self._stated @ self._scatter(b[0] + b[1] * t, collapsed, groups, place) @ self._stated
            self._freedom = groups.max()

    @property
    def rises(self):
        return self._b[1] > 0

    @property
    def median(self):
        return math.exp(self._origin - self._unit * self._b[0] / self._b[1])

    @property
    def dispersion(self):
        return self._unit / self._b[1]

    def significant(self, confidence):
        """Whether the data tell the curve from one that does not rise. Where they do not, the median and the largest dispersion have no bound."""
        return 2 * (self._largest - self._without_slope) * self._factor(np.array([0.0, 1.0])) > self._quantile(confidence)

    def median_interval(self, confidence):
        if not self.significant(confidence):
            return 0.0, math.inf
        b0, b1 = self._b
        best = -b0 / b1
        low, high = self._interval(best, np.array([-1 / b1, b0 / b1**2]), confidence, lambda at: self._along(np.zeros_like(self._t), self._t - at, b1))
        with np.errstate(over="ignore"):
            return float(np.exp(self._origin + self._unit * low)), float(np.exp(self._origin + self._unit * high))

    def dispersion_interval(self, confidence):
        b0, b1 = self._b
        low, high = self._interval(b1, np.array([0.0, 1.0]), confidence, lambda at: self._along(at * self._t, np.ones_like(self._t), b0))
        return self._unit / high, self._unit / low if low > 0 else math.inf

    def probability(self, x):
        from scipy.special import ndtr

        return ndtr(self._b[0] + self._b[1] * self._place(x))

    def band(self, x, confidence):
        """Pointwise, from the variance of b_0 + b_1 t."""
        from scipy.special import ndtr

        t = self._place(x)
        variance = np.maximum(*(v[0, 0] + 2 * v[0, 1] * t + v[1, 1] * t**2 for v in (self._stated, self._shown)))
        spread = np.sqrt(self._quantile(confidence) * variance)
        return ndtr(self._b[0] + self._b[1] * t - spread), ndtr(self._b[0] + self._b[1] * t + spread)

    def _place(self, x):
        return (np.log(x) - self._origin) / self._unit

    def _quantile(self, confidence):
        from scipy.stats import norm, t

        return (norm if math.isinf(self._freedom) else t(self._freedom)).ppf((1 + confidence) / 2) ** 2

    def _scores(self, eta):
        """d ln P/d eta of a collapse and of one that stands."""
        from scipy.special import log_ndtr

        density = -(eta**2) / 2 - math.log(2 * math.pi) / 2
        return np.exp(density - log_ndtr(eta)), -np.exp(density - log_ndtr(-eta))

    def _likelihood(self, eta):
        """(log-likelihood, its first and second derivative for eta at each t)"""
        from scipy.special import log_ndtr

        up, down = self._scores(eta)
        value = self._collapsed @ log_ndtr(eta) + self._stands @ log_ndtr(-eta)
        return value, self._collapsed * up + self._stands * down, -self._collapsed * up * (up + eta) - self._stands * down * (down + eta)

    def _scatter(self, eta, collapsed, groups, place):
        """Sum over the groups of s s', s being the group's score, corrected for its own part in the fit: (1 - I_g I^-1)^-1 times it, I_g its information."""
        up, down = self._scores(eta)
        score = np.where(collapsed, up[place], down[place])
        information = score * (score + eta[place])
        t = self._t[place]
        sums = np.array([np.bincount(groups, score * t**k) for k in (0, 1)]).T
        own = np.array([np.bincount(groups, information * t**k) for k in (0, 1, 1, 2)]).T.reshape(-1, 2, 2)
        # symmetric: with I^-1 = L L' it is L'^-1 (1 - L' I_g L)^-1 L'; a group that holds all the information says nothing of the scatter: no bound
        root = np.linalg.cholesky(self._stated)
        part, axes = np.linalg.eigh(root.T @ own @ root)
        scaled = np.einsum("gij,gi->gj", axes, sums @ root) / np.maximum(1 - part, 1e-9)
        corrected = np.linalg.solve(root.T, np.einsum("gij,gj->gi", axes, scaled).T)
        return corrected @ corrected.T

    def _best(self):
        b = np.zeros(2)
        design = np.array([np.ones_like(self._t), self._t])
        value, slope, curvature = self._likelihood(b @ design)
        for _ in range(_STEPS):
            try:
                step = np.linalg.solve(-(design * curvature) @ design.T, design @ slope)
            except np.linalg.LinAlgError:
                break
            gain = step @ design @ slope / 2  # of likelihood, that the step promises
            while True:
                there = self._likelihood((b + step) @ design)
                if there[0] >= value or np.abs(step).max() < 1e-14 * (1 + np.abs(b).max()):
                    break
                step /= 2
            b = b + step
            value, slope, curvature = there
            # The error is now about the square of the step, and the likelihood cannot tell. Round-off in steps is larger the nearer the data are separated.
            if np.abs(step).max() <= 1e-6 * (1 + np.abs(b).max()) and gain <= 1e-16 * (1 - value):
                return b
        raise NoMaximum

    def _along(self, offset, direction, start):
        """Largest log-likelihood of eta = offset + s direction over the number s."""
        s = start
        value, slope, curvature = self._likelihood(offset + s * direction)
        for _ in range(_STEPS):
            step = (slope @ direction) / -(curvature @ direction**2)
            while True:
                there = self._likelihood(offset + (s + step) * direction)
                if there[0] >= value or abs(step) < 1e-14 * (1 + abs(s)):
                    break
                step /= 2
            s += step
            value, slope, curvature = there
            if abs(step) <= 1e-10 * (1 + abs(s)):
                break
        return value

    def _variance(self, gradient):
        return max(gradient @ self._stated @ gradient, gradient @ self._shown @ gradient)

    def _factor(self, gradient):
        """What the loss of log-likelihood is multiplied by, for a parameter of that gradient over (b_0, b_1)."""
        return (gradient @ self._stated @ gradient) / self._variance(gradient)

    def _interval(self, best, gradient, confidence, profile):
        """Where the loss of the profile reaches the quantile, below and above; infinite where it does not."""
        from scipy.optimize import brentq

        quantile, factor = self._quantile(confidence), self._factor(gradient)
        reach = math.sqrt(quantile * self._variance(gradient))

        def excess(at):
            return 2 * (self._largest - profile(at)) * factor - quantile

        def end(side):
            distance = reach
            while excess(best + side * distance) < 0:
                distance *= 1.5
                if distance > 1e6 * reach:
                    return side * math.inf
            return brentq(excess, best, best + side * distance, xtol=1e-10 * (abs(best) + reach), rtol=1e-10)

        return end(-1), end(1)


def wilson(events, cases, confidence=0.95):
    """(lower, upper) end of Wilson's interval for the probability of an event that was seen `events` times in `cases`; arrays broadcast."""
    from scipy.stats import norm

    z = norm.ppf((1 + confidence) / 2)
    p, n = np.divide(events, cases), np.asarray(cases, dtype=float)
    middle, half = p + z**2 / (2 * n), z * np.sqrt(p * (1 - p) / n + (z / (2 * n)) ** 2)
    low, high = (middle - half) / (1 + z**2 / n), (middle + half) / (1 + z**2 / n)
    return np.where(p == 0, 0.0, low), np.where(p == 1, 1.0, high)
