"""SMC format of the U.S. Geological Survey (.smc): 11 lines of text, 48 integers in six lines, 50 reals in ten lines, comments, values.

The first line says the kind: 1 and 2 accelerations in cm/s^2, 3 velocities in cm/s, 4 displacements in cm, by the definition of the format. The first integer
and the first real stand for values that are not known. Integer 16 is the number of comments, 17 that of the values; real 2 is their number a second.
"""

import re

from masonry._given import is_whole
from masonry._records.text import NUMBER, Series, number_of, shortened
from masonry._records.units import named_unit

NAME = "SMC"

_KIND = re.compile(r"^\s*(\d)\s+(UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE SPECTRA|FOURIER\b.*|UNKNOWN)\s*$", re.IGNORECASE)
_WORDS = {"1": "UNCORRECTED ACCELEROGRAM", "2": "CORRECTED ACCELEROGRAM", "3": "VELOCITY", "4": "DISPLACEMENT"}
_UNITS = {"1": "cm/s^2", "2": "cm/s^2", "3": "cm/s", "4": "cm"}
_STATION = r"station\s*=\s*(.*?)\s*component\s*=\s*(.*?)\s*$"


def recognises(text):
    return bool(_KIND.match(text.line(1)))


def _header(text, first, lines, count, kind):
    found = [NUMBER.findall(text.line(number)) for number in range(first, first + lines)]
    for number, line in enumerate(found, first):
        if len(line) != count // lines or NUMBER.sub("", text.line(number)).strip():
            text.refuse(number, f"hold {count // lines} {kind} of the header")
    return [number_of(value) for line in found for value in line]


def read(text):
    kind, words = _KIND.match(text.line(1)).groups()
    if _WORDS.get(kind) != words.upper():
        text.refuse(1, "be 1 UNCORRECTED ACCELEROGRAM, 2 CORRECTED ACCELEROGRAM, 3 VELOCITY or 4 DISPLACEMENT")
    integers = _header(text, 12, 6, 48, "integers")
    reals = _header(text, 18, 10, 50, "reals")
    unknown = integers[0]
    comments, count = 0 if integers[15] == unknown else integers[15], integers[16]
    if not is_whole(comments, 0, 1e6):
        text.refuse(13, "end with the number of comments")
    if not is_whole(count, 2):
        text.refuse(14, "begin with the number of values, at least 2")
    comments = int(comments)
    if not 0 < reals[1] < min(1e5, abs(reals[0])):
        text.refuse(18, "give the values a second in its second place, above 0 and below 100000; without it, times and values at unequal steps stand in pairs, "
                        "which are not read")
    for number in range(28, 28 + comments):
        if not text.line(number).startswith("|"):
            text.refuse(number, f"be one of {comments} comments, which begin with |")
    values, after = text.values(28 + comments, int(count), "the number in line 14", width=10)
    text.end(after)
    _, place = text.search(_STATION, 1, 11)
    unit = _UNITS[kind]
    _refuse_unknown(text, values, reals[0], 28 + comments)
    station, component = (shortened(place[1]), shortened(place[2])) if place else (text.line(3).strip(), "")
    return [Series(values, 1 / reals[1], named_unit(unit), unit, component, station=station, title=text.line(4).strip(" *"))]


def _refuse_unknown(text, values, unknown, first):
    """ValueError where a value is the one that stands for those that are not known: 1.7E+38."""
    if not (abs(values) >= 0.99 * abs(unknown)).any():
        return
    at = next(number for number in range(first, len(text.lines) + 1)
              if any(abs(number_of(value)) >= 0.99 * abs(unknown) for value in NUMBER.findall(text.line(number))))
    text.refuse(at, f"hold values that are known; {unknown:g} stands for one that is missing")
