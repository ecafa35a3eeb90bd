"""Fragility curves against an independent maximum likelihood, simulated populations, and exact histories."""

import csv
import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_ndtr
from scipy.stats import binomtest, chi2, norm, t

import masonry
from masonry._lognormal import LognormalFit, wilson

BLOCK = masonry.RockingBlock.from_size(0.4, 2.0)
RECORDS = [masonry.artificial_record(seed, 1.0, duration=4, frequency=1.5) for seed in range(12)]
LEVELS = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]


def minus_likelihood(parameters, x, collapsed):
    eta = (np.log(x) - parameters[0]) / np.exp(parameters[1])
    return -np.sum(np.where(collapsed, log_ndtr(eta), log_ndtr(-eta)))


def other_fit(x, collapsed):
    """(ln median, ln dispersion) and the log-likelihood, by a search without derivatives."""
    found = minimize(minus_likelihood, [np.log(x).mean(), -0.7], (x, collapsed), "Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000})
    return found.x, -found.fun


def drawn(seed, cases=150, median=2.0, dispersion=0.4):
    rng = np.random.default_rng(seed)
    x = rng.uniform(0.5, 5, cases)
    return x, rng.uniform(size=cases) < norm.cdf(np.log(x / median) / dispersion)


@pytest.mark.parametrize("seed", range(5))
def test_the_fit_is_that_of_another_optimiser(seed):
    x, collapsed = drawn(seed)
    expected, _ = other_fit(x, collapsed)
    curve = masonry.Fragility(x, collapsed)
    # a search that ends at 1e-12 of the likelihood is 1e-6 off, for the likelihood is flat there
    np.testing.assert_allclose([math.log(curve.median), math.log(curve.dispersion)], expected, atol=1e-5)
    assert curve.probability(3.0) == pytest.approx(norm.cdf((math.log(3.0) - expected[0]) / math.exp(expected[1])), abs=1e-5)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("confidence", [0.8, 0.95])
def test_the_intervals_are_those_of_the_profile_likelihood(seed, confidence):
    x, collapsed = drawn(seed, 60)
    _, largest = other_fit(x, collapsed)
    curve = masonry.Fragility(x, collapsed, confidence=confidence)

    def loss(fixed, value):
        profile = minimize(lambda free: minus_likelihood([value, free[0]] if fixed == 0 else [free[0], value], x, collapsed), [-0.7 if fixed == 0 else 0.7],
                           method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-11})
        return 2 * (largest + profile.fun)

    for fixed, interval in enumerate((curve.median_interval, curve.dispersion_interval)):
        for end in interval:
            assert loss(fixed, math.log(end)) == pytest.approx(chi2.ppf(confidence, 1), abs=1e-5)


def test_wilson_is_that_of_scipy():
    events, cases = np.array([0, 1, 3, 10, 10]), np.array([4, 20, 7, 11, 10])
    low, high = wilson(events, cases, 0.9)
    for k in range(5):
        expected = binomtest(int(events[k]), int(cases[k])).proportion_ci(0.9, method="wilson")
        assert (low[k], high[k]) == pytest.approx((expected.low, expected.high), abs=1e-14)


# A right 95 % interval holds the truth in 95 +- 2.2 of 100 populations (binomial). 86 is 4.1 standard deviations below: a right interval misses that
# once in some 7000 choices of the seed.
COVERED = 86


def test_intervals_hold_the_truth_as_often_as_they_say():
    held = np.zeros(2)
    for seed in range(100):
        curve = masonry.Fragility(*drawn(1000 + seed, 100))
        held += (curve.median_interval[0] <= 2.0 <= curve.median_interval[1], curve.dispersion_interval[0] <= 0.4 <= curve.dispersion_interval[1])
    assert np.all(held >= COVERED)


# Each record has a threshold of its own: its histories at many levels are one observation, not many. Intervals that take the histories as
# independent hold the truth too seldom, which is why these do not.
def test_intervals_allow_for_levels_of_the_same_record():
    levels, count = np.linspace(0.5, 6, 23), 30
    held, naive = np.zeros(2), np.zeros(2)
    for seed in range(100):
        threshold = 2.0 * np.exp(0.4 * np.random.default_rng(seed).standard_normal(count))
        collapsed = levels > threshold[:, None]
        x, record = np.broadcast_to(levels, collapsed.shape).ravel(), np.repeat(np.arange(count), len(levels))
        for total, groups in ((held, record), (naive, None)):
            fit = LognormalFit(x, collapsed.ravel(), groups)
            ends = fit.median_interval(0.95), fit.dispersion_interval(0.95)
            total += [low <= truth <= high for (low, high), truth in zip(ends, (2.0, 0.4))]
    assert np.all(held >= COVERED)
    assert naive[0] < COVERED


