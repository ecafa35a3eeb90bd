"""Whether the scene has collapsed by now."""

import numpy as np
from masonry._given import is_whole, shown
from masonry.dem.bodies import blocks, poses, shapes_of
from masonry.results.collapse import fallen
from masonry.results.wall_history import WallHistory
from yade import O

_bases = {}  # of the present scene: its bodies, and the base of each


def _since_built():
    """WallHistory of two samples: the blocks where they were put, and as they are now."""
    bodies = blocks()
    centers, sizes, quaternions = poses(bodies)
    first = np.array([tuple(body.state.refPos) for body in bodies]).reshape(-1, 3)
    rested = np.array([tuple(body.state.refOri) for body in bodies]).reshape(-1, 4)[:, [3, 0, 1, 2]]
    history = WallHistory([0.0, 1.0], [body.id for body in bodies], sizes, [body.dynamic for body in bodies], np.stack([first, centers]),
                          np.stack([rested, quaternions]), shapes=shapes_of(bodies)[0])
    key = tuple(bodies)
    if _bases.get("bodies") != key:
        _bases.update(bodies=key, rows=history.bases)
    history.__dict__["bases"] = _bases["rows"]
    return history


def collapsed(blocks=1):
    """Whether so many free blocks have fallen: True or False. End a run with it: dem.run(60, until=dem.collapsed), or until=lambda: dem.collapsed(5).

    A block has fallen when its centre is lower, relative to the base, by more than half of its height where it was put, or when it leans so far that it would not come back
    alone, as in results.fallen(). A block that leans far may still come back: results.collapse(history) tells at the end. Before the first step, and without free
    blocks, the answer is False."""
    if not is_whole(blocks, 1):
        raise ValueError(f"blocks = {shown(blocks)}: must be a whole number from 1 on")
    if O.iter == 0 or not any(body is not None and body.dynamic and body.shape for body in O.bodies):
        return False
    return int(fallen(_since_built())[-1].sum()) >= blocks
