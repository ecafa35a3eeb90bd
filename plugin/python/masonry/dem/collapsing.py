"""Whether the scene has collapsed by now."""

import numpy as np
from masonry import _pose
from masonry._given import is_whole, shown
from masonry.dem import bodies
from masonry.results.collapse import fallen
from masonry.results.wall_history import WallHistory
from yade import O

# Share of the drop, and of the lean, from which on a block may have fallen, below which it is not looked at further.
_SURE = 0.9


class _Built:
    """The blocks of a scene where they were put."""

    def __init__(self, blocks):
        self.blocks = blocks
        self.place = np.array([tuple(body.state.refPos) for body in blocks])
        self.turn = np.array([tuple(body.state.refOri) for body in blocks])[:, [3, 0, 1, 2]]
        self.free = np.array([body.dynamic for body in blocks])
        self.sizes = bodies.poses(blocks)[1]
        self.shapes = bodies.shapes_of(blocks)[0]
        least, most = self.sizes.min(axis=1), self.sizes.max(axis=1)
        # A block has not fallen that is lower by less than half of its least size and leans by less than the angle of this size over the largest one.
        self.drop, self.cosine = _SURE * least / 2, np.cos(_SURE * np.arctan(least / most))
        self.bases = None  # of WallHistory

    def is_of(self, blocks):
        return len(blocks) == len(self.blocks) and all(one is other for one, other in zip(blocks, self.blocks))

    def fallen(self):
        """How many have fallen by now."""
        states = np.array([(*body.state.pos, *body.state.ori) for body in self.blocks])
        place, turn = states[:, :3], states[:, [6, 3, 4, 5]]
        back = _pose.product(turn, _pose.inverse(self.turn))
        cosine = 1 - 2 * (back[:, 1] ** 2 + back[:, 2] ** 2)  # of the angle between what was upwards and the vertical
        moved = self.place[:, 2] - place[:, 2]
        if not (self.free & ((np.abs(moved) > self.drop) | (cosine < self.cosine)) | ~self.free & (np.abs(moved) > self.drop.min() / 2)).any():
            return 0
        history = WallHistory([0.0, 1.0], [body.id for body in self.blocks], self.sizes, self.free, np.stack([self.place, place]), np.stack([self.turn, turn]),
                              shapes=self.shapes)
        if self.bases is None:
            self.bases = history.bases
        history.__dict__["bases"] = self.bases  # a cached property, which takes long
        return int(fallen(history)[-1].sum())


_present = []  # the _Built of the scene that was looked at last


def collapsed(blocks=1):
    """Whether so many free blocks have fallen: True or False. End a run with it: dem.run(60, until=dem.collapsed), or until=lambda: dem.collapsed(5).

    A block has fallen when its centre is lower, relative to the base, by more than half of its height where it was put, or when it leans so far that it would not
    come back alone, as in results.fallen(). A block that leans far may still come back: results.collapse(history) tells at the end. Before the first step, and without free
    blocks, the answer is False."""
    if not is_whole(blocks, 1):
        raise ValueError(f"blocks = {shown(blocks)}: must be a whole number from 1 on")
    present = bodies.blocks()
    if O.iter == 0 or not any(body.dynamic for body in present):
        return False
    if not _present or not _present[0].is_of(present):
        _present[:] = [_Built(present)]
    return _present[0].fallen() >= blocks
