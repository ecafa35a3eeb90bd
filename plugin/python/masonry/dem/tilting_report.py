"""The report page of a collapse multiplier."""

import datetime
from pathlib import Path

from masonry._files import written
from masonry.results.reporting import curves, template, text, words

# Rows of the table of joints: those that moved most.
_JOINTS = 40
_VERDICTS = {"rest": "the blocks stand", "collapse": "collapse", "jammed": "blocks move and jam: taken for collapse", "stretched": "ties have stretched: taken for collapse",
             "unclear": "still moving: taken for collapse", "missed": "contact laws missed: half the stair is tried"}


def write(collapse, path, title):
    """Writes the page of a dem.tilting.Collapse, one .html file."""
    if not str(path).endswith(".html"):
        raise ValueError(f"path = {path}: must end in .html")
    joints = collapse.joints[(-collapse.joints["opening"] - collapse.joints["slip"]).argsort(kind="stable")]
    joints = joints[joints["opens"] | joints["slides"]]
    rows = [(f"{j['id1']} – {j['id2']}", "opens" * bool(j["opens"]), "slides" * bool(j["slides"]), f"{1e3 * j['opening']:.4f}", f"{1e3 * j['slip']:.4f}") for j in joints[:_JOINTS]]
    trials = [(f"{t.multiplier:.5g}", _VERDICTS[t.verdict], f"{1e3 * t.moved:.3g}", f"{t.time:.3g}", str(t.failures)) for t in collapse.trials]
    low, high = collapse.bracket
    about = collapse.about
    sections = [
        {"name": "mechanism", "heading": "Mechanism", "figure": curves.plain_svg(collapse.figure("")),
         "caption": "The blocks at the end of the trial that is drawn, their movement magnified; red: joints that open, blue: joints that slide and stay closed."},
        {"name": "joints", "heading": "Joints of the mechanism", "caption": f"{len(joints)} joints open or slide.", "rows": rows, "fold": "Table of joints",
         "columns": ["Blocks", "", "", "Opening (mm)", "Slip (mm)"], "more": f"The {len(rows)} that moved most, by how far when the trial ended."},
        {"name": "trials", "heading": "Trials", "caption": f"{len(trials)} loads have been tried.", "rows": trials, "fold": "Table of trials",
         "columns": ["Multiplier", "Verdict", "Moved (mm)", "Time (s)", "Failures"], "more": "Each load is put on from the largest one that the blocks have stood."}]
    numbers = [("Collapse multiplier", f"{collapse.multiplier:.5g}", ""), ("Largest that stands, least that does not", f"{low:.5g}, {high:.5g}", ""),
               ("Blocks that move", str(len(collapse.blocks)), ""), ("Joints that open", str(int(collapse.joints["opens"].sum())), ""),
               ("Joints that slide and stay closed", str(int((collapse.joints["slides"] & ~collapse.joints["opens"]).sum())), "")]
    content = {"title": title or about.get("script") or "Tilting table", "kind": "unfinished" if collapse.doubts else "collapsed",
               "headline": f"Collapse multiplier {collapse.multiplier:.4g}", "sentences": [f"{one[0].upper()}{one[1:]}." for one in collapse.remarks],
               "warnings": [f"Not to be trusted: {doubt}." for doubt in collapse.doubts], "scene": None, "library": None, "numbers": numbers, "sections": sections,
               "facts": words.facts(about), "solver": [], "known": True}
    page = template("report.html").render(**content, style=text("report.css"), viewer="", written=datetime.date.today().isoformat())
    with written(path) as beside:
        Path(beside).write_text(page, encoding="utf-8")
