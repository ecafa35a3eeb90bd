"""Spectra of blocks and oscillators against closed forms and independent integrations."""

import csv
import math
import os
import threading

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import masonry
from masonry import spectra

G = 9.81
BLOCK = masonry.RockingBlock(0.2, 1.0)
RECORD = masonry.artificial_record(3, 4.0, duration=4, dt=0.02)


def integrated(acceleration, end, period, damping, kinks=()):
    """Largest |u| of an oscillator by DOP853, from kink to kink; its turning points are events, exact to the tolerance."""
    w, state, largest = 2 * math.pi / period, [0.0, 0.0], 0.0

    def slope(t, y):
        return [y[1], -2 * damping * w * y[1] - w**2 * y[0] - acceleration(t)]

    times = np.unique([0.0, *kinks, end])
    for begin, stop in zip(times[:-1], times[1:]):
        inside = np.nextafter(stop, 0)
        found = solve_ivp(lambda t, y: slope(min(t, inside), y), (begin, stop), state, method="DOP853", rtol=1e-11, atol=1e-14, max_step=period / 10,
                          events=lambda t, y: y[1])
        state = found.y[:, -1]
        largest = max([largest, abs(state[0]), *(abs(y[0]) for y in found.y_events[0])])
    return largest


# --- oscillators ---


@pytest.mark.parametrize("period", [0.12, 1.0, 7.0])
@pytest.mark.parametrize("damping", [0.0, 0.05, 0.7])
@pytest.mark.parametrize("motion, kinks", [(masonry.Sine(2.0, 1.0, cycles=4.25), [4.25]), (masonry.HalfSine(3.0, 0.4), [0.4]),
                                           (masonry.Rectangular(2.0, 0.3), [0.3])], ids=["sine", "half-sine", "rectangle"])
def test_oscillator_under_shaped_motions(motion, kinks, period, damping):
    expected = integrated(motion.acceleration, kinks[-1] + 1.1 * period, period, damping, kinks)
    # DOP853 at 1e-11 for each step, over some thousand steps at most
    assert spectra.oscillator_peak(motion, period, damping) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("baseline", ["none", "constant"])
@pytest.mark.parametrize("period", [0.03, 0.5, 4.0])
def test_oscillator_under_a_record(baseline, period):
    record = masonry.Record(0.02, RECORD.samples[:40] + 0.1, scale=1.5, baseline=baseline, unit="m/s^2")  # ends with a jump to zero
    times = 0.02 * np.arange(40)
    expected = integrated(record.acceleration, times[-1] + 1.1 * period, period, 0.05, times)
    assert spectra.oscillator_peak(record, period, 0.05) == pytest.approx(expected, rel=1e-8)


# Oracle: the exact transition matrix of the state (u, u', a, slope) for one step, as a matrix exponential; a long record, so that round-off shows.
def test_oscillator_at_the_samples_of_a_long_record():
    record = masonry.artificial_record(1, 3.0, duration=40, dt=0.01)
    a = record.acceleration(0.01 * np.arange(len(record.samples)))
    for period in (0.5, 10.0):
        w = 2 * math.pi / period
        step = expm(0.01 * np.array([[0, 1, 0, 0], [-w**2, -2 * 0.02 * w, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]]))
        u, v, sampled = 0.0, 0.0, 0.0
        for k in range(len(a) - 1):
            u, v = (step @ [u, v, a[k], (a[k + 1] - a[k]) / 0.01])[:2]
            sampled = max(sampled, abs(u))
        peak = spectra.oscillator_peak(record, period, 0.02)
        # the turning point lies within half a sample: u is higher by at most w^2 u h^2/8 and what the base adds to the curvature
        assert sampled * (1 - 1e-10) <= peak <= sampled + (w**2 * sampled + np.abs(a).max() + 2 * 0.02 * w * w * sampled) * 0.01**2 / 8


def test_undamped_oscillator_in_resonance_grows_as_the_closed_form():
    # u = -(a/(2 w^2)) (sin wt - wt cos wt): the largest value of 3 cycles is at their end, a/(2 w^2) 6 pi, and stays
    w = 2 * math.pi * 1.5
    assert spectra.oscillator_peak(masonry.Sine(2.0, 1.5, cycles=3), 1 / 1.5, 0.0) == pytest.approx(2.0 / (2 * w**2) * 6 * math.pi, rel=1e-12)


