"""Exact theory of the rocking masonry block: closed form, histories under any base motion, overturning thresholds.

Needs NumPy only; `from masonry import dem` adds the simulated blocks inside YADE. SI units, angles in radians. Sizes,
restitutions and motion parameters may be NumPy arrays that broadcast against each other; bad input raises ValueError.

Signs: an angle is positive when the block is tilted towards +x; a base acceleration towards +x tips it towards -x.
"""

try:
    from . import _fit

    _fit.require_python()  # before the compiled modules, which need that Python's libraries
    from . import _core as _core
except ImportError as _error:
    if _error.name is None:  # the sentence of require_python
        raise
    raise ImportError("masonry needs its compiled module masonry/_core.so: build it with `cmake --preset release && cmake --build build`, put build/python "
                      f"on PYTHONPATH, and use the system's Python. ({_error})") from None

from . import closed_form, spectra  # noqa: E402
from ._build import VERSION as __version__  # noqa: E402
from ._calls import check_keywords as _check_keywords  # noqa: E402
from ._fragility import Fragility, fragility, fragility_of_table  # noqa: E402
from .artificial import artificial_record  # noqa: E402
from .block import RockingBlock  # noqa: E402
from .history import History, simulate  # noqa: E402
from .motions import HalfSine, PulseTrain, Record, Rectangular, Sine  # noqa: E402
from .overturning import overturning_amplitude  # noqa: E402
from .records import read_record  # noqa: E402

__all__ = ["Fragility", "HalfSine", "History", "PulseTrain", "Record", "Rectangular", "RockingBlock", "Sine", "artificial_record",
           "closed_form", "fragility", "fragility_of_table", "overturning_amplitude", "read_record", "simulate", "spectra"]

_check_keywords(__name__)
_check_keywords(closed_form.__name__)
