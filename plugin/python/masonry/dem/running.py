"""Running a scene for so many seconds, or to the end of its motion."""

import contextlib
import math
import time

from masonry._given import number_given, shown
from masonry._progress import wanted
from yade import O, wrapper

from masonry.dem import notes
from masonry.dem.checks import listed
from masonry.dem.joint_engine import joint_engine_given
from masonry.dem.pushing import Push

# Wall clock between two looks at the bar, s.
_SHOWN = 0.1
# Simulated time between two looks at a condition, s.
_LOOKED = 0.01
# Share of a step by which O.time may miss the end: it is a sum of steps.
_ROUND_OFF = 1e-3


def motion_end(motion, name="until"):
    """When a motion engine, or the last one of a list, is over, s."""
    several = list(motion) if isinstance(motion, (list, tuple)) else [motion]
    for one in several:
        if not isinstance(one, wrapper.BaseMotionEngine):
            raise ValueError(f"{name} = {shown(one)}: must be a motion engine (RecordMotionEngine, PulseTrainEngine), or a list of them")
        if not one.end < math.inf:
            raise ValueError(f"{name}: the end of this {type(one).__name__} is not known (a resonant train ends with impacts to come): give seconds")
    if not several:
        raise ValueError(f"{name} = []: must name a motion engine")
    return max(one.end for one in several)


def _check_given(until):
    """ValueError where a motion that the script has made does not move the scene."""
    moving = [*O.engines, *(motion for engine in O.engines for motion in getattr(engine, "motions", ()))]
    for one in until if isinstance(until, (list, tuple)) else [until]:
        if notes.is_left_out(one) and not any(motion is one for motion in moving):
            raise ValueError(f"until: this {type(one).__name__} of body {listed(one.ids)} moves nothing: give it to dem.engines(motion=...)")


@contextlib.contextmanager
def _pauses():
    """A list that is no longer empty once O.pause() has been called, by a PyRunner for example."""
    kind, asked = type(O), []
    pause = kind.pause
    kind.pause = lambda _: asked.append(True)
    try:
        yield asked
    finally:
        kind.pause = pause


def _is_to_stop(before):
    """Whether O.stopAtIter or O.stopAtTime ends the run after the step that began at the time `before`, as in O.run()."""
    return O.iter == O.stopAtIter or before < O.stopAtTime - _ROUND_OFF * O.dt <= O.time


def _is_condition(until):
    return callable(until) and not isinstance(until, wrapper.Engine)  # YADE's engines can be called


def _condition(until):
    """The function that says whether to end."""
    return until.is_over if isinstance(until, Push) else until if _is_condition(until) else lambda: False


def _end_given(seconds, until):
    """The time at which the run ends at the latest, s."""
    if seconds is not None and not 0 < number_given("seconds", seconds) < math.inf:
        raise ValueError(f"seconds = {seconds}: must be positive and finite")
    if isinstance(until, Push):
        if not until.is_given():
            raise ValueError("until: this push moves nothing: O.engines = dem.engines(push)")
        return until.motion.end + 2 * O.dt if seconds is None else O.time + seconds
    if _is_condition(until):
        if seconds is None:
            raise ValueError("seconds = None: must say how long the run may wait for the condition `until`, s")
        return O.time + seconds
    if (seconds is None) == (until is None):
        raise ValueError(f"seconds = {seconds}, until = {until}: give one of the two, or seconds and a condition (a function)")
    end = O.time + seconds if until is None else motion_end(until)
    if not end > O.time:
        raise ValueError(f"until: that motion is over at {end:g} s and O.time = {O.time:g} s: give seconds")
    if until is not None:
        _check_given(until)
    return end


def run(seconds=None, until=None, progress=None):
    """Runs the scene and returns when that is done.

    seconds     how much simulated time from now on, s, positive; with a condition: at most
    until       a motion engine, or a list of them, instead of seconds: to the end of the last one. Or a condition, beside seconds: a function without arguments
                that says whether to end, as dem.at_rest, dem.overturned or dem.collapsed. Or a test of dem.push() or dem.pull_and_release(): to its end
    progress    a progress bar; None: where stderr is a terminal

    Returns True where a condition has ended the run, else False.

    The last step is the first one that reaches the end; O.stopAtIter, O.stopAtTime and O.pause(), which a PyRunner may call, end the run earlier. A condition is
    looked at before the first step, then once in 0.01 s and at the end. What goes wrong in the run is raised as it comes out of O.step(), which this calls;
    Ctrl-C stops between two steps. Raises ValueError where O.engines has no engine of dem.engines(), O runs already, the motion is over, or the script has not
    given it to an engine.
    """
    from tqdm import tqdm

    if not O.engines:
        raise ValueError("O.engines is empty: set O.engines = dem.engines(...)")
    joint_engine_given()
    if O.running:
        raise ValueError("O is running already: call O.pause() or O.wait() first")
    if not 0 < O.dt < math.inf:
        raise ValueError(f"O.dt = {O.dt}: must be positive and finite; dem.engines() chooses one")
    start, end, condition = O.time, _end_given(seconds, until), _condition(until)
    if condition():
        return True
    looked = start
    with _pauses() as paused, tqdm(total=float(f"{end - start:.4g}"), desc="run", disable=not wanted(progress), bar_format="{desc}: {percentage:3.0f}%|{bar}| {n:.3g} of {total:g} s [{elapsed}<{remaining}]") as bar:
        look = time.monotonic() + _SHOWN
        while O.time < end - _ROUND_OFF * O.dt:
            before = O.time
            O.step()
            if paused or _is_to_stop(before):
                break
            if O.time >= looked + _LOOKED:
                looked = O.time
                if condition():
                    break
            if time.monotonic() >= look:
                look = time.monotonic() + _SHOWN
                bar.update(min(O.time - start, bar.total) - bar.n)
        bar.update(min(O.time - start, bar.total) - bar.n)
    return bool(condition())
