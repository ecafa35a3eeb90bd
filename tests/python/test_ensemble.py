"""Statistics of ensembles against closed forms and SciPy, artificial records against their spectrum."""

import math
import signal
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from masonry import ensemble
from masonry.artificial import power
from masonry.ensemble.cases import keys
from masonry.ensemble.submitting import termination
from masonry.ensemble.table import make_table
from scipy import stats

import masonry


@pytest.mark.parametrize("count", [1, 7, 50])
def test_a_share_of_none_or_all_has_the_interval_of_clopper_and_pearson(count):
    # All of n fail with probability (1 - p)^n: the upper end solves (1 - p)^n = 0.025.
    none, every = ensemble.fraction([False] * count), ensemble.fraction([True] * count)
    assert none[:2] == (0, 0) and abs(none[2] - (1 - 0.025**(1 / count))) < 1e-12
    assert every[::2] == (1, 1) and abs(every[1] - 0.025**(1 / count)) < 1e-12


def test_shares_have_the_interval_of_the_beta_distribution():
    for events, count, confidence in ((3, 10, 0.95), (17, 40, 0.9), (99, 200, 0.99)):
        share, low, high = ensemble.fraction(np.arange(count) < events, confidence)
        outside = (1 - confidence) / 2
        assert share == events / count
        assert np.allclose([low, high], [stats.beta.ppf(outside, events, count - events + 1), stats.beta.ppf(1 - outside, events + 1, count - events)],
                           rtol=0, atol=1e-9)


@pytest.mark.parametrize("count", [1, 5, 10, 40, 101])
@pytest.mark.parametrize("probability", [0.16, 0.5, 0.84])
def test_quantiles_are_values_of_the_sample_and_so_are_their_bounds(count, probability):
    values = np.random.default_rng(count).permutation(np.arange(1.0, count + 1))
    middle, low, high = ensemble.quantile(values, probability, 0.95)
    assert middle == np.quantile(values, probability, method="inverted_cdf")

    def above(rank):
        """Probability that the rank-th of n uniform numbers, Beta(r, n + 1 - r), is above the quantile `probability`."""
        return 0.0 if rank < 1 else 1.0 if rank > count else stats.beta.sf(probability, rank, count + 1 - rank)

    # The values are their own ranks: at most 2.5 % on either side, and no end could be drawn closer.
    first, last = (0 if low == -math.inf else int(low)), (count + 1 if high == math.inf else int(high))
    assert above(first) <= 0.025 < above(first + 1) and 1 - above(last) <= 0.025 < 1 - above(last - 1)


def test_an_end_may_leave_out_just_what_it_is_allowed_to():
    # All of n values are on one side of the median with probability 2^-n, in floating point too: with a confidence of 1 - 2 2^-n the ends are the first and
    # the last one, and with any larger one there are none.
    for count in (2, 3, 5):
        assert ensemble.quantile(np.arange(count), 0.5, 1 - 2 * 0.5**count)[1:] == (0, count - 1)
        assert ensemble.quantile(np.arange(count), 0.5, 1 - 1.99 * 0.5**count)[1:] == (-math.inf, math.inf)


def test_collapsed_cases_have_no_largest_drift():
    table = np.array([(s, c, v) for s, row in ((0.2, [0.1, 0.2, 0.3, 0.4]), (0.4, [0.5, np.nan, 0.6, np.nan]), (0.8, [np.nan] * 4))
                      for v in row for c in [math.isnan(v)]], dtype=[("scale", float), ("collapsed", bool), ("peak_drift", float)])
    found = ensemble.statistics(table, by="scale", probabilities=(0.25, 0.5, 0.75))
    assert found["scale"].tolist() == [0.2, 0.4, 0.8] and found["cases"].tolist() == [4, 4, 4] and found["fraction"].tolist() == [0, 0.5, 1]
    assert found["quantile_0.5"].tolist() == [0.2, 0.6, math.inf] and found["quantile_0.75"].tolist() == [0.3, math.inf, math.inf]
    assert found["fraction_high"][0] == ensemble.fraction([False] * 4)[2]
    whole = ensemble.statistics(table)
    assert whole["cases"][0] == 12 and whole["fraction"][0] == 0.5
    # Without `by` and `probabilities`: the median, and the mean less and plus a standard deviation of a normal distribution.
    assert whole.dtype.names == ("cases", "fraction", "fraction_low", "fraction_high",
                                 *(f"quantile_{p}{end}" for p in (0.16, 0.5, 0.84) for end in ("", "_low", "_high")))


