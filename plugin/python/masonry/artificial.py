"""Artificial accelerograms for ensembles: filtered white noise under an envelope."""

import math

import numpy as np

from ._given import number_given, positive_given, shown
from .motions import Record


def artificial_record(seed, peak, duration=10.0, dt=0.01, frequency=2.5, damping=0.6, cutoff=0.2):
    """A masonry.Record of stationary noise with the spectrum of Kanai and Tajimi, high-passed after Clough and Penzien, under an envelope.

    seed         whole number, 0 or larger: the same seed gives the same record
    peak         largest acceleration, m/s^2, positive
    duration     s; the envelope grows with t^2 over the first fifth, stays over two fifths, and decays to 5 % at the end
    dt           s between samples, above 0 and at most 1/(8 frequency)
    frequency    of the ground, Hz, and its damping ratio (above 0): where most of the power is
    cutoff       Hz, positive and below `frequency`: waves much slower than this are left out, so that the base stays near its place

    Power over frequency f before the envelope, with r = f/frequency, q = f/cutoff: (1 + 4 z^2 r^2)/((1 - r^2)^2 + 4 z^2 r^2) times
    q^4/((1 - q^2)^2 + 4 z^2 q^2), z the damping ratio in both. The mean acceleration is taken off (baseline 'constant').
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
    samples = samples * np.select([share < 0.2, share < 0.6], [(share / 0.2)**2, 1.0], np.exp(math.log(0.05) * (share - 0.6) / 0.4))
    mean = ((samples[1:] + samples[:-1]) / 2).sum() / (count - 1)  # by the trapezoidal rule, whose name differs between versions of NumPy
    samples = samples - mean  # what the baseline would take off
    return Record(dt, peak / np.abs(samples).max() * samples, baseline="constant", name=f"artificial, seed {seed}", unit="m/s^2")


def power(f, frequency, damping, cutoff):
    """The power spectrum of artificial_record, 1 where f is far above the cutoff and far below the ground's frequency. f: Hz, array."""
    r, q, z = np.square(f / frequency), np.square(f / cutoff), 4 * damping**2
    return (1 + z * r) / (np.square(1 - r) + z * r) * np.square(q) / (np.square(1 - q) + z * q)
