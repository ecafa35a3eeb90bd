"""Base motions: along x, exact at any time. Amplitudes, impulses and durations may be arrays (one motion a case). Accelerations are at most 1e6 m/s^2 and
velocity jumps 2e6 m/s; larger ones, such as the numbers that stand for missing values in files, are refused.

Every motion with a known course has .acceleration(t), .velocity(t), .displacement(t) (m/s^2, m/s, m; values right of a jump).
"""

import copy
import math

import numpy as np

from . import _core
from . import _records
from ._arrays import columns, restore, shape_of
from ._from_motion import accelerations, resolution_of
from ._given import array_given, number_given, positive_given, shown, whole_given
from ._high_pass import high_pass, padding
from ._records.units import QUANTITIES, STANDARD_GRAVITY, unit_factor


class Motion:
    """Base class. A motion of one amplitude can be scaled: .amplitude, and .scaled(factor)."""

    shape = ()

    def _motions(self, shape):
        """The compiled motions, one a case of that shape (or one for all)."""
        raise NotImplementedError

    def _end(self):
        """When it ends, s: a number or an array of self.shape; infinite where that is not known."""
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

    def _end(self):
        return 0.0

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

    def _last_pulse(self):
        """Duration of the pulse that brings the base to rest, or of the last one, s."""
        single = self.half_cycles is not None or self.assembly or self.times is not None and self.times.size == 1
        return self.duration / 2 if single and self.single_keeps == "amplitude" else self.duration

    def _end(self):
        if self.times is None:
            return np.inf
        return self.times[-1] + self._last_pulse() if self.times.size else 0.0

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

    def _end(self):
        return self.duration


class HalfSine(_Shaped):
    """Acceleration amplitude sin(pi t/duration) for `duration` (s)."""

    def __init__(self, amplitude, duration):
        super().__init__(_core.half_sine, amplitude=amplitude, duration=duration)

    def _end(self):
        return self.duration


class Sine(_Shaped):
    """Acceleration amplitude sin(2 pi frequency t), frequency in Hz, for `cycles` (> 0, need not be whole)."""

    def __init__(self, amplitude, frequency, cycles=1):
        super().__init__(_core.sine, amplitude=amplitude, frequency=frequency, cycles=cycles)

    def _end(self):
        return np.divide(self.cycles, self.frequency)


_BASELINES = "none", "constant", "linear", "high-pass"
# m/s^2: no motion of the ground, so the unit is another.
_FASTEST = 50
# s: strong motion is recorded in steps of 2.5 to 20 ms, so longer ones are rather in ms.
LONGEST_STEP = 0.5
# m/s^2, m/s or m: the limit of the accelerations of a base, and of samples that make them.
_LARGEST = 1e6
# Steps at the ends of a displacement or velocity in which a way to or from rest shows.
_EDGE = 10


