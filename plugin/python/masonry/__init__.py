"""Exact theory of the rocking masonry block: closed form, histories under any base motion, overturning thresholds.

Needs NumPy only; `from masonry import dem` adds the simulated blocks inside YADE. SI units, angles in radians. Sizes,
restitutions and motion parameters may be NumPy arrays that broadcast against each other; bad input raises ValueError.

Signs: an angle is positive when the block is tilted towards +x; a base acceleration towards +x tips it towards -x.
"""

try:
    from . import _core as _core
except ImportError as _error:
    raise ImportError("masonry needs its compiled module masonry/_core.so: build it with `cmake --preset release && cmake --build build`, put build/python "
                      f"on PYTHONPATH, and use /usr/bin/python3. ({_error})") from None

from . import closed_form
from .artificial import artificial_record
from .block import RockingBlock
from .history import History, simulate
from .motions import HalfSine, PulseTrain, Record, Rectangular, Sine
from .overturning import overturning_amplitude

__all__ = ["HalfSine", "History", "PulseTrain", "Record", "Rectangular", "RockingBlock", "Sine", "artificial_record",
           "closed_form", "overturning_amplitude", "simulate"]