def test_groups_of_several_columns_are_the_combinations_that_occur():
    table = np.array([(0.4, "wall", True, 9), (0.2, "pier", False, 0.1), (0.2, "wall", False, 0.2), (0.2, "pier", True, 9), (0.4, "wall", False, 0.3)],
                     dtype=[("scale", float), ("kind", "U4"), ("collapsed", bool), ("peak_drift", float)])
    found = ensemble.statistics(table, by=["scale", "kind"], probabilities=(0.5,))
    assert found[["scale", "kind", "cases", "fraction"]].tolist() == [(0.2, "pier", 2, 0.5), (0.2, "wall", 1, 0), (0.4, "wall", 2, 0.5)]
    for row in found:
        part = table[(table["scale"] == row["scale"]) & (table["kind"] == row["kind"])]
        assert row["quantile_0.5_low"] == ensemble.statistics(part, probabilities=(0.5,))["quantile_0.5_low"][0]
    assert found.dtype.names[:2] == ("scale", "kind") and ensemble.statistics(table, by=["scale"]).tolist() == ensemble.statistics(table, by="scale").tolist()


def test_artificial_records_are_those_of_their_seed():
    record = masonry.artificial_record(3, peak=2.5, duration=8, dt=0.01)
    assert record.samples.max() == 2.5 or -record.samples.min() == 2.5
    assert np.array_equal(record.samples, masonry.artificial_record(3, peak=2.5, duration=8, dt=0.01).samples)
    assert not np.array_equal(record.samples, masonry.artificial_record(4, peak=2.5, duration=8, dt=0.01).samples)
    assert len(record.samples) == 801 and abs(record.acceleration(1.0) - record.samples[100]) < 1e-12


@pytest.mark.parametrize("options", [{}, dict(duration=0.2), dict(duration=40), dict(duration=5, frequency=1.0), dict(duration=20, dt=0.02), dict(duration=3, cutoff=1.0)])
def test_artificial_records_end_at_rest_where_they_began(options):
    for seed in range(20):
        record = masonry.artificial_record(seed, 9.0, **options)
        # Sums over n samples of a velocity and a displacement: the round-off of each term, of at most peak T and peak T^2, adds up over n.
        n, T = len(record.samples), record.duration
        assert abs(record.final_velocity) < n * 2e-16 * 9 * T and abs(record.final_displacement) < n * 2e-16 * 9 * T**2
        assert record.peak == pytest.approx(9, rel=1e-15)
        assert record.samples[0] == 0 and abs(record.displacement(T + 100)) < 1e-9  # and it stays there


def test_artificial_records_have_the_spectrum_of_kanai_and_tajimi():
    assert abs(power(np.array([1.0]), 30, 0.6, 0.01)[0] - 1) < 5e-3 and power(np.array([0.0]), 2.5, 0.6, 0.2)[0] == 0
    assert abs(power(np.array([2.5]), 2.5, 0.6, 1e-4)[0] - (1 + 1.44) / 1.44) < 1e-6
    dt, count, records = 0.02, 1001, 400
    strong = slice(200, 600)  # where the envelope is flat: 8 s
    total = 0
    for seed in range(records):
        samples = masonry.artificial_record(seed, 1.0, 20.0, dt).samples[strong]
        total = total + np.abs(np.fft.rfft(samples / samples.std() * np.hanning(400)))**2
    f = np.fft.rfftfreq(400, dt)
    band = (f > 0.8) & (f < 8)
    ratio = total[band] / power(f[band], 2.5, 0.6, 0.2)
    # The mean of 400 periodograms scatters by 1/sqrt(400) = 5 %; 58 frequencies: four times that.
    assert np.max(np.abs(ratio / ratio.mean() - 1)) < 0.2 and count == 1001


