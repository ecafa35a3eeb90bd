"""What the physics tests share: one block on a base, its history, and the balance of energy."""

import contextlib
import io
import math

import numpy as np
from masonry import dem
from yade import O, PyRunner

import masonry


def stone(restitution=None, **attributes):
    given = {} if restitution is None else {"restitution": restitution}
    return dem.BlockMat(density=2000, **{"noSlip": True, **given, **attributes})


def quiet_engines(*arguments, model="compliant", **options):
    with contextlib.redirect_stdout(io.StringIO()):
        return dem.engines(*arguments, model=model, **options)


def rigid_engines(*arguments, model="auto", **options):
    return quiet_engines(*arguments, model=model, **options)


def said_by(act, *arguments, **options):
    """What act(*arguments, **options) prints."""
    with contextlib.redirect_stdout(io.StringIO()) as said:
        act(*arguments, **options)
    return said.getvalue()


class Samples:
    """(time, value) every few steps, taken inside O.run()."""

    instance = None

    def __init__(self, value, iterPeriod=0, **period):
        self.times, self.values, self._value = [], [], value
        Samples.instance = self
        O.engines = O.engines + [PyRunner(command="import rocking_scene; rocking_scene.Samples.instance.take()", iterPeriod=iterPeriod, **period)]

    def take(self):
        self.times.append(O.time + O.dt)  # NewtonIntegrator has moved the bodies already; O.time follows after the step
        self.values.append(self._value())

    def peaks(self):
        """Largest |value| of each half cycle, by the parabola through three samples: error (period w)^4/1000 or so."""
        h = np.abs(self.values)
        top = np.flatnonzero((h[1:-1] >= h[2:]) & (h[1:-1] > h[:-2])) + 1
        left, mid, right = h[top - 1], h[top], h[top + 1]
        return mid + (right - left) ** 2 / (16 * mid - 8 * left - 8 * right)


class Balance:
    """Energy that appears (+) or is lost track of (-) since the first step, J."""

    def __init__(self):
        if O.iter == 0:
            O.step()
        self.start = self._sum()

    @staticmethod
    def _sum():
        e = dem.energy()
        return sum(e.values()) - 2 * e["baseWork"]

    def error(self):
        return self._sum() - self.start


def one_block(slenderness, half_width=0.3, restitution=None, depth=1.0, **attributes):
    """(base id, block id, masonry.RockingBlock) of a fresh scene."""
    O.reset()
    b, a = half_width, half_width * slenderness
    material = stone(restitution, **attributes)
    base = dem.base((6 * b + 4 * a, 2 * depth, b), material)
    block = dem.block((2 * b, depth, 2 * a), material, on=base)
    return base, block, masonry.RockingBlock(b, a)


def bits():
    """All that the physics leaves behind, each number by its bits: state of the bodies first. NaN is one value: its sign means nothing, depends
    on the compiler, and XML does not keep it."""
    engine = next(e for e in O.engines if hasattr(e, "impactTimes"))
    vectors = [v for b in O.bodies for v in (b.state.pos, b.state.ori, b.state.vel, b.state.angVel, b.state.angMom)]
    for i in sorted(O.interactions, key=lambda i: (i.id1, i.id2)):
        vectors += [(i.id1, i.id2), *i.phys.forces, *getattr(i.phys, "shears", ())]
    vectors += [value for name, value in sorted(engine.dict().items()) if name.startswith("impact") and isinstance(value, list)]
    counters = [getattr(engine, name) for name in ("sweeps", "events", "movingSteps") if hasattr(engine, name)]
    numbers = np.array([*(x for v in vectors for x in v), *dem.energy().values(), *counters, O.time], dtype=float)
    return np.where(np.isnan(numbers), np.nan, numbers).view(np.int64)


def barrier(id, block):
    """Energy from rest to overturning, J."""
    return O.bodies[id].state.mass * block.gravity * block.radius * (1 - math.cos(block.critical_angle))


def turned_over():
    """Energy that the scene has had in hand, J: what energy from nowhere is compared with."""
    return sum(value for key, value in dem.energy().items() if key not in ("potential", "baseWork"))


def joint_engine():
    return next(e for e in O.engines if isinstance(e, dem.RockingJointEngine))


def steps(count):
    """A short O.run(count, True), which looks every 40 ms only whether it has ended."""
    for _ in range(count):
        O.step()


def run_impacts(count, t_end):
    """Runs until so many impacts have been counted, at most to t_end (s). Returns them all."""
    while len(dem.impacts()) < count and O.time < t_end:
        O.run(5000, True)
    return dem.impacts()


def refuses(act, *words, kind=ValueError):
    """act() ends in an error of that kind, whose text, returned, holds all the words."""
    try:
        act()
    except kind as error:
        assert all(word in str(error) for word in words), (words, error)
        return str(error)
    raise AssertionError(f"accepted: {words}")


def refuses_to_run(*words):
    """The first step ends in an error, and so does the next; the blocks have not moved."""
    poses = [(tuple(b.state.pos), tuple(b.state.ori)) for b in O.bodies]
    for _ in range(2):
        refuses(O.step, *words, kind=(RuntimeError, ValueError))
        assert poses == [(tuple(b.state.pos), tuple(b.state.ori)) for b in O.bodies], words
