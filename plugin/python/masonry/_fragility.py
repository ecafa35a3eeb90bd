"""Fragility: the probability of collapse over an intensity measure."""

import csv
import math
import re

import numpy as np

from . import _core
from ._files import save_picture, written
from ._given import array_given, number_given, positive_given, shown
from ._lognormal import LognormalFit, NoMaximum, wilson
from ._optional import needs
from ._progress import steps
from ._records.units import STANDARD_GRAVITY
from .block import RockingBlock
from .history import case_arguments, warn_of_doubt
from .motions import Record

# Distinct measures up to which each is a level of its own, and bins of as many histories each beyond that.
_LEVELS, _BINS = 50, 12
# Relative difference of measures that are the same: sums over a record have round-off.
_SAME = 1e-9
_SA = re.compile(r"Sa\((\d+\.?\d*|\.\d+)\)")
_MEASURES = {
    "PGA": ("m/s^2", lambda record: _pga(record), lambda block: 1.0),
    "PGA/g": ("", lambda record: _pga(record) / STANDARD_GRAVITY, lambda block: 1.0),
    "PGV": ("m/s", lambda record: _pgv(record), lambda block: 1.0),
    "PGA/(g tan alpha)": ("", lambda record: _pga(record), lambda block: np.divide(block.slenderness, block.gravity)),
    "p PGV/(g tan alpha)": ("", lambda record: _pgv(record), lambda block: block.frequency_parameter * np.divide(block.slenderness, block.gravity)),
}