def test_bad_input_is_refused(tmp_path):
    script = tmp_path / "scene.py"
    script.write_text("def run(case): return {}")
    table = np.zeros(2, dtype=[("collapsed", bool), ("peak_drift", float)])
    gaps = np.array([(0.2, False, 0.1), (0.4, False, np.nan), (0.4, True, np.nan)], dtype=[("scale", float), ("collapsed", bool), ("peak_drift", float)])
    for act, word in ((lambda: ensemble.fraction([]), "events"), (lambda: ensemble.fraction([True], 1), "confidence = 1"), (lambda: ensemble.fraction([True], "0.9"), "confidence = '0.9'"),
                      (lambda: ensemble.quantile([1, math.nan], 0.5), "NaN"), (lambda: ensemble.quantile([], 0.5), "values"),
                      (lambda: ensemble.quantile([1], 1.0), "probability = 1"), (lambda: ensemble.statistics(table, by="scale"), "scale"),
                      (lambda: ensemble.run(script, [], tmp_path), "at least one"), (lambda: ensemble.run(script, [{"a": 1}, {"b": 1}], tmp_path), "same keys"),
                      (lambda: ensemble.run(script, [{"a": 1}, {"a": 1}], tmp_path), "twice"), (lambda: ensemble.run(script, [{"a": {1}}], tmp_path), "must be a dict"),
                      (lambda: ensemble.run(script, [{"a": 1}], tmp_path, processes=0), "processes = 0"),
                      (lambda: ensemble.run(script, [{"a": 1}], tmp_path, time_limit=0), "time_limit = 0"),
                      (lambda: ensemble.run(script, [{"a": 1}], tmp_path, processes="two"), "processes = 'two'"),
                      (lambda: ensemble.run(script, [{"a": 1}], tmp_path, processes=math.nan), "processes = nan"),
                      (lambda: ensemble.run(script, [{"a": 1}], tmp_path, time_limit="1"), "time_limit = '1'"),
                      (lambda: ensemble.run(script, 5, tmp_path), "cases = 5: must be a list"),
                      (lambda: ensemble.run(script, [1, 2], tmp_path), "case = 1: must be a dict"),
                      (lambda: ensemble.statistics(gaps), "column 'peak_drift': 1 of 3 cases are NaN"),
                      (lambda: ensemble.statistics(gaps, by="scale"), "column 'peak_drift': 1 of 2 cases with scale = 0.4"),
                      (lambda: ensemble.statistics(gaps, by=("scale", "collapsed")), "1 of 1 cases with scale = 0.4, collapsed = False"),
                      (lambda: ensemble.statistics(gaps, by=["scale", "kind"]), "'kind': is no column"),
                      (lambda: ensemble.statistics(gaps, by=["scale", "scale"]), r"by = \['scale', 'scale'\], .* two columns 'scale'"),
                      (lambda: ensemble.statistics(gaps, probabilities=(0.5, 0.5)), r"probabilities = \(0.5, 0.5\): would make two columns 'quantile_0.5'"),
                      (lambda: ensemble.statistics(gaps, probabilities=0.5), "probabilities = 0.5: must be a list"),
                      (lambda: masonry.artificial_record(1, "3"), "peak = '3'"), (lambda: masonry.artificial_record(1, 1, dt="a"), "dt = 'a'"),
                      (lambda: masonry.artificial_record(-1, 1), "seed = -1"), (lambda: masonry.artificial_record(1, 0), "peak = 0"),
                      (lambda: masonry.artificial_record(1, 1, dt=0.1), "dt = 0.1"), (lambda: masonry.artificial_record(1, 1, cutoff=3), "cutoff = 3"),
                      (lambda: masonry.artificial_record(1, 1, duration=0.1), "duration = 0.1")):
        with pytest.raises(ValueError, match=word):
            act()
    with pytest.raises(FileNotFoundError):
        ensemble.run(tmp_path / "none.py", [{"a": 1}], tmp_path)


