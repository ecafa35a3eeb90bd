"""Exact histories of rocking blocks."""

from functools import cached_property

import numpy as np

from . import _core
from ._arrays import columns, restore, shape_of
from ._calls import warn
from ._files import check_csv, save_picture, written
from ._given import array_given, shown, whole_given
from ._optional import needs
from .block import columns_of, critical_angle_of, restitution_of
from .motions import Motion, PulseTrain, Record, Still, compiled, end_of


# Relative to the time at which a motion ends, how much earlier a run may end by rounding of sums of steps.
_ROUND = 1e-9
# Instants of History.times, and the share of the last event at which they end.
_POINTS, _AFTER = 4000, 1.02


class History:
    """What happened to the block(s). Scalar input: 1-D arrays and scalars. Array input: the cases' shape comes first, and the
    last axis is filled up with NaN. Angles and angular velocities are signed.

    impact_times         s
    impact_velocities    angular velocity just before each impact, rad/s
    peak_angles          largest angle of each half cycle, rad; a block released from rest starts at its first peak
    peak_times           s
    overturned           bool; where False, it stands for as much of the motion as has been run: motion_run
    motion_run           share of the motion of the base that has been run, 0 to 1: 1 where there is none and where nothing more will happen, 0 where it has no
                         known end
    overturn_half_cycle  the half cycle 1, 2, ... in which it overturns; 0: it does not
    rest_time            s, since when it has been at rest; NaN: it was rocking (or had overturned) when the run ended
    end_time             s; infinite: nothing more will happen
    base_displacement    of the base at the end of the run, m

    block, motion, vertical, restitution, restoring    as simulate() was given them; motions None: none, restitution None: the natural one
    """

    def __init__(self, shape, arguments, result, given):
        self.shape = shape
        self.block, self.motion, self.vertical, self.restitution, self.restoring = given
        self._arguments = arguments
        for name, value in result.items():
            setattr(self, name, restore(value, shape))
        self.overturned = self.overturn_half_cycle > 0
        ends = self._motion_ends()
        with np.errstate(invalid="ignore"):  # an infinite run of a motion without an end
            share = np.where(np.isinf(self.end_time) | (self.end_time >= (1 - _ROUND) * ends), 1.0, self.end_time / np.where(ends > 0, ends, 1.0))
        self.motion_run = share if shape else share.item()

    def _motion_ends(self):
        """When the motions of the base end, s: an array of the cases' shape."""
        ends = [end_of(motion, self.shape, self.impact_times) for motion in (self.motion, self.vertical) if motion is not None]
        return np.max(ends, axis=0) if ends else np.zeros(self.shape)

    def _sample(self, t):
        return [restore(table.reshape((-1,) + np.shape(t)), self.shape)
                for table in _core.sample(*self._arguments, np.ravel(np.asarray(t, dtype=float)))]

    def sample(self, t):
        """(angle, angular velocity) at times t >= 0 (s): shape of the cases, then shape of t. NaN after end_time and once the
        block lies on its side. The run is repeated for it, so ask for many times at once."""
        angle, velocity, _ = self._sample(t)
        return angle, velocity

    def sample_base(self, t):
        """Displacement of the base at times t, m; of a resonant train too."""
        return self._sample(t)[2]

    def __repr__(self):
        cases, falls = np.size(self.overturned), np.count_nonzero(self.overturned)
        critical = [np.reshape(np.broadcast_to(edge.critical_angle, self.shape), (*self.shape, 1)) for edge in (self.block.right, self.block.left)]
        ratio = np.where(self.peak_angles > 0, self.peak_angles / critical[0], -self.peak_angles / critical[1])
        largest = np.max(ratio, where=~np.isnan(ratio) & ~np.reshape(self.overturned, (*self.shape, 1)), initial=0)
        if self.shape:
            stand = f"{cases - falls} stand and rotate to at most {largest:.3g} of the critical angle" if falls < cases else "none stands"
            partly = np.count_nonzero((self.motion_run < 1) & ~self.overturned)
            stand += f", {partly} of them after only a part of the motion" if partly else ""
            return f"History({' x '.join(map(str, self.shape))} cases: {falls} overturn, {stand})"
        done = f"overturns in half cycle {self.overturn_half_cycle}" if falls else \
            f"stands, {len(self.impact_times)} impacts, at most {largest:.3g} of the critical angle{part_of_motion(self)}"
        under = "on a still base" if self.motion is None else f"under {shown(self.motion)}"
        rest = f", at rest from {self.rest_time:.4g} s on" if np.isfinite(self.rest_time) else "" if falls else f", still rocking at {self.end_time:.4g} s"
        block = self.block
        size = f"of {2 * block.half_width:g} x {2 * block.half_height:g} m" if block.right is block else f"{block}".removeprefix("RockingBlock ")
        return f"History(block {size} {under}: {done}{rest})"

    def _of_one(self, what):
        if self.shape:
            raise ValueError(f"the history is of {self.shape} cases: must be of one block and one motion {what}")

    def _shown_end(self):
        """Time until which something happens, s."""
        lies = self._fall()[1] if self.overturned else np.nan
        ends = [self.motion.duration if isinstance(self.motion, Record) else 0.0, *np.ravel(self.impact_times)[-1:], self.rest_time, self.end_time, lies]
        return max((end for end in ends if np.isfinite(end) and end > 0), default=1.0)

    @cached_property
    def times(self):
        """(4000,) s, evenly from 0 to a little after the last thing that happens, of one block; angles and velocities belong to them. sample(t) has those of other times."""
        self._of_one("to have times")
        return np.linspace(0, _AFTER * self._shown_end(), _POINTS)

    @cached_property
    def _sampled(self):
        return self.sample(self.times)

    @property
    def angles(self):
        """(4000,) rad, at `times`; NaN once the block lies on its side, or after the end of the run."""
        return self._sampled[0]

    @property
    def velocities(self):
        """(4000,) angular velocities at `times`, rad/s."""
        return self._sampled[1]

    def to_csv(self, path, times=None):
        """Writes a .csv file of one block, a line for each of `times` (s, None: history.times): time (s), angle (rad), angular velocity (rad/s), displacement of
        the base (m) and, of a record, its acceleration (m/s^2)."""
        check_csv(path)
        self._of_one("to be written as a table")
        times = self.times if times is None else np.ravel(array_given("times", times))
        angle, velocity, base = self._sample(times)
        columns = {"time (s)": times, "angle (rad)": angle, "angular velocity (rad/s)": velocity, "base (m)": base}
        if isinstance(self.motion, Record):
            columns["acceleration of the base (m/s^2)"] = self.motion.acceleration(times)
        with written(path) as beside:
            np.savetxt(beside, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")

    def _is_inside(self, t):
        """Whether the angle of one block is below its critical angle at times t."""
        angle = self.sample(t)[0]
        return np.abs(angle) < critical_angle_of(self.block, angle)

    def _fall(self):
        """(time at which one block that overturns passes its critical angle for good, time at which it lies on its side or the run ends), s."""
        begin, end = 0.0, 1.0
        while np.isfinite(self.sample(end)[0]):
            begin, end = end, 2 * end
        after = lambda t: np.isnan(self.sample(t)[0])  # noqa: E731
        lies = _first(after, begin, end)
        inside = self._is_inside(np.linspace(0, lies, 4000))
        last = np.flatnonzero(inside)[-1]
        step = lies / 3999
        return _first(lambda t: ~self._is_inside(t), last * step, min((last + 1) * step, lies)), lies

    def draw(self, path):
        """Writes a picture (.png, .pdf or .svg) of one block: its angle relative to the critical one, and the motion of the base below it. The title says
        whether it overturns: when it passes its critical angle for good."""
        with needs("python3-matplotlib", "a picture of a history"):
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure
        self._of_one("to be drawn")
        passes = self._fall()[0] if self.overturned else np.nan
        times = self.times
        figure = Figure(figsize=(8, 5), layout="constrained")
        FigureCanvasAgg(figure)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        angles = self.angles / critical_angle_of(self.block, self.angles)
        above.plot(times, angles, color="tab:blue")
        for level in (-1, 1):
            above.axhline(level, color="0.6", linestyle="--", linewidth=0.8)
        verdict = f"overturns at {passes:.4g} s, in half cycle {self.overturn_half_cycle}" if self.overturned else f"stands, {len(self.impact_times)} impacts{part_of_motion(self)}"
        above.set(ylabel="angle / critical angle", title=verdict, ylim=1.1 * np.array([-1, 1]) * np.clip(np.nanmax(np.abs(angles)), 1, 1.5))
        if isinstance(self.motion, Record):
            below.plot(times, self.motion.acceleration(times), color="tab:red", linewidth=0.8)
            below.set(ylabel="base (m/s^2)")
        else:
            below.plot(times, self.sample_base(times), color="tab:red")
            below.set(ylabel="base (m)")
        below.set(xlabel="time (s)", xlim=(0, times[-1]))
        save_picture(figure, path, dpi=150)


def part_of_motion(history):
    """How much of the motion has been run, in words; '' where all of it has been, or where the block has overturned."""
    if history.overturned or history.motion_run == 1:
        return ""
    end = history._motion_ends()
    return f", after {history.end_time:.4g} " + ("s of a motion without a known end" if np.isinf(end) else f"of {end:.4g} s of the motion")


def _first(holds, begin, end, points=1000):
    """The first time in [begin, end] at which holds(times) is true, to a millionth of the interval; it is at the end."""
    for _ in range(2):
        times = np.linspace(begin, end, points)
        first = max(int(np.argmax(holds(times) | (times == end))), 1)
        begin, end = times[first - 1], times[first]
    return end


def warn_of_doubt(*motions):
    """A warning for each record among them whose unit is in doubt."""
    for record in motions:
        if isinstance(record, Record) and record.doubt():
            warn(record.doubt())


def _motion_given(name, motion):
    motion = Still() if motion is None else motion
    if not isinstance(motion, Motion):
        raise ValueError(f"{name} = {shown(motion)}: must be a motion of masonry (PulseTrain, Sine, Record, ...) or None")
    return motion


def case_arguments(block, motion, restitution, restoring, initial_angle, initial_velocity, t_end, half_cycles, vertical=None):
    """(shape of the cases, arguments of the compiled functions)"""
    motion, vertical = _motion_given("motion", motion), _motion_given("vertical", vertical)
    if isinstance(vertical, PulseTrain) and vertical.times is None:
        raise ValueError(f"vertical = {shown(vertical)}: must be a motion with a known course, not a resonant train")
    restitution = [restitution_of(edge, restitution) for edge in (block.right, block.left)]
    t_end = np.inf if t_end is None else t_end
    half_cycles = -1 if half_cycles is None else whole_given("half_cycles", half_cycles, 1)
    shape = np.broadcast_shapes(block.shape, motion.shape, vertical.shape, shape_of(restitution[0], initial_angle, initial_velocity, t_end))
    state = columns(shape, *restitution, initial_angle, initial_velocity, t_end)
    return shape, (columns_of(block, shape), compiled(motion, shape), compiled(vertical, shape), state, restoring, half_cycles)


def simulate(block, motion=None, restitution=None, restoring="exact", initial_angle=0.0, initial_velocity=0.0, t_end=None, half_cycles=None,
             vertical=None):
    """History of the block(s) from the given state under the motion of the base; all arguments but the names broadcast.

    restitution: C in [0, 1]; None or NaN: the block's natural one. restoring: 'exact' (gravity as it is), 'linear' (Housner), 'constant'
    (Casapulla and Maione). The run ends at t_end (s), after so many half_cycles, or when the motion is over and the block at rest
    or overturned. A block is overturned when it cannot come back (free), lies on its side (moved base), or has reached the
    critical angle (constant moment).

    vertical: the base's motion upwards, whose acceleration adds to gravity; it must stay above -gravity, because the block keeps to its base."""
    shape, arguments = case_arguments(block, motion, restitution, restoring, initial_angle, initial_velocity, t_end, half_cycles, vertical)
    warn_of_doubt(motion, vertical)
    return History(shape, arguments, _core.simulate(*arguments), (block, motion, vertical, restitution, restoring))


def with_exact_moment(history, end):
    """History of the same block and motion with the exact restoring moment, until `end` (s)."""
    _, _, angle, velocity, _ = (float(column[0]) for column in history._arguments[3])
    return simulate(history.block, history.motion, history.restitution, "exact", angle, velocity, end, vertical=history.vertical)