def test_variance_between_records_is_the_sandwich():
    rng = np.random.default_rng(3)
    x = np.tile([1.0, 2.0, 3.0], 40)
    record = np.repeat(np.arange(40), 3)
    collapsed = rng.uniform(size=120) < norm.cdf(np.log(x / 2) / 0.5 + np.repeat(rng.standard_normal(40), 3))
    curve = masonry.Fragility(x, collapsed, records=record)
    # in (b_0, b_1) of eta = b_0 + b_1 ln x, with scores and information by central differences
    best, step, everything = np.array([-math.log(curve.median), 1]) / curve.dispersion, 1e-4, np.ones(120, dtype=bool)

    def value(b, one):
        eta = b[0] + b[1] * np.log(x[one])
        return -np.sum(np.where(collapsed[one], log_ndtr(eta), log_ndtr(-eta)))

    def slope(one):
        return np.array([(value(best + step * e, one) - value(best - step * e, one)) / (2 * step) for e in np.eye(2)])

    def bend(one):
        return np.array([[sum(a * b * value(best + step * (a * e + b * f), one) for a in (1, -1) for b in (1, -1)) / (4 * step**2) for f in np.eye(2)]
                         for e in np.eye(2)])

    stated = np.linalg.inv(bend(everything))
    scores = np.array([np.linalg.solve(np.eye(2) - bend(record == k) @ stated, slope(record == k)) for k in range(40)])
    shown = stated @ (scores.T @ scores) @ stated
    gradient = np.array([-1 / best[1], best[0] / best[1] ** 2])  # of ln median = -b_0/b_1
    factor = (gradient @ stated @ gradient) / (gradient @ shown @ gradient)
    assert factor < 0.9  # the histories of a record are alike
    low, high = curve.median_interval
    for end in (low, high):
        profile = minimize(lambda free: minus_likelihood([math.log(end), free[0]], x, collapsed), [math.log(curve.dispersion)], method="Nelder-Mead",
                           options={"xatol": 1e-9, "fatol": 1e-11})
        loss = 2 * (profile.fun - value(best, everything))
        assert loss * factor == pytest.approx(t.ppf(0.975, 39) ** 2, rel=1e-3)  # differences of step 1e-4


# --- where there is no curve ---


@pytest.mark.parametrize("x, collapsed, words", [
    ([1, 2, 3], [0, 0, 0], r"No history of 3 collapsed.* larger measures.*At 3 the probability of collapse is at most 0\.\d+ \(95 % interval, 1 histories\)"),
    ([1, 2, 3], [1, 1, 1], r"All 3 histories collapsed.*smaller measures.*at least 0\.\d+"),
    ([1, 2, 3, 4], [0, 0, 1, 1], r"up to 2 stand and all from 3 on collapse \(complete separation\)"),
    ([1, 2, 2, 3], [0, 0, 1, 1], r"below 2 stand and all above it collapse \(complete separation\)"),
    ([2, 2, 2], [0, 1, 1], "All histories have the same measure, 2"),
    ([1, 2, 3, 4], [1, 1, 0, 0], "have smaller measures than those that stand"),
    ([1, 2, 3, 4, 5], [1, 1, 0, 1, 0], "does not rise with measure"),
])
def test_data_without_a_curve_are_told_in_words(tmp_path, x, collapsed, words):
    curve = masonry.Fragility(x, collapsed)
    assert not curve.fitted and math.isnan(curve.median) and math.isnan(curve.dispersion) and np.isnan(curve.probability([1.0, 2.0])).all()
    import re
    assert re.search(words, str(curve)), str(curve)
    curve.plot(tmp_path / "f.png")
    curve.to_csv(tmp_path / "f.csv")
    assert (tmp_path / "f.csv").read_text().startswith(f"# {curve.verdict}\n")


def test_few_histories_have_infinite_ends_and_say_so():
    curve = masonry.Fragility([1, 2, 3, 4, 5, 6], [0, 1, 0, 1, 0, 1])
    assert curve.fitted and math.isinf(curve.dispersion_interval[1]) and curve.median_interval == (0.0, math.inf)
    assert curve.dispersion_interval[0] < curve.dispersion and "too few to show that the fraction rises" in str(curve)