def test_steady_state_of_harmonic_motion():
    # many cycles: what is left of the start is e^(-0.1 * 2 pi 60) ~ 1e-17. The transient overshoots, so the steady state is a lower bound, and it is the
    # peak itself where the start is slower to build up: in resonance
    for damping in (0.05, 0.1):
        steady = 1 / (2 * damping) * 2.0 / (2 * math.pi) ** 2
        damped = math.sqrt(1 - damping**2)
        assert spectra.oscillator_peak(masonry.Sine(2.0, damped, cycles=200), 1.0, damping) == pytest.approx(
            2.0 / (2 * math.pi) ** 2 / math.hypot(1 - damped**2, 2 * damping * damped), rel=2e-3)
        assert spectra.oscillator_peak(masonry.Sine(2.0, 1.0, cycles=200), 1.0, damping) == pytest.approx(steady, rel=1e-6)


@pytest.mark.parametrize("damping", [0.0, 0.03, 0.4])
def test_oscillator_under_a_dirac_pulse_and_a_train(damping):
    period, w = 0.8, 2 * math.pi / 0.8
    damped = math.sqrt(1 - damping**2)
    first = 0.3 / w * math.exp(-damping / damped * math.atan2(damped, damping))
    assert spectra.oscillator_peak(masonry.PulseTrain(0.3, times=[0.1]), period, damping) == pytest.approx(first, rel=1e-13)
    # its resonant train: Eq. 7 with the velocity that is left after half a period
    half, n = period / 2 / damped, 6
    kept = math.exp(-math.pi * damping / damped)
    train = masonry.PulseTrain(0.3, times=half * np.arange(n))
    grown = (2 - (1 + kept) * kept ** (n - 1)) / (1 - kept) if kept < 1 else 2 * n - 1
    assert spectra.oscillator_peak(train, period, damping) == pytest.approx(first * grown, rel=1e-12)


def test_stiff_and_damped_oscillators_stay_finite():
    # the displacement of a stiff oscillator is a/w^2, to w_sine/w of it
    u = spectra.oscillator_peak(masonry.Sine(2.0, 0.5, cycles=20), [0.01, 0.02], 0.6)
    np.testing.assert_allclose(u, 2.0 / (2 * math.pi / np.array([0.01, 0.02])) ** 2, rtol=0.02)


def test_a_spectrum_is_the_same_on_any_number_of_cores(monkeypatch):
    """All cores that the process may use get a part: the first oscillators wait for each other there. NumPy rounds products of complex numbers by where
    an array lies in memory, so that the last bit may differ, also on one core."""
    from masonry.spectra import _oscillator

    periods = np.linspace(0.1, 3, 12)
    alone = [spectra.oscillator_peak(RECORD, period) for period in periods]
    together, one = threading.Barrier(3, timeout=60), _oscillator._peak_under_record
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0, 1, 2})
    monkeypatch.setattr(_oscillator, "_peak_under_record", lambda source, oscillator: together.wait() * 0 + one(source, oscillator))
    assert spectra.oscillator_peak(RECORD, periods) == pytest.approx(alone, rel=1e-13)


def test_response_spectrum_has_names_and_units(tmp_path):
    motions = [RECORD, masonry.Sine(1.0, 2.0)]
    spectrum = spectra.response(motions, [0.2, 0.5, 1.0], damping=[0.02, 0.05])
    assert spectrum.dims == ("record", "period", "damping") and spectrum.shape == (2, 3, 2)
    w = 2 * math.pi / spectrum["period"][:, None]
    np.testing.assert_allclose(spectrum["pseudo_acceleration"], w**2 * spectrum["displacement"], rtol=1e-14)
    assert spectrum["displacement"][1, 2, 1] == spectra.oscillator_peak(motions[1], 1.0, 0.05)
    spectrum.to_csv(tmp_path / "s.csv")
    rows = list(csv.reader(open(tmp_path / "s.csv")))
    assert rows[0] == ["record", "period (s)", "damping", "displacement (m)", "pseudo_velocity (m/s)", "pseudo_acceleration (m/s^2)"]
    assert len(rows) == 13 and float(rows[-1][3]) == spectrum["displacement"][1, 2, 1]
    spectrum.plot(tmp_path / "s.png")
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"


