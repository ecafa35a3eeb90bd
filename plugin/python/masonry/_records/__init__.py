"""Files of ground motions. Each reader says what it expected when it cannot read a file, and none guesses a unit."""

import os
from dataclasses import dataclass

from masonry._given import shown
from masonry._records import afad, cosmos, csmip, esm, knet, obspy_files, peer, smc, table
from masonry._records.text import Text, shortened
from masonry._records.units import QUANTITIES

# In this order: the first that recognises a file reads it.
_READERS = cosmos, csmip, smc, knet, esm, afad, peer


@dataclass(frozen=True)
class Source:
    """Where a record comes from: file, format, station, component, title, and the unit that the file states or the script has named."""

    file: str
    format: str
    station: str
    component: str
    unit: str
    title: str

    def __str__(self):
        where = " ".join(filter(None, (self.station, self.component)))
        return f"{self.format} file {self.file}: {where + ', ' if where else ''}unit {self.unit}"


def open_text(path):
    """The file's lines; None where it is no text."""
    with open(path, "rb") as file:
        content = file.read()
    if b"\0" in content:
        return None
    try:
        return Text(path, content.decode("utf-8-sig"))
    except UnicodeDecodeError:  # words may be of any encoding, numbers are not
        return Text(path, content.decode("latin-1"))


def read(path, component=None, quantity=None, unit=None, dt=None, columns=None):
    """(series, name of the format) of a file. Arguments as those of masonry.read_record."""
    if quantity is not None and quantity not in QUANTITIES:
        raise ValueError(f"quantity = {shown(quantity)}: must be one of {', '.join(QUANTITIES)}, or None")
    path = os.fspath(path)
    text = open_text(path)
    if text is None:
        return _one(path, obspy_files.read(path, unit), component, quantity), obspy_files.NAME
    reader = next((reader for reader in _READERS if reader.recognises(text)), None)
    if reader is None:
        try:
            series = table.read(text, unit, dt, _columns(text, component, columns))
        except ValueError as error:
            raise ValueError(f"{error}. (It is read as columns, because it has the header of no other format.)") from None
        return _one(path, series, None, quantity), table.NAME
    for name, value in (("unit", unit), ("dt", dt), ("columns", columns)):
        if value is not None:
            raise ValueError(f"{name} = {shown(value)}: must be left out for {path}, a {reader.NAME} file, which says it")
    return _one(path, reader.read(text), component, quantity), reader.NAME


def _columns(text, component, columns):
    """The columns of a text file, also where its component is named: that column, and the first one where that is the time."""
    if component is None:
        return columns
    if columns is not None:
        raise ValueError(f"component = {shown(component)}: must be left out where columns are given")
    names = table.names_of(text) or []
    if component not in names:
        raise ValueError(f"component = {shown(component)}: must be the name of a column in the first line of {text.path}, "
                         + (shown(names) if names else "which has none"))
    return (0, component) if names[0].lower().startswith("t") else component


def _matches(series, component):
    if isinstance(component, int) and not isinstance(component, bool):
        return series.number == component
    said, name = shortened(str(component)).lower(), shortened(series.component).lower()
    return said in (name, name.split(" ")[0], name.replace("-", ""))


def _one(path, found, component, quantity):
    """The series of that component and quantity: ValueError unless there is one. quantity None: acceleration where the file has it."""
    if component is not None:
        chosen = [series for series in found if _matches(series, component)]
        if not chosen:
            raise ValueError(f"component = {shown(component)}: must be one of those of {path}: {_listed(found)}")
        found = chosen
    quantities = [series.unit.quantity for series in found]
    if quantity is None:
        quantity = next((known for known in QUANTITIES if known in quantities), None)
    chosen = [series for series in found if series.unit.quantity == quantity]
    if not chosen:
        raise ValueError(f"quantity = {shown(quantity)}: must be one of those of {path}: {', '.join(sorted(set(quantities)))}")
    if len(chosen) > 1:
        raise ValueError(f"{path} has {len(chosen)} components: component= must say which: {_listed(chosen)}")
    return chosen[0]


def _listed(found):
    names = [(f"{series.number} " if series.number else "") + repr(shortened(series.component)) for series in found]
    return ", ".join(dict.fromkeys(names))


def source_of(path, series, name):
    return Source(os.path.basename(path), name, series.station, shortened(series.component), series.spelled, series.title)
