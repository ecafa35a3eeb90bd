"""Files of accelerograms. Each reader says what it expected when it cannot read a file."""

import math
import re

import numpy as np

from ._given import positive_given, shown

STANDARD_GRAVITY = 9.80665  # m/s^2
UNITS = ("m/s^2", "cm/s^2", "mm/s^2", "g")

# "stuck" negatives (1.2-3.4) are two numbers; an exponent sign is not a separator
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
# NPTS and DT of line 4, as they are named or, in older files, in this order before their names. Thousands may be parted by commas.
_COUNT, _STEP = r"(\d{1,3}(?:,\d{3})+|\d+)", rf"({_NUMBER.pattern})(?![-+.\d]|[A-Z][-+\d])"
_NAMED = re.compile(rf"(?=.*NPTS\s*=\s*{_COUNT})(?=.*DT\s*=\s*{_STEP}\s*([^\s,;]*))", re.IGNORECASE)
_COUNTED = re.compile(rf"\s*{_COUNT}[\s,]+{_STEP}\s*NPTS[\s,]+DT\s*(.*)", re.IGNORECASE)
_SECONDS = {**dict.fromkeys(("", "S", "SEC", "SECS", "SECOND", "SECONDS"), 1.0),
            **dict.fromkeys(("MS", "MSEC", "MSECS", "MILLISECOND", "MILLISECONDS"), 1e-3)}

# Where line 3 says its unit, and the units by their spelling without blanks, powers and brackets, as multiples of (g, m/s^2).
_UNIT_PLACES = [re.compile(pattern) for pattern in (r"\bUNITS?\b\s*(?:OF|ARE|IS|IN|:|=)?\s*(.+)", r"\bIN\s+(.+)", r"[(\[]([^()\[\]]+)[)\]]$", r"[,:=]\s*([^,:=]+)$")]
_SPELLINGS = {**dict.fromkeys(("G", "GS", "G'S", "GRAVITY", "STANDARDGRAVITY"), ("g", 1)),
              **dict.fromkeys(("G/10", "0.1G", ".1G"), ("g", 0.1)),
              **dict.fromkeys(("%G", "%OFG", "PERCENTG", "PERCENTOFG", "G/100", "0.01G", ".01G"), ("g", 0.01)),
              **dict.fromkeys(("M/S2", "M/S/S", "MS-2"), ("m/s^2", 1)),
              **dict.fromkeys(("CM/S2", "CM/S/S", "CMS-2", "GAL", "GALS"), ("cm/s^2", 1)),
              **dict.fromkeys(("MM/S2", "MM/S/S", "MMS-2"), ("mm/s^2", 1))}


def unit_factor(unit, gravity=STANDARD_GRAVITY):
    """What an acceleration in that unit is multiplied by, to have it in m/s^2."""
    factors = dict(zip(UNITS, (1.0, 1e-2, 1e-3, positive_given("gravity", gravity, ", in m/s^2"))))
    if unit not in UNITS:
        raise ValueError(f"unit = {shown(unit)}: must be one of {', '.join(UNITS)}")
    return factors[unit]


def _number(text):
    return float(text.upper().replace("D", "E"))


def _quoted(line):
    """A line of a file, for a message."""
    return repr(line if len(line) <= 80 else line[:77] + "...")


def _at2_factor(line, gravity):
    """What the samples are multiplied by, to have them in m/s^2, by line 3; None if it does not state a unit of acceleration."""
    text = re.sub(r"[.,;]?\s+FILTER\b.*", "", line.upper()).strip().rstrip(".,;")  # older files add the corners of their filter
    if re.search(r"VELOCIT|DISPLACEMENT|\bVEL\b|\bDISP\b", text):
        return None
    found = next(filter(None, (place.search(text) for place in _UNIT_PLACES)), None)
    if not found:
        return None
    spelling = re.sub(r"SECONDS?|SECS?\b|SEC(?=\d|\^|\*)", "S", found[1].replace("²", "2"))
    spelling = re.sub(r"SQUARED?\b|(?<=\d|S)\s*SQ\b", "2", spelling).replace(" PER ", "/")
    unit, share = _SPELLINGS.get(re.sub(r"[\s^*()\[\]]", "", spelling), (None, 0))
    return unit and share * unit_factor(unit, gravity)


def read_at2(path, gravity=STANDARD_GRAVITY):
    """(title, dt, samples in m/s^2) of a PEER NGA file: title in line 2, unit in line 3, NPTS and DT in line 4
    (NPTS= 4000, DT= .0050 SEC, in either order; older files: 4000 .0050 NPTS, DT). Exponents may be Fortran's (1.0D-02)."""
    with open(path, encoding="latin-1") as file:
        header = [file.readline().strip() for _ in range(4)]
        body = file.read()
    factor = _at2_factor(header[2], gravity)
    if factor is None:
        raise ValueError(f"{path}: line 3 is {_quoted(header[2])}: must state ACCELERATION in units of G, G/10, %G, CM/S^2, GAL or M/S^2")
    counted = _NAMED.match(header[3]) or _COUNTED.match(header[3])
    if not counted:
        raise ValueError(f"{path}: line 4 is {_quoted(header[3])}: must give NPTS and DT")
    unit = re.sub(r"^NPTS.*", "", counted[3].upper()).strip(" ()[].,;")
    if unit not in _SECONDS:
        raise ValueError(f"{path}: line 4 is {_quoted(header[3])}: must give DT in SEC or MSEC")
    words = re.findall(r"[^\s,\x1a]+", _NUMBER.sub(" ", body))  # files from DOS end with \x1a
    if words:
        raise ValueError(f"{path}: {_quoted(words[0])} stands among the values: must be numbers")
    samples, count = np.array([_number(text) for text in _NUMBER.findall(body)]), int(counted[1].replace(",", ""))
    if len(samples) != count:
        raise ValueError(f"{path}: {len(samples)} values: must be NPTS = {count}")
    return header[1], _SECONDS[unit] * _number(counted[2]), factor * samples


