"""Snippets of the Markdown pages: finds them, runs them, and compares what they print with what the page says.

    python3 snippets.py PAGE            runs the scripts of the page that need no YADE
    yade -n -x snippets.py PAGE         runs those that need it, one after the other, in a working folder of their own

A comment above a fenced block says what the block is; every block of Python has one:

    <!-- run: python -->                a script for plain Python; `yade` instead: for YADE
    <!-- run: python, continued -->     the script above goes on
    <!-- prints -->                     what the last part of the script prints; `...` stands for any text within a line, or for any lines
    <!-- prints within 5 % -->          the same, and numbers may differ by so much
    <!-- file: NAME -->                 a file that later scripts of the page read
    <!-- not run: REASON -->            neither run nor compared
"""
import builtins
import contextlib
import io
import os
import re
import sys
import tempfile
import traceback
import types
from dataclasses import dataclass, field

_BLOCK = re.compile(r"(?:<!--\s*(?P<mark>.*?)\s*-->[ \t]*\n+)?(?P<indent>[ \t]*)```(?P<language>\w*)[^\n]*\n(?P<text>.*?)\n(?P=indent)```", re.S)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@dataclass
class Part:
    code: str
    line: int
    prints: str = None
    within: float = 0.0


@dataclass
class Script:
    interpreter: str
    files: dict
    parts: list = field(default_factory=list)


def read(path):
    """(scripts, faults) of a page."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    scripts, files, faults = [], {}, []
    for block in _BLOCK.finditer(page):
        mark, text = block["mark"] or "", block["text"]
        text = "\n".join(line[len(block["indent"]):] for line in text.split("\n"))
        line = page.count("\n", 0, block.start("text")) + 1
        run = re.fullmatch(r"run: (python|yade)(, continued)?", mark)
        prints = re.fullmatch(r"prints(?: within ([\d.]+) %)?", mark)
        if run and run[2]:
            scripts[-1].parts.append(Part(text, line))
        elif run:
            scripts.append(Script(run[1], dict(files), [Part(text, line)]))
        elif prints:
            scripts[-1].parts[-1].prints, scripts[-1].parts[-1].within = text, float(prints[1] or 0) / 100
        elif mark.startswith("file: "):
            files[mark[6:]] = text + "\n"
        elif block["language"] == "python" and not mark.startswith("not run: "):
            faults.append(f"{path}:{line}: this block of Python has no mark")
    return scripts, faults


def _same_line(said, printed, within):
    pieces = re.split(r"(\.\.\.)", said)
    pattern, numbers = "", []
    for piece in pieces:
        if piece == "...":
            pattern += ".*?"
            continue
        at = 0
        for number in _NUMBER.finditer(piece):
            pattern += re.escape(piece[at:number.start()]) + f"({_NUMBER.pattern})"
            numbers.append(number[0])
            at = number.end()
        pattern += re.escape(piece[at:])
    found = re.fullmatch(re.sub(r"(\\ )+", r"\\s+", pattern), printed)
    return bool(found) and all(abs(float(a) - float(b)) <= within * abs(float(a)) for a, b in zip(numbers, found.groups()))


def same(said, printed, within=0.0):
    """Whether the lines printed are those that the page says."""
    said, printed = [[line.rstrip() for line in text.strip("\n").split("\n")] for text in (said, printed)]

    def match(i, k):
        if i == len(said):
            return k == len(printed)
        if said[i].strip() == "...":
            return any(match(i + 1, m) for m in range(k, len(printed) + 1))
        return k < len(printed) and _same_line(said[i].strip(), printed[k].strip(), within) and match(i + 1, k + 1)

    return match(0, 0)


def _run(script, page):
    """The first fault of a script, or ''."""
    for name, text in script.files.items():
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)
    sys.modules["__main__"] = types.ModuleType("__main__")  # where YADE's PyRunner looks for names
    names = vars(sys.modules["__main__"])
    names["__builtins__"] = builtins  # the module, as in every __main__: YADE puts labels of engines into it
    for part in script.parts:
        output = io.StringIO()
        try:
            with contextlib.redirect_stdout(output):
                exec(compile("\n" * (part.line - 1) + part.code, page, "exec"), names)
        except BaseException:
            return f"{page}:{part.line}: {traceback.format_exc()}\nIt had printed:\n{output.getvalue()}"
        if part.prints is not None and not same(part.prints, output.getvalue(), part.within):
            return f"{page}:{part.line}: the page says\n{part.prints}\nand the snippet prints\n{output.getvalue()}"
    return ""


def main(page):
    page = os.path.abspath(page)
    inside = "yade" in sys.modules
    scripts = [script for script in read(page)[0] if (script.interpreter == "yade") == inside]
    faults = []
    for script in scripts:
        if inside:
            from yade import O
            O.reset()
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            faults.append(_run(script, page))
        print(f"line {script.parts[0].line}: {'FAILED' if faults[-1] else 'right'}", flush=True)
    faults = [fault for fault in faults if fault]
    print("\n\n".join(faults))
    sys.stdout.flush()
    os._exit(bool(faults))


if __name__ == "__main__":
    main(sys.argv[-1])
