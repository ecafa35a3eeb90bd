"""Spectra: how blocks of many sizes, or oscillators of many periods, answer motions of the same kind.

rocking() gives the largest rotation over the critical angle and overturning() the least amplitude that overturns, both on a grid of motions and blocks;
response() gives response spectra of the elastic oscillator, exact for records and other motions; resonance() gives the stabilised phase under the
resonant train of Casapulla and Maione, beside that of the elastic oscillator. They return a Spectrum: arrays whose dimensions have names, coordinates and
units, with to_csv(), to_xarray() and plot(). peak_ratio(), oscillator_peak() and half_cycle() are the pieces, for arrays that broadcast.
"""

from masonry._calls import check_keywords as _check_keywords

from ._grid import Spectrum
from ._oscillator import oscillator_peak, response
from ._resonance import half_cycle, resonance
from ._rocking import overturning, peak_ratio, rocking

__all__ = ["Spectrum", "half_cycle", "oscillator_peak", "overturning", "peak_ratio", "resonance", "response", "rocking"]

_check_keywords(__name__)
