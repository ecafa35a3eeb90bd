"""One case of masonry.ensemble inside YADE: yade -j1 -n -x _run_case.py '{"script": ..., "function": ..., "case": ..., "path": ...}'."""

import ctypes
import importlib.util
import json
import os
import signal
import sys

import numpy as np
from masonry._files import written
from masonry._given import shown
from masonry.ensemble.cases import plain

# Names of the case itself in the file, and of the arguments of NumPy's function that writes it.
_TAKEN = "case", "file", "allow_pickle"


def end_with(parent):
    """Ends this process when the one that has started it ends, killed or not."""
    PR_SET_PDEATHSIG = 1  # of Linux
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended already
        sys.exit("the ensemble that this case is of has ended")


def main(script, function, case, path, parent):
    end_with(parent)
    spec = importlib.util.spec_from_file_location("ensemble_scene", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    outcome = getattr(module, function)(case)
    if not isinstance(outcome, dict) or not outcome:
        raise ValueError(f"{function}() of {script} returned {shown(outcome)}: must be a dict of numbers and arrays")
    values = {name: np.asarray(value) for name, value in outcome.items()}
    for name, value in values.items():
        if value.dtype.kind not in "biufU" or not isinstance(name, str) or name in ("", *_TAKEN):
            raise ValueError(f"{function}() of {script} returned {name} = {shown(outcome[name])}: must be a number, a string or an array of them, whose name is a text, "
                             f"and not {', '.join(_TAKEN)}")
    with written(path) as beside:
        np.savez_compressed(beside, case=plain(case), **values)


main(**json.loads(sys.argv[1]))
