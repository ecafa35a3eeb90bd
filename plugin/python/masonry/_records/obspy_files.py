"""What ObsPy reads (miniSEED, SAC, GSE2, ...), where it is installed. Its samples have no unit: they may be counts."""

import numpy as np

from masonry._records.text import Series
from masonry._records.units import named_unit

NAME = "ObsPy"


def stream_of(path):
    """What ObsPy reads of the file; None where ObsPy is not installed or cannot read it."""
    try:
        import obspy
    except ImportError:
        return None
    try:
        return obspy.read(str(path))
    except Exception:  # ObsPy's readers raise whatever they meet
        return None


def read(path, stream, unit=None):
    """One series for each trace of the stream."""
    if stream is None:
        raise ValueError(f"{path}: is no text file: must be unpacked, if it is compressed, or be one that ObsPy reads, where it is installed "
                         "(python3 -m pip install obspy)")
    if unit is None:
        raise ValueError(f"{path}: unit = None: must be given for what ObsPy reads ('m/s^2', ...), once its samples have a unit and are not counts of the "
                         "recorder (obspy.Stream.remove_response)")
    of, names = named_unit(unit), [trace.stats.channel for trace in stream]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{path}: channel {name} has {names.count(name)} pieces: must have no gaps (obspy.Stream.merge)")
    result = []
    for trace in stream:
        if np.ma.isMaskedArray(trace.data):
            raise ValueError(f"{path}: channel {trace.stats.channel} has missing values: must have none")
        result.append(Series(np.asarray(trace.data, dtype=float), float(trace.stats.delta), of, unit, trace.stats.channel,
                             station=f"{trace.stats.network}.{trace.stats.station}", title=str(trace.stats.starttime)))
    return result
