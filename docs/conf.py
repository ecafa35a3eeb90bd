"""Sphinx: the pages of docs/ and validation/, and the API from the docstrings. Run by docs/build."""
import importlib
import re
from pathlib import Path

project = "yade-masonry"
author = "The yade-masonry contributors"
copyright = author
version = release = "0.1.0"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary"]
root_doc = "docs/index"
include_patterns = ["docs/**.md", "docs/api/classes/*.rst", "validation/README.md", "validation/**/README.md", "CHANGELOG.md"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "yade-masonry"
html_copy_source = False
smartquotes = False
templates_path = [str(Path(__file__).parent / "_templates")]
html_static_path = ["_static"]
html_css_files = ["pages.css"]
pygments_style = "friendly"
autodoc_member_order = "bysource"
autodoc_docstring_signature = False


def _is_text(paragraph):
    """Tables and code are indented or have columns; what is neither is text."""
    return not any(line.startswith(" ") or re.search(r"\S {2,}\S", line) for line in paragraph)


def _entries(paragraph):
    """[(name, text)] of a table of arguments, whose lines are `name    text`, or indented where the text goes on; None where it is none."""
    entries = []
    for line in paragraph:
        entry = re.fullmatch(r"(\S.*?) {2,}(\S.*)", line)
        if entry:
            entries.append([entry[1], entry[2]])
        elif line.startswith("        ") and entries and not re.search(r"\S {2,}\S", line):
            entries[-1][1] += " " + line.strip()
        else:
            return None
    return entries


def _escaped(text):
    """Plain text as RST: what stands between backticks is code, and signs that are markup elsewhere are escaped."""
    pieces = re.split(r"`([^`]*)`", text)
    return "".join(f"``{piece}``" if k % 2 else re.sub(r"([*|\\]|_(?=\W|$))", r"\\\1", piece) for k, piece in enumerate(pieces) if piece)


def _default(name, attribute):
    """The value of an attribute in a new object of its YADE class, as Python writes it; "" for attributes that only the engine sets (YADE's flag 2)."""
    flags = re.search(r":yattrflags:`\s*(\d+)`", attribute.__doc__ or "")
    if not flags or int(flags[1]) & 2:
        return ""
    module, cls, attribute = name.rsplit(".", 2)
    value = getattr(getattr(importlib.import_module(module), cls)(), attribute)
    text = str(tuple(value)) if type(value).__name__ == "Vector3" else repr(value)
    return "" if text.startswith("<") else text


def _paragraphs(lines):
    paragraph = []
    for line in [*lines, ""]:
        if line.strip():
            paragraph.append(line.rstrip())
        elif paragraph:
            yield paragraph
            paragraph = []


def _as_rst(app, what, name, obj, options, lines):
    """Docstrings are plain text. Text stays text, with the signs escaped that are markup in RST; tables and code keep their columns."""
    result = []
    for paragraph in _paragraphs(lines):
        entries = _entries(paragraph)
        if _is_text(paragraph):
            result += _escaped("\n".join(paragraph)).split("\n") + [""]
        elif entries:
            result += [line for name, text in entries for line in (f"``{name}``", "    " + _escaped(text), "")]
        else:
            result += ["::", ""] + ["    " + line for line in paragraph] + [""]
    default = _default(name, obj)
    if default:
        result += [f"Default: ``{default}``", ""]
    lines[:] = result


def _signature(app, what, name, obj, options, signature, return_annotation):
    """Classes of YADE take their attributes by name; the signature that Boost.Python gives says nothing."""
    if what == "class" and type(obj).__module__ == "Boost.Python":
        return "(**attributes)", None
    return signature, return_annotation


def setup(app):
    app.connect("autodoc-process-docstring", _as_rst)
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True}
