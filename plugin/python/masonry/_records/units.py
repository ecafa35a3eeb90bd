"""Units of records: by their names in scripts, and by the spellings of files."""

import re
from dataclasses import dataclass

from masonry._given import positive_given, shown

STANDARD_GRAVITY = 9.80665  # m/s^2
QUANTITIES = {"acceleration": "m/s^2", "velocity": "m/s", "displacement": "m"}


@dataclass(frozen=True)
class Unit:
    """A unit of acceleration, velocity or displacement. scale: one of it in SI units; in g where of_gravity."""

    quantity: str
    scale: float
    of_gravity: bool = False

    def factor(self, gravity):
        """What a value in this unit is multiplied by, to have it in m/s^2, m/s or m."""
        return self.scale * gravity if self.of_gravity else self.scale


# The units that a script may name. "g" is one of them; files have more spellings.
_NAMED = {"m/s^2": Unit("acceleration", 1.0), "cm/s^2": Unit("acceleration", 1e-2), "mm/s^2": Unit("acceleration", 1e-3),
          "g": Unit("acceleration", 1.0, of_gravity=True), "m/s": Unit("velocity", 1.0), "cm/s": Unit("velocity", 1e-2), "mm/s": Unit("velocity", 1e-3),
          "m": Unit("displacement", 1.0), "cm": Unit("displacement", 1e-2), "mm": Unit("displacement", 1e-3)}

# Spellings without blanks, powers and brackets, in capital letters.
_SPELLINGS = {**dict.fromkeys(("G", "GS", "G'S", "GRAVITY", "STANDARDGRAVITY"), _NAMED["g"]),
              **dict.fromkeys(("G/10", "0.1G", ".1G"), Unit("acceleration", 0.1, of_gravity=True)),
              **dict.fromkeys(("%G", "%OFG", "PERCENTG", "PERCENTOFG", "G/100", "0.01G", ".01G"), Unit("acceleration", 0.01, of_gravity=True)),
              **dict.fromkeys(("GAL", "GALS"), _NAMED["cm/s^2"]),
              **{spelling: unit for prefix, scale in (("", 1.0), ("C", 1e-2), ("M", 1e-3))
                 for spelling, unit in ((f"{prefix}M/S2", Unit("acceleration", scale)), (f"{prefix}M/S/S", Unit("acceleration", scale)),
                                        (f"{prefix}MS-2", Unit("acceleration", scale)), (f"{prefix}M/S", Unit("velocity", scale)),
                                        (f"{prefix}MS-1", Unit("velocity", scale)), (f"{prefix}M", Unit("displacement", scale)))}}


def named_unit(unit, quantity=None):
    """The unit of that name; ValueError unless there is one, of that quantity where it is given."""
    names = [name for name, known in _NAMED.items() if quantity in (None, known.quantity)]
    if unit not in names:
        raise ValueError(f"unit = {shown(unit)}: must be one of {', '.join(names)}")
    return _NAMED[unit]


def unit_factor(unit, gravity=STANDARD_GRAVITY, quantity="acceleration"):
    """What a value in the unit of that name is multiplied by, to have it in SI units."""
    return named_unit(unit, quantity).factor(positive_given("gravity", gravity, ", in m/s^2"))


def spelled_unit(text):
    """The unit that a file spells so, or None."""
    spelling = re.sub(r"SECONDS?|SECS?\b|SEC(?=\d|\^|\*|/)", "S", text.strip().upper().replace("²", "2"))
    spelling = re.sub(r"SQUARED?\b|(?<=\d|S)\s*SQ\b", "2", spelling).replace(" PER ", "/")
    return _SPELLINGS.get(re.sub(r"[\s^*()\[\]]", "", spelling))
