"""Base motions: along x, exact at any time. Amplitudes, impulses and durations may be arrays (one motion a case).

Every motion with a known course has .acceleration(t), .velocity(t), .displacement(t) (m/s^2, m/s, m; values right of a jump).
"""

import math

import numpy as np

from . import _core
from ._given import array_given, number_given, positive_given, shown, whole_given
from ._arrays import columns, restore, shape_of
from ._readers import STANDARD_GRAVITY, read_at2, read_csv, unit_factor


class Motion:
    """Base class. A motion of one amplitude can be scaled: .amplitude, and .scaled(factor)."""

    shape = ()

    def _motions(self, shape):
        """The compiled motions, one a case of that shape (or one for all)."""
        raise NotImplementedError

    def _values(self, t, which):
        table = self._motions(self.shape).values(np.ravel(np.asarray(t, dtype=float)))[which]
        return restore(table.reshape((math.prod(self.shape),) + np.shape(t)), self.shape)

    def acceleration(self, t):
        return self._values(t, 0)

    def velocity(self, t):
        return self._values(t, 1)

    def displacement(self, t):
        return self._values(t, 2)


class Still(Motion):
    """A base that does not move."""

    def _motions(self, shape):
        return _core.none()


class PulseTrain(Motion):
    """Jumps of the base velocity: +I, -2I, +2I, ... (m/s), so that the base moves at +I, -I, +I, ...

    times=None     resonant: the first at t = 0, each other right after an impact of the block. With half_cycles=n the jump
                   after impact n is I and brings the base to rest; without, the train has no end.
    times=[...]    at these times (s, increasing); with assembly=True the last jump is I and brings the base to rest.

    shape: 'dirac', or 'rectangular' or 'half-sine' with a duration (s), that of a pulse of 2I. single_keeps says what the pulses of I (the first,
    and the last one where that brings the base to rest) share with it: 'amplitude', for half the duration, or 'duration', at half the amplitude.
    A pulse of a resonant train must have ended at the next impact.
    """

    def __init__(self, impulse, times=None, half_cycles=None, assembly=False, shape="dirac", duration=0.0, single_keeps="amplitude"):
        array_given("impulse", impulse)
        half_cycles = half_cycles if half_cycles is None else whole_given("half_cycles", half_cycles, 1)
        if half_cycles is not None and times is not None:
            raise ValueError(f"half_cycles = {half_cycles}: must be left out with times, it is for a resonant train (times=None)")
        if times is None and assembly:
            raise ValueError(f"assembly = {assembly}: must be left out for a resonant train (times=None); half_cycles brings its base to rest")
        if number_given("duration", duration) != 0 and shape == "dirac":
            raise ValueError(f"duration = {shown(duration)}: must be left out (0) for dirac pulses; shape='rectangular' or 'half-sine' has one")
        self.impulse = self.amplitude = impulse
        self.times = None if times is None else np.atleast_1d(array_given("times", times))
        self.half_cycles, self.assembly = half_cycles, assembly
        self.pulse_shape, self.duration, self.single_keeps = shape, duration, single_keeps
        self.shape = np.shape(impulse)
        if assembly and self.times.size < 2:
            raise ValueError(f"assembly = True: must be left out with {self.times.size} pulses, of which none brings the base to rest")
        motions = self._motions(self.shape)
        if shape != "dirac":
            positive_given("duration", duration, ", in s")
        if self.times is not None:
            motions.values(np.zeros(1))  # refuses bad input here

    def __repr__(self):
        times = None if self.times is None else self.times.tolist()
        given = (("times", times, None), ("half_cycles", self.half_cycles, None), ("assembly", self.assembly, False), ("shape", self.pulse_shape, "dirac"),
                 ("duration", self.duration, 0), ("single_keeps", self.single_keeps, "amplitude"))
        return f"PulseTrain(impulse={self.impulse}{''.join(f', {name}={value!r}' for name, value, default in given if value != default)})"

    def scaled(self, factor):
        return PulseTrain(np.multiply(self.impulse, factor), self.times, self.half_cycles, self.assembly, self.pulse_shape, self.duration, self.single_keeps)

    def _motions(self, shape):
        impulse, = columns(shape, self.impulse)
        form = (self.pulse_shape, float(self.duration), self.single_keeps)
        if self.times is None:
            return _core.resonant(impulse, self.half_cycles or -1, *form)
        return _core.pulses(impulse, self.times, self.assembly, *form)


class _Shaped(Motion):
    """A motion of a few numbers, the first of which is the amplitude."""

    def __init__(self, maker, **parameters):
        for name, value in parameters.items():
            array_given(name, value)
        self._maker, self._parameters = maker, parameters
        self.__dict__.update(parameters)
        self.shape = shape_of(*parameters.values())
        self.acceleration(0.0)  # refuses bad input here

    def scaled(self, factor):
        return type(self)(**{**self._parameters, "amplitude": np.multiply(self.amplitude, factor)})

    def _motions(self, shape):
        return self._maker(*columns(shape, *self._parameters.values()))

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{name}={value}' for name, value in self._parameters.items())})"


class Rectangular(_Shaped):
    """Constant acceleration `amplitude` (m/s^2) for `duration` (s)."""

    def __init__(self, amplitude, duration):
        super().__init__(_core.rectangular, amplitude=amplitude, duration=duration)


