"""The report of a history: one HTML file that opens in a browser without a network."""

import datetime
from pathlib import Path

from masonry._files import written
from masonry._given import shown
from masonry.history import History
from masonry.results.wall_history import WallHistory

from . import single_block, structure, view3d

_HERE = Path(__file__).parent


def report(history, path, title="", exact=None):
    """Writes the report of a history, one .html file: what was run, how much of the motion, the verdict and the warnings in words, a 3D view that
    turns and plays, curves of drift, excursion, joints and energies, and the impacts. The file needs no network.

    history    a WallHistory; or a masonry.History of one block: its rotation beside the exact solution, and the phase plane
    path       must end in .html
    title      heading; without it, the name of the script or of the block
    exact      of a WallHistory with one free block: the masonry.History to compare its rotation with; None: no comparison

    The 3D view needs the library three.js (Debian: libjs-three) when the report is written; without it, the report says so in its place. Raises
    ImportError where jinja2 (Debian: python3-jinja2) is missing and ValueError for input out of its range.
    """
    if not str(path).endswith(".html"):
        raise ValueError(f"path = {path}: must end in .html")
    if exact is not None and not (isinstance(exact, History) and exact.shape == ()):
        raise ValueError(f"exact = {shown(exact)}: must be the masonry.History of one block, or None")
    made = template("report.html")
    if isinstance(history, WallHistory):
        content = structure.content(history, exact)
    elif isinstance(history, History) and exact is None:
        content = single_block.content(history)
    else:
        raise ValueError(f"history = {shown(history)}: must be a WallHistory, or a masonry.History without `exact`")
    content["title"] = title or content["title"]
    page = made.render(**content, **view3d.library(), style=text("report.css"), viewer=text("viewer.js"),
                       written=datetime.date.today().isoformat())
    with written(path) as beside:
        Path(beside).write_text(page, encoding="utf-8")


def text(name):
    """Content of a file beside the template."""
    return (_HERE / name).read_text(encoding="utf-8")


def template(name):
    """The template of that name; ImportError where jinja2 is missing."""
    try:
        import jinja2
    except ImportError:
        raise ImportError("results.report needs jinja2: apt install python3-jinja2") from None
    return jinja2.Environment(loader=jinja2.FileSystemLoader(_HERE), autoescape=True, trim_blocks=True, lstrip_blocks=True).get_template(name)
