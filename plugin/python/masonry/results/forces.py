"""What the recorded forces of the joints say: base shear, overturning moment, lines of thrust."""

import numpy as np
from masonry import _pose
from masonry._given import shown
from masonry.results.history_tables import JOINT_FORCES
from masonry.results.wall_history import history_given

_REACTIONS = [("time", float), ("force", float, 3), ("moment", float, 3)]


def _forces_given(history):
    if history_given(history).forces is None:
        raise ValueError("history: the forces of its joints were not recorded: dem.WallRecorder(recordForces=True)")
    return history.forces


def _rows(history, ids):
    """Rows of the bodies in the history."""
    row = {id: k for k, id in enumerate(history.ids.tolist())}
    return np.array([row[id] for id in ids.tolist()], dtype=int)


def has_forces(history):
    return history.forces is not None and len(history.forces) > 0


def base_reactions(history, about=None, base=None):
    """Forces of the prescribed bodies on the recorded blocks over time, by joints and by ties that are fixed to them: a structured array, one row a sample.

    about    point that the moment is about, m, as the structure stands in the first sample; it moves with the base of each block. None: the middle of the
             plan of the free blocks (with `base`: of those that stand on it), at the height of their lowest point
    base     id of a prescribed body: its forces alone; None: those of all, without the platens of dem.push()

    time      s
    force     N; x and y: the base shear, z: the weight that the base carries
    moment    about that point, N m; y: the overturning moment in the plane x, z

    Values are those at the instants of the samples, not means: between blocks that move they jump. The first sample is NaN where no joint carries load in
    it, as before the first step. Raises ValueError where forces or prescribed bodies were not recorded."""
    forces, free, bases = _forces_given(history), history.free, history.bases
    if free.all():
        raise ValueError("history: no prescribed body was recorded, and so no force of the base: add its id to WallRecorder.ids")
    if base is not None and base not in history.ids[~free].tolist():
        raise ValueError(f"base = {shown(base)}: must be the id of a prescribed body of the history, among {shown(history.ids[~free].tolist())}")
    standing = free if base is None else free & (history.ids[bases] == base)
    low = history.corners(0)[standing if standing.any() else free].reshape(-1, 3)
    point = np.array([*(low.min(axis=0) + low.max(axis=0))[:2] / 2, low[:, 2].min()]) if about is None else np.asarray(about, dtype=float)
    row1, row2 = (_rows(history, forces[name]) for name in ("id1", "id2"))
    # On the structure: block 2 where block 1 is the base, else block 1.
    side = np.where(free[row2] & ~free[row1], 1.0, np.where(free[row1] & ~free[row2], -1.0, 0.0))
    if base is None:
        pushing = [id for motion in history.about.get("motions", []) if motion.get("kind") == "push" for id in motion["ids"]]
        side[np.isin(history.ids[np.where(free[row1], row2, row1)], pushing)] = 0
    else:
        side[history.ids[np.where(free[row1], row2, row1)] != base] = 0
    force = side[:, None] * forces["force"]
    under = bases[np.where(free[row2], row2, row1)]
    moved = history.position[forces["sample"], under] - history.position[0, under]
    turns = (history.orientation[forces["sample"], under] != history.orientation[0, under]).any(axis=1)
    if turns.any():  # with its base
        now, first = (_pose.matrices(history.orientation[sample, under[turns]]) for sample in (forces["sample"][turns], 0))
        arm = point - history.position[0, under[turns]]
        moved[turns] += np.einsum("jab,jcb,jc->ja", now, first, arm) - arm
    moment = np.cross(forces["point"] - (point + moved), force)
    table = np.zeros(len(history.time), dtype=_REACTIONS)
    table["time"] = history.time
    for name, values in (("force", force), ("moment", moment)):
        np.add.at(table[name], forces["sample"], values)
    _add_ties(history, table, point, base)
    if not (forces["sample"] == 0).any():
        table["force"][0] = table["moment"][0] = np.nan
    return table


def _add_ties(history, table, point, base):
    """Adds the forces of ties between free blocks and prescribed bodies (`base`: that one alone) to base_reactions()."""
    row_of = {id: row for row, id in enumerate(history.ids.tolist())}
    for k in range(0 if history.ties is None else history.ties.shape[1]):
        tie = history.ties[:, k]
        ends = [(row_of.get(int(tie[body][0])), tie[place][0]) for body, place in (("body1", "point1"), ("body2", "point2"))]
        if any(row is None for row, _ in ends) or history.free[ends[0][0]] == history.free[ends[1][0]]:
            continue
        (block, held), (under, fixed) = ends if history.free[ends[0][0]] else ends[::-1]
        if base is not None and history.ids[under] != base:
            continue
        place, anchor = (history.position[:, row] + np.einsum("sab,b->sa", _pose.matrices(history.orientation[:, row]), own)
                         for row, own in ((block, held), (under, fixed)))
        force = np.nan_to_num(tie["force"][:, None] * (anchor - place) / np.linalg.norm(anchor - place, axis=1, keepdims=True))
        table["force"] += force
        table["moment"] += np.cross(np.nan_to_num(place - (point + history.position[:, under] - history.position[0, under])), force)


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
    one = _rows(history, table["id1"])
    back = np.einsum("jab,jcb->jac", _pose.matrices(history.orientation[0, one]), _pose.matrices(history.orientation[sample, one]))
    return history.position[0, one] + np.einsum("jab,jb->ja", back, table["point"] - history.position[sample, one]), np.einsum("jab,jb->ja", back, table["force"])
