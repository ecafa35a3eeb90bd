"""Files of accelerograms. Each reader says what it expected when it cannot read a file."""

import re

import numpy as np

from ._given import positive_given

# "stuck" negatives (1.2-3.4) are two numbers; an exponent sign is not a separator
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
# NPTS and DT of line 4, as they are named or, in older files, in this order before their names. Thousands may be parted by commas.
_COUNT, _STEP = r"(\d{1,3}(?:,\d{3})+|\d+)", rf"({_NUMBER.pattern})(?![-+.\d]|[A-Z][-+\d])"
_NAMED = re.compile(rf"(?=.*NPTS\s*=\s*{_COUNT})(?=.*DT\s*=\s*{_STEP})", re.IGNORECASE)
_COUNTED = re.compile(rf"\s*{_COUNT}[\s,]+{_STEP}\s*NPTS", re.IGNORECASE)


def _number(text):
    return float(text.upper().replace("D", "E"))


def read_at2(path):
    """(title, dt, samples in g) of a PEER NGA file: title in line 2, unit in line 3, NPTS and DT in line 4
    (NPTS= 4000, DT= .0050 SEC, in either order; older files: 4000 .0050 NPTS, DT). Exponents may be Fortran's (1.0D-02)."""
    with open(path, encoding="latin-1") as file:
        header = [file.readline().strip() for _ in range(4)]
        body = file.read()
    if not re.search(r"\bG\b", header[2].upper()):
        raise ValueError(f"{path}: line 3 is {header[2]!r}: must state ACCELERATION in units of G")
    counted = _NAMED.match(header[3]) or _COUNTED.match(header[3])
    if not counted:
        raise ValueError(f"{path}: line 4 is {header[3]!r}: must give NPTS and DT")
    words = re.findall(r"[^\s,\x1a]+", _NUMBER.sub(" ", body))  # files from DOS end with \x1a
    if words:
        raise ValueError(f"{path}: {words[0]!r} stands among the values: must be numbers")
    samples, count = np.array([_number(text) for text in _NUMBER.findall(body)]), int(counted[1].replace(",", ""))
    if len(samples) != count:
        raise ValueError(f"{path}: {len(samples)} values: must be NPTS = {count}")
    return header[1], _number(counted[2]), samples


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_csv(path, unit, dt=None, gravity=9.80665):
    """(dt, samples in m/s^2) of a text file with comma or blank separated columns; lines starting with # and a first line of
    words are skipped. Two columns are time and acceleration, equally spaced; one column needs dt."""
    factors = {"m/s^2": 1.0, "cm/s^2": 1e-2, "mm/s^2": 1e-3, "g": gravity}
    if unit not in factors:
        raise ValueError(f"unit = {unit!r}: must be one of {', '.join(factors)}")
    positive_given("gravity", gravity, ", in m/s^2")
    if dt is not None:
        positive_given("dt", dt, ", in s")
    with open(path, encoding="utf-8-sig", errors="replace") as file:  # words may be of any encoding, numbers are not
        lines = [(number, line.replace(",", " ").split()) for number, line in enumerate(file, 1) if line.strip() and not line.startswith("#")]
    if lines and not _is_number(lines[0][1][0]):
        lines = lines[1:]
    for number, line in lines:
        if not all(map(_is_number, line)) or len(line) != len(lines[0][1]):
            raise ValueError(f"{path}: line {number} is {' '.join(line)!r}: must be as many numbers as in the other lines, parted by commas or blanks; "
                             "lines of words must start with #, but for the first")
    table = np.array([line for _, line in lines], dtype=float)
    if table.ndim != 2 or table.shape[1] not in (1, 2) or len(table) < 2:
        raise ValueError(f"{path}: table of shape {table.shape}: must have one or two columns and at least two rows")
    if table.shape[1] == 1:
        if dt is None:
            raise ValueError(f"{path}: dt = None: must be given (s) for a file of one column")
        return float(dt), factors[unit] * table[:, 0]
    time = table[:, 0]
    step = (time[-1] - time[0]) / (len(time) - 1)
    if not (step > 0 and np.allclose(np.diff(time), step, rtol=1e-3, atol=0)):
        raise ValueError(f"{path}: steps of time from {np.diff(time).min():g} to {np.diff(time).max():g} s: must be positive, and equal to 1 in 1000")
    if dt is not None and abs(dt / step - 1) > 1e-3:
        raise ValueError(f"dt = {dt}: must be the step of the file, {step} s")
    return step, factors[unit] * table[:, 1]
