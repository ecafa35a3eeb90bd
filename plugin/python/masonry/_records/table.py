"""Text files of columns: comma or blank separated, with lines of words that start with # or % and a first line of words. Also values that run on
from line to line."""

import math
import re

import numpy as np

from masonry._given import positive_given, shown
from masonry._records.text import NUMBER, Series, number_of, quoted
from masonry._records.units import named_unit, spelled_unit

NAME = "text"


# Commas part some columns and blanks others.
_MIXED = re.compile(r"[^\s,]\s+[^\s,]")
_BRACKETS = re.compile(r"[(\[]([^()\[\]]+)[)\]]\s*$")
_SECONDS = "s", "sec", "secs", "second", "seconds"
_PARTS = re.compile(r"[-+]?(\d*)\.?(\d*)(?:[ED]([-+]?\d+))?")


def _fields(line):
    """The columns of a line; None where commas part some of them and blanks others: then the commas may be decimal ones."""
    if "," not in line:
        return line.split()
    line = line.rstrip(",").strip()
    return None if _MIXED.search(line) else [field.strip() for field in line.split(",")]


def _lines(text):
    """[(number, text)] of the lines that hold something."""
    return [(number, line.strip()) for number, line in enumerate(text.lines, 1) if line.strip() and line.lstrip()[0] not in "#%"]


def names_of(text, lines=None):
    """Names of the columns, which the first line gives; None: it gives numbers."""
    lines = _lines(text) if lines is None else lines
    if not lines or NUMBER.fullmatch(re.split(r"[\s,]", lines[0][1])[0]):
        return None
    line = lines[0][1].rstrip(" ,")
    return [name.strip(" \"'") for name in re.split(r"," if "," in line else r"\s+", line)]


def _is_number(field):
    return NUMBER.fullmatch(field) and math.isfinite(number_of(field))


def _rows(text, even):
    """(names of the columns, or None where the first line does not name each; rows of texts that are numbers; the lines' numbers). even: all rows have as many."""
    path, lines = text.path, _lines(text)
    names = names_of(text, lines)
    rows = [(number, line, _fields(line)) for number, line in (lines if names is None else lines[1:])]
    for name in names or ():
        if NUMBER.fullmatch(name) and not name.isdecimal():  # names may be directions, such as 360
            raise ValueError(f"{path}: line {lines[0][0]} is {quoted(lines[0][1])}: must be numbers, or words that name the columns")
    for number, line, fields in rows:
        if not fields or not all(map(_is_number, fields)) or even and len(fields) != len(rows[0][2]):
            raise ValueError(f"{path}: line {number} is {quoted(line)}: must be as many numbers as in the other lines, with decimal points, parted by commas "
                             "or by blanks; lines of words must start with # or %, but for the first")
    if sum(len(fields) for _, _, fields in rows) < 2 or even and len(rows) < 2:
        raise ValueError(f"{path}: {len(rows)} lines of numbers: must be at least two")
    return names if len(names or ()) == len(rows[0][2]) else None, [fields for _, _, fields in rows], [number for number, _, _ in rows]


def _chosen(path, names, count, first, columns):
    """The places of the columns to read: (time, value) or (value,)."""
    if columns is None:
        if count > 2:
            raise ValueError(f"{path}: line {first} has {count} columns: columns=(time, acceleration) must say which, by number (from 0) or by name"
                             + (f" ({shown(names)})" if names else "")
                             + ", or component= the name of one; columns='all' where values run on from line to line")
        return tuple(range(count))
    chosen = tuple(columns) if isinstance(columns, (tuple, list)) else (columns,)
    places = [names.index(column) if names and column in names else column for column in chosen]
    if len(places) not in (1, 2) or len(set(places)) < len(places) or not all(isinstance(place, (int, np.integer)) and 0 <= place < count for place in places):
        raise ValueError(f"columns = {shown(columns)}: must be acceleration or (time, acceleration), two columns, by number (0 to {count - 1}) or by the names in the "
                         f"first line of {path}" + (f", {shown(names)}" if names else ", which has none for each column"))
    return tuple(places)