# --- blocks ---


def test_peak_ratio_is_that_of_simulate():
    rng = np.random.default_rng(1)
    block = masonry.RockingBlock(rng.uniform(0.1, 0.5, (3, 1)), rng.uniform(0.8, 1.5, (3, 1)))
    motion = masonry.Sine(rng.uniform(1, 8, 700), rng.uniform(0.3, 4, 700), 1.5)  # 2100 cases: three parts
    ratio = spectra.peak_ratio(block, motion)
    history = masonry.simulate(block, motion)
    expected = np.nanmax(np.abs(history.peak_angles), axis=-1, initial=0) / np.broadcast_to(block.critical_angle, (3, 700))
    np.testing.assert_array_equal(ratio, np.where(history.overturned, np.inf, expected))
    assert 0.1 < np.isinf(ratio).mean() < 0.9 and (ratio == 0).any()


def test_peak_ratio_of_a_single_block_is_a_number():
    ratio = spectra.peak_ratio(BLOCK, masonry.HalfSine(4.0, 0.2))
    assert isinstance(ratio, float) and 0 < ratio < 1


# DOP853 with the exact equation of motion. It starts at uplift and ends at impacts and at the end of the sine, where the acceleration has kinks.
def test_peak_ratio_against_another_integration():
    motion, p2, alpha = masonry.Sine(2.5, 1.5, 1), BLOCK.frequency_parameter**2, BLOCK.critical_angle
    w, end = 2 * math.pi * 1.5, 1 / 1.5
    time, side, largest, impacts = math.asin(G / BLOCK.slenderness / 2.5) / w, -1, 0.0, 0
    growth = p2 * 2.5 * w / G * math.cos(w * time) * math.cos(alpha)  # of the acceleration at uplift, where it is 0: the first 0.1 ms are its cubic
    time, state = time + 1e-4, [growth * 1e-12 / 6, growth * 1e-8 / 2]
    for _ in range(21):
        stop, moved = (end, 1.0) if time < end else (10.0, 0.0)

        def slope(t, y):
            push = side * moved * 2.5 * math.sin(w * t) / G
            return [y[1], -p2 * (math.sin(alpha - y[0]) + push * math.cos(alpha - y[0]))]

        def landing(t, y):
            return y[0] + 1e-13 * (y[1] >= 0)  # not where it begins

        landing.terminal, landing.direction = True, -1
        run = solve_ivp(slope, (time, stop), state, method="DOP853", rtol=1e-11, atol=1e-14, max_step=0.01, events=[landing, lambda t, y: y[1]])
        largest = max([largest, *(y[0] for y in run.y_events[1])])
        time, state = run.t[-1], run.y[:, -1]
        if len(run.t_events[0]):
            impacts += 1
            side, state = -side, [0.0, -BLOCK.natural_restitution * state[1]]
    assert impacts == 20
    # errors of 1e-11 for each step grow with e^(p t), p t about 5
    assert spectra.peak_ratio(BLOCK, motion) == pytest.approx(largest / alpha, rel=1e-8)


def test_rocking_spectrum_is_a_grid_with_names():
    spectrum = spectra.rocking(masonry.Sine, amplitude=[2.0, 4.0, 6.0], frequency=[1.0, 2.0], width=0.4, slenderness=[4.0, 5.0],
                               restitution=[0.7, 0.8, 0.9, 1.0], t_end=3.0)
    assert spectrum.dims == ("amplitude", "frequency", "slenderness", "restitution") and spectrum.shape == (3, 2, 2, 4)
    one = spectra.peak_ratio(masonry.RockingBlock.from_size(0.4, 2.0), masonry.Sine(4.0, 2.0), 0.8, t_end=3.0)
    assert spectrum["ratio"][1, 1, 1, 1] == one and spectrum["overturned"].dtype == bool
    row = spectrum.rows()[np.ravel_multi_index((1, 1, 1, 1), spectrum.shape)]
    assert (row["amplitude"], row["frequency"], row["slenderness"], row["restitution"], row["ratio"]) == (4.0, 2.0, 5.0, 0.8, one)


