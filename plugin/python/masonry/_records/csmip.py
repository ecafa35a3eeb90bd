"""Volumes 1 and 2 of the California network (CSMIP, .V1 and .V2): one or several channels, each with a header and its blocks of values.

A line above each block says how many values follow, their step and their unit:
    12000 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)
    13200 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)
"""

import re

from masonry._records.text import Series, column_width, number_of, shortened
from masonry._records.units import spelled_unit

NAME = "CSMIP V1/V2"

_NUMBER = r"(\d*\.?\d+(?:E[-+]?\d+)?)"
_BLOCK = re.compile(rf"^\s*(\d+)\s+(?:points of (accel|veloc|displ)\w* data equally[- ]spaced at\s*{_NUMBER}\s*sec|"
                    rf"(accel)erogram points at\s*{_NUMBER}\s*(?:pts|points|samples)/sec)", re.IGNORECASE)
_UNIT = re.compile(r"(?:\bunits?\s*(?:of|:|=)|\bin(?!\s+units))\s*([^\s(),;]+)", re.IGNORECASE)
_CHANNEL = r"\bchan(?:nel)?\.?\s*(\d+)\s*:\s*(\S.*?)\s*(?:\s{2}|\bfrom\b|$)"
_STATION = r"^\s*Station No\.?\s*(\S+)"
_QUANTITIES = {"a": "acceleration", "v": "velocity", "d": "displacement"}


def recognises(text):
    return any(_BLOCK.match(line) for _, line in text.header())


def read(text):
    """All blocks of all channels."""
    result, first = [], 1
    while True:
        at, block = text.search(_BLOCK, first)
        if not block:
            return result
        quantity = _QUANTITIES[(block[2] or block[4])[0].lower()]
        said = _UNIT.search(text.line(at), block.end())
        spelled = said[1].rstrip(".") if said else ""
        unit = spelled_unit(spelled)
        if unit is None or unit.quantity != quantity:
            text.refuse(at, f"give a unit of {quantity}")
        dt = number_of(block[3]) if block[3] else 1 / number_of(block[5])
        _, channel = text.search(_CHANNEL, first, at)
        name, station = text.search(_STATION, first, at)
        if channel or not result:  # the header of a channel; its further blocks have none
            component, number = (shortened(channel[2]), int(channel[1])) if channel else ("", 0)
        if station:
            place = " ".join((station[1], re.split(r"\s{2,}", text.line(name + 1).strip())[0]))
        elif not result:
            place = ""
        values, first = text.values(at + 1, int(block[1]), "points", column_width(text.line(at)))
        result.append(Series(values, dt, unit, spelled, component, number, place, text.line(2).strip()))
