"""Tables of a WallHistory: impacts, forces of joints and ties."""

import numpy as np

# Rows of the forces of joints: force on block 2, N, and where it acts, m.
JOINT_FORCES = [("id1", int), ("id2", int), ("force", float, 3), ("point", float, 3)]
# Columns of the ties: the bodies, where it is fixed to them (from their centres, in their own axes, m), N, N, m, J.
TIES = [("body1", int), ("body2", int), ("point1", float, 3), ("point2", float, 3), ("strength", float), ("force", float), ("extension", float), ("energy", float), ("broken", bool)]
# Columns of the impacts, of dem.impacts(), that a report shows.
_IMPACTS = "time", "body", "support", "restitution_asked", "restitution", "velocity", "energy_lost", "friction_demand", "capped"


def check_tables(history):
    """ValueError where impacts or forces have not the columns that they should have, or forces are those of other blocks or samples."""
    for name, columns in (("impacts", _IMPACTS), ("forces", ("sample", *(column[0] for column in JOINT_FORCES)))):
        table = getattr(history, name)
        found = np.asarray(table).dtype
        if table is not None and not (np.ndim(table) == 1 and all(column in (found.names or ()) and found[column].base.kind in "biuf" for column in columns)):
            raise ValueError(f"{name}: must be None or a structured array with the columns {', '.join(columns)}, of numbers")
    if history.ties is not None and not (np.asarray(history.ties).dtype == np.dtype(TIES) and np.ndim(history.ties) == 2 and len(history.ties) == len(history.time)):
        raise ValueError(f"ties: must be None or a structured array of {len(history.time)} samples by ties, with the columns {', '.join(name for name, *_ in TIES)}")
    if history.forces is None:
        return
    strangers = np.setdiff1d(np.concatenate([history.forces["id1"], history.forces["id2"]]), history.ids)
    if len(strangers):
        raise ValueError(f"forces: they name the body {strangers[0]}, which is not among the ids of the history: must be those of joints between its bodies")
    if not (history.forces["force"].shape == history.forces["point"].shape == (len(history.forces), 3) and np.isin(history.forces["sample"], np.arange(len(history.time))).all()):
        raise ValueError("forces: must be vectors of three components, at samples of the history")
