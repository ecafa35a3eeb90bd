"""The ties of a WallHistory: what each has carried, and where it is."""

import numpy as np
from masonry import _pose
from masonry.results.wall_history import history_given

_FIELDS = [("body1", int), ("body2", int), ("force", float), ("force_time", float), ("extension", float), ("extension_time", float), ("broken", bool), ("broken_time", float)]


def ties(history):
    """What each tie (dem.tie) has carried: a structured array, one row a tie, in the order in which they were made. Empty where there are none.

    body1, body2                 ids that it joins
    force, force_time            largest force, N (tension positive), and when
    extension, extension_time    largest extension until it broke, m, and when
    broken, broken_time          whether it broke, and the first sample in which it was broken, s; NaN: it did not

    The largest values are those of the samples; history.ties has the history of each: history.ties["force"][:, k] over history.time."""
    table = np.zeros(0 if history_given(history).ties is None else history.ties.shape[1], dtype=_FIELDS)
    for k, row in enumerate(table):
        own = history.ties[:, k]
        row["body1"], row["body2"] = own["body1"][0], own["body2"][0]
        for name, values in (("force", own["force"]), ("extension", np.where(own["broken"], -np.inf, own["extension"]))):
            row[name], row[name + "_time"] = values.max(), history.time[values.argmax()]
        row["broken"] = own["broken"][-1]
        row["broken_time"] = history.time[own["broken"].argmax()] if row["broken"] else np.nan
    return table


def tie_ends(history, sample, enlarge=1.0):
    """(m, 2, 3) ends of the ties that are not broken in a sample, seen from the bases of their bodies, with movements since the first sample taken `enlarge`
    times, m."""
    if history.ties is None:
        return np.zeros((0, 2, 3))
    own = history.ties[sample]
    own = own[~own["broken"]]
    row_of = {id: row for row, id in enumerate(history.ids.tolist())}
    known = [tie for tie in own if tie["body1"] in row_of and tie["body2"] in row_of]
    ends = np.zeros((len(known), 2, 3))
    for k, tie in enumerate(known):
        for end in (0, 1):
            row, point = row_of[tie[f"body{end + 1}"]], tie[f"point{end + 1}"]
            first, now = (history.relative_position[j, row] + _pose.matrices(history.relative_orientation[j, row]) @ point for j in (0, sample))
            ends[k, end] = first + enlarge * (now - first)
    return ends