def test_rocking_spectrum_of_a_record_and_of_a_point():
    spectrum = spectra.rocking(RECORD, scale=[0.0, 1.0], width=0.4, slenderness=6)
    assert spectrum.dims == ("scale",) and spectrum["ratio"][0] == 0 and not np.signbit(spectrum["ratio"][0]) and spectrum.fixed["restitution"] == "natural"
    assert spectra.rocking(RECORD, width=0.4, slenderness=6)["ratio"] == spectrum["ratio"][1]


def test_overturning_spectrum():
    spectrum = spectra.overturning(masonry.Rectangular, duration=[0.2, 0.5], width=[0.2, 0.4], slenderness=5, restitution=0.9, restoring="linear")
    for i, duration in enumerate((0.2, 0.5)):
        for k, width in enumerate((0.2, 0.4)):
            block = masonry.RockingBlock.from_size(width, 5 * width)
            expected = G * block.critical_angle / (1 - math.exp(-block.frequency_parameter * duration))  # Housner
            assert spectrum["amplitude"][i, k] == pytest.approx(expected, rel=2e-12)
            assert spectrum["amplitude_over_uplift"][i, k] == pytest.approx(expected * 5 / G, rel=2e-12)


def test_overturning_scale_of_a_motion():
    V1 = G * math.sqrt(2 * (1 - math.cos(BLOCK.critical_angle))) / (BLOCK.frequency_parameter * math.cos(BLOCK.critical_angle))
    spectrum = spectra.overturning(masonry.PulseTrain(0.5, times=[0.0]), width=0.4, slenderness=5)
    assert spectrum["scale"] == pytest.approx(V1 / 0.5, rel=2e-12)


