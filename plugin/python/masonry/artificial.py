"""Artificial accelerograms for ensembles: filtered white noise under an envelope."""

import math

import numpy as np

from ._given import number_given, positive_given, shown
from .motions import Record


def artificial_record(seed, peak, duration=10.0, dt=0.01, frequency=2.5, damping=0.6, cutoff=0.2):
    """A masonry.Record of stationary noise with the spectrum of Kanai and Tajimi, high-passed after Clough and Penzien, under an envelope. The base ends at
    rest where it began.

    seed         whole number, 0 or larger: the same seed gives the same record
    peak         largest acceleration, m/s^2, positive
    duration     s; the envelope grows with t^2 over the first fifth, stays over two fifths, and decays to 5 % at the end
    dt           s between samples, above 0 and at most 1/(8 frequency)
    frequency    of the ground, Hz, and its damping ratio (above 0): where most of the power is
    cutoff       Hz, positive and below `frequency`: waves much slower than this are left out

    Power over frequency f before the envelope, with r = f/frequency, q = f/cutoff: (1 + 4 z^2 r^2)/((1 - r^2)^2 + 4 z^2 r^2) times
    q^4/((1 - q^2)^2 + 4 z^2 q^2), z the damping ratio in both. A straight line in time under the same envelope is subtracted: the one that leaves the base
    neither a velocity nor a displacement after the last sample.
    """
    if not (isinstance(seed, (int, np.integer)) and seed >= 0):
        raise ValueError(f"seed = {shown(seed)}: must be a whole number, 0 or larger")
    for name, value in (("peak", peak), ("duration", duration), ("frequency", frequency), ("damping", damping), ("cutoff", cutoff)):
        positive_given(name, value)
    if not cutoff < frequency:
        raise ValueError(f"cutoff = {cutoff}: must be below frequency = {frequency}")
    if not 0 < number_given("dt", dt) <= 1 / (8 * frequency):
        raise ValueError(f"dt = {dt}: must be above 0 and at most {1 / (8 * frequency):g} s, an eighth of the ground's period")
    count = round(duration / dt) + 1
    if count < 16:
        raise ValueError(f"duration = {duration}: must be at least {15 * dt:g} s, 15 samples")
    spectrum = np.fft.rfft(np.random.default_rng(int(seed)).standard_normal(count))
    samples = np.fft.irfft(spectrum * np.sqrt(power(np.fft.rfftfreq(count, dt), frequency, damping, cutoff)), count)
    share = np.linspace(0, 1, count)
    envelope = np.select([share < 0.2, share < 0.6], [(share / 0.2)**2, 1.0], np.exp(math.log(0.05) * (share - 0.6) / 0.4))
    samples, lines = samples * envelope, np.stack([envelope, envelope * share], axis=1)
    for _ in range(2):  # the second takes off what round-off has left
        samples = samples - lines @ np.linalg.solve(_ends(count) @ lines, _ends(count) @ samples)
    return Record(dt, peak / np.abs(samples).max() * samples, name=f"artificial, seed {seed}", unit="m/s^2")


def _ends(count):
    """(2, count) weights of the samples, linear in between, in the last velocity over the step, and in the last displacement over step and duration: the integrals
    of 1 and of the share of time that is left, each times the hat function of a sample."""
    weights = np.stack([np.ones(count), np.linspace(1, 0, count)])
    third = 1 / (3 * (count - 1))
    weights[:, 0], weights[:, -1] = (0.5, 0.5 * (1 - third)), (0.5, 0.5 * third)
    return weights


def power(f, frequency, damping, cutoff):
    """The power spectrum of artificial_record, 1 where f is far above the cutoff and far below the ground's frequency. f: Hz, array."""
    r, q, z = np.square(f / frequency), np.square(f / cutoff), 4 * damping**2
    return (1 + z * r) / (np.square(1 - r) + z * r) * np.square(q) / (np.square(1 - q) + z * q)
