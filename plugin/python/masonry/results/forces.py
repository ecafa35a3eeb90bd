"""What the recorded forces of the joints say: base shear, overturning moment, lines of thrust."""

import numpy as np
from masonry import _pose
from masonry.results.wall_history import JOINT_FORCES, history_given

_REACTIONS = [("time", float), ("force", float, 3), ("moment", float, 3)]


def _forces_given(history):
    if history_given(history).forces is None:
        raise ValueError("history: the forces of its joints were not recorded: dem.WallRecorder(recordForces=True)")
    return history.forces


def has_forces(history):
    return history.forces is not None and len(history.forces) > 0


def base_reactions(history, about=None):
    """Forces of the prescribed bodies on the structure over time: a structured array, one row a sample.

    about    point that the moment is about, m, as the structure stands in the first sample; it moves with the base. None: the middle of the free blocks'
             plan, at the height of their lowest point

    time      s
    force     N; x and y: the base shear, z: the weight that the base carries
    moment    about that point, N m; y: the overturning moment in the plane x, z

    Values are those at the instants of the samples, not means: between blocks that move they jump. A sample before the first step has no forces: NaN. Raises
    ValueError where forces were not recorded."""
    forces = _forces_given(history)
    low = history.corners(0)[history.free].reshape(-1, 3)
    point = np.array([*(low.min(axis=0) + low.max(axis=0))[:2] / 2, low[:, 2].min()]) if about is None else np.asarray(about, dtype=float)
    moved = np.zeros((len(history.time), 3)) if history.base is None else history.position[:, history.base] - history.position[0, history.base]
    free = dict(zip(history.ids.tolist(), history.free.tolist()))
    free1, free2 = (np.array([free[id] for id in forces[name].tolist()], dtype=bool) for name in ("id1", "id2"))
    # On the structure: block 2 where block 1 is the base, else block 1.
    side = np.where(free2 & ~free1, 1.0, np.where(free1 & ~free2, -1.0, 0.0))
    force = side[:, None] * forces["force"]
    moment = np.cross(forces["point"] - (point + moved)[forces["sample"]], force)
    table = np.zeros(len(history.time), dtype=_REACTIONS)
    table["time"] = history.time
    for name, values in (("force", force), ("moment", moment)):
        np.add.at(table[name], forces["sample"], values)
        if not (forces["sample"] == 0).any():
            table[name][0] = np.nan
    return table


def thrust(history, time=None):
    """The resultant of every joint at an instant: a structured array, one row for each joint that carries load. In a bed joint the resultants follow
    the lines of thrust; one that comes near the edge of its joint is about to rock.

    time     the sample nearest to it, s; None: the last one with forces

    id1, id2    the blocks
    force       on block 2, N
    point       where it crosses the joint, m"""
    forces = _forces_given(history)
    if time is None:
        sample = int(forces["sample"].max()) if len(forces) else len(history.time) - 1
    else:
        sample = history.sample(time)
    found = forces[forces["sample"] == sample]
    table = np.zeros(len(found), dtype=JOINT_FORCES)
    for name in table.dtype.names:
        table[name] = found[name]
    return table


def thrust_at_first(history, time):
    """(points, forces) of thrust(history, time) put back to where the blocks were in the first sample, with the first block of each joint: for pictures."""
    table, sample = thrust(history, time), history.sample(time)
    row = {id: k for k, id in enumerate(history.ids.tolist())}
    one = np.array([row[id] for id in table["id1"].tolist()], dtype=int)
    back = np.einsum("jab,jcb->jac", _pose.matrices(history.orientation[0, one]), _pose.matrices(history.orientation[sample, one]))
    return history.position[0, one] + np.einsum("jab,jb->ja", back, table["point"] - history.position[sample, one]), np.einsum("jab,jb->ja", back, table["force"])
