"""What ObsPy reads (miniSEED, SAC, GSE2, ...), where it is installed. Its samples have no unit: they may be counts."""

import numpy as np

from masonry._records.text import Series
from masonry._records.units import named_unit

NAME = "ObsPy"


def read(path, unit=None):
    """One series for each trace."""
    try:
        import obspy
    except ImportError:
        raise ValueError(f"{path}: is no text file: must be unpacked, if it is compressed, or read by ObsPy, which is not installed "
                         "(python3 -m pip install obspy)") from None
    try:
        stream = obspy.read(str(path))
    except Exception as error:  # ObsPy's readers raise whatever they meet
        raise ValueError(f"{path}: ObsPy cannot read it ({str(error)[:100]}): must be a file of a format that masonry or ObsPy knows") from None
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
