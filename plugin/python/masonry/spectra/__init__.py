"""Spectra: how one block after another, or one oscillator after another, answers the same kind of motion.

    rocking              largest rotation over the critical angle, on a grid of motions and blocks
    overturning          least amplitude that overturns, on a grid of motions and blocks
    response             response spectra of the elastic oscillator, exact for records and other motions
    resonance            stabilised phase under the resonant train of Casapulla and Maione, beside that of the elastic oscillator
    peak_ratio, oscillator_peak, half_cycle   the pieces, for arrays that broadcast

The first four return a Spectrum: arrays whose dimensions have names, coordinates and units; to_csv(), to_xarray() and plot().
"""

from ._grid import Spectrum
from ._oscillator import oscillator_peak, response
from ._resonance import half_cycle, resonance
from ._rocking import overturning, peak_ratio, rocking

__all__ = ["Spectrum", "half_cycle", "oscillator_peak", "overturning", "peak_ratio", "resonance", "response", "rocking"]