class Record(Motion):
    """Motion of a base that was recorded: accelerations `dt` (s) apart, times `scale`, the first at t = 0, linear between them, zero after the last.
    Velocity and displacement are their exact integrals. `scale` may be an array: one case each. In YADE: dem.record_motion(record, ids).

    acceleration, velocity, displacement: one of them is given. Velocities and displacements become the accelerations of a smooth motion. It differs from the
    samples by what their rounding leaves, so that four decimals do not become noise; samples without rounding are met. The base starts from rest, at the
    place of the first displacement; it ends exactly at the last displacement, at rest, or with exactly the last velocity.

    unit: of the samples: 'm/s^2', 'cm/s^2', 'mm/s^2' or 'g' (that is `gravity`, m/s^2: the standard one, whatever the blocks weigh); 'm/s', 'cm/s', 'mm/s';
    'm', 'cm', 'mm'. None: SI units, and a run under a record whose peak may be one in g, or one of displacements in mm, asks.

    baseline: what is subtracted from accelerations. 'none'. 'constant': the mean, so that the last velocity is zero. 'linear': the slope of the straight line
    through the origin that fits the velocity best (least squares). 'high-pass': what is slower than `corner` (Hz), by a Butterworth filter of that `order`
    which runs forwards and backwards; the record gets `padding` seconds of zeros before and after it, without which base and filter would not come to rest.

    resolution: step between values of velocity or displacement, in their unit, that rounding has left; None: it is found from the values.

    final_velocity       of the base after the last sample, m/s
    final_displacement   of the base at the last sample, m
    padding              s before the first sample and after the last, added by 'high-pass'
    deviation            largest difference between the motion and the given velocities (m/s) or displacements (m); 0 for accelerations
    source               file, format, station, component, title and unit of a record that was read; else None
    """

    source = None

    def __init__(self, dt, acceleration=None, scale=1.0, baseline="none", name="", unit=None, gravity=STANDARD_GRAVITY, *, velocity=None, displacement=None,
                 resolution=None, corner=None, order=2):
        given = {quantity: values for quantity, values in zip(QUANTITIES, (acceleration, velocity, displacement)) if values is not None}
        if len(given) != 1:
            raise ValueError(f"{' and '.join(given) or 'nothing'} of acceleration, velocity and displacement is given: must be one of them")
        (self.quantity, samples), = given.items()
        self.dt = float(number_given("dt", dt))
        samples = np.ascontiguousarray(array_given(self.quantity, samples))
        if samples.ndim != 1:
            raise ValueError(f"{self.quantity} has the shape {samples.shape}: must be one row of samples, at least two")
        self.unit_given = unit is not None
        factor = unit_factor(unit, gravity, self.quantity) if self.unit_given else 1.0
        for k in np.flatnonzero(np.abs(factor * samples) > _LARGEST)[:1]:
            raise ValueError(f"{self.quantity}[{k}] = {samples[k]:g}{' ' + unit if self.unit_given else ''}: must be at most {_LARGEST:g} {QUANTITIES[self.quantity]} "
                             "without its sign; files have such numbers for values that are missing")
        self._unscaled, self.deviation = self._accelerations(samples, factor, resolution, baseline)
        array_given("scale", scale)
        self.scale = self.amplitude = scale
        if baseline not in _BASELINES:
            raise ValueError(f"baseline = {shown(baseline)}: must be one of {', '.join(map(repr, _BASELINES))}")
        self.baseline, self.padding = baseline, 0.0
        self.name = name
        self.shape = np.shape(scale)
        self._filter(corner, order)
        self.velocity(0.0)  # refuses bad input here

    def _accelerations(self, samples, factor, resolution, baseline):
        """(accelerations in m/s^2, deviation from the samples in SI units)"""
        if self.quantity == "acceleration":
            if resolution is not None:
                raise ValueError(f"resolution = {shown(resolution)}: must be left out for accelerations, which are not smoothed")
            return (samples if factor == 1 else factor * samples), 0.0
        if baseline != "none":
            raise ValueError(f"baseline = {shown(baseline)}: must be 'none' for a {self.quantity}, which says where the base ends")
        if resolution is not None and not number_given("resolution", resolution) >= 0:
            raise ValueError(f"resolution = {shown(resolution)}: must be 0 or positive, in the unit of the samples")
        positive_given("dt", self.dt, ", in s")
        values, deviation = accelerations(samples, self.dt, self.quantity, resolution)
        return factor * values, factor * deviation

    def _filter(self, corner, order):
        if self.baseline == "high-pass":
            if corner is None:
                raise ValueError("corner = None: must be given (Hz) for baseline='high-pass'")
            positive_given("dt", self.dt, ", in s")
            self._unscaled = high_pass(self._unscaled, self.dt, corner, order)
            self.padding, self.corner, self.order = padding(self.dt, corner, order) * self.dt, corner, order
        elif corner is not None:
            raise ValueError(f"corner = {shown(corner)}: must be left out with baseline={self.baseline!r}, it is for 'high-pass'")

    @property
    def samples(self):
        """The accelerations with the scale in them, before a constant or linear baseline is subtracted, m/s^2: a new array, the shape of `scale` in front."""
        samples = np.multiply.outer(self.scale, self._unscaled)
        samples.flags.writeable = False  # writing into it would change nothing
        return samples

    @property
    def subtracted(self):
        """The baseline that the motion of the samples still subtracts: 'none', 'constant' or 'linear'."""
        return "none" if self.baseline == "high-pass" else self.baseline

    @property
    def peak(self):
        """The largest of the samples, without sign, m/s^2: the shape of `scale`."""
        return restore(np.abs(np.ravel(self.scale)) * np.abs(self._unscaled).max(), self.shape)

    @property
    def duration(self):
        """Time of the last sample, s."""
        return self.dt * (len(self._unscaled) - 1)

    def _end(self):
        return self.duration

    @property
    def final_velocity(self):
        return self.velocity(self.duration)

    @property
    def final_displacement(self):
        return self.displacement(self.duration)

    def scaled(self, factor):
        result = copy.copy(self)
        result.scale = result.amplitude = np.multiply(self.scale, array_given("factor", factor))
        result.shape = np.shape(result.scale)
        result.deviation = np.multiply(self.deviation, np.abs(factor).max())
        result.velocity(0.0)  # refuses bad input here
        return result

    def doubt(self):
        """A sentence on what may not be meant: steps that may be in ms; a record whose peak is beyond those of earthquakes, or, without a unit, that of strong motion in g;
        displacements or velocities that are too fast, or that do not begin or end at rest. '' otherwise."""
        peak = np.max(self.peak)
        name = f" {self.name[:60]!r}" if self.name else ""
        if self.dt > LONGEST_STEP:
            return f"The record{name} has steps of {self.dt:g} s: are they in ms? dt is in s."
        if self.quantity != "acceleration":
            inside = np.abs(self._unscaled[_EDGE:-_EDGE]).max(initial=0) * np.abs(self.scale).max()
            if peak > 3 * inside:
                return (f"The record{name} of a {self.quantity} does not begin or end at rest, as the base does: it reaches {peak:.3g} m/s^2 in its first or "
                        f"last {_EDGE} steps, and {inside:.3g} m/s^2 in between.")
            if not self.unit_given and peak > _FASTEST:
                return (f"The record{name} of a {self.quantity} has no unit and reaches {peak:.3g} m/s^2: is it in {QUANTITIES[self.quantity]}? "
                        "Give unit= to Record.")
            return ""
        largest = np.abs(self._unscaled).max()
        if largest > _FASTEST:
            return f"The record{name} reaches {largest:.3g} m/s^2 before its scale, {largest / STANDARD_GRAVITY:.3g} g: is its unit right?"
        if self.unit_given or not 0.1 <= peak <= 1.5:
            return ""
        return (f"The record{name} has no unit and a peak of {peak:.3g}: is it in g? It is taken in m/s^2, "
                f"{peak / STANDARD_GRAVITY:.2g} g. Give unit='g' or unit='m/s^2' to Record.")

    def _motions(self, shape):
        scale, = columns(shape if np.ndim(self.scale) else (), self.scale)
        return _core.record(self.dt, self._unscaled, scale, self.subtracted)

    def __repr__(self):
        of = f"baseline={self.baseline!r}" if self.quantity == "acceleration" else f"from its {self.quantity}"
        return (f"Record({self.name + ': ' if self.name else ''}{len(self._unscaled)} samples, dt={self.dt:g} s, "
                f"at most {np.abs(self.samples).max():.3g} m/s^2, {of})")

    def __str__(self):
        lines = [repr(self)]
        if self.source:
            lines.append(str(self.source))
        if not self.shape:
            lines.append(f"the base ends {_rounded(self.final_displacement)} m from where it begins, at {_rounded(self.final_velocity)} m/s")
        if self.padding:
            lines.append(f"Butterworth filter of order {self.order} at {self.corner:g} Hz, forwards and backwards; {self.padding:g} s were added before and after")
        if self.deviation:
            lines.append(f"the base differs from the given {self.quantity} by at most {self.deviation:.2g} m{'/s' if self.quantity == 'velocity' else ''}")
        return "\n  ".join(lines)

    @classmethod
    def from_at2(cls, path, scale=1.0, baseline="none", gravity=STANDARD_GRAVITY):
        """The record of a PEER file of accelerations (.AT2); masonry.read_record reads it too, and other formats."""
        positive_given("gravity", gravity, ", in m/s^2")
        series, = _records.peer.read(_records.text_given(path), "acceleration")
        return record_of_series(cls, path, series, _records.peer.NAME, gravity, scale=scale, baseline=baseline)

    @classmethod
    def from_csv(cls, path, unit, dt=None, scale=1.0, baseline="none", gravity=STANDARD_GRAVITY, columns=None):
        """The record of a text file of columns, whose unit is named; masonry.read_record reads it too, and other formats."""
        unit_factor(unit, gravity)
        series, = _records.table.read(_records.text_given(path), unit, dt, columns)
        return record_of_series(cls, path, series, _records.table.NAME, gravity, scale=scale, baseline=baseline)