class Fragility:
    """Lognormal fragility curve, fitted by maximum likelihood to histories that stand or collapse.

    measure              name of the intensity measure;  unit: its unit
    values, collapsed    measure of each history, and whether it collapsed: arrays of one shape
    median, dispersion   of the curve Phi(ln(x/median)/dispersion); NaN where there is no fit
    median_interval, dispersion_interval   (lower, upper) end of the confidence interval, by profile likelihood
    levels               structured array: measure, cases, collapsed, fraction, low, high (Wilson's interval); one row for each value of the measure, or
                         for bins of equally many histories where there are more than 50
    verdict              a sentence: the fit, or why there is none
    fitted               whether there is a fit
    """

    def __init__(self, values, collapsed, measure="measure", unit="", records=None, confidence=0.95):
        with needs("python3-scipy", "a fragility curve"):
            import scipy.special  # noqa: F401
        self.measure, self.unit, self.confidence = measure, unit, confidence
        self.values, self.collapsed = _merged(np.asarray(values, dtype=float)), np.asarray(collapsed, dtype=bool)
        self._many = None if records is None else len(np.unique(records))
        self.levels = _levels(self.values.ravel(), self.collapsed.ravel(), confidence)
        self._fit = None
        self.median = self.dispersion = math.nan
        self.median_interval = self.dispersion_interval = (math.nan, math.nan)
        self.verdict = self._without_fit() or self._with_fit(records)

    @property
    def fitted(self):
        return self._fit is not None

    def probability(self, x):
        """Of collapse at measures x > 0; NaN where there is no fit."""
        return self._fit.probability(x) if self.fitted else np.full(np.shape(x), np.nan)[()]

    def band(self, x):
        """(lower, upper) end of the pointwise confidence interval of probability(x), from the variance of the fit; NaN where there is none."""
        return self._fit.band(x, self.confidence) if self.fitted else (np.full(np.shape(x), np.nan)[()],) * 2

    def to_csv(self, path):
        """Writes the levels, with the fitted probability and its band beside them; comment lines above say the fit."""
        rows = self.levels
        low, high = self.band(rows["measure"])
        with written(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
            file.write(f"# {self.verdict}\n")
            writer = csv.writer(file)
            writer.writerow([self.measure + (f" ({self.unit})" if self.unit else ""), *rows.dtype.names[1:], "fit", "fit_low", "fit_high"])
            writer.writerows(zip(*(rows[name].tolist() for name in rows.dtype.names), self.probability(rows["measure"]), low, high))

    def plot(self, path):
        """Picture: fractions with Wilson's intervals, and the curve with its band. path: the file, whose ending says its kind."""
        with needs("python3-matplotlib", "a picture of a fragility curve"):
            import matplotlib

            matplotlib.use("Agg")
            import matplotlib.pyplot as plt

        figure, axes = plt.subplots(figsize=(6.4, 4), layout="constrained")
        rows = self.levels
        # Lists: with an array of one number Matplotlib makes a conversion that NumPy 2 deprecates.
        interval = [(rows["fraction"] - rows["low"]).tolist(), (rows["high"] - rows["fraction"]).tolist()]
        axes.errorbar(rows["measure"], rows["fraction"], interval, fmt="o", color="0.3", markersize=4, capsize=2, linewidth=1,
                      label=f"fraction, {self.confidence:.0%} interval (Wilson)")
        x = np.linspace(0, rows["measure"].max() * 1.05, 301)[1:]
        if self.fitted:
            low, high = self.band(x)
            axes.fill_between(x, low, high, color="C0", alpha=0.2, linewidth=0, label=f"{self.confidence:.0%} band of the fit")
            axes.plot(x, self.probability(x), color="C0",
                      label=f"lognormal: median {self.median:.3g} {self.unit}".rstrip() + f", dispersion {self.dispersion:.2f}")
        axes.set(xlabel=self.measure + (f" ({self.unit})" if self.unit else ""), ylabel="probability of collapse", ylim=(-0.03, 1.03), xlim=(0, x[-1]))
        if not self.fitted:
            import textwrap

            axes.set_title(textwrap.fill(self.verdict, 80), fontsize=9)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
        save_picture(figure, path, dpi=120)
        plt.close(figure)

    def __repr__(self):
        return f"Fragility({self.verdict})"

    def __str__(self):
        return self.verdict

    def _shown(self, value):
        return f"{value:.4g}" + (f" {self.unit}" if self.unit else "")

    def _without_fit(self):
        """Why no curve can be fitted; '' where one can."""
        values, collapsed, percent = self.values.ravel(), self.collapsed.ravel(), f"{self.confidence * 100:g} %"
        if not collapsed.any():
            last = self.levels[-1]
            return (f"No history of {len(values)} collapsed, so there is no curve: take larger measures. At {self._shown(last['measure'])} the probability of "
                    f"collapse is at most {last['high']:.2g} ({percent} interval, {last['cases']} histories).")
        if collapsed.all():
            first = self.levels[0]
            return (f"All {len(values)} histories collapsed, so there is no curve: take smaller measures. At {self._shown(first['measure'])} the probability "
                    f"of collapse is at least {first['low']:.2g} ({percent} interval, {first['cases']} histories).")
        stands, falls = values[~collapsed], values[collapsed]
        if stands.max() <= falls.min():
            if stands.min() == falls.max():
                return f"All histories have the same measure, {self._shown(stands[0])}, so there is no curve: take several levels."
            standing = f"up to {self._shown(stands.max())} stand and all from {self._shown(falls.min())} on" if stands.max() < falls.min() else \
                f"below {self._shown(falls.min())} stand and all above it"
            return (f"All histories {standing} collapse (complete separation), so the dispersion cannot be estimated: take more records, or levels closer "
                    "to each other in between.")
        if falls.max() <= stands.min():
            return "The histories that collapse have smaller measures than those that stand, so there is no curve."
        return ""

    def _with_fit(self, records):
        groups = None if records is None else np.unique(records, return_inverse=True)[1]
        try:
            fit = LognormalFit(self.values.ravel(), self.collapsed.ravel(), groups)
        except NoMaximum:
            stands, falls = self.values[~self.collapsed].max(), self.values[self.collapsed].min()
            return (f"All histories below {self._shown(falls)} stand and all above {self._shown(stands)} collapse (nearly complete separation), so the dispersion "
                    "cannot be estimated: take more records, or levels closer to each other in between.")
        if not fit.rises:
            return f"The fraction that collapses does not rise with {self.measure}, so there is no curve: take another measure."
        self._fit, self.median, self.dispersion = fit, fit.median, fit.dispersion
        self.median_interval, self.dispersion_interval = fit.median_interval(self.confidence), fit.dispersion_interval(self.confidence)
        numbers = (f"{self.measure}: median {self._shown(self.median)} ({self.confidence * 100:g} % interval {self.median_interval[0]:.4g} to "
                   f"{self.median_interval[1]:.4g}), dispersion {self.dispersion:.3g} ({self.dispersion_interval[0]:.3g} to {self.dispersion_interval[1]:.3g})")
        of = f"{self.values.size} histories" + (f" under {self._many} records" if self._many else "")
        ends = (*self.median_interval, self.dispersion_interval[1])
        sure = fit.significant(self.confidence) and np.all(np.isfinite(ends))
        unsure = "" if sure else "; these are too few to show that the fraction rises, so that some ends are infinite"
        return f"{numbers}, from {of}{unsure}."


def fragility(block, records, scales=None, levels=None, measure="PGA", restitution=None, restoring="exact", vertical=None, confidence=0.95, progress=False):
    """Fragility of the block(s) under records x scales: whether each block overturns under each record at each scale, exactly, and the lognormal curve that
    fits best. Returns a Fragility; its arrays have the shape of the blocks, then records, then scales or levels.

    block      one block, or a population of blocks (arrays), which is taken together. For a curve for each block call this once for each.
    records    masonry.Record, at least two
    scales     numbers that multiply every record; or
    levels     values of the measure to which every record is scaled
    measure    'PGA' (m/s^2), 'PGA/g', 'PGV' (m/s), 'PGA/(g tan alpha)', 'p PGV/(g tan alpha)', or 'Sa(T)' with a number for T (s): the pseudo
               acceleration at 5 % damping, m/s^2
    restitution, restoring    as of simulate(); restitution broadcasts with the blocks
    vertical   records of the vertical motion, one for each of `records`, multiplied by the same scale; or None
    progress   a progress bar (tqdm); None: where stderr is a terminal

    The intervals allow for histories under one record not being independent of each other: they hold for new records of the same kind."""
    records = _records("records", records)
    if len(records) < 2:
        raise ValueError(f"records = {shown(records)}: must be at least two, for one does not show the scatter between records")
    warn_of_doubt(*records)
    vertical = [None] * len(records) if vertical is None else _records("vertical", vertical)
    if len(vertical) != len(records):
        raise ValueError(f"vertical has {len(vertical)} records: must have one for each of the {len(records)} records")
    if (scales is None) == (levels is None):
        raise ValueError("scales, levels: must give one of the two")
    name = "scales" if levels is None else "levels"
    given = array_given(name, scales if levels is None else levels)
    if given.ndim != 1 or not given.size or not (np.all(given > 0) and np.all(np.isfinite(given))):
        raise ValueError(f"{name} = {shown(scales if levels is None else levels)}: must be a list of positive numbers")
    unit, of_record, of_block = _measure(measure)
    _check_confidence(confidence)

    restitution = array_given("restitution", np.nan if restitution is None else restitution)  # NaN: the natural one
    shape = np.broadcast_shapes(block.shape, np.shape(restitution))
    wide = block
    if block.shape:
        wide = RockingBlock(*(np.broadcast_to(value, shape)[..., None] for value in (block.half_width, block.half_height, block.gravity)))
    collapsed = np.zeros((*shape, len(records), given.size), dtype=bool)
    values = np.zeros(collapsed.shape)
    for k in steps(range(len(records)), progress, "fragility", "record"):
        unscaled = of_record(records[k]) * of_block(wide) + np.zeros((*shape, 1))
        if not np.all(unscaled > 0):
            raise ValueError(f"records: number {k + 1}, {shown(records[k])}, does not move the base")
        scale = given if levels is None else given / unscaled
        upwards = None if vertical[k] is None else vertical[k].scaled(scale)
        _, arguments = case_arguments(wide, records[k].scaled(scale), np.broadcast_to(restitution, shape)[..., None], restoring, 0.0, 0.0, None, None, upwards)
        collapsed[..., k, :] = np.reshape(_core.overturns(*arguments), (*shape, given.size)) > 0
        values[..., k, :] = given if levels is not None else scale * unscaled
    number = np.broadcast_to(np.arange(len(records))[:, None], collapsed.shape).ravel()
    return Fragility(values, collapsed, measure, unit, number, confidence)


def fragility_of_table(table, measure, event="collapsed", record=None, unit="", confidence=0.95):
    """The same curve for the rows of a table: that of ensemble.run(), or any structured array.

    measure    column of the intensity measure, positive numbers
    event      column that says whether the structure collapsed
    record     column that names the record, where records come with several levels: the intervals then allow for their histories not being
               independent. None: each row counts as independent.
    """
    for name in (measure, event, *([] if record is None else [record])):
        if name not in table.dtype.names:
            raise ValueError(f"{shown(name)}: is no column of the table, which has {', '.join(table.dtype.names)}")
    values = array_given(measure, table[measure])
    if not len(values) or not (np.all(values > 0) and np.all(np.isfinite(values))):
        raise ValueError(f"column {shown(measure)}: must be positive numbers, at least one")
    if not np.isin(table[event], (0, 1)).all():
        raise ValueError(f"column {shown(event)}: must be True or False")
    if record is not None and len(np.unique(table[record])) < 2:
        raise ValueError(f"column {shown(record)}: must name at least two records, for one does not show the scatter between records")
    _check_confidence(confidence)
    return Fragility(values, table[event].astype(bool), measure, unit, None if record is None else table[record], confidence)


def _check_confidence(confidence):
    if not 0 < number_given("confidence", confidence) < 1:
        raise ValueError(f"confidence = {confidence}: must be above 0 and below 1")


def _records(name, records):
    records = list(records) if isinstance(records, (list, tuple)) else [records]
    for record in records:
        if not isinstance(record, Record) or record.shape:
            raise ValueError(f"{name} = {shown(record)}: must be a list of masonry.Record, each of one scale")
    return records


def _measure(name):
    """(unit, value of a record as it is, what a block multiplies it by)"""
    if name in _MEASURES:
        return _MEASURES[name]
    found = _SA.fullmatch(name) if isinstance(name, str) else None
    if not found:
        raise ValueError(f"measure = {shown(name)}: must be one of {', '.join(_MEASURES)}, or Sa(0.5) with the period in s")
    from .spectra import oscillator_peak

    period = positive_given("period", float(found[1]))
    return "m/s^2", lambda record: (2 * math.pi / period) ** 2 * oscillator_peak(record, period, 0.05), lambda block: 1.0


def _samples(record):
    """Times of the samples, and the accelerations there with their scale and baseline."""
    times = record.dt * np.arange(len(record.samples))
    return times, record.acceleration(times)


def _pga(record):
    return np.abs(_samples(record)[1]).max()


def _pgv(record):
    """Exact: the velocity turns at the samples' zero crossings, between which the acceleration is linear."""
    times, a = _samples(record)
    k = np.flatnonzero(a[1:] * a[:-1] < 0)
    return np.abs(record.velocity(np.concatenate([times, times[k] + record.dt * a[k] / (a[k] - a[k + 1])]))).max()


def _merged(values):
    """The values, of which those that differ by round-off are made equal: they are one level."""
    distinct, place = np.unique(values, return_inverse=True)
    first = np.concatenate([[True], distinct[1:] > distinct[:-1] * (1 + _SAME)])
    return distinct[first][np.cumsum(first) - 1][place].reshape(values.shape)


def _levels(values, collapsed, confidence):
    distinct, place = np.unique(values, return_inverse=True)
    if len(distinct) > _LEVELS:
        place = np.empty(len(values), dtype=int)
        place[np.argsort(values, kind="stable")] = np.arange(len(values)) * _BINS // len(values)
    cases, falls = np.bincount(place), np.bincount(place, collapsed).astype(int)
    middle = distinct if len(distinct) <= _LEVELS else np.exp(np.bincount(place, np.log(values)) / cases)
    low, high = wilson(falls, cases, confidence)
    table = np.zeros(len(cases), dtype=[("measure", float), ("cases", int), ("collapsed", int), ("fraction", float), ("low", float), ("high", float)])
    for name, column in zip(table.dtype.names, (middle, cases, falls, falls / cases, low, high)):
        table[name] = column
    return table
