"""The mechanism of a collapse: which blocks have moved, which joints open or slide, and its picture."""

import math

import numpy as np
from masonry._pose import axes_of
from masonry.dem.bodies import geometry
from yade import wrapper

# A joint opens or slides where its points have moved by more than this share of the farthest moved block.
_MOVED = 0.05
# Drawn movement of the farthest moved block, relative to the smallest size of a block.
_DRAWN = 0.4
_JOINT_FIELDS = [("id1", int), ("id2", int), ("opening", float), ("slip", float), ("opens", bool), ("slides", bool)]


def _section(size, axes, across):
    """Half diagonals (4, 3), in order around, of the middle section of a box; `across` is the axis one looks along."""
    one, two = (size[k] / 2 * axes[k] for k in range(3) if k != np.argmax(np.abs(axes[:, across])))
    return np.array([one + two, one - two, -one - two, two - one])


def _silhouette(corners, across):
    """Outline (k, 3) of the corners of a convex block, from its centre of mass, as one sees them along that axis, in order around, at its depth."""
    from scipy.spatial import ConvexHull

    outline = corners[ConvexHull(np.delete(corners, across, axis=1)).vertices]
    outline[:, across] = 0
    return outline


class Mechanism:
    """Where the blocks were at rest, where they are now, and the joints that were closed at rest."""

    def __init__(self, blocks, start, joints, axis):
        self._ids, self._axis, self._joints = [b.id for b in blocks], axis, joints
        self._free = np.array([b.dynamic for b in blocks])
        self._now, self._sizes, turned = geometry(blocks)
        self._before = np.array([tuple(pos) for pos, _ in start])
        self._axes = axes_of(np.array([tuple(ori) for _, ori in start])[:, [3, 0, 1, 2]])
        self._turn = np.einsum("nka,nkb->nab", turned, self._axes)
        self._row = {id: k for k, id in enumerate(self._ids)}
        self._outlines = [_silhouette(np.array([tuple(v) for v in b.shape.vertices]) @ own, 1 - axis) if isinstance(b.shape, wrapper.ConvexBlock)
                          else _section(size, own, 1 - axis) for b, size, own in zip(blocks, self._sizes, self._axes)]
        corners = [self._movement(k, self._before[k] + outline) for k, outline in enumerate(self._outlines)]
        self._moved = np.array([np.linalg.norm(c, axis=1).max() for c in corners])

    def _movement(self, row, points):
        """Of points of a block, from where they were."""
        arm = points - self._before[row]
        return self._now[row] - self._before[row] + arm @ self._turn[row].T - arm

    def moving(self):
        return [id for id, moved in zip(self._ids, self._moved) if moved > _MOVED * self._moved.max()]

    def joints(self):
        table = np.zeros(len(self._joints), dtype=_JOINT_FIELDS)
        for k, (id1, id2, normal, points) in enumerate(self._joints):
            apart = self._movement(self._row[id2], points) - self._movement(self._row[id1], points)
            gap = apart @ normal
            least = _MOVED * self._moved.max()
            slip = np.where(gap <= gap.min() + least, np.linalg.norm(apart - gap[:, None] * normal, axis=1), 0).max()  # where it is closed, or nearest to it
            table[k] = id1, id2, max(gap.max(), 0), slip, gap.max() > least, slip > least
        return table

    def figure(self, collapse, title):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import to_rgba
        from matplotlib.figure import Figure

        plane, scale = [self._axis, 2], _DRAWN * self._sizes[self._free].min() / self._moved.max()

        def place(row, points):
            return (points + scale * self._movement(row, points))[:, plane]

        outlines = [place(k, self._before[k] + outline) for k, outline in enumerate(self._outlines)]
        # From behind to the front, with x or y to the right.
        order = np.lexsort((self._before[:, 1 - self._axis] * (1 if self._axis else -1), self._free))
        figure = Figure(figsize=(7.5, 6), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot(aspect="equal")
        axes.add_collection(PolyCollection([outlines[k] for k in order], facecolors=np.where(self._free[order], "0.85", "0.6"), edgecolors="0.3", linewidths=0.6))
        for joint, (id1, id2, normal, points) in zip(collapse.joints, self._joints):
            if not (joint["opens"] or joint["slides"]):
                continue
            colour, (across, up) = "C3" if joint["opens"] else "C0", normal[plane]
            if math.hypot(across, up) < 0.5:  # seen face on
                middle = (points - points.mean(axis=0))[:, plane]
                around = np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))
                axes.fill(*place(self._row[id1], points[around]).T, facecolor=to_rgba(colour, 0.25), edgecolor=colour, linewidth=0.8)
                continue
            along = points[:, plane] @ [-up, across]
            sides = [place(self._row[id], points[[along.argmin(), along.argmax()]]) for id in (id1, id2)]
            if joint["opens"]:
                axes.fill(*np.concatenate([sides[0], sides[1][::-1]]).T, facecolor=colour, edgecolor=colour, linewidth=1.2)
            else:
                axes.plot(*sides[0].T, color=colour, linewidth=1.8)
        axes.plot([], [], color="C3", linewidth=4, label="opens")
        axes.plot([], [], color="C0", linewidth=1.8, label="slides, closed")
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize="small")
        shown = np.concatenate([outline for outline, free in zip(outlines, self._free) if free])
        (left, low), (right, high), margin = shown.min(axis=0), shown.max(axis=0), 0.15 * np.ptp(shown, axis=0).max()
        axes.set(xlim=(left - margin, right + margin), ylim=(low - margin, high + margin))
        axes.set(xlabel=f"{'xy'[self._axis]} (m)", ylabel="z (m)")
        axes.set_title(f"{title}\nmovement drawn {scale:.3g} times".strip(), fontsize="small")
        return figure
