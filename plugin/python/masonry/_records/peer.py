"""PEER: .AT2 (acceleration), .VT2 (velocity), .DT2 (displacement).

Title in line 2, quantity and unit in the line above NPTS and DT (line 3, in files with a longer header a later one), then the values. NPTS= 4000, DT= .0050
SEC, in either order; older files: 4000 .0050 NPTS, DT. Exponents may be Fortran's (1.0D-02).
"""

import re

from masonry._records.text import NUMBER, Series, shortened
from masonry._records.units import spelled_unit

NAME = "PEER"

# NPTS and DT, as they are named or, in older files, in this order before their names. Thousands may be parted by commas.
_COUNT, _STEP = r"(\d{1,3}(?:,\d{3})+|\d{1,9})(?!\d)", rf"({NUMBER.pattern})(?![-+.\d]|[A-Z][-+\d])"
_NAMED = re.compile(rf"(?=.*NPTS\s*=\s*{_COUNT})(?=.*DT\s*=\s*{_STEP}\s*([^\s,;]*))", re.IGNORECASE)
_COUNTED = re.compile(rf"\s*{_COUNT}[\s,]+{_STEP}\s*NPTS[\s,]+DT\s*(.*)", re.IGNORECASE)
_SECONDS = {**dict.fromkeys(("", "S", "SEC", "SECS", "SECOND", "SECONDS"), 1.0),
            **dict.fromkeys(("MS", "MSEC", "MSECS", "MILLISECOND", "MILLISECONDS"), 1e-3)}

# These patterns find the unit in a line.
_UNIT_PLACES = [re.compile(pattern) for pattern in (r"\bUNITS?\b\s*(?:OF|ARE|IS|IN|:|=)?\s*(.+)", r"\bIN\s+(.+)", r"[(\[]([^()\[\]]+)[)\]]$", r"[,:=]\s*([^,:=]+)$")]
_QUANTITIES = {"acceleration": r"ACCEL|\bACC\b", "velocity": r"VELOCIT|\bVEL\b", "displacement": r"DISPLACEMENT|\bDISP\b"}
_MUST = {"acceleration": "state ACCELERATION in units of G, G/10, %G, CM/S^2, GAL or M/S^2",
         None: "state ACCELERATION, VELOCITY or DISPLACEMENT in units of G, G/10, %G, CM/S^2, GAL or M/S^2, of CM/S or M/S, of CM or M"}


def _points(line):
    return _NAMED.match(line) or _COUNTED.match(line)


def recognises(text):
    return any(re.search(r"NPTS", line, re.IGNORECASE) and _points(line) for _, line in text.header()) or \
        str(text.path).upper().endswith((".AT2", ".VT2", ".DT2"))


def _unit(line):
    """(unit, spelling) that the line states of its quantity; (None, '') otherwise."""
    upper = re.sub(r"[.,;]?\s+FILTER\b.*", "", line.upper()).strip().rstrip(".,;")  # older files add the corners of their filter
    found = next(filter(None, (place.search(upper) for place in _UNIT_PLACES)), None)
    unit = spelled_unit(found[1]) if found else None
    said = [quantity for quantity, pattern in _QUANTITIES.items() if re.search(pattern, upper)]
    if unit is None or said not in ([], [unit.quantity]):
        return None, ""
    return unit, shortened(found[1])


def read(text, quantity=None):
    """The one series of the file. quantity: the one that the file must state; None: any."""
    counted = next((number for number, line in text.header() if _points(line)), 4)
    points = _points(text.line(counted))
    stated = next((number for number in range(counted - 1, 2, -1) if re.search(r"ACC|VEL|DISP|UNIT", text.line(number), re.IGNORECASE)), counted - 1)
    unit, spelled = _unit(text.line(stated))
    if unit is None or quantity not in (None, unit.quantity):
        text.refuse(stated, _MUST[quantity])
    if not points:
        text.refuse(counted, "give NPTS and DT")
    seconds = re.sub(r"^NPTS.*", "", points[3].upper()).strip(" ()[].,;")
    if seconds not in _SECONDS:
        text.refuse(counted, "give DT in SEC or MSEC")
    step = text.number(counted, points[2], "give a DT above 0")
    values, after = text.values(counted + 1, int(points[1].replace(",", "")), "NPTS")
    text.end(after)
    title = text.line(2).strip()
    station, component = [part.strip() for part in title.split(",")][-2:] if "," in title else ("", "")
    return [Series(values, _SECONDS[seconds] * step, unit, spelled, component, station=station, title=title)]