@pytest.mark.parametrize("call, words", [
    (lambda: spectra.rocking(masonry.Sine, amplitude=[1.0], width=0.4, slenderness=5), "motion = Sine: missing a required argument: 'frequency'"),
    (lambda: spectra.rocking(3.0, width=0.4, slenderness=5), "motion = 3.0: must be masonry.Sine"),
    (lambda: spectra.rocking(RECORD, amplitude=2.0, width=0.4, slenderness=5), "amplitude: must be left out for Record"),
    (lambda: spectra.rocking(masonry.Sine, amplitude=[[1.0]], frequency=1, width=0.4, slenderness=5), r"amplitude = \[\[1.0\]\]: must be a number or a list"),
    (lambda: spectra.overturning(masonry.Sine, amplitude=1.0, frequency=1.0, width=0.4, slenderness=5), "amplitude = 1.0: must be left out"),
    (lambda: spectra.oscillator_peak(RECORD, 0.0), "period = .*must be positive"),
    (lambda: spectra.oscillator_peak(RECORD, 1.0, 1.0), "damping = .*below 1"),
    (lambda: spectra.oscillator_peak(masonry.PulseTrain(1.0), 1.0), r"motion = PulseTrain\(impulse=1.0\): must be a Record, Sine"),
    (lambda: spectra.resonance(0.4, 5, 1.0), "restitution = .*below 1"),
    (lambda: spectra.resonance(0.4, 5, 0.7).plot("x.png"), "one point has no picture"),
])
def test_bad_input(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_a_record_that_may_be_in_g_is_asked_about():
    record = masonry.Record(0.1, [0, 0.3, -0.1, 0, 0])
    for call in (lambda: spectra.oscillator_peak(record, 1.0), lambda: spectra.peak_ratio(BLOCK, record)):
        with pytest.warns(UserWarning, match="is it in g") as warned:
            call()
        assert warned[0].filename == __file__


# --- resonance ---


def test_half_cycle_is_that_of_a_history():
    block = masonry.RockingBlock([0.1, 0.3, 0.3], [0.5, 1.5, 1.5])
    speed = np.array([0.3, 0.05, 3.0])
    history = masonry.simulate(block, initial_velocity=speed, restitution=0.5, half_cycles=1)
    peak, duration = spectra.half_cycle(block, speed)
    np.testing.assert_allclose(peak[:2], history.peak_angles[:2, 0], rtol=1e-12)
    np.testing.assert_allclose(duration[:2], history.impact_times[:2, 0], rtol=1e-12)
    assert np.isinf(peak[2]) and np.isnan(duration[2]) and history.overturned.tolist() == [False, False, True]


def test_resonance_is_the_limit_of_the_train():
    spectrum = spectra.resonance([0.6, 1.2], [4.0, 5.0], 0.7, damping=0.05)
    n = 70  # what is left to the limit is 0.85 0.7^69 = 2e-11 of the speed
    for i, width in enumerate((0.6, 1.2)):
        for k, slenderness in enumerate((4.0, 5.0)):
            block = masonry.RockingBlock.from_size(width, width * slenderness)
            for restoring, prefix in (("constant", ""), ("exact", "gravity_")):
                history = masonry.simulate(block, masonry.PulseTrain(0.0125 * G), 0.7, restoring, half_cycles=n)
                peaks = np.abs(history.peak_angles)
                assert spectrum[f"{prefix}ratio"][i, k] == pytest.approx(peaks[-1] / block.critical_angle, rel=1e-9)
                assert spectrum[f"{prefix}period"][i, k] == pytest.approx(2 * (history.impact_times[-1] - history.impact_times[-2]), rel=1e-9)
                assert spectrum[f"{prefix}amplification"][i, k] == pytest.approx(peaks[-1] / peaks[0], rel=1e-9)
    # the oscillator, by its own trains of 300 pulses: what is left is 0.85^300
    half = 0.5 / math.sqrt(1 - 0.05**2)
    grown = [spectra.oscillator_peak(masonry.PulseTrain(0.1, times=half * np.arange(count)), 1.0, 0.05) for count in (1, 300)]
    assert spectrum["oscillator_amplification"][0, 0] == pytest.approx(grown[1] / grown[0], rel=1e-10)


def test_pictures(tmp_path):
    grid = spectra.rocking(masonry.Sine, amplitude=np.linspace(1, 8, 6), frequency=[1.0, 2.0, 3.0], width=[0.4, 0.8], slenderness=5)
    grid.plot(tmp_path / "map.png", x="frequency", y="amplitude")
    spectra.resonance([0.4, 0.6], [3, 4, 5], 0.7).plot(tmp_path / "curves.png", "gravity_ratio", x="period")
    assert {path.name for path in tmp_path.iterdir()} == {"map.png", "curves.png"}
    with pytest.raises(ValueError, match="y = 'width2': must be one of amplitude, frequency, width"):
        grid.plot(tmp_path / "no.png", y="width2")


def test_curves_say_where_blocks_overturn(tmp_path, monkeypatch):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    drawn, plotted = [], []
    plot = Axes.plot
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: drawn.append(figure))
    monkeypatch.setattr(Axes, "plot", lambda axes, x, y, *more, **given: plotted.append((x, y, more)) or plot(axes, x, y, *more, **given))
    slenderness = np.linspace(3, 12, 10)
    spectrum = spectra.resonance(0.6, slenderness, 0.7)
    infinite = np.isinf(spectrum["gravity_ratio"])
    spectrum.plot(tmp_path / "curves.png", "gravity_ratio", x="gravity_period")
    crosses, = [(x, y) for x, y, more in plotted if more == ("x",) and len(x)]
    last = np.flatnonzero(~infinite)[-1]
    assert infinite[last + 1:].all() and 0 < last < 9
    assert crosses[0] == spectrum["gravity_period"][last] and crosses[1] == spectrum["gravity_ratio"][last]
    assert [text.get_text() for text in drawn[0].axes[0].get_legend().get_texts()] == ["overturns beyond"]


def test_xarray():
    xarray = pytest.importorskip("xarray")
    data = spectra.response(RECORD, [0.2, 0.5]).to_xarray()
    assert isinstance(data, xarray.Dataset) and data["displacement"].attrs["units"] == "m" and data["period"].attrs["units"] == "s"
    assert float(data["displacement"].sel(period=0.5)) == spectra.oscillator_peak(RECORD, 0.5)


def test_progress_is_silent_unless_it_is_wanted(capfd):
    pytest.importorskip("tqdm")
    spectra.rocking(masonry.HalfSine, amplitude=[2.0, 4.0], duration=0.3, width=0.4, slenderness=5)
    assert capfd.readouterr().err == ""
    spectra.rocking(masonry.HalfSine, amplitude=[2.0, 4.0], duration=0.3, width=0.4, slenderness=5, progress=True)
    assert "rocking: 100%" in capfd.readouterr().err