def test_tables_have_lists_arrays_and_none_as_text(tmp_path):
    cases = [{"kind": None, "speeds": np.arange(2), "seed": np.int64(1)}, {"kind": "wall", "speeds": [0, 1, 2], "seed": 2}]
    table = make_table(cases, [{"peak_drift": 0.1}, {"peak_drift": 0.2}])
    assert table.tolist() == [("None", "[0, 1]", 1, 0.1), ("wall", "[0, 1, 2]", 2, 0.2)]
    np.savez(tmp_path / "ensemble.npz", table=table)
    assert np.load(tmp_path / "ensemble.npz")["table"].tolist() == table.tolist()  # no objects, which NumPy does not load


def test_statistics_have_the_confidence_asked():
    table = np.array([(k < 12, 0.1 * k) for k in range(40)], dtype=[("collapsed", bool), ("peak_drift", float)])
    row, = ensemble.statistics(table, probabilities=(0.5,), confidence=0.6)
    assert (row["fraction"], row["fraction_low"], row["fraction_high"]) == ensemble.fraction(table["collapsed"], 0.6)
    values = np.where(table["collapsed"], np.inf, table["peak_drift"])
    assert (row["quantile_0.5"], row["quantile_0.5_low"], row["quantile_0.5_high"]) == ensemble.quantile(values, 0.5, 0.6)


@pytest.mark.parametrize("count, probability, rank", [(25, 0.56, 14), (50, 0.14, 7), (100, 0.07, 7)])
def test_the_rank_of_a_quantile_is_not_one_more_by_round_off(count, probability, rank):
    assert count * probability > rank  # in floating point; the product is whole
    assert ensemble.quantile(np.arange(1.0, count + 1), probability)[0] == rank


def test_results_of_another_function_are_not_taken(tmp_path):
    script = tmp_path / "scene.py"
    script.write_text("")
    assert keys(script, "run", [{}]) != keys(script, "other", [{}])
    assert len(set(keys(script, "run", [{"a": 1, "b": 2}, {"b": 2, "a": 1}]))) == 1  # the order of the keys says nothing


def test_artificial_records_grow_and_decay_by_their_envelope():
    # 400 records of 10 s; the mean square over a window of 0.2 s and more scatters by some 10 %.
    t = 0.02 * np.arange(501)
    envelope = np.select([t < 2, t < 6], [(t / 2) ** 2, 1.0], 0.05 ** ((t - 6) / 4))
    samples = [masonry.artificial_record(seed, 1.0, 10.0, 0.02).samples for seed in range(400)]
    square = np.mean([(s / s[100:300].std()) ** 2 for s in samples], axis=0)
    for low, high in ((0.9, 1.1), (1.4, 1.6), (3, 5), (7.9, 8.1), (9.4, 9.6)):
        part = (t >= low) & (t <= high)
        assert abs(square[part].mean() / (envelope[part] ** 2).mean() - 1) < 0.25, (low, high)


def test_what_ends_a_program_stays_its_own():
    before, own = signal.getsignal(signal.SIGTERM), lambda number, frame: None
    try:
        for handler in (own, signal.SIG_DFL):
            signal.signal(signal.SIGTERM, handler)
            with termination():
                assert (signal.getsignal(signal.SIGTERM) is handler) == (handler is own)
            assert signal.getsignal(signal.SIGTERM) is handler
        with ThreadPoolExecutor() as pool:  # where signals cannot be set
            pool.submit(termination().__enter__).result()
    finally:
        signal.signal(signal.SIGTERM, before)
