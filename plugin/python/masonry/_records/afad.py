"""Text files of the Turkish network (AFAD): lines `KEY : value`, a line with the names of three components, then three values a line in gal."""

import re

import numpy as np

from masonry._records.text import Series
from masonry._records.units import spelled_unit

NAME = "AFAD"

_FIRST = re.compile(r"STRONG GROUND MOTION RECORDS? OF T", re.IGNORECASE)
_COMPONENTS = r"^\s*N-?S\s+E-?W\s+U-?D\s*$"


def recognises(text):
    return bool(_FIRST.search(text.line(1)))


def _value(text, pattern, must):
    number, found = text.search(pattern, 1, 40)
    if not found:
        text.refuse(1, f"be followed by a line `{must}`")
    return number, found


def read(text):
    _, count = _value(text, r"^\s*NUMBER OF DATA\s*:\s*(\d{1,9})\s*$", "NUMBER OF DATA : 12000")
    stepped, step = _value(text, r"^\s*SAMPLING INTERVAL \(sec\)\s*:\s*(\S+)\s*$", "SAMPLING INTERVAL (sec) : 0.01")
    at, peaks = _value(text, r"\bPGA VALUES\s*\(([^)]*)\)", "RAW PGA VALUES (gal) : ...")
    names, _ = _value(text, _COMPONENTS, "N-S  E-W  U-D")
    _, station = text.search(r"^\s*STATION ID\s*:\s*(.*?)\s*$", 1, names)
    unit = spelled_unit(peaks[1])
    if unit is None or unit.quantity != "acceleration":
        text.refuse(at, "give its unit in brackets, such as (gal)")
    dt = text.number(stepped, step[1], "give a number of seconds above 0")
    values, after = text.values(names + 1, 3 * int(count[1]), "three times NUMBER OF DATA")
    text.end(after)
    title = re.sub(r"^\s*PLACE\s*:\s*", "", text.line(2)).strip()
    return [Series(np.ascontiguousarray(column), dt, unit, peaks[1], name, station=station[1] if station else "", title=title)
            for name, column in zip(text.line(names).split(), values.reshape(-1, 3).T)]