def last_digits(texts, values):
    """The unit of the last digit of each number, all written with as many significant digits as the longest."""
    parts = [_PARTS.fullmatch(text.upper()).groups() for text in texts]
    longest = max(len((whole + decimals).lstrip("0")) for whole, decimals, _ in parts)
    finest = _power(min(int(exponent or 0) - len(decimals) for _, decimals, exponent in parts))
    return [max(finest, _power(math.floor(math.log10(abs(t))) + 1 - longest) if t else 0) for t in values]


def _power(exponent):
    """A power of ten, infinite where it is too large for a number."""
    return float(f"1e{exponent}")


def _step(path, texts, lines):
    """The step of the times, s: that of a straight line from the first to the last, where they keep to it within the rounding of their last
    digits (and a sample that is missing would not), or where their differences are equal to 1 in 1000."""
    time = np.array([number_of(text) for text in texts])
    steps = np.diff(time)
    step = (time[-1] - time[0]) / len(steps)
    digit = max(last_digits(texts, time))
    rounded = np.abs(time - time[0] - step * np.arange(len(time))).max() <= digit and 3 * digit <= step and digit <= 1e-3 * step * len(steps)
    if not (step > 0 and (rounded or np.allclose(steps, step, rtol=1e-3, atol=0))):
        worst = np.argmax(np.abs(steps - np.median(steps))) if np.median(steps) > 0 else 0
        raise ValueError(f"{path}: steps of time from {steps.min():g} to {steps.max():g} s: must be positive, and equal to 1 in 1000 or but for the rounding of "
                         f"the last digit; line {lines[worst + 1]} is {steps[worst]:g} s after the one before")
    return step


def _unit(path, unit, name):
    """The unit that the script names, or that the name of the column has in brackets."""
    said = _BRACKETS.search(name)
    known = spelled_unit(said[1]) if said else None
    if unit is None and known is None:
        raise ValueError(f"{path}: unit = None: must be given for a text file of columns (unit='g', 'm/s^2', ...), whose first line names none in brackets")
    if unit is not None and known not in (None, named_unit(unit)):
        raise ValueError(f"{path}: unit = {shown(unit)}: must be left out, or that of the first line, {said[1]}")
    return (known, said[1]) if unit is None else (named_unit(unit), unit)


def read(text, unit=None, dt=None, columns=None):
    """The one series of the chosen columns. unit: its name; None: the one in brackets behind the column's name. Two columns are time and value, equally
    spaced; one column, or columns='all', needs dt."""
    path, together = text.path, isinstance(columns, str) and columns == "all"
    if unit is not None:
        named_unit(unit)
    if dt is not None:
        positive_given("dt", dt, ", in s")
    names, rows, lines = _rows(text, even=not together)
    if together and (names is None or "all" not in names):
        values, places, name = [value for row in rows for value in row], (0,), ""
    else:
        places = _chosen(path, names, len(rows[0]), lines[0], columns)
        values = [row[places[-1]] for row in rows]
        name = names[places[-1]] if names else ""
    of, spelled = _unit(path, unit, name)
    if len(places) == 1:
        if dt is None:
            raise ValueError(f"{path}: dt = None: must be given (s) for a file of one column")
        step = float(dt)
    else:
        said = names and _BRACKETS.search(names[places[0]])
        if said and said[1].strip().lower() not in _SECONDS:
            raise ValueError(f"{path}: the column of the times is named {shown(names[places[0]])}: must be in seconds, (s)")
        step = _step(path, [row[places[0]] for row in rows], lines)
        if dt is not None and abs(dt / step - 1) > 1e-3:
            raise ValueError(f"dt = {dt}: must be the step of the file, {step} s")
    return [Series(np.array([number_of(value) for value in values]), step, of, spelled, name)]
