"""The ties of a WallHistory: their largest forces, and where they are."""

import numpy as np
from masonry import _pose
from masonry.results.history_tables import TIES
from masonry.results.wall_history import history_given

_FIELDS = [("body1", int), ("body2", int), ("force", float), ("force_time", float), ("compression", float), ("compression_time", float), ("extension", float), ("extension_time", float), ("broken", bool), ("broken_time", float)]


def ties(history):
    """Largest forces and extensions of each tie (dem.tie): a structured array, one row a tie, in the order in which they were made. Empty where there are none.

    body1, body2                 ids that it joins
    force, force_time            largest tension, N, and when; of a tie that broke at least its strength, at which it broke; 0 and NaN: it was never in tension
    compression, compression_time    largest compression of a strut, N, positive, and when; 0 and NaN: it did not press
    extension, extension_time    largest extension until it broke, m, and when
    broken, broken_time          whether it broke, and the first sample in which it was broken, s; NaN: it did not

    The forces of samples are means of the step before, while extensions belong to its end: a force need not equal stiffness times the extension in this table. The
    largest values are those of the samples; history.ties has the history of each: history.ties["force"][:, k] over history.time."""
    table = np.zeros(0 if history_given(history).ties is None else history.ties.shape[1], dtype=_FIELDS)
    for k, row in enumerate(table):
        own = history.ties[:, k]
        row["body1"], row["body2"] = own["body1"][0], own["body2"][0]
        for name, values in (("force", own["force"]), ("compression", -own["force"]), ("extension", np.where(own["broken"], -np.inf, own["extension"]))):
            row[name], row[name + "_time"] = values.max(), history.time[values.argmax()]
        row["broken"] = own["broken"][-1]
        row["broken_time"] = history.time[own["broken"].argmax()] if row["broken"] else np.nan
        strength = own["strength"][-1]
        if row["broken"] and strength > row["force"]:
            row["force"], row["force_time"] = strength, row["broken_time"]
        for name in ("force", "compression"):
            if row[name] <= 0:
                row[name], row[name + "_time"] = 0, np.nan
    return table


def unbroken(history, sample):
    """Rows of the ties that are not broken in a sample and whose bodies are in the history."""
    if history.ties is None:
        return np.zeros(0, dtype=TIES)
    own = history.ties[sample]
    return own[~own["broken"] & np.isin(own["body1"], history.ids) & np.isin(own["body2"], history.ids)]


def tie_ends(history, sample, enlarge=1.0, relative=True):
    """(m, 2, 3) ends of the ties of unbroken(), m, with movements since the first sample taken `enlarge` times. relative: seen from the bases of their bodies."""
    position, orientation = (history.relative_position, history.relative_orientation) if relative else (history.position, history.orientation)
    row_of, own = {id: row for row, id in enumerate(history.ids.tolist())}, unbroken(history, sample)
    ends = np.zeros((len(own), 2, 3))
    for k, tie in enumerate(own):
        for end in (0, 1):
            row, point = row_of[tie[f"body{end + 1}"]], tie[f"point{end + 1}"]
            first, now = (position[j, row] + _pose.matrices(orientation[j, row]) @ point for j in (0, sample))
            ends[k, end] = first + enlarge * (now - first)
    return ends
