"""Slices of a study for arrays of jobs: slice k of n computes the cases k, k + n, k + 2n, ..."""

import os
import re
from dataclasses import dataclass

from .._given import is_whole, shown


@dataclass
class Asked:
    """What `masonry ensemble` asks of the run in the study that it starts."""
    slice: tuple = None
    gather: bool = False


asked = Asked()


def of_slurm(environment=os.environ):
    """(k, n) of the Slurm array job that this process is of, or None. ValueError where its tasks are not numbered evenly."""
    if "SLURM_ARRAY_TASK_ID" not in environment:
        return None
    number, least, most, count, step = (int(environment.get(f"SLURM_ARRAY_TASK_{name}", default))
                                        for name, default in (("ID", 0), ("MIN", 0), ("MAX", -1), ("COUNT", 0), ("STEP", 1)))
    if count < 1 or (most - least) != (count - 1) * step or (number - least) % step:
        raise ValueError(f"SLURM_ARRAY_TASK_ID = {number}: the array of {count} tasks from {least} to {most} has gaps, so that it tells no slices: "
                         "must be one like --array=1-40, or give each job its --slice")
    return (number - least) // step + 1, count


def slice_given(value):
    """(k, n) of "k/n", of (k, n) or of "slurm", which is None outside of an array job; ValueError where it is none of them."""
    if value == "slurm":
        return of_slurm()
    pair = value
    if isinstance(value, str):
        found = re.fullmatch(r"\s*(\d+)\s*/\s*(\d+)\s*", value)
        pair = (int(found[1]), int(found[2])) if found else None
    if not (isinstance(pair, (tuple, list)) and len(pair) == 2 and is_whole(pair[1], 1) and is_whole(pair[0], 1, pair[1])):
        raise ValueError(f"slice = {shown(value)}: must be like '3/40' or (3, 40), from '1/40' to '40/40', or 'slurm'")
    return int(pair[0]), int(pair[1])