def _rounded(value):
    """A number for a text: what is round-off is 0."""
    return f"{value:.3g}" if abs(value) >= 1e-9 else "0"


def record_of_series(cls, path, series, format, gravity=STANDARD_GRAVITY, **options):
    """The record, of class `cls`, of what a reader has found in a file."""
    quantity = series.unit.quantity
    factor = series.unit.factor(positive_given("gravity", gravity, ", in m/s^2"))
    options[quantity] = factor * series.values
    if quantity != "acceleration":
        options["resolution"] = factor * resolution_of(series.values)  # of the digits in the file
    try:
        result = cls(series.dt, name=series.title or str(path), unit=QUANTITIES[quantity], **options)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    result.source = _records.source_of(path, series, format)
    return result


def compiled(motion, shape):
    """The compiled motions, one a case of that shape (or one for all)."""
    return motion._motions(shape)


def end_of(motion, shape, impact_times):
    """When a motion of blocks with these impacts is over, s: an array of that shape, infinite where that is not known."""
    end = np.broadcast_to(motion._end(), shape)
    resonant = isinstance(motion, PulseTrain) and motion.times is None and motion.half_cycles
    if not resonant or np.shape(impact_times)[-1] < motion.half_cycles:
        return end
    last = impact_times[..., motion.half_cycles - 1]  # the instant of its last pulse
    return np.where(np.isnan(last), np.inf, last + motion._last_pulse())
