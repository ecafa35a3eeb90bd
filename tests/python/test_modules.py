"""Modules of the package use public names of each other: what begins with an underscore belongs to the module, or a module to its folder."""

import ast
from pathlib import Path

import pytest

import masonry

PACKAGE = Path(masonry.__file__).parent
MODULES = sorted(PACKAGE.rglob("*.py"))


def is_private(name):
    return name.startswith("_") and not name.endswith("__")


def module_of(path):
    parts = ["masonry", *path.relative_to(PACKAGE).with_suffix("").parts]
    return parts[:-1] if parts[-1] == "__init__" else parts


def is_module(parts):
    """Whether it is a module of the package, compiled ones included."""
    path = PACKAGE.joinpath(*parts[1:])
    return parts[0] == "masonry" and (path.is_dir() or path.with_suffix(".py").exists() or path.with_suffix(".so").exists())


def private_names_of_others(path):
    """[line: name] of private names of other modules that the module at `path` imports or uses."""
    tree, faults = ast.parse(path.read_text()), []
    folder = ["masonry", *path.relative_to(PACKAGE).parts[:-1]]

    def look(line, parts):
        """`parts`: a module, or a name in one. A private one belongs to the module or folder that holds it."""
        for k, name in enumerate(parts):
            if is_private(name) and not (is_module(parts[:k + 1]) and folder[:k] == parts[:k]):
                faults.append(f"{line}: {'.'.join(parts)}")

    own = {node.name for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    own |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    own |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
            and isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for name in node.names:
                look(node.lineno, name.name.split("."))
        elif isinstance(node, ast.ImportFrom):
            source = folder[:len(folder) + 1 - node.level] * (node.level > 0) + (node.module or "").split(".") * bool(node.module)
            for name in node.names:
                look(node.lineno, source + [name.name])
        elif isinstance(node, ast.Attribute) and is_private(node.attr) and node.attr not in own:
            faults.append(f"{node.lineno}: .{node.attr}")
    return faults


@pytest.mark.parametrize("path", MODULES, ids=lambda path: ".".join(module_of(path)))
def test_no_private_name_of_another_module(path):
    assert private_names_of_others(path) == []
