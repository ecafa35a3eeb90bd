"""A text file of a record, by its lines, and what a reader finds in it."""

import math
import re
from dataclasses import dataclass

import numpy as np

from masonry._records.units import Unit

# "Stuck" negatives (1.2-3.4) are two numbers, and an exponent's sign is not a separator. Without a sign, a number cannot follow another at once: where columns
# are full (99.123456.654321) only the width of the columns can tell.
NUMBER = re.compile(r"(?:[-+]|(?<![\d.]))(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d{1,4})?")
# Lines of a header that are searched for what tells the format.
HEADER_LINES = 200


@dataclass
class Series:
    """One motion of a file, in the unit of the file."""

    values: np.ndarray
    dt: float  # s
    unit: Unit  # None: the file states none
    spelled: str = ""  # the unit, as the file spells it
    component: str = ""
    number: int = 0  # of the channel; 0: the file numbers none
    station: str = ""
    title: str = ""


def number_of(text):
    """The number that the text spells, with an exponent of Fortran (1.2D-3) or of C."""
    try:
        return float(text)
    except ValueError:
        return float(text.upper().replace("D", "E"))


def quoted(line):
    """A line of a file, for a message."""
    return repr(line if len(line) <= 80 else line[:77] + "...")


def shortened(text):
    """Without runs of blanks."""
    return " ".join(text.split())


def _words(line):
    """What stands in the line besides numbers."""
    return NUMBER.sub(" ", line).replace(",", " ").replace("\x1a", " ").split()  # files from DOS end with \x1a


def _parted(line, width):
    """The line with a blank after every column."""
    return " ".join(line[k:k + width] for k in range(0, len(line), width))


def column_width(line):
    """The width of the columns by the line's Fortran format, such as (8f10.6) or (10I8); 0: it has none."""
    found = re.search(r"\(\s*\d*\s*[FEDGI]\s*(\d{1,3})(?:\.\d+)?[ED]?\s*\)", line, re.IGNORECASE)
    return int(found[1]) if found else 0


class Text:
    """The lines of a file. Numbers of lines count from 1, as editors do."""

    def __init__(self, path, content):
        # Files that came through several systems end their lines with CR LF, CR CR LF or CR, also mixed.
        self.path = path
        self.lines = re.sub(r"\r*\n|\r", "\n", content).split("\n")

    def line(self, number):
        """The text of a line; '' past the end."""
        return self.lines[number - 1] if 1 <= number <= len(self.lines) else ""

    def header(self):
        """(number, text) of the lines in which a format can be told."""
        return enumerate(self.lines[:HEADER_LINES], 1)

    def search(self, pattern, first=1, last=None):
        """(number of the line, match) of the first line in which the pattern is found; (0, None): in none."""
        pattern = re.compile(pattern, re.IGNORECASE) if isinstance(pattern, str) else pattern
        for number in range(first, min(len(self.lines), last or len(self.lines)) + 1):
            found = pattern.search(self.lines[number - 1])
            if found:
                return number, found
        return 0, None

    def refuse(self, number, must):
        """Raises the error that names a line of the file."""
        raise ValueError(f"{self.path}: line {number} is {quoted(self.line(number).strip())}: must {must}")

    def number(self, number, text, must):
        """The number that a part of a line spells; ValueError with the line unless it is positive and finite. must: what the line must do."""
        if not NUMBER.fullmatch(text) or not 0 < number_of(text) < math.inf:
            self.refuse(number, must)
        return number_of(text)

    def unread(self, first, last=None):
        """The numbers of the lines from `first` to `last` (None: the end of the file) that rows of numbers follow: lines of words, and a row of numbers with no words
        above it."""
        found, above = [], 0
        for number in range(first, 1 + (len(self.lines) if last is None else last)):
            if _words(self.line(number)):
                above = number
            elif NUMBER.search(self.line(number)):
                above = above or number
                if above not in found[-1:]:
                    found.append(above)
        return found

    def end(self, first):
        """ValueError with its line where values follow from the line `first` on, which no reader understands."""
        for number in self.unread(first):
            self.refuse(number, "not be followed by values: those of the motion have ended above it")

    def values(self, first, count, name, width=0):
        """(the `count` numbers that stand from the line `first` on, the number of the line after them). ValueError with its line unless there are so many
        until the next words or the end of the file. name: how the file calls their number. width: of the columns, where the file states it."""
        found, number = [], first
        while number <= len(self.lines):
            line = self.lines[number - 1]
            words = _words(line)
            if words and width and not _words(_parted(line, width)):
                line, words = _parted(line, width), []
            if words and len(found) >= count:
                break
            if words:
                word = next(word for word in re.split(r"[\s,]+", line) if _words(word))
                raise ValueError(f"{self.path}: line {number}: {quoted(word)} stands among the values: must be numbers, {name} = {count} of them, and comes "
                                 f"after {len(found)}")
            found += NUMBER.findall(line)
            number += 1
        if len(found) != count:
            raise ValueError(f"{self.path}: lines {first} to {number - 1} hold {len(found)} values: must be {name} = {count}")
        values = np.array([number_of(text) for text in found])
        if not np.isfinite(values).all():
            number = next((k for k in range(first, number) if any(math.isinf(number_of(text)) for text in NUMBER.findall(self.line(k)))), first)
            self.refuse(number, "hold numbers below 1.8e308")
        return values, number
