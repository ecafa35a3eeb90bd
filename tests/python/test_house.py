"""The house: includes of the plugin point downwards only, and files and functions are short."""

import re
from pathlib import Path

PLUGIN = Path(__file__).resolve().parents[2] / "plugin"
# A folder of plugin/core may include these, besides itself and the files at the top (math, tolerances, checks, archives). The order of
# the table is that of the arrows: a folder may name only those above it.
BELOW = {
    "simd": "",
    "linalg": "simd",
    "parallel": "",
    "motion": "",
    "shape": "",
    "rocking": "motion shape",
    "contact": "simd shape",
    "laws": "linalg contact",
    "impact": "shape contact laws",
    "joints": "shape contact laws impact",
    "dynamics/model": "motion contact laws impact joints",
    "dynamics/localised": "contact laws impact joints dynamics/model",
    "dynamics/wall": "linalg simd parallel contact laws impact joints dynamics/model",
    "dynamics/compliant": "contact laws impact joints dynamics/model",
    "dynamics/scheduler": "dynamics/model dynamics/localised dynamics/wall",
}


# Sources of a class of plugin/yade beside its own.
PARTS = {"rigid_checks": "MoreauJeanIntegrator", "rigid_failures": "MoreauJeanIntegrator", "rigid_scene_building": "rigid_scene"}


def sources(folder):
    return sorted(path for path in (PLUGIN / folder).rglob("*") if path.suffix in (".hpp", ".cpp"))


def includes(path):
    return re.findall(r'^#\s*include\s+["<]([^">]+\.hpp)[">]', path.read_text(), re.M)


def folder_of(name):
    """Folder of plugin/core of a file that an include names; '' for those at the top, None for others' headers."""
    return str(Path(name).parent) if "/" in name and (PLUGIN / "core" / name).exists() else "" if (PLUGIN / "core" / name).exists() else None


def test_table_points_downwards():
    known = list(BELOW)
    for folder, below in BELOW.items():
        assert all(known.index(name) < known.index(folder) for name in below.split()), folder


def test_core_includes_point_downwards():
    wrong = []
    for path in sources("core"):
        own = str(path.parent.relative_to(PLUGIN / "core")).replace(".", "")
        allowed = {"", own, *BELOW.get(own, "").split()}
        for name in includes(path):
            folder = folder_of(name)
            if folder is None and "/" in name and name.split("/")[0] in {"contact", "dynamics", "yade", "core", "python", "abi"}:
                wrong.append(f"{path.relative_to(PLUGIN)} includes {name}, which is not in plugin/core")
            elif folder is not None and folder not in allowed:
                wrong.append(f"{path.relative_to(PLUGIN)} includes {name}: {own or 'the top of plugin/core'} stands below {folder}")
    assert not wrong, "\n".join(wrong)


def test_every_folder_of_the_core_is_in_the_table():
    folders = {str(path.parent.relative_to(PLUGIN / "core")) for path in sources("core")} - {"."}
    assert folders == set(BELOW)


def test_adapters_include_no_circle():
    """A class of plugin/yade, header and source as one, never includes what includes it."""
    graph = {}
    for path in sources("yade"):
        own = graph.setdefault(PARTS.get(path.stem, path.stem), set())
        for name in includes(path):
            if "/" not in name and (path.parent / name).exists():
                own.add(PARTS.get(Path(name).stem, Path(name).stem))
    for name, below in graph.items():
        below.discard(name)
    while leaves := [name for name, below in graph.items() if not below]:
        for leaf in leaves:
            del graph[leaf]
        for below in graph.values():
            below.difference_update(leaves)
    assert not graph, f"these include each other: {', '.join(sorted(graph))}"


# Longer on purpose, and why: lines of a file, or of the function that begins with these words.
LONGER = {
    "yade/rigid_failures.cpp: void MoreauJeanIntegrator::count": "one sentence for each kind of failure",
}


def functions(text):
    """First line and number of lines of each function that begins at the left margin."""
    lines = text.split("\n")
    start = None
    for k, line in enumerate(lines):
        if line == "{":
            start = k
        elif line == "}" and start is not None:
            first = start - 1
            while first > 0 and lines[first].startswith(("\t", " ")):
                first -= 1
            yield lines[first], k - start + 1
            start = None


def test_files_and_functions_are_short():
    """At most 400 lines a file and 60 a function, except those of the table."""
    found = set()
    for path in [*sources("core"), *sources("yade"), *sources("guard"), *sources("python")]:
        name, text = str(path.relative_to(PLUGIN)), path.read_text()
        if text.count("\n") > 400:
            found.add(name)
        for first, lines in functions(text):
            if lines > 60:
                found.add(f"{name}: {first.split('(')[0]}")
    assert found == set(LONGER)
