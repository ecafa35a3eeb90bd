"""Has the structure collapsed, when, and how far had it moved before?"""

import math
from dataclasses import dataclass

import numpy as np
from masonry._given import is_whole, positive_given, shown
from masonry.results.wall_history import history_given

# Height above the lowest corner, relative to the largest size, up to which a corner belongs to the face on which a block stands.
_LEVEL = 1e-6
# The units of CollapseReport.numbers(); `collapsed` is a bool.
UNITS = {"collapse_time": "s", "fallen": "1", "peak_drift": "1", "peak_drift_time": "s", "residual_drift": "1", "first_excursion": "s", "motion_run": "1"}


@dataclass
class CollapseReport:
    """What collapse() found. Times are those of samples, s; drifts are those of WallHistory.drift(), relative to the height.

    collapsed          whether as many blocks as were asked for have fallen by the end of the history
    time               of collapse; NaN: none
    fallen             ids of the blocks that have fallen by the end of the history, in the order in which they fell
    fall_times         theirs
    free               how many blocks could fall
    peak_drift         the largest before collapse; where there is none, of the whole history
    peak_drift_time    when
    residual_drift     in the last sample, also after collapse
    excursion          the level of the drift that was asked for
    first_excursion    when the drift first reached it, also after collapse; NaN: never
    motion_run         share of the motion that has been run, WallHistory.motion_run: below 1, nobody knows yet whether the structure stands
    run                the same in words
    from_base          False: the history has no prescribed block; drifts and falls are then those in the world
    """

    collapsed: bool
    time: float
    fallen: np.ndarray
    fall_times: np.ndarray
    free: int
    peak_drift: float
    peak_drift_time: float
    residual_drift: float
    excursion: float
    first_excursion: float
    from_base: bool
    motion_run: float
    run: str

    @property
    def verdict(self):
        """'collapsed'; 'stands': not, and the motion is over; 'unfinished': not yet, and the motion goes on; 'unknown': not by the end of a history
        that does not say how long the motion lasts."""
        if self.collapsed:
            return "collapsed"
        return "unknown" if math.isnan(self.motion_run) else "unfinished" if self.motion_run < 1 else "stands"

    def __str__(self):
        fate = {"collapsed": f"collapsed at {self.time:.4g} s", "stands": "stands", "unknown": "stands in the last sample",
                "unfinished": "NOT FINISHED, no collapse so far"}[self.verdict]
        fate += f": {len(self.fallen)} of {self.free} blocks have fallen; {self.run}"
        first = "never" if math.isnan(self.first_excursion) else f"first at {self.first_excursion:.4g} s"
        return (f"{fate}\npeak drift {'before collapse ' if self.collapsed else ''}{self.peak_drift:.3g} of the height, at {self.peak_drift_time:.4g} s; "
                f"{self.residual_drift:.3g} at the end\n"
                f"drift of {self.excursion:g}: {first}"
                + ("" if self.from_base else "\nNOT RELATIVE TO THE BASE, which was not recorded: its own motion is in every drift"))

    def numbers(self):
        """A dict of plain numbers, for tables: collapsed, collapse_time, fallen (how many), peak_drift, peak_drift_time, residual_drift,
        first_excursion, motion_run (where it is below 1 and collapsed is False, the answer is not known yet)."""
        return {"collapsed": self.collapsed, "collapse_time": self.time, "fallen": len(self.fallen), "peak_drift": self.peak_drift,
                "peak_drift_time": self.peak_drift_time, "residual_drift": self.residual_drift, "first_excursion": self.first_excursion, "motion_run": self.motion_run}


