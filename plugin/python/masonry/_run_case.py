"""One case of masonry.ensemble inside YADE: yade -j1 -n -x _run_case.py '{"script": ..., "function": ..., "case": ..., "path": ...}'."""

import importlib.util
import json
import os
import sys

import numpy as np


def main(script, function, case, path):
    spec = importlib.util.spec_from_file_location("ensemble_scene", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    outcome = getattr(module, function)(case)
    if not isinstance(outcome, dict) or not outcome:
        raise ValueError(f"{function}() of {script} returned {outcome!r}: must be a dict of numbers and arrays")
    values = {name: np.asarray(value) for name, value in outcome.items()}
    for name, value in values.items():
        if value.dtype.kind not in "biufU" or name == "case":
            raise ValueError(f"{function}() of {script} returned {name} = {outcome[name]!r}: must be a number, a string or an array of them, and not named case")
    unfinished = path[:-len(".npz")] + ".part.npz"
    np.savez_compressed(unfinished, case=json.dumps(case), **values)
    os.replace(unfinished, path)  # a file that is there is whole


main(**json.loads(sys.argv[1]))
