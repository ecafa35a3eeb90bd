"""The baseline 'high-pass': a Butterworth filter that runs forwards and backwards, so that no phase is shifted."""

import numpy as np

from ._given import positive_given, whole_given
from ._optional import needs


def padding(dt, corner, order):
    """Samples of zeros on each side of a record. Boore (2005, Bull. Seism. Soc. Am. 95(2), 745-750) adds 1.5 order/corner on both sides together; as much on each
    side brings the base to rest to 1e-6 of its largest displacement."""
    return int(np.ceil(1.5 * order / corner / dt))


def high_pass(samples, dt, corner, order):
    """The samples with zeros before and after them, filtered. The sum of the two passes has twice the order: half the amplitude is left at the corner."""
    with needs("python3-scipy", "baseline='high-pass'"):
        from scipy.signal import butter, sosfiltfilt
    positive_given("corner", corner, ", in Hz")
    order = whole_given("order", order, 1, 10)
    if not corner < 0.5 / dt:
        raise ValueError(f"corner = {corner}: must be below {0.5 / dt:g} Hz, half the samples a second")
    around = np.zeros(padding(dt, corner, order))
    return sosfiltfilt(butter(order, corner, "highpass", fs=1 / dt, output="sos"), np.concatenate([around, samples, around]), padlen=0)
