"""Volumes 1 and 2 of the California network (CSMIP, .V1 and .V2): one or several channels, each with a header and its blocks of values.

A line above each block says how many values follow, their step and their unit:
    12000 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)
    13200 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)
The accelerations of a channel come first, velocities and displacements after them.
"""

import re

from masonry._records.text import Series, column_width, shortened
from masonry._records.units import spelled_unit

NAME = "CSMIP V1/V2"

_NUMBER = r"(\d*\.?\d+(?:E[-+]?\d+)?)"
_BLOCK = re.compile(rf"^\s*(\d{{1,9}})\s+(?:points of (accel|veloc|displ)\w* data equally[- ]spaced at\s*{_NUMBER}\s*sec|"
                    rf"(accel)erogram points at\s*{_NUMBER}\s*(?:pts|points|samples)/sec)", re.IGNORECASE)
_UNIT = re.compile(r"(?:\bunits?\s*(?:of|:|=)|\bin(?!\s+units))\s*([^\s(),;]+)", re.IGNORECASE)
_CHANNEL = r"\bchan(?:nel)?\.?\s*(\d{1,9})\s*:\s*(\S.*?)\s*(?:\s{2}|\bfrom\b|$)"
_STATION = r"^\s*Station No\.?\s*(\S+)"
_QUANTITIES = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_MUST = ("say how many values of accel, veloc or displ data follow, their step and their unit, such as '12000 points of accel data equally spaced at .005 sec, in "
         "cm/sec2', or stand in the header of a channel, such as 'Chan  1: 90 Deg'")


def recognises(text):
    return any(_BLOCK.match(line) for _, line in text.header())


def _header(text, first, at):
    """The match of the channel in the lines from `first` to before `at`, where a block begins; None where they have none. ValueError for values, or a second
    channel, whose block has not been understood."""
    named, channel = text.search(_CHANNEL, first, at)
    if first > 1:
        _refuse_unread(text, first, (named or at) - 1)
    number, other = named, channel
    while other:
        if other[1] != channel[1]:
            _refuse_unread(text, named, number)
            text.refuse(number, f"not begin another channel: channel {channel[1]} has no values above it")
        number, other = text.search(_CHANNEL, number + 1, at)
    return channel


def _refuse_unread(text, first, last):
    for number in text.unread(first, last)[-1:]:
        text.refuse(number, _MUST)


def read(text):
    """All blocks of all channels."""
    result, first, known = [], 1, []
    while True:
        at, block = text.search(_BLOCK, first)
        if not block:
            _refuse_unread(text, first, len(text.lines))
            return result
        quantity = _QUANTITIES[(block[2] or block[4])[0].lower()]
        channel = _header(text, first, at)
        if channel:
            known = []
        if quantity in known or not known and quantity != "acceleration":
            text.refuse([at, *text.unread(first, at - 1)][-1], _MUST + "; accelerations come first, and each quantity once")
        known.append(quantity)
        said = _UNIT.search(text.line(at), block.end())
        spelled = said[1].rstrip(".") if said else ""
        unit = spelled_unit(spelled)
        if unit is None or unit.quantity != quantity:
            text.refuse(at, f"give a unit of {quantity}")
        step = text.number(at, block[3] or block[5], "give a step, or a number of points a second, above 0")
        dt = step if block[3] else 1 / step
        name, station = text.search(_STATION, first, at)
        if channel or not result:  # the header of a channel; its further blocks have none
            component, number = (shortened(channel[2]), int(channel[1])) if channel else ("", 0)
        if station:
            place = " ".join((station[1], re.split(r"\s{2,}", text.line(name + 1).strip())[0]))
        elif not result:
            place = ""
        values, first = text.values(at + 1, int(block[1]), "points", column_width(text.line(at)))
        result.append(Series(values, dt, unit, spelled, component, number, place, text.line(2).strip()))
