"""Long loops: parts of many cases, and a progress bar. progress: True or False; None: a bar where stderr is a terminal, for in a log each state of it would
be a line."""

import sys

from ._optional import needs

# Cases of one call of the compiled functions: enough for all cores, few enough for the tables of their impacts to stay small.
_TOGETHER = 1024


def _bar():
    with needs("python3-tqdm", "a progress bar"):
        from tqdm import tqdm
    return tqdm


def wanted(progress):
    """Whether a bar is drawn."""
    return sys.stderr is not None and sys.stderr.isatty() if progress is None else bool(progress)


def steps(items, progress, name, unit="case"):
    """The items, with a progress bar if it is wanted."""
    if not wanted(progress):
        return items
    return _bar()(items, desc=name, unit=unit)


def chunks(cases, progress, name):
    """(begin, end) of parts of so many cases, with a progress bar if it is wanted."""
    parts = [(begin, min(begin + _TOGETHER, cases)) for begin in range(0, cases, _TOGETHER)]
    if not wanted(progress):
        yield from parts
        return
    with _bar()(total=cases, desc=name, unit="case") as bar:
        for begin, end in parts:
            yield begin, end
            bar.update(end - begin)
