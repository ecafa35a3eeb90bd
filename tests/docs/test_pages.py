"""README, CHANGELOG and docs: their snippets print what the pages say, their links lead somewhere, and they keep to their lengths."""
import ast
import os
import re
import runpy
import shutil
import subprocess
from pathlib import Path

import pytest

import snippets

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
LINKED = [*PAGES, ROOT / "CHANGELOG.md", ROOT / "validation/README.md"]
# Seconds: the slowest page runs an ensemble of YADE processes.
TIME_LIMIT = 900


def needed(page):
    return sorted({script.interpreter for script in snippets.read(page)[0]})


@pytest.mark.parametrize("page, interpreter", [(page, interpreter) for page in PAGES for interpreter in needed(page)],
                         ids=lambda value: value.name if isinstance(value, Path) else value)
def test_snippets_print_what_the_page_says(page, interpreter):
    command = {"python": ["/usr/bin/python3"], "yade": ["yade", "-j1", "-n", "-x"]}[interpreter]
    if not shutil.which(command[0]):
        pytest.skip("there is no YADE")
    run = subprocess.run([*command, snippets.__file__, str(page)], capture_output=True, text=True, timeout=TIME_LIMIT,
                         env={**os.environ, "OMP_WAIT_POLICY": "passive"}, stdin=subprocess.DEVNULL)
    assert run.returncode == 0, run.stdout[-6000:] + run.stderr[-3000:]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_python_says_whether_it_is_run(page):
    assert snippets.read(page)[1] == []


def test_lengths():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 130
    version = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("## [0.1.0]")[1].split("\n## ")[0]
    assert len(version.splitlines()) <= 40
    assert os.path.getsize(ROOT / "docs/gallery/collapse.gif") <= 1.5e6


def _anchor(heading):
    """The anchor that GitHub and MyST make of a heading."""
    words = re.sub(r"[`*]|\[|\]\([^)]*\)", "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def _headings(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    return {_anchor(heading) for heading in re.findall(r"^#+ (.*)$", text, re.M)}


@pytest.mark.parametrize("page", LINKED, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), f"{page.name}: {target}"
        assert ROOT in (file, *file.parents), f"{page.name}: {target} leaves the project"
        if anchor:
            assert anchor in _headings(file), f"{page.name}: {target} has no such heading"


def test_tables_of_docstrings_are_tables():
    """The pages show a paragraph as a block of code where one of its lines is none of a table of names: two lines in one, or a name that one blank parts from its text."""
    pages = runpy.run_path(str(ROOT / "docs/conf.py"))
    package = ROOT / "plugin/python/masonry"
    for path in (path for path in package.rglob("*.py") if not re.search(r"(^|/)_", str(path.relative_to(package)))):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            doc = ast.get_docstring(node) if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Module)) else None
            for paragraph in pages["_paragraphs"]((doc or "").splitlines()):
                named = [line for line in paragraph if re.fullmatch(r"\S.*? {2,}\S.*", line)]
                assert not named or pages["_entries"](paragraph), f"{path.name}: {paragraph[0]}"
                assert not [line for line in named if re.search(r" {3,}\S.* {3,}", line)], f"{path.name}: {named}"


def test_comparison_of_what_is_printed():
    assert snippets.same("a 1.5 b\n...\nend", "a 1.5 b\nx\ny\nend")
    assert not snippets.same("a 1.5 b", "a 1.6 b")
    assert snippets.same("a 1.5 b", "a 1.6 b", within=0.1)
    assert snippets.same("at ... s", "at 3.2 s")
    assert not snippets.same("collapsed at 1 s", "stands", within=0.5)
    assert not snippets.same("one\ntwo", "one")
