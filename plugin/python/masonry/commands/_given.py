"""What several commands read and write: lists of numbers, records, sizes of a block."""

import argparse
import math
from pathlib import Path

import numpy as np

from .._given import shown

NUMBERS = "numbers: 0.5, or 0.4,0.6,1.2, or 0.5:4:20 (20 from 0.5 to 4 at equal steps), or 0.1:10:20:log (at equal factors)"


# Numbers of one list.
_MOST = 10**6


def _number(text):
    value = float(text)
    if not math.isfinite(value):
        raise ValueError
    return value


def numbers(text):
    """A number, or an array of the numbers that the text lists."""
    try:
        if ":" in text:
            first, last, count, *log = text.split(":")
            if log not in ([], ["log"]) or not 2 <= int(count) <= _MOST:
                raise ValueError
            return (np.geomspace if log else np.linspace)(_number(first), _number(last), int(count))
        values = [_number(word) for word in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{shown(text)} is no list of numbers: write 0.5, or 0.4,0.6,1.2, or 0.5:4:20, or 0.1:10:20:log, at most a million") from None
    return values[0] if len(values) == 1 else np.array(values)


def add_records(parser, nargs, more=""):
    parser.add_argument("records", nargs=nargs, type=Path, metavar="RECORD", help=f"file of a record, of any format that masonry.read_record knows{more}")
    parser.add_argument("--component", help="of files with several: its name, direction or number")
    parser.add_argument("--unit", help="of text files of columns: m/s^2, cm/s^2, mm/s^2 or g")
    parser.add_argument("--dt", type=float, help="s between the samples of text files without times")
    parser.add_argument("--quantity", default="acceleration", choices=("acceleration", "velocity", "displacement"),
                        help="what is read (default: acceleration)")
    parser.add_argument("--baseline", default="constant", choices=("none", "constant", "linear", "high-pass"),
                        help="what is subtracted from accelerations (default: constant, their mean, so that the base comes to rest)")
    parser.add_argument("--corner", type=float, help="Hz, of the baseline high-pass: what is slower is subtracted")
    parser.add_argument("--order", type=int, help="of that filter (default: 2)")


def read_records(given):
    from masonry import read_record

    baseline = given.baseline if given.quantity == "acceleration" else "none"
    filtered = {} if given.order is None else {"order": given.order}
    if given.corner is None and baseline == "high-pass":
        raise ValueError("--corner: must be given, in Hz, with --baseline high-pass")
    if given.corner is not None and baseline != "high-pass":
        raise ValueError(f"--corner {given.corner:g}: must be left out without --baseline high-pass")
    if given.order is not None and baseline != "high-pass":
        raise ValueError(f"--order {given.order}: must be left out without --baseline high-pass")
    return [read_record(path, given.component, given.quantity, unit=given.unit, dt=given.dt, baseline=baseline, corner=given.corner, **filtered)
            for path in given.records]


def add_output(parser, name):
    parser.add_argument("-o", "--output", type=Path, default=Path(name), metavar="NAME", help=f"NAME.csv and NAME.png are written (default: {name})")
    parser.add_argument("--quiet", action="store_true", help="no progress bar, which is drawn only where stderr is a terminal")


def progress(given):
    return False if given.quiet else None


def write(result, given, **picture):
    """CSV and PNG of a result, and a line that names them."""
    table, image = (given.output.with_name(given.output.name + ending) for ending in (".csv", ".png"))
    result.to_csv(table)
    result.plot(image, **picture)
    print(f"masonry: wrote {table} and {image}")
