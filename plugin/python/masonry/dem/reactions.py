"""The forces of the joints as they are now."""

import numpy as np
from masonry._given import is_whole, shown
from masonry.results.history_tables import JOINT_FORCES
from yade import O, wrapper

_FIELDS = [("id", int), ("force", float, 3), ("point", float, 3)]


def joint_forces():
    """The forces of all joints that carry load, after the last step: a structured array, one row for each pair of blocks.

    id1, id2    the blocks
    force       on block 2, N: pressure and friction of all points of the joint, with tension and shear of its mortar
    point       where the resultant crosses the joint, m: centre of the pressure. With mortar, which also pulls, it may lie outside the joint; where hardly any force
                crosses it, it is the place nearest to the joint on the line along which the resultant acts

    In a step in which an impact happened, rigid blocks show the force after it. The forces of a joint have no other moment about `point` than
    one about its normal, or about the resultant where hardly any force crosses the joint. Empty before the first step."""
    rows = np.frombuffer(wrapper.WallRecorder().jointForcesNow()).reshape(-1, 8)
    table = np.zeros(len(rows), dtype=JOINT_FORCES)
    table["id1"], table["id2"], table["force"], table["point"] = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 5:]
    return table


def reactions(id):
    """The forces with which a body carries, or holds, the blocks that touch it, after the last step: a structured array, one row for each of them.

    id       the block that is carried
    force    on it, N
    point    where it acts, m, as in joint_forces()

    dem.reactions(base)["force"].sum(axis=0) is the reaction of the base: for blocks at rest their weight, else m (a - g). For rigid blocks O.forces holds only
    the loads of other engines; these are the forces of the joints for every model."""
    if not (is_whole(id, 0) and id < len(O.bodies) and O.bodies[int(id)] is not None):
        raise ValueError(f"id = {shown(id)}: must be the id of a body in O.bodies")
    joints = joint_forces()
    table = np.zeros(np.count_nonzero((joints["id1"] == id) | (joints["id2"] == id)), dtype=_FIELDS)
    own, other = joints[joints["id1"] == id], joints[joints["id2"] == id]
    for name, values in (("id", (own["id2"], other["id1"])), ("force", (own["force"], -other["force"])), ("point", (own["point"], other["point"]))):
        table[name] = np.concatenate(values)
    return table