class HalfSine(_Shaped):
    """Acceleration amplitude sin(pi t/duration) for `duration` (s)."""

    def __init__(self, amplitude, duration):
        super().__init__(_core.half_sine, amplitude=amplitude, duration=duration)


class Sine(_Shaped):
    """Acceleration amplitude sin(2 pi frequency t), frequency in Hz, for `cycles` (> 0, need not be whole)."""

    def __init__(self, amplitude, frequency, cycles=1):
        super().__init__(_core.sine, amplitude=amplitude, frequency=frequency, cycles=cycles)


class Record(Motion):
    """Accelerogram: `scale` times the accelerations, `dt` (s) apart, the first at t = 0, linear between them, zero after the last.
    Velocity and displacement are its exact integrals. `scale` may be an array: one case each. In YADE: dem.record_motion(record, ids).

    baseline: 'none'; 'constant': the mean acceleration is subtracted, so that the last velocity is zero; 'linear': the slope
    of the straight line through the origin that fits the velocity best (least squares) is subtracted.
    unit: of the accelerations: 'm/s^2', 'cm/s^2', 'mm/s^2' or 'g' (that is `gravity`, m/s^2: the standard one, whatever the blocks weigh).
    None: m/s^2, and a run under a record whose peak is 0.1 to 1.5 asks whether it is in g.
    """

    def __init__(self, dt, acceleration, scale=1.0, baseline="none", name="", unit=None, gravity=STANDARD_GRAVITY):
        self.dt = float(number_given("dt", dt))
        self._unscaled = np.ascontiguousarray(array_given("acceleration", acceleration))
        if unit != "m/s^2" and unit is not None:
            self._unscaled = unit_factor(unit, gravity) * self._unscaled
        self.unit_given = unit is not None
        if self._unscaled.ndim != 1:
            raise ValueError(f"acceleration has the shape {self._unscaled.shape}: must be one row of samples, at least two")
        array_given("scale", scale)
        self.scale = self.amplitude = scale
        self.baseline = baseline
        self.name = name
        self.shape = np.shape(scale)
        self.velocity(0.0)  # refuses bad input here

    @property
    def samples(self):
        """The accelerations with the scale in them, before the baseline is subtracted, m/s^2: a new array, the shape of `scale` in front."""
        samples = np.multiply.outer(self.scale, self._unscaled)
        samples.flags.writeable = False  # writing into it would change nothing
        return samples

    @property
    def peak(self):
        """The largest of the samples, without sign, m/s^2: the shape of `scale`."""
        return restore(np.abs(np.ravel(self.scale)) * np.abs(self._unscaled).max(), self.shape)

    @property
    def duration(self):
        """Time of the last sample, s."""
        return self.dt * (len(self._unscaled) - 1)

    def scaled(self, factor):
        return Record(self.dt, self._unscaled, np.multiply(self.scale, factor), self.baseline, self.name, "m/s^2" if self.unit_given else None)

    def doubt(self):
        """A sentence that asks whether the record is in g, where it has no unit and its peak is one of strong motion in g; else ''."""
        peak = np.max(self.peak)
        if self.unit_given or not 0.1 <= peak <= 1.5:
            return ""
        return (f"The record{' ' + repr(self.name[:60]) if self.name else ''} has no unit and a peak of {peak:.3g}: is it in g? It is taken in m/s^2, "
                f"{peak / STANDARD_GRAVITY:.2g} g. Give unit='g' or unit='m/s^2' to Record.")

    def _motions(self, shape):
        scale, = columns(shape if np.ndim(self.scale) else (), self.scale)
        return _core.record(self.dt, self._unscaled, scale, self.baseline)

    def __repr__(self):
        return (f"Record({self.name + ': ' if self.name else ''}{len(self._unscaled)} samples, dt={self.dt:g} s, "
                f"at most {np.abs(self.samples).max():.3g} m/s^2, baseline={self.baseline!r})")

    @classmethod
    def from_at2(cls, path, scale=1.0, baseline="none", gravity=STANDARD_GRAVITY):
        """PEER NGA file (.AT2). The unit is the one that line 3 states: G (that is `gravity`, m/s^2: the standard one, whatever the blocks weigh,
        9.81 elsewhere), G/10, %G, CM/S^2, GAL or M/S^2; DT is in SEC or MSEC. Another unit, a velocity or a displacement is refused."""
        positive_given("gravity", gravity, ", in m/s^2")
        name, dt, samples = read_at2(path, gravity)
        return cls(dt, samples, scale, baseline, name=name, unit="m/s^2")

    @classmethod
    def from_csv(cls, path, unit, dt=None, scale=1.0, baseline="none", gravity=STANDARD_GRAVITY, columns=None):
        """Columns time, acceleration; or one column of acceleration with `dt` (s). unit: 'm/s^2', 'cm/s^2', 'mm/s^2' or 'g' (that is
        `gravity`, m/s^2: the standard one, whatever the blocks weigh, 9.81 elsewhere).

        columns: which ones of a file with more, (time, acceleration) or acceleration, by number (from 0) or by their names in the first line.
        Columns are parted by commas or by blanks, numbers have decimal points and may have Fortran's exponents (1.2D-3). Lines that start with
        # or % and one first line of words are skipped. Times may be rounded to their last digit."""
        dt, samples = read_csv(path, unit, dt, gravity, columns)
        return cls(dt, samples, scale, baseline, name=str(path), unit="m/s^2")
