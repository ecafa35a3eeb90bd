"""COSMOS strong-motion data format 1.x (.V1, .V1c, .V2, .V2c): one or several records, each with text, integers, reals, comments and values.

Consortium of Organizations for Strong Motion Observation Systems, Strong Motion Data Format, version 1.20 (2001). Real header 62 is the step in ms, 34 that of
the recorder in s; the line above the values gives their number and their length in whole seconds, with which the step must agree.
"""

import re

from masonry._records.text import Series, column_width, shortened
from masonry._records.units import spelled_unit

NAME = "COSMOS"

_START = re.compile(r"\(Format\s+v\s*[\d.]+\s+with\s+(\d+)\s+text\s+lines?\)", re.IGNORECASE)
_HEADER = re.compile(r"^\s*(\d{1,9})\s+(Integer|Real)-header values follow on\s*(\d+)\s+lines?", re.IGNORECASE)
_BLOCK = re.compile(r"^\s*(\d{1,9})\s+(?:\w+\s+)*(\w+)\.?\s+pts,\s*approx\s*(\d{1,9}\.?\d*)\s*secs?,\s*units\s*=\s*([^,]+?)\s*(?:\(\s*(\d{1,9})\s*\))?\s*,", re.IGNORECASE)
_COMMENTS = re.compile(r"^\s*\d+\s+Comment\s+line|^\s*\|", re.IGNORECASE)
_CHANNEL = r"^\s*Sta\s+Chan\s*(\S{1,9})\s*:\s*(.*?)\s*(?:\(Rcrdr|Location|$)"
_STATION = r"^\s*Statn No:\s*(.*?)\s*$"
_CODES = r"<SCNL>\s*([^\s.]+)\.([^\s.]+)"
# Units by their numbers, table 2 of the format, and what a script would write for them.
_UNITS = {2: "g", 4: "cm/s^2", 5: "cm/s", 6: "cm"}


def recognises(text):
    return any(_START.search(line) for _, line in text.header())


def read(text):
    """All records of the file."""
    result, first = [], 1
    while True:
        start, begun = text.search(_START, first)
        for number in text.unread(first, start - 1 if begun else None):
            text.refuse(number, "stand in a record, which begins with a line such as 'Corrected acceleration (Format v01.20 with 13 text lines)'")
        if not begun:
            return result
        series, first = _record(text, start)
        result.append(series)


def _headers(text, start):
    """(real-header values, number of the line that announces the values of the motion)"""
    last = text.search(_START, start + 1)[0] or None  # of another record
    number, found = text.search(_HEADER, start, last)
    while found and found[2].lower() != "real":
        number, found = text.search(_HEADER, number + 1, last)
    if not found:
        text.refuse(start, "be followed by a line such as '100 Real-header values follow on  20 lines, Format= (5F15.6)'")
    reals, at = text.values(number + 1, int(found[1]), "real-header values", column_width(text.line(number)))
    while at < len(text.lines) and (_COMMENTS.match(text.line(at)) or not text.line(at).strip()):
        at += 1
    return reals, at


def _step(text, reals, at, count, seconds):
    """The step that agrees with the length of the values, s."""
    known = [(f"real-header value {place}", reals[place - 1] * scale) for place, scale in ((62, 1e-3), (34, 1.0)) if len(reals) >= place and reals[place - 1] > 0]
    for _, dt in known:
        if abs(count * dt - seconds) <= 1 + 0.01 * seconds:
            return dt
    text.refuse(at, "agree with the step of the header" + (f", {', '.join(f'{name} ({dt:g} s)' for name, dt in known)}" if known else ", which gives none"))


def _record(text, start):
    """(series, number of the line after it)"""
    reals, at = _headers(text, start)
    block = _BLOCK.match(text.line(at))
    if not block:
        text.refuse(at, "be a comment, which begins with |, or a line such as '12000 acceleration pts, approx 60 secs, units=cm/s^2(04),Format=(8F10.5)'")
    code, spelled = int(block[5] or 0), shortened(block[4])
    unit = spelled_unit(spelled)
    if unit is None or not block[2].lower().startswith(unit.quantity[:5]) or code and spelled_unit(_UNITS.get(code, "")) != unit:
        text.refuse(at, "give values in a unit of acceleration, velocity or displacement (2: g, 4: cm/s^2, 5: cm/s, 6: cm), "
                        "not counts, which only the network can convert")
    dt = _step(text, reals, at, int(block[1]), float(block[3]))
    values, after = text.values(at + 1, int(block[1]), "pts", column_width(text.line(at)))
    _, channel = text.search(_CHANNEL, start, at)
    _, station = text.search(_STATION, start, at)
    _, codes = text.search(_CODES, start, at)
    component = shortened(channel[2]) if channel else ""
    if codes and component.lower() in ("", "other", "unknown"):
        component = codes[2]
    number = int(channel[1]) if channel and channel[1].isdecimal() else 0
    return Series(values, dt, unit, spelled, component, number, shortened(station[1]) if station else "", text.line(start + 1).strip()), after
