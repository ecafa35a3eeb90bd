"""Cases as plain values, the keys that name their results, and the results in the folder."""

import hashlib
import json
import os
from pathlib import Path

import numpy as np

from .._files import read_npz
from .._given import shown

RUN_CASE = Path(__file__).with_name("_run_case.py")


def plain(case):
    """The case as JSON, NumPy's numbers as Python's."""
    def convert(value):
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        raise TypeError

    try:
        json.dumps(case, ensure_ascii=False, default=convert).encode()  # texts that files cannot hold
        return json.dumps(case, sort_keys=True, default=convert)
    except (TypeError, ValueError, RecursionError):
        raise ValueError(f"case = {shown(case)}: must be a dict of numbers, strings, None, and lists of them") from None


def contents(paths):
    digest = hashlib.sha256()
    for path in paths:
        digest.update(hashlib.sha256(Path(path).read_bytes()).digest())
    return digest.hexdigest()


def code(script):
    """A digest of what computes a case: the script, and this package as it is installed but for what only starts cases and collects results."""
    package = Path(__file__).parents[1]
    return contents([script, *sorted(f for f in package.rglob("*") if f.suffix in (".py", ".so")
                               and (f.parent.name not in ("ensemble", "commands") or f == RUN_CASE))])


def _texts(value):
    """The strings in a plain value, those in lists too."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [text for item in value for text in _texts(item)]
    return [value] if isinstance(value, str) else []


def keys(script, function, cases):
    """A name for each case: of its values, of the files that they name, and of the code."""
    made_by = code(script)
    found, named = [], {}
    for case in map(plain, cases):
        files = [text for text in _texts(json.loads(case)) if os.path.isfile(text)]
        named.update({file: contents([file]) for file in files if file not in named})
        found.append(hashlib.sha256(json.dumps([made_by, function, case, [named[file] for file in files]]).encode()).hexdigest()[:20])
    return found


def path_of(folder, key):
    return folder / f"case_{key}.npz"


def load_all(folder, keys, cases):
    """{key: what the case returned}; None for a case that has no file, or a damaged one or that of another case, which a line tells."""
    # A listing shows what other machines have written: a look-up by name may be answered from the memory of a network file system.
    present = set(os.listdir(folder))
    outcomes = {key: read(path_of(folder, key), case) if path_of(folder, key).name in present else None for key, case in zip(keys, cases)}
    for key, outcome in outcomes.items():
        if outcome is None and path_of(folder, key).exists():
            print(f"masonry.ensemble: {path_of(folder, key)} is damaged, or of another case: its case counts as not yet computed")
    return outcomes


def read(path, case):
    """What a case returned; None where it has no file, or a damaged one, or that of another case."""
    try:
        found = read_npz(path, "result")
    except (OSError, ValueError):
        return None
    if str(found.get("case")) != plain(case):
        return None
    return {name: value if value.ndim else value.item() for name, value in found.items() if name != "case"}


def clear(folder, keys):
    """Removes what killed workers have left of cases that have a result now. Another run that is at work on such a case finds its result instead."""
    for name in os.listdir(folder):
        if name.startswith(".case_") and name.split(".")[1][len("case_"):] in keys:
            (folder / name).unlink(missing_ok=True)