# The likelihood of nearly separated data is steep: the fit must not stop short of its maximum.
@pytest.mark.parametrize("overlap", [1e-2, 1e-4, 1e-6, 1e-8, 4e-9])
def test_nearly_separated_data(overlap):
    x = np.array([1, 1.5, 2, 2 + overlap, 3, 4.0])
    curve = masonry.Fragility(x, [0, 0, 1, 0, 1, 1])
    expected, _ = other_fit(x, np.array([0, 0, 1, 0, 1, 1], dtype=bool))
    value = minus_likelihood(np.log([curve.median, curve.dispersion]), x, np.array([0, 0, 1, 0, 1, 1], dtype=bool))
    assert value <= minus_likelihood(expected, x, np.array([0, 0, 1, 0, 1, 1], dtype=bool)) + 1e-9


def test_measures_that_differ_by_round_off_are_one_level():
    curve = masonry.Fragility(np.array([1, 1, 2, 2, 3, 3]) * (1 + 1e-15 * np.array([0, 3, -2, 1, 2, 0])), [0, 0, 0, 1, 1, 1])
    assert curve.levels["cases"].tolist() == [2, 2, 2] and "complete separation" in str(curve)


# All that overlaps is one record, which says nothing of the scatter between records. Its score is nearly 0 at the best fit, as the sum of all is 0: without the
# correction for its own part in the fit the interval would be narrower than for independent histories.
def test_a_record_that_holds_all_the_information_widens_the_interval():
    x = np.array([0.01] * 5 + [100.0] * 5 + [1.5, 2.5])
    collapsed = np.array([0] * 5 + [1] * 5 + [1, 0])
    curve = masonry.Fragility(x, collapsed, records=[*range(5), *range(5), 5, 5])
    alone = masonry.Fragility(x, collapsed)
    assert curve.fitted and curve.median == alone.median
    assert curve.median_interval[0] < alone.median_interval[0] and curve.median_interval[1] > alone.median_interval[1]


# --- histories ---


def test_collapses_are_those_of_simulate():
    curve = masonry.fragility(BLOCK, RECORDS, levels=LEVELS)
    assert curve.collapsed.shape == curve.values.shape == (12, 7)
    for k, record in enumerate(RECORDS):
        assert record.peak == pytest.approx(1.0)
        assert curve.collapsed[k].tolist() == masonry.simulate(BLOCK, record.scaled(np.array(LEVELS) / np.abs(
            record.acceleration(record.dt * np.arange(len(record.samples)))).max())).overturned.tolist()
    assert curve.levels["measure"].tolist() == LEVELS and curve.levels["collapsed"].tolist() == curve.collapsed.sum(axis=0).tolist()
    assert curve.fitted and curve.median_interval[0] < curve.median < curve.median_interval[1]
    low, high = curve.band(LEVELS)
    assert np.all(low < curve.probability(LEVELS)) and np.all(curve.probability(LEVELS) < high)


def test_scales_multiply_the_scale_that_a_record_has():
    halves = [masonry.Record(record.dt, 2 * record.samples, scale=0.5, baseline="constant", unit="m/s^2") for record in RECORDS]
    curve = masonry.fragility(BLOCK, halves, scales=LEVELS, vertical=[record.scaled(0.1) for record in halves])
    expected = [masonry.simulate(BLOCK, record.scaled(LEVELS), vertical=record.scaled(0.1).scaled(LEVELS)).overturned.tolist() for record in RECORDS]
    assert curve.collapsed.tolist() == expected and 0.2 < curve.collapsed.mean() < 0.8
    assert curve.collapsed.tolist() != masonry.fragility(BLOCK, halves, scales=np.multiply(0.5, LEVELS)).collapsed.tolist()


def test_populations_and_restitutions_broadcast():
    block = masonry.RockingBlock.from_size([0.4, 0.5, 0.6], 2.0)
    curve = masonry.fragility(block, RECORDS[:3], scales=LEVELS, restitution=[[0.8], [0.9]])
    assert curve.collapsed.shape == (2, 3, 3, 7)
    one = masonry.fragility(masonry.RockingBlock.from_size(0.5, 2.0), RECORDS[:3], scales=LEVELS, restitution=0.9)
    assert np.array_equal(curve.collapsed[1, 1], one.collapsed)


