"""Largest rotations and overturning amplitudes on a grid of motions and blocks."""

import inspect

import numpy as np

from .. import _core
from .._arrays import restore
from .._calls import near_words
from .._given import shown
from .._progress import chunks, steps
from ..block import RockingBlock
from ..history import case_arguments, warn_of_doubt
from ..motions import Motion, PulseTrain, Record
from ..overturning import overturning_amplitude
from ._grid import UNITS, Spectrum, outer


def peak_ratio(block, motion, restitution=None, restoring="exact", t_end=None, half_cycles=None, vertical=None, since=0.0, progress=False):
    """Largest rotation over the critical angle, without sign, of blocks that start upright and at rest; infinite where the block overturns. All
    arguments but the names broadcast; the shape is that of the cases. It is below 1 for nearly all blocks that stand: a moving base can bring a
    block back that has passed its critical angle.

    since: peaks before this time (s) are left out, for a steady state. The other arguments are those of simulate()."""
    warn_of_doubt(motion, vertical)
    shape, (blocks, motions, vertical, state, restoring, half_cycles) = case_arguments(block, motion, restitution, restoring, 0.0, 0.0, t_end, half_cycles,
                                                                                       vertical)
    critical = [np.broadcast_to(edge.critical_angle, shape).ravel() for edge in (block.right, block.left)]
    ratio = np.zeros(critical[0].size)
    for begin, end in chunks(ratio.size, progress, "rocking"):
        part = slice(begin, end)
        found = _core.simulate(tuple(column[part] for column in blocks), motions.part(begin, end), vertical.part(begin, end),
                               tuple(column[part] for column in state), restoring, half_cycles)
        peaks = np.where(found["peak_times"] >= since, found["peak_angles"], 0.0)  # NaN times of short rows count as 0
        largest = np.maximum(peaks.max(axis=1, initial=0.0) / critical[0][part], -peaks.min(axis=1, initial=0.0) / critical[1][part])
        ratio[part] = np.where(found["overturn_half_cycle"] > 0, np.inf, largest + 0.0)  # not -0.0 where the block rests
    return restore(ratio, shape)


def rocking(motion, width, slenderness, restitution=None, gravity=9.81, restoring="exact", t_end=None, half_cycles=None, progress=False, **parameters):
    """Rocking spectrum: the largest rotation over the critical angle (`ratio`, infinite where the block overturns) and whether it overturns
    (`overturned`), for blocks that start upright and at rest.

    motion        masonry.Sine, HalfSine, Rectangular or PulseTrain, whose numbers follow by name (amplitude=, frequency=, ...); or one motion, a
                  Record for instance, which is multiplied by scale=
    width         whole width 2b, m
    slenderness   height over width
    restitution   C; None: the natural one
    progress      a progress bar (tqdm); None: where stderr is a terminal

    Each number may be a list, and each list is a dimension of the result, those of the motion first. restoring, t_end and half_cycles are those of
    simulate().
    """
    dims, coords, made, fixed = _grid(motion, parameters, width, slenderness, restitution, gravity)
    ratio = peak_ratio(made.block, made.motion, made.restitution, restoring, t_end, half_cycles, progress=progress)
    ratio = np.broadcast_to(ratio, tuple(len(coords[name]) for name in dims))
    return Spectrum(dims, coords, {"ratio": ratio, "overturned": np.isinf(ratio)}, UNITS, {"quantity": "rotation over critical angle", **fixed})


def overturning(motion, width, slenderness, restitution=None, gravity=9.81, restoring="exact", samples=400, progress=False, **parameters):
    """Overturning spectrum: the least `amplitude` (impulse, scale) of the motion that overturns, and the same over that which lifts a block from
    rest (`amplitude_over_uplift`, not for pulse trains). NaN where none up to 40 times that does: see masonry.overturning_amplitude, which finds it.

    The arguments are those of rocking(), without amplitude=, impulse= or scale=.
    """
    name = "scale" if isinstance(motion, Motion) else "impulse" if motion is PulseTrain else "amplitude"
    if name in parameters:
        raise ValueError(f"{name} = {shown(parameters[name])}: must be left out: it is what is looked for")
    dims, coords, made, fixed = _grid(motion, {name: 1.0, **parameters}, width, slenderness, restitution, gravity)
    del fixed[name]
    shape = tuple(len(coords[name]) for name in dims)
    columns = {key: np.broadcast_to(value, shape).ravel() for key, value in made.columns.items()}
    first = np.full(int(np.prod(shape)), np.nan)
    for i in steps(range(first.size), progress, "overturning"):
        one = {key: column[i].item() for key, column in columns.items()}
        block = RockingBlock.from_size(one["width"], one["width"] * one["slenderness"], gravity)
        shaken = _motion(motion, {key: one[key] for key in made.parameters})
        found = overturning_amplitude(block, shaken, one["restitution"], restoring, samples=samples)
        first[i] = found[0] / shaken.amplitude if len(found) else np.nan
    values = {name: first.reshape(shape)}
    if not isinstance(made.motion, PulseTrain):
        peak = made.motion.peak if isinstance(made.motion, Record) else made.motion.amplitude
        values[f"{name}_over_uplift"] = values[name] * peak * np.broadcast_to(made.columns["slenderness"], shape) / gravity
    return Spectrum(dims, coords, values, UNITS, {"quantity": "least amplitude that overturns", **fixed})


class _Made:
    """The block and the motion of a grid, as arrays that broadcast over its dimensions."""

    def __init__(self, motion, parameters, arrays, gravity):
        self.parameters = parameters
        self.columns = arrays
        self.block = RockingBlock.from_size(arrays["width"], np.multiply(arrays["width"], arrays["slenderness"]), gravity)
        self.motion = _motion(motion, {name: arrays[name] for name in parameters})
        self.restitution = arrays["restitution"]


def _grid(motion, parameters, width, slenderness, restitution, gravity):
    natural = restitution is None
    dims, coords, arrays = outer(**parameters, width=width, slenderness=slenderness, restitution=np.nan if natural else restitution)
    made = _Made(motion, tuple(parameters), arrays, gravity)
    name = repr(motion) if isinstance(motion, Motion) else motion.__name__
    fixed = {"motion": name, **{key: value for key, value in arrays.items() if key not in dims}, "gravity": gravity}
    if natural:
        fixed["restitution"] = "natural"
    return dims, coords, made, fixed


def _motion(motion, parameters):
    if isinstance(motion, Motion):
        if set(parameters) - {"scale"}:
            raise ValueError(f"{', '.join(sorted(set(parameters) - {'scale'}))}: must be left out for {shown(motion)}, which takes scale= alone")
        if motion.shape:
            raise ValueError(f"motion = {shown(motion)}: must be one motion, of single numbers; give their list by name")
        return motion.scaled(parameters.get("scale", 1.0))
    if not (isinstance(motion, type) and issubclass(motion, Motion)):
        raise ValueError(f"motion = {shown(motion)}: must be masonry.Sine, HalfSine, Rectangular or PulseTrain (without brackets), or one motion")
    numbers = list(inspect.signature(motion).parameters)
    unknown = next((name for name in parameters if name not in numbers), None)
    if unknown is not None:
        raise ValueError(f"motion = {motion.__name__}: it has no `{unknown}`; {near_words(unknown, numbers)} Its numbers are {', '.join(numbers)}")
    try:
        inspect.signature(motion).bind(**parameters)
    except TypeError as error:
        raise ValueError(f"motion = {motion.__name__}: {error}; its numbers are {', '.join(numbers)}") from None
    return motion(**parameters)
