"""K-NET and KiK-net (.NS, .EW, .UD, .NS1, ...): 17 lines of a header, then counts, which a factor of the header turns into gal.

    Sampling Freq(Hz) 100Hz
    Duration Time(s)  300
    Scale Factor      3920(gal)/6182761
"""

import re

from masonry._records.text import Series
from masonry._records.units import spelled_unit

NAME = "K-NET"

_KEYS = {"rate": r"^\s*Sampling Freq\w*\(Hz\)\s+([\d.]+)\s*(?:Hz)?\s*$", "length": r"^\s*Duration Time\(s\)\s+([\d.]+)\s*$",
         "factor": r"^\s*Scale Factor\s+([\d.]+)\s*\(([^)]*)\)\s*/\s*([\d.]+)\s*$", "direction": r"^\s*Dir\.\s+(\S.*?)\s*$",
         "station": r"^\s*Station Code\s+(\S+)\s*$", "origin": r"^\s*Origin Time\s+(\S.*?)\s*$"}
_DIRECTIONS = {"1": "N-S, in the borehole", "2": "E-W, in the borehole", "3": "U-D, in the borehole", "4": "N-S", "5": "E-W", "6": "U-D"}  # of KiK-net


def recognises(text):
    return sum(any(line.lstrip().startswith(key) for _, line in text.header()) for key in ("Scale Factor", "Sampling Freq", "Station Code")) >= 2


def read(text):
    end, _ = text.search(r"^\s*Memo\.?", 1, 40)
    found = {key: text.search(pattern, 1, end or 40) for key, pattern in _KEYS.items()}
    for key, must in (("rate", "Sampling Freq(Hz) 100Hz"), ("length", "Duration Time(s) 300"), ("factor", "Scale Factor 3920(gal)/6182761")):
        if not end or not found[key][1]:
            wrong, _ = text.search(rf"^\s*{re.escape(must.split()[0])}", 1, 40)
            text.refuse(wrong or 1, f"be, or be followed by, lines such as `{must}`, and by `Memo.`")
    said = {key: match and match[1] for key, (_, match) in found.items()}
    line, factor = found["factor"]
    unit = spelled_unit(factor[2])
    if unit is None or unit.quantity != "acceleration":
        text.refuse(line, "give a unit of acceleration in brackets, such as 3920(gal)/6182761")
    scale, divisor = (text.number(line, factor[k], "have a divisor above 0, and a factor") for k in (1, 3))
    rate, length = (text.number(found[key][0], said[key], "give a number above 0") for key in ("rate", "length"))
    counts, after = text.values(end + 1, round(min(rate * length, 1e9)), "the rate times Duration Time")
    text.end(after)
    return [Series(counts * (scale / divisor), 1 / rate, unit, factor[2], _DIRECTIONS.get(said["direction"], said["direction"] or ""),
                   station=said["station"] or "", title=said["origin"] or "")]