# Measures that are linear in the record: levels and scales are two ways to say the same.
@pytest.mark.parametrize("measure", ["PGA", "PGA/g", "PGV", "PGA/(g tan alpha)", "p PGV/(g tan alpha)", "Sa(0.5)"])
def test_measures(measure):
    record = masonry.Record(0.1, [0, 3, -1, 0, 0], unit="m/s^2", scale=0.5)
    # velocity by hand: the first triangle is up to t = 0.175, where the acceleration is zero: 3 (0.1 + 0.075)/2
    pga, pgv = 1.5, 0.5 * 3 * (0.1 + 0.075) / 2
    tan, p = 0.2, math.sqrt(3 * 9.81 / (4 * math.hypot(0.2, 1.0)))
    expected = {"PGA": pga, "PGA/g": pga / 9.80665, "PGV": pgv, "PGA/(g tan alpha)": pga / (9.81 * tan), "p PGV/(g tan alpha)": p * pgv / (9.81 * tan),
                "Sa(0.5)": float(masonry.spectra.response(record, 0.5, 0.05)["pseudo_acceleration"])}[measure]
    scales = np.array([0.5, 1.0, 30.0])
    by_scale = masonry.fragility(BLOCK, [record, record], scales=scales, measure=measure)
    np.testing.assert_allclose(by_scale.values, np.tile(expected * scales, (2, 1)), rtol=1e-12)
    by_level = masonry.fragility(BLOCK, [record, record], levels=expected * scales, measure=measure)
    assert np.array_equal(by_level.collapsed, by_scale.collapsed) and by_level.collapsed[0].tolist() == [False, False, True]


def test_a_record_that_may_be_in_g_is_asked_about():
    record = masonry.Record(0.1, [0, 0.3, -0.1, 0, 0])
    with pytest.warns(UserWarning, match="is it in g") as warned:
        masonry.fragility(BLOCK, [record, record], scales=[1.0])
    assert all(warning.filename == __file__ for warning in warned)


def test_vertical_motion_is_scaled_alike():
    up = [masonry.artificial_record(100 + seed, 0.8, duration=4) for seed in range(3)]
    curve = masonry.fragility(BLOCK, RECORDS[:3], scales=LEVELS, vertical=up)
    for k in range(3):
        history = masonry.simulate(BLOCK, RECORDS[k].scaled(LEVELS), vertical=up[k].scaled(LEVELS))
        assert curve.collapsed[k].tolist() == history.overturned.tolist()


def test_table_of_an_ensemble():
    curve = masonry.fragility(BLOCK, RECORDS, levels=LEVELS)
    table = np.zeros(curve.values.size, dtype=[("seed", int), ("peak", float), ("collapsed", bool), ("peak_drift", float)])
    table["seed"], table["peak"], table["collapsed"] = np.repeat(np.arange(12), 7), curve.values.ravel(), curve.collapsed.ravel()
    of_rows = masonry.fragility_of_table(table, "peak", record="seed")
    assert (of_rows.median, of_rows.median_interval) == (curve.median, curve.median_interval) and of_rows.measure == "peak"
    alone = masonry.fragility_of_table(table, "peak")
    assert alone.median == curve.median and alone.median_interval != curve.median_interval


def test_files(tmp_path):
    curve = masonry.fragility(BLOCK, RECORDS, levels=LEVELS)
    curve.to_csv(tmp_path / "f.csv")
    lines = (tmp_path / "f.csv").read_text().splitlines()
    assert lines[0] == f"# {curve}"
    rows = list(csv.DictReader(lines[1:]))
    assert [float(row["PGA (m/s^2)"]) for row in rows] == LEVELS and [float(row["fit"]) for row in rows] == curve.probability(LEVELS).tolist()
    curve.plot(tmp_path / "f.png")
    assert (tmp_path / "f.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize("change, words", [
    ({"scales": None, "levels": None}, "scales, levels: must give one"),
    ({"levels": [1.0]}, "scales, levels: must give one"),
    ({"scales": [0.0, 1.0]}, r"scales = \[0.0, 1.0\]: must be a list of positive numbers"),
    ({"measure": "PGD"}, "measure = 'PGD': must be one of PGA, PGA/g, PGV"),
    ({"records": RECORDS[:1]}, "records = .*at least two"),
    ({"records": [1.0, 2.0]}, "records = 1.0: must be a list of masonry.Record"),
    ({"records": [RECORDS[0], masonry.Record(0.1, [0, 0, 0])]}, "records: number 2, .*does not move the base"),
    ({"vertical": RECORDS[:3]}, "vertical has 3 records"),
    ({"confidence": 1.0}, "confidence = 1.0"),
])
def test_bad_input(change, words):
    with pytest.raises(ValueError, match=words):
        masonry.fragility(**{"block": BLOCK, "records": RECORDS[:2], "scales": [1.0, 2.0], **change})


@pytest.mark.parametrize("given, words", [
    ({"measure": "pga"}, "'pga': is no column"), ({"measure": "zero"}, "column 'zero': must be positive"),
    ({"event": "peak"}, "column 'peak': must be True or False"),
    ({"record": "one"}, "column 'one': must name at least two records"),
])
def test_bad_tables(given, words):
    table = np.zeros(2, dtype=[("peak", float), ("zero", float), ("collapsed", bool), ("one", int)])
    table["peak"] = 1, 2
    with pytest.raises(ValueError, match=words):
        masonry.fragility_of_table(table, **{"measure": "peak", **given})
