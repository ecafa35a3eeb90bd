"""Pieces of a report."""


def section(name, heading, figure="", caption="", **more):
    return {"name": name, "heading": heading, "figure": figure, "caption": caption, **more}


def shaded(verdict):
    return f" Shaded: after the collapse at {verdict.time:.4g} s, where the curve may leave the picture." if verdict.collapsed else ""


def counted(number, word):
    return f"{number} {word}{'s' if number != 1 else ''}"
