"""How often an event happened in an ensemble and how large a number was, with confidence intervals."""

import math

import numpy as np

from .._given import array_given, number_given, shown


def _check_confidence(confidence):
    if not 0 < number_given("confidence", confidence) < 1:
        raise ValueError(f"confidence = {confidence}: must be above 0 and below 1")


def fraction(events, confidence=0.95):
    """(share of True, lower and upper end of its confidence interval), by Clopper and Pearson: the interval holds the true probability in at least
    `confidence` of all ensembles. events: bools, one a case, at least one."""
    from scipy.stats import binomtest

    _check_confidence(confidence)
    events = np.asarray(events).ravel()
    if not len(events) or not np.isin(events, (0, 1)).all():
        raise ValueError("events: must be True or False, at least one")
    events = events.astype(bool)
    interval = binomtest(int(events.sum()), len(events)).proportion_ci(confidence, method="exact")
    return float(events.mean()), float(interval.low), float(interval.high)


def quantile(values, probability, confidence=0.95):
    """(quantile, lower and upper end of its confidence interval) of numbers of which some may be infinite.

    The quantile is the ceil(n probability)-th of the n values in order, so that infinite ones (a collapse has no largest drift) take part. The
    interval's ends are values of the sample, or infinite where the sample is too small to bound it: the number of values below the
    true quantile is binomial, whatever their distribution, and on either side at most (1 - confidence)/2 is left out.
    probability: above 0 and below 1. Raises ValueError for NaN.
    """
    from scipy.stats import binom

    _check_confidence(confidence)
    if not 0 < number_given("probability", probability) < 1:
        raise ValueError(f"probability = {probability}: must be above 0 and below 1")
    values = np.sort(np.asarray(values, dtype=float).ravel())
    if not len(values) or np.isnan(values).any():
        raise ValueError(f"values: must be at least one number, without NaN; {int(np.isnan(values).sum())} of {len(values)} are NaN")
    count, outside = len(values), (1 - confidence) / 2
    padded = np.concatenate([[-math.inf], values, [math.inf]])
    # K, the number of values below the quantile, is binomial. The r-th value is above the quantile when K < r: the lower end is the largest r with
    # P(K < r) <= outside; it is below when K >= r: the upper end is the least r with P(K >= r) <= outside. r = 0 and n + 1: infinity.
    ranks = np.arange(count + 2)
    low = np.flatnonzero(binom.cdf(ranks - 1, count, probability) <= outside)[-1]
    high = np.flatnonzero(binom.sf(ranks - 1, count, probability) <= outside)[0]
    middle = math.ceil(count * probability * (1 - 1e-12))
    return float(values[max(middle, 1) - 1]), float(padded[low]), float(padded[high])


def statistics(table, by=None, probabilities=(0.16, 0.5, 0.84), confidence=0.95, event="collapsed", value="peak_drift"):
    """How often the event happened and how large the value was: a structured array, one row for each value of the column `by` (of a list of
    columns: for each combination of their values that occurs), or one for the whole table. Columns: those of `by`; cases; fraction, fraction_low,
    fraction_high (fraction()); and for each probability quantile_0.5, quantile_0.5_low, quantile_0.5_high (quantile()), where cases with the event
    count as infinite: quantiles are those of all cases, and infinite where more than that share has collapsed.

    table         of run(); its columns `event` (bool) and `value` (numbers) are those of results.CollapseReport.numbers()
    """
    by = [] if by is None else list(by) if isinstance(by, (list, tuple)) else [by]
    for name in (*by, event, value):
        if name not in table.dtype.names:
            raise ValueError(f"{shown(name)}: is no column of the table, which has {', '.join(table.dtype.names)}")
    chances = array_given("probabilities", probabilities)
    if chances.ndim != 1:
        raise ValueError(f"probabilities = {shown(probabilities)}: must be a list of numbers above 0 and below 1")
    made = [*by, "cases", *(f"fraction{end}" for end in ("", "_low", "_high")), *(f"quantile_{p:g}{end}" for p in chances for end in ("", "_low", "_high"))]
    twice = [name for name in dict.fromkeys(made) if made.count(name) > 1]
    if twice:
        raise ValueError(f"by = {by}, probabilities = {probabilities}: would make two columns {shown(twice[0])}: must all differ")
    groups, member = np.unique(table[by], return_inverse=True) if by else ([()], np.zeros(len(table), dtype=int))
    rows = []
    for number, group in enumerate(groups):
        part = table[member == number]
        happened = part[event].astype(bool)
        numbers = np.where(happened, np.inf, part[value])
        for name, column in ((event, part[event]), (value, numbers)):
            if np.isnan(column).any():
                which = " with " + ", ".join(f"{n} = {v}" for n, v in zip(by, group)) if by else ""
                raise ValueError(f"column {shown(name)}: {int(np.isnan(column).sum())} of {len(part)} cases{which} are NaN: "
                                 f"must be numbers{f', but where {event} is True' if name == value else ''}")
        row = [*group, len(part), *fraction(happened, confidence)]
        for probability in chances:
            row += quantile(numbers, probability, confidence)
        rows.append(tuple(row))
    kinds = [table.dtype[name] for name in by] + [int] + [float] * (len(made) - len(by) - 1)
    return np.array(rows, dtype=list(zip(made, kinds)))