def fallen(history):
    """(s, n) bool: which blocks have fallen. A free block has, when its centre is lower, relative to the base, by more than half of its first
    height, or when it has overturned: it leans further than where its centre is highest over its lowest corner, so that, alone, it
    would not come back. An erased block has fallen.

    That critical lean is atan((b |cos f| + d |sin f|) / a) for half widths b, d, half height a and a lean in the direction f of the
    block's own plan: atan(b / a) about an edge, atan(sqrt(b^2 + d^2) / a) over a corner.
    """
    history_given(history)
    low, high = history.extent
    with np.errstate(invalid="ignore"):
        back = comes_back(history.vertical, history.upwards, history.own_corners, ~history.convex)
        stands = back & (history.displacement[..., 2] >= -(high - low) / 2)
    return ~stands & history.free


def comes_back(vertical, up, corners, stands):
    """(s, n) bool: whether blocks that lean come back, alone. vertical: (s, n, 3) in the axes of each block; up: (n, 3) where it was; corners: (n, c, 3);
    stands: (n,) which stood on their base at first in any case; the others where their centre was above it."""
    cosine = np.einsum("sna,na->sn", vertical, up)
    sideways = vertical - cosine[..., None] * up
    heights = np.einsum("nca,na->nc", corners, up)
    base = heights <= heights.min(axis=1, keepdims=True) + _LEVEL * np.ptp(corners, axis=1).max(axis=1)[:, None]
    # The corner of the base that is the lowest now.
    reach = np.where(base, -np.einsum("sna,nca->snc", sideways, corners), -np.inf).max(axis=2)
    stood = stands | _stands_alone(corners, up, base)
    return (cosine > 0) & (~stood | ((sideways**2).sum(axis=2) * -heights.min(axis=1) <= cosine * reach))


def _stands_alone(corners, up, base):
    """(n,) bool: whether the centre of each block is above the inside of its base: seen from it, no two neighbouring corners of the base are half a turn
    apart."""
    along = np.cross(up, np.eye(3)[np.abs(up).argmin(axis=1)])
    angles = np.arctan2(*(np.einsum("nca,na->nc", corners, axis) for axis in (np.cross(up, along), along)))
    angles = np.sort(np.where(base, angles, np.nan), axis=1)
    last = np.nanmax(angles, axis=1, keepdims=True)
    gaps = np.diff(np.concatenate([np.where(np.isnan(angles), last, angles), angles[:, :1] + 2 * np.pi], axis=1), axis=1)
    return (base.sum(axis=1) >= 3) & (gaps.max(axis=1) < np.pi)


def lies(history):
    """(s, n) bool: which blocks have fallen for good: from which sample on fallen() holds until the end of the history."""
    return np.logical_and.accumulate(fallen(history)[::-1])[::-1]


def collapse(history, blocks=1, excursion=0.01):
    """The CollapseReport of a WallHistory.

    blocks       so many fallen blocks are a collapse (1 to the number of free blocks)
    excursion    level of the drift whose first crossing is reported, relative to the height (positive)

    A block has fallen from the sample on from which fallen() holds until the end of the history; one that leans far and comes back has not.
    The time of collapse is that at which `blocks` of them have fallen, right within the time between two samples. Drift is
    WallHistory.drift(). Raises ValueError for input out of its range.
    """
    free = int(history_given(history).free.sum())
    if not is_whole(blocks, 1, free):
        raise ValueError(f"blocks = {shown(blocks)}: must be a whole number from 1 to {free}, the number of free blocks")
    positive_given("excursion", excursion)
    down = lies(history)
    rows = np.flatnonzero(down[-1])
    samples = down[:, rows].argmax(axis=0)
    order = np.argsort(samples, kind="stable")
    times = history.time[samples[order]]
    collapsed = len(rows) >= blocks
    drift = history.drift()
    before = samples[order][int(blocks) - 1] if collapsed else len(drift)
    peak = int(np.nanargmax(drift[:max(before, 1)]))
    beyond = np.flatnonzero(drift >= excursion)
    return CollapseReport(collapsed, float(times[int(blocks) - 1]) if collapsed else math.nan, history.ids[rows[order]], times, free, float(drift[peak]),
                          float(history.time[peak]), float(drift[-1]), excursion, float(history.time[beyond[0]]) if len(beyond) else math.nan,
                          history.base is not None, history.motion_run, history.run_in_words())
