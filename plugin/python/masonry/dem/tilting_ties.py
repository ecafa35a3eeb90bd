"""Ties of a scene under the constant loads of a TiltTable."""

import contextlib
import math

from masonry.dem.ties import ties
from yade import Vector3

# A step changes these values of a tie.
_STATE = ("length", "broken", "brokenAt", "force", "extension", "energy")


class TiltedTies:
    """The living ties of a scene, and their state as built.

    A constant load makes blocks swing on a tie, up to twice the force that balances the load. Statics knows neither the swing nor the rate of the load: blocks are
    stopped where they are fastest, which is where the forces balance (kinetic damping), and a tie breaks where the blocks rest and it bears more than its strength,
    the most overloaded one first."""

    def __init__(self):
        self._ties = [one for one in ties() if not one.dead]
        self._built = [{name: getattr(one, name) for name in _STATE} for one in self._ties]
        self._strengths = [one.strength for one in self._ties]
        self._fastest, self._extensions = 0.0, []

    def __bool__(self):
        return bool(self._ties)

    def put_back(self):
        for one, state in zip(self._ties, self._built):
            one.updateAttrs(state)

    @contextlib.contextmanager
    def loaded(self):
        """A load is held: ties break by break_worst() alone."""
        self._fastest, self._extensions = 0.0, [one.extension for one in self._ties]
        self._give_strengths([math.inf] * len(self._ties))
        try:
            yield
        finally:
            self._give_strengths(self._strengths)

    def brake(self, blocks, speed):
        """Stops the blocks where their speed falls."""
        if speed < self._fastest:
            for body in blocks:
                body.state.vel = body.state.angVel = Vector3.Zero
            self._fastest = 0.0
        else:
            self._fastest = speed

    def break_worst(self):
        """Gives the most overloaded tie its strength, so that the next step breaks it. Whether there was one."""
        k = max(range(len(self._ties)), key=lambda k: self._ties[k].force / self._strengths[k], default=None)
        if k is None or self._ties[k].force <= self._strengths[k]:
            return False
        self._ties[k].strength = self._strengths[k]
        return True

    def hold_more(self, least):
        """Whether ties that bear force have stretched or shortened under the load, by more than that, m."""
        return any(one.force != 0 and abs(one.extension - before) > least for one, before in zip(self._ties, self._extensions))

    def broken(self):
        """How many have broken since the scene was built."""
        return sum(one.broken and not state["broken"] for one, state in zip(self._ties, self._built))

    def _give_strengths(self, strengths):
        for one, strength in zip(self._ties, strengths):
            one.strength = strength
