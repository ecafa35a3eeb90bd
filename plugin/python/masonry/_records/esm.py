"""ESM, ITACA and AFAD (.asc, .ASC): lines `KEY: value`, then one value a line."""

import re

from masonry._records.text import Series
from masonry._records.units import spelled_unit

NAME = "ESM"

_KEY = re.compile(r"^\s*([A-Z][A-Z0-9_/^ ]*?)\s*:\s*(.*?)\s*$")
_NEEDED = "UNITS", "NDATA", "SAMPLING_INTERVAL_S"


def recognises(text):
    return sum(any(line.strip().startswith(key) for _, line in text.header()) for key in _NEEDED) >= 2


def read(text):
    keys, at = {}, {}
    first = 1
    while _KEY.match(text.line(first)):
        key, value = _KEY.match(text.line(first)).groups()
        if key in keys and key in _NEEDED:
            text.refuse(first, f"not give {key} again: line {at[key]} has given it")
        keys[key], at[key] = value, first
        first += 1
    for key in _NEEDED:
        if key not in keys:
            text.refuse(first, f"come after the header, in which {key} is missing")
    unit, kind = spelled_unit(keys["UNITS"]), keys.get("DATA_TYPE", "")
    if unit is None:
        text.refuse(at["UNITS"], "give a unit of acceleration, velocity or displacement, such as cm/s^2")
    if kind and kind.lower() != unit.quantity:
        text.refuse(at["DATA_TYPE"], f"be {unit.quantity.upper()}, whose unit the file gives")
    if not re.fullmatch(r"\d{1,9}", keys["NDATA"]):
        text.refuse(at["NDATA"], "give a whole number")
    dt = text.number(at["SAMPLING_INTERVAL_S"], keys["SAMPLING_INTERVAL_S"], "give a number of seconds above 0")
    values, after = text.values(first, int(keys["NDATA"]), "NDATA")
    text.end(after)
    place = ".".join(filter(None, (keys.get("NETWORK"), keys.get("STATION_CODE"))))
    title = " ".join(filter(None, (keys.get("EVENT_NAME"), keys.get("EVENT_ID"), keys.get("EVENT_DATE_YYYYMMDD"))))
    return [Series(values, dt, unit, keys["UNITS"], keys.get("STREAM", ""), station=place, title=title)]
