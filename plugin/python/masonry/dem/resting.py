"""Whether the blocks are at rest."""

import numpy as np
from masonry import _core
from masonry.dem.bodies import blocks, reach
from masonry.dem.joint_engine import joint_engine
from masonry.dem.reactions import joint_forces
from yade import O, wrapper

# Largest resultant of the forces on a block at rest, relative to the sum of their sizes. Where a rocking block turns back it is 0.4 times the angle, in rad, that is
# left to the critical one; walls of method='wall' that have come to rest have up to 0.02, other methods round-off.
_UNBALANCED, _UNBALANCED_IN_WALLS = 4e-3, 5e-2


def at_rest():
    """Whether all free blocks are at rest: True or False. Call it between steps, or end a run with it: dem.run(60, until=dem.at_rest).

    A block is at rest if its centre moves slower than 1e-4 sqrt(g R) (m/s) and it turns slower than 1e-4 sqrt(g/R) (rad/s), where R (m) is half of its
    diagonal, and if the forces on it balance within 0.4 % (method='wall': 5 %) of the sum of their sizes: where a rocking block turns back it stands still for
    an instant, and its forces do not balance. Speeds are those in the world: on a base that moves, no block is at rest. Before the first step, and without
    gravity, the answer is False.

    YADE's utils.unbalancedForce() does not tell it: it is 0 for rigid blocks, whether they move or not."""
    engine = joint_engine()
    gravity = next((np.array(one.gravity) for one in (engine, *O.engines) if hasattr(one, "gravity")), np.zeros(3))
    strength = np.linalg.norm(gravity)
    if O.iter == 0 or engine is None or strength == 0:
        return False
    free = [body for body in blocks() if body.dynamic]
    state = np.array([(*body.state.vel, *body.state.angVel, body.state.mass, reach(body)) for body in free])
    speed, spin, mass, reaches = np.linalg.norm(state[:, :3], axis=1), np.linalg.norm(state[:, 3:6], axis=1), state[:, 6], state[:, 7]
    if (speed > _core.REST_SPEED * np.sqrt(strength * reaches)).any() or (spin > _core.REST_SPEED * np.sqrt(strength / reaches)).any():
        return False
    force = np.array([O.forces.f(body.id, True) for body in free]) + mass[:, None] * gravity
    sizes = mass * strength
    if isinstance(engine, wrapper.MoreauJeanIntegrator):  # those of compliant joints are in O.forces
        joints, row = joint_forces(), np.full(len(O.bodies), -1)
        row[[body.id for body in free]] = np.arange(len(free))
        for name, sign in (("id1", -1), ("id2", 1)):
            known = row[joints[name]] >= 0
            np.add.at(force, row[joints[name]][known], sign * joints["force"][known])
            np.add.at(sizes, row[joints[name]][known], np.linalg.norm(joints["force"][known], axis=1))
    allowed = _UNBALANCED_IN_WALLS if getattr(engine, "method", "") == "wall" else _UNBALANCED
    return bool((np.linalg.norm(force, axis=1) <= allowed * sizes).all())