def _fields(line):
    """The columns of a line; None where commas part some of them and blanks others: then the commas may be decimal ones."""
    line = line.strip().rstrip(",").strip()
    if "," in line and re.search(r"[^\s,]\s+[^\s,]", line):
        return None
    return re.split(r"\s*,\s*|\s+", line)


def _table(path):
    """(names of the columns or None, rows of texts that are numbers, the lines' numbers)"""
    with open(path, encoding="utf-8-sig", errors="replace") as file:  # words may be of any encoding, numbers are not
        lines = [(number, line.strip()) for number, line in enumerate(file, 1) if line.strip() and line.lstrip()[0] not in "#%"]
    names = None
    if lines and not _NUMBER.fullmatch(re.split(r"[\s,]", lines[0][1])[0]):
        names = [name.strip(" \"'") for name in re.split(r"," if "," in lines[0][1] else r"\s+", lines[0][1])]
    rows = [(number, line, _fields(line)) for number, line in (lines if names is None else lines[1:])]
    for number, line, fields in rows:
        if not fields or not all(map(_NUMBER.fullmatch, fields)) or len(fields) != len(rows[0][2]):
            raise ValueError(f"{path}: line {number} is {_quoted(line)}: must be as many numbers as in the other lines, with decimal points, parted by commas "
                             "or by blanks; lines of words must start with # or %, but for the first")
    if len(rows) < 2:
        raise ValueError(f"{path}: {len(rows)} lines of numbers: must be at least two")
    return names, [fields for _, _, fields in rows], [number for number, _, _ in rows]


def _chosen(path, names, count, first, columns):
    """The places of the columns to read: (time, acceleration) or (acceleration,)."""
    if columns is None:
        if count > 2:
            raise ValueError(f"{path}: line {first} has {count} columns: columns=(time, acceleration) must say which, by number (from 0) or by name"
                             + (f" ({shown(names)})" if names and len(names) == count else ""))
        return tuple(range(count))
    chosen = tuple(columns) if isinstance(columns, (tuple, list)) else (columns,)
    places = [names.index(column) if names and column in names else column for column in chosen]
    if len(places) not in (1, 2) or not all(isinstance(place, (int, np.integer)) and 0 <= place < count for place in places):
        raise ValueError(f"columns = {shown(columns)}: must be acceleration or (time, acceleration), by number (0 to {count - 1}) or by the names in the "
                         f"first line of {path}" + (f", {shown(names)}" if names else ", which has none"))
    return tuple(places)


def _last_digits(texts):
    """The unit of the last digit of each number, all written with as many significant digits as the longest."""
    parts = [re.fullmatch(r"[-+]?(\d*)\.?(\d*)(?:[ED]([-+]?\d+))?", text.upper()).groups() for text in texts]
    longest = max(len((whole + decimals).lstrip("0")) for whole, decimals, _ in parts)
    finest = 10.0 ** min(int(exponent or 0) - len(decimals) for _, decimals, exponent in parts)
    return [max(finest, 10.0 ** (math.floor(math.log10(abs(t))) + 1 - longest) if t else 0) for t in map(_number, texts)]


def _step(path, texts, lines):
    """The step of the times, s: that of a straight line from the first to the last, where they keep to it within the rounding of their last
    digits (and a sample that is missing would not), or where their differences are equal to 1 in 1000."""
    time = np.array([_number(text) for text in texts])
    steps = np.diff(time)
    step = (time[-1] - time[0]) / len(steps)
    digit = max(_last_digits(texts))
    rounded = np.abs(time - time[0] - step * np.arange(len(time))).max() <= digit and 3 * digit <= step and digit <= 1e-3 * step * len(steps)
    if not (step > 0 and (rounded or np.allclose(steps, step, rtol=1e-3, atol=0))):
        worst = np.argmax(np.abs(steps - np.median(steps))) if np.median(steps) > 0 else 0
        raise ValueError(f"{path}: steps of time from {steps.min():g} to {steps.max():g} s: must be positive, and equal to 1 in 1000 or but for the rounding of "
                         f"the last digit; line {lines[worst + 1]} is {steps[worst]:g} s after the one before")
    return step


def read_csv(path, unit, dt=None, gravity=STANDARD_GRAVITY, columns=None):
    """(dt, samples in m/s^2) of a text file with comma or blank separated columns; lines starting with # or % and a first line of
    words are skipped. Two columns are time and acceleration, equally spaced; one column needs dt."""
    factor = unit_factor(unit, gravity)
    if dt is not None:
        positive_given("dt", dt, ", in s")
    names, rows, lines = _table(path)
    places = _chosen(path, names, len(rows[0]), lines[0], columns)
    samples = factor * np.array([_number(row[places[-1]]) for row in rows])
    if len(places) == 1:
        if dt is None:
            raise ValueError(f"{path}: dt = None: must be given (s) for a file of one column")
        return float(dt), samples
    step = _step(path, [row[places[0]] for row in rows], lines)
    if dt is not None and abs(dt / step - 1) > 1e-3:
        raise ValueError(f"dt = {dt}: must be the step of the file, {step} s")
    return step, samples
