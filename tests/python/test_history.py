"""Histories: scalar and array input agree, and agree with SciPy where a closed form of another kind is at hand."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import ellipk, ellipkinc

import masonry

G = 9.81
I = 0.0125 * G


def test_quarter_period_by_elliptic_integrals():
    block = masonry.RockingBlock(0.1, 0.5)
    alpha, p, start = block.critical_angle, block.frequency_parameter, block.critical_angle / 2
    k = np.cos((alpha - start) / 2)
    quarter = (ellipk(k**2) - ellipkinc(np.arcsin(np.cos(alpha / 2) / k), k**2)) / p
    history = masonry.simulate(block, initial_angle=start, restitution=1.0, half_cycles=3)
    np.testing.assert_allclose(history.impact_times, quarter * np.array([1, 3, 5]), rtol=1e-13)
    np.testing.assert_allclose(np.abs(history.peak_angles), start, rtol=1e-14)


def test_stabilised_peak_under_real_gravity():
    block = masonry.RockingBlock(0.3, 1.5)
    history = masonry.simulate(block, masonry.PulseTrain(I), 0.7, half_cycles=200)
    w = masonry.closed_form.stabilised(block, I, 0.7).angular_velocity
    peak = block.critical_angle - np.arccos(np.cos(block.critical_angle) + w**2 / (2 * block.frequency_parameter**2))
    assert abs(history.impact_velocities[-1]) == pytest.approx(w, rel=1e-13)
    assert abs(history.peak_angles[-1]) == pytest.approx(peak, rel=1e-12)
    assert masonry.simulate(block, masonry.PulseTrain(I), 0.8, half_cycles=200).overturn_half_cycle == 7


def test_velocities_of_the_recurrence_in_all_models():
    block = masonry.RockingBlock(0.3, 1.5)
    expected = masonry.closed_form.pulse_sequence(block, I, 0.7, 25).angular_velocity
    for restoring in ("exact", "linear", "constant"):
        history = masonry.simulate(block, masonry.PulseTrain(I), 0.7, restoring, half_cycles=25)
        np.testing.assert_allclose(np.abs(history.impact_velocities), expected, rtol=1e-13)


def test_sample_against_scipy():
    block = masonry.RockingBlock(0.3, 1.5)
    motion = masonry.Sine(0.3 * G, 1.0, cycles=2)
    history = masonry.simulate(block, motion, 0.9)
    uplift = np.arcsin((0.3 / 1.5) / 0.3) / (2 * np.pi)
    t = np.linspace(uplift, history.impact_times[0], 50)
    p2, alpha = block.frequency_parameter**2, block.critical_angle
    equation = lambda t, y: [y[1], -p2 * (np.sin(alpha - y[0]) - motion.acceleration(t) / G * np.cos(alpha - y[0]))]  # tilted to -x
    reference = solve_ivp(equation, (t[0], t[-1]), [0, 0], "DOP853", t, rtol=1e-13, atol=1e-15).y
    angle, velocity = history.sample(t)
    np.testing.assert_allclose(-angle, reference[0], atol=1e-11)
    np.testing.assert_allclose(-velocity[:-1], reference[1][:-1], atol=1e-11)


@given(st.floats(0.5, 20), st.just(0.0) | st.floats(1e-3, 1), st.floats(1e-9, 0.999), st.sampled_from(["exact", "linear", "constant"]))
def test_free_rocking_loses_energy_as_restitution_says(slenderness, C, share, restoring):
    block = masonry.RockingBlock(0.3, 0.3 * slenderness)
    history = masonry.simulate(block, initial_angle=share * block.critical_angle, restitution=C, restoring=restoring, half_cycles=12)
    w = np.abs(history.impact_velocities)
    assert not history.overturned
    np.testing.assert_allclose(w[1:], C * w[:-1], rtol=1e-12)
    assert np.all(np.diff(np.abs(history.peak_angles)) <= 1e-15)
    assert np.all(history.peak_angles[1:] * history.peak_angles[:-1] <= 0)
    assert np.all(np.diff(history.impact_times) >= 0)  # the last hops are below the resolution of time


@given(st.floats(1, 15), st.floats(0.3, 0.95), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5))
def test_mirror(slenderness, C, share, velocity):
    block = masonry.RockingBlock(0.3, 0.3 * slenderness)
    one = masonry.simulate(block, masonry.HalfSine(5.0, 0.4), C, initial_angle=share / slenderness, initial_velocity=velocity, t_end=4)
    two = masonry.simulate(block, masonry.HalfSine(-5.0, 0.4), C, initial_angle=-share / slenderness, initial_velocity=-velocity, t_end=4)
    np.testing.assert_array_equal(one.impact_times, two.impact_times)
    np.testing.assert_array_equal(one.peak_angles, -two.peak_angles)
    assert one.overturn_half_cycle == two.overturn_half_cycle


def test_arrays_give_the_scalar_answers_in_the_callers_shape():
    half_height, C = np.array([0.9, 1.5, 2.7]), np.array([[0.6], [0.8]])
    block = masonry.RockingBlock(0.3, half_height)
    table = masonry.simulate(block, masonry.PulseTrain(I), C, half_cycles=15)
    t = np.array([[0.1, 0.5, 2.0, 4.0]])
    angles, _ = table.sample(t)
    assert table.overturned.shape == (2, 3) and angles.shape == (2, 3, 1, 4)
    for i, j in np.ndindex(2, 3):
        one = masonry.simulate(masonry.RockingBlock(0.3, half_height[j]), masonry.PulseTrain(I), C[i, 0], half_cycles=15)
        n = len(one.impact_times)
        np.testing.assert_array_equal(table.impact_times[i, j, :n], one.impact_times)
        assert np.all(np.isnan(table.impact_times[i, j, n:]))
        assert table.overturn_half_cycle[i, j] == one.overturn_half_cycle
        assert table.base_displacement[i, j] == one.base_displacement
        np.testing.assert_array_equal(angles[i, j], one.sample(t)[0])


def test_one_and_two_threads_give_the_same_bits():
    script = ("import masonry, numpy as np; b = masonry.RockingBlock(0.3, np.linspace(0.5, 4, 400));"
              "h = masonry.simulate(b, masonry.Sine(3.0, 1.0), 0.8, t_end=10);"
              "print(np.nansum(h.peak_angles).hex(), np.nansum(h.impact_times).hex(), h.overturned.sum())")
    run = lambda threads: subprocess.run([sys.executable, "-c", script], env={**os.environ, "OMP_NUM_THREADS": threads}, check=True,
                                         capture_output=True).stdout
    assert run("1") == run("2")


def test_train_of_given_length_leaves_the_base_at_rest_where_the_paper_says():
    block = masonry.RockingBlock(0.3, 1.5)
    history = masonry.simulate(block, masonry.PulseTrain(I, half_cycles=60), 0.7, "constant")
    drift = -2 * 5 * 0.0125 * I / (1 - 0.7)
    assert history.base_displacement == pytest.approx(drift, rel=1e-8)  # up to C^60
    np.testing.assert_allclose(history.sample_base(np.array([100.0, 200.0])), drift, rtol=1e-8)
    assert history.rest_time > history.impact_times[60]
    assert history.sample(history.rest_time + 1) == (0, 0)


def test_the_block_rests_until_the_base_accelerates_enough():
    block = masonry.RockingBlock(0.3, 1.5)
    history = masonry.simulate(block, masonry.Rectangular(0.999 * G / 5, 1.0))
    assert len(history.impact_times) == 0 and history.rest_time == 0 and not history.overturned
    moved = masonry.simulate(block, masonry.Rectangular(1.001 * G / 5, 1.0))
    assert moved.peak_angles[0] < 0  # a base that accelerates towards +x tips it towards -x


# In free flight w^2/2 + p^2 cos(alpha - |angle|) stays. Round-off of some hundred steps; a knot with the larger peak of the half cycle is off by
# a tenth of it.
def test_samples_after_a_second_smaller_peak_keep_the_energy():
    block, end = masonry.RockingBlock(0.3, 1.5), 1.4
    for amplitude in (5.6, 5.7, 5.8):
        history = masonry.simulate(block, masonry.Sine(amplitude, 1.0, end), 0.8, t_end=6.0)
        landing = history.impact_times[history.impact_times > end][0]
        angle, velocity = history.sample(np.linspace(end, landing, 500, endpoint=False))
        assert np.any(velocity * angle > 0) and np.abs(angle).max() < np.abs(history.peak_angles).max()
        energy = velocity**2 / 2 + block.frequency_parameter**2 * np.cos(block.critical_angle - np.abs(angle))
        assert np.ptp(energy) < 1e-12 * energy[0]


# A 1e-9 more of the motion moves a peak by as little, but for what is lost where the block is lifted by less than round-off of its angle. Where
# round-off at the instant of uplift was taken for a landing, peaks up to 0.15 critical angles were lost.
@pytest.mark.parametrize("restoring", ["exact", "linear", "constant"])
def test_no_uplift_is_lost(restoring):
    block = masonry.RockingBlock(0.3, 1.5)
    amplitude = G / 5 * np.arange(1.01, 2, 0.002)
    for duration in np.arange(0.1, 3, 0.15):
        first, more = (np.nan_to_num(np.abs(masonry.simulate(block, masonry.HalfSine(factor * amplitude, duration), restoring=restoring, t_end=2 * duration)
                                            .peak_angles)).max(axis=1) for factor in (1, 1 + 1e-9))
        assert np.abs(more - first).max() < 1e-6 * block.critical_angle


def test_with_constant_moment_what_reaches_the_critical_angle_has_overturned():
    block = masonry.RockingBlock(0.3, 1.5)
    alpha = block.critical_angle
    assert masonry.simulate(block, restoring="constant", initial_angle=1.5 * alpha, t_end=5.0).overturned
    # The peak of 0.9 alpha at 0.5 rad/s is 0.5^2 / (2 angular acceleration) farther: beyond alpha.
    assert masonry.simulate(block, restoring="constant", initial_angle=0.9 * alpha, initial_velocity=0.5, t_end=5.0).overturned
    amplitude = G / 5 * np.arange(1.01, 4, 0.01)
    short, long = (masonry.simulate(block, masonry.HalfSine(amplitude, 0.8), 0.8, "constant", t_end=end) for end in (5.0, None))
    assert np.array_equal(short.overturned, long.overturned) and 0 < short.overturned.sum() < len(amplitude)


@pytest.mark.parametrize("arguments, words", [
    (dict(restitution=-0.1), "restitution = -0.1"),
    (dict(restitution="a"), "restitution = 'a': must be a number"),
    (dict(initial_angle=2.0), "initial_angle = 2"),
    (dict(initial_velocity=np.inf), "initial_velocity = inf"),
    (dict(t_end=-1), "t_end = -1"),
    (dict(half_cycles=0), "half_cycles = 0"),
    (dict(half_cycles=2.5), "half_cycles = 2.5: must be a whole number, at least 1"),
    (dict(half_cycles="a"), "half_cycles = 'a': must be a whole number"),
    (dict(motion=1.0), "motion = 1.0: must be a motion"),
    (dict(restoring="cubic"), "restoring = 'cubic'"),
    (dict(initial_angle=0.1, restitution=1.0), "never ends"),
    (dict(motion=masonry.PulseTrain(0.1)), "never ends"),
])
def test_bad_input(arguments, words):
    with pytest.raises(ValueError, match=words):
        masonry.simulate(masonry.RockingBlock(0.3, 1.5), **arguments)


def test_import_is_light():
    script = "import sys, numpy; before = set(sys.modules); import masonry; print(sorted(set(sys.modules) - before))"
    added = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout
    assert not any(heavy in added for heavy in ("matplotlib", "scipy", "h5py", "pandas", "yade", "masonry.dem"))


def test_without_a_value_the_restitution_is_the_natural_one():
    block = masonry.RockingBlock(0.3, 1.5)
    found = masonry.simulate(block, initial_angle=0.1, half_cycles=2)
    given = masonry.simulate(block, initial_angle=0.1, half_cycles=2, restitution=1 - 1.5 * np.sin(np.arctan(0.2)) ** 2)
    np.testing.assert_allclose(found.peak_angles, given.peak_angles, rtol=1e-14)


@pytest.mark.parametrize("restoring", ["exact", "linear", "constant"])
def test_samples_after_overturning_are_nan(restoring):
    alpha = np.arctan(0.2)
    block = masonry.RockingBlock(0.1 * np.sin(alpha), 0.1 * np.cos(alpha))
    motion = masonry.Record(0.02, 8 * np.random.default_rng(16).normal(size=50))
    for t_end in (None, 2.0):
        history = masonry.simulate(block, motion, restoring=restoring, t_end=t_end)
        angle, velocity = history.sample(np.array([0.1, 0.6, 1.0, 1.5, 1e9, np.inf]))
        assert history.overturned and abs(angle[0]) < np.pi / 2
        assert np.all(np.isnan(angle[1:])) and np.all(np.isnan(velocity[1:]))
    free = masonry.simulate(block, initial_angle=0.9 * alpha, initial_velocity=5.0, restoring=restoring)
    assert np.isnan(free.sample([1e3, np.inf])[0]).all()


def _integrated(block, motion, vertical, C, t_end, kinks, ends=None):
    """(impact times, peaks) by SciPy's DOP853 with events, from rest at t = 0, piece by piece between the kinks. motion(t, impacts), vertical(t)."""
    p2, alpha, g = block.frequency_parameter**2, block.critical_angle, block.gravity
    impacts, peaks, t, side, y, peak = [], [], 0.0, 0, np.zeros(2), 0.0
    while t < t_end:
        end = min([k for k in kinks(impacts) if k > t + 1e-12] + [t_end])
        excess = lambda t: abs(motion(t, impacts)) - (g + vertical(t)) / block.slenderness
        if side == 0:
            times = np.linspace(t, end, 401)[1:-1]
            above = np.flatnonzero([excess(time) > 0 for time in times])
            if not above.size:
                t = end
                continue
            low, high = times[above[0]] - (end - t) / 400, times[above[0]]
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (low, middle) if excess(middle) > 0 else (middle, high)
            t, side, y, peak = high, -np.sign(motion(high, impacts)), np.zeros(2), 0.0
        equation = lambda time, u: [u[1], -p2 * ((1 + vertical(time) / g) * np.sin(alpha - u[0]) + side * motion(time, impacts) / g * np.cos(alpha - u[0]))]
        landing, top = (lambda time, u: u[0] if time > t + 1e-9 else 1.0), (lambda time, u: u[1])
        landing.terminal, landing.direction, top.direction = True, -1, -1
        inside = np.nextafter(end, t)  # the motion is right of its kinks
        found = solve_ivp(equation, (t, inside), y, "DOP853", rtol=1e-10, atol=1e-13, events=(landing, top))
        peak = max([peak] + [u[0] for u in found.y_events[1]])
        t, y = (found.t[-1] if found.status == 1 else end), found.y[:, -1]
        if found.status == 1:
            impacts.append(t)
            peaks.append(side * peak)
            side, y, peak = -side if -C * y[1] > 1e-6 else 0, np.array([0, -C * y[1]]), 0.0
    return impacts, peaks


# Bound: DOP853 at its tightest tolerance, over a few impacts.
@pytest.mark.parametrize("upwards", [masonry.Sine(3.0, 2.3, 4), masonry.Sine(-6.0, 5.1, 10), masonry.Record(0.3, [0, 4, -5, 2, -3, 4, 0])])
def test_vertical_motion_against_an_independent_integration(upwards):
    block, sideways = masonry.RockingBlock(0.3, 1.5), masonry.Sine(2.6, 1.1, 2.5)
    history = masonry.simulate(block, sideways, 0.85, vertical=upwards, t_end=2.3)
    kinks = sorted({2.5 / 1.1, 4 / 2.3, 10 / 5.1, *(0.3 * np.arange(7))})
    impacts, peaks = _integrated(block, lambda t, _: sideways.acceleration(t), upwards.acceleration, 0.85, 2.3, lambda _: kinks)
    # The last of infinitely many hops end at different thresholds: impacts after larger peaks count.
    times, found, peaks = history.impact_times, history.peak_angles[:len(history.impact_times)], np.array(peaks)
    times, found = times[np.abs(found) > 1e-4], found[np.abs(found) > 1e-4]
    impacts, peaks = np.array(impacts)[np.abs(peaks) > 1e-4], peaks[np.abs(peaks) > 1e-4]
    assert len(impacts) >= 2 and len(times) == len(impacts)
    np.testing.assert_allclose(times, impacts, rtol=1e-7)
    np.testing.assert_allclose(found, peaks, rtol=0, atol=1e-7 * np.abs(peaks).max())
    plain = masonry.simulate(block, sideways, 0.85, t_end=2.3)
    assert np.abs(plain.peak_angles).max() < 0.99 * np.abs(peaks).max() or np.abs(plain.peak_angles).max() > 1.01 * np.abs(peaks).max()


# Under a constant vertical acceleration the base is another planet: gravity g + a_z, until that ends.
def test_constant_vertical_acceleration_is_gravity():
    sideways = masonry.Sine(2.6, 1.1, 2.5)
    for lift in (-4.0, 5.0):
        for restoring in ("exact", "linear", "constant"):
            heavy = masonry.simulate(masonry.RockingBlock(0.3, 1.5, G + lift), sideways.scaled((G + lift) / G), 0.85, restoring, t_end=4)
            moved = masonry.simulate(masonry.RockingBlock(0.3, 1.5), sideways.scaled((G + lift) / G), 0.85, restoring, t_end=4,
                                     vertical=masonry.Rectangular(lift, 5.0))
            assert len(heavy.impact_times) >= 3
            np.testing.assert_allclose(moved.impact_times, heavy.impact_times, rtol=1e-10)
            t = np.linspace(0, 4, 50)
            np.testing.assert_allclose(moved.sample(t)[0], heavy.sample(t)[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("shape", ["rectangular", "half-sine"])
@pytest.mark.parametrize("keeps", ["amplitude", "duration"])
def test_finite_resonant_train_against_an_independent_integration(shape, keeps):
    block, duration, C, n = masonry.RockingBlock(0.3, 1.5 if keeps == "amplitude" else 3.0), 0.1, 0.6, 6
    single = duration / 2 if keeps == "amplitude" else duration
    history = masonry.simulate(block, masonry.PulseTrain(I, half_cycles=n, shape=shape, duration=duration, single_keeps=keeps), C, half_cycles=n + 1)

    def pulse(k, impacts):
        return (0.0, *impacts)[k], (single if k in (0, n) else duration), (-1) ** k * (1 if k in (0, n) else 2) * I

    def acceleration(t, impacts):
        total = 0.0
        for k in range(min(len(impacts), n) + 1):
            start, length, jump = pulse(k, impacts)
            if start <= t < start + length:
                total += jump / length * (1 if shape == "rectangular" else np.pi / 2 * np.sin(np.pi * (t - start) / length))
        return total

    kinks = lambda impacts: [sum(pulse(k, impacts)[:2]) for k in range(min(len(impacts), n) + 1)]
    impacts, peaks = _integrated(block, acceleration, lambda t: 0.0, C, 1.001 * history.impact_times[-1], kinks)
    assert len(history.impact_times) == n + 1 == len(impacts)
    np.testing.assert_allclose(history.impact_times, impacts, rtol=1e-7)
    np.testing.assert_allclose(history.peak_angles[:n + 1], peaks, rtol=1e-7)
    assert history.sample_base(1e3) == pytest.approx(history.sample_base(2e3))  # the last pulse brings the base to rest


def test_the_papers_finite_pulse_starts_and_stabilises():
    block = masonry.RockingBlock(0.3, 1.5)
    train = dict(impulse=I, shape="rectangular", duration=0.1)
    started = masonry.simulate(block, masonry.PulseTrain(**train), 0.6, half_cycles=40)
    assert len(started.impact_times) == 40
    half = masonry.simulate(block, masonry.PulseTrain(**train, single_keeps="duration"), 0.6, half_cycles=40, t_end=10)
    assert len(half.impact_times) == 0  # 0.125 g is less than the 0.2 g that lift this block
    # In the steady state each half cycle is the one before, mirrored: any start leads there.
    started, pushed = (masonry.simulate(block, masonry.PulseTrain(**train), 0.6, initial_velocity=velocity, half_cycles=80) for velocity in (0, -0.05))
    np.testing.assert_allclose(np.abs(started.peak_angles[-2:]), np.abs(pushed.peak_angles[-2:]), rtol=1e-7)
    short = masonry.simulate(block, masonry.PulseTrain(I, shape="rectangular", duration=1e-5), 0.6, half_cycles=40)
    np.testing.assert_allclose(short.impact_times, masonry.simulate(block, masonry.PulseTrain(I), 0.6, half_cycles=40).impact_times, rtol=1e-3)
    with pytest.raises(ValueError, match="single_keeps = 'shape': must be 'amplitude' or 'duration'"):
        masonry.PulseTrain(**train, single_keeps="shape")
    with pytest.raises(ValueError, match="duration = 0"):
        masonry.PulseTrain(I, shape="rectangular")
    with pytest.raises(RuntimeError, match="impact 1 at .* the pulse before acts until"):
        masonry.simulate(block, masonry.PulseTrain(2.65, shape="half-sine", duration=4.0), 0.6, half_cycles=4)


def test_bad_vertical_motions():
    block = masonry.RockingBlock(0.3, 1.5)
    for vertical, words in ((masonry.Rectangular(-10.0, 1.0), "vertical acceleration = -10: must stay above -gravity"), (masonry.Sine(9.9, 1.0), "must stay above"),
                            (masonry.PulseTrain(0.1, [0]), "velocity jump of vertical"), (masonry.PulseTrain(0.1), "vertical = .*not a resonant train"),
                            (1.0, "vertical = 1.0: must be a motion")):
        with pytest.raises(ValueError, match=words):
            masonry.simulate(block, masonry.Sine(3.0, 1.0), vertical=vertical)


def test_nan_is_the_natural_restitution_and_sizes_are_whole():
    block = masonry.RockingBlock.from_size(0.6, np.array([3.0, 4.0]))
    assert block.half_width == 0.3 and block.half_height.tolist() == [1.5, 2]
    assert isinstance(masonry.RockingBlock.from_size(0.6, 3.0).slenderness, float)
    natural, mixed = (masonry.simulate(block, initial_angle=0.1, restitution=C, half_cycles=3) for C in (None, [np.nan, 0.5]))
    np.testing.assert_array_equal(natural.peak_angles[0], mixed.peak_angles[0])
    assert np.abs(natural.peak_angles[1, 1]) > np.abs(mixed.peak_angles[1, 1])


@pytest.mark.parametrize("restoring", ["exact", "constant"])
def test_the_picture_of_a_block_that_overturns_says_when(tmp_path, monkeypatch, restoring):
    """Set off with the angular velocity w from the upright position, the block passes its critical angle when the integral of dt = d(angle)/velocity has come
    there: (velocity/p)^2 = (w/p)^2 - 2 (cos(alpha - angle) - cos(alpha)), and with the constant moment (w/p)^2 - 2 sin(alpha) angle."""
    from matplotlib.figure import Figure
    from scipy.integrate import quad

    block = masonry.RockingBlock(0.3, 1.5)
    alpha, p, w = block.critical_angle, block.frequency_parameter, 1.0
    work = (lambda a: 2 * (np.cos(alpha - a) - np.cos(alpha))) if restoring == "exact" else (lambda a: 2 * np.sin(alpha) * a)
    passes = quad(lambda a: 1 / (p * np.sqrt((w / p)**2 - work(a))), 0, alpha)[0]
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **given: drawn.append(figure))
    history = masonry.simulate(block, initial_velocity=w, restoring=restoring)
    assert history.overturned
    history.draw(tmp_path / "fall.png")
    title = drawn[0].axes[0].get_title()
    assert title == f"overturns at {passes:.4g} s, in half cycle 1"
    assert drawn[0].axes[0].lines[0].get_xdata()[-1] > passes
    # Driven past its critical angle more than once: the last time counts.
    driven = masonry.simulate(block, masonry.Sine(3.5, 1.0, 3))
    passes, lies = driven._fall()
    around = np.abs(driven.sample([passes - 1e-4, passes + 1e-4, lies - 1e-4, lies + 1e-4])[0]) / alpha
    assert around[0] < 1 < around[1] and np.isfinite(around[2]) and np.isnan(around[3])
    assert np.all(np.abs(driven.sample(np.linspace(passes + 1e-4, lies - 1e-4, 1000))[0]) > alpha)


def test_a_history_says_what_happened_in_one_line():
    block = masonry.RockingBlock(0.3, 1.5)
    assert repr(masonry.simulate(block, initial_velocity=1.0)) == "History(block of 0.6 x 3 m on a still base: overturns in half cycle 1)"
    stands = masonry.simulate(block, masonry.Sine(2.5, 1.0, 3))
    ratio = np.abs(stands.sample(np.linspace(0, 12, 100001))[0]).max() / block.critical_angle
    assert repr(stands) == (f"History(block of 0.6 x 3 m under Sine(amplitude=2.5, frequency=1.0, cycles=3): stands, {len(stands.impact_times)} impacts, "
                            f"at most {ratio:.3g} of the critical angle, at rest from {stands.rest_time:.4g} s on)")
    assert repr(masonry.simulate(block, masonry.Sine([2.5, 3.5, 0.1], 1.0, 3))) == f"History(3 cases: 1 overturn, 2 stand and rotate to at most {ratio:.3g} of the critical angle)"
    assert repr(masonry.simulate(block, initial_velocity=[1.0, 2.0])) == "History(2 cases: 2 overturn, none stands)"
    blocks = masonry.RockingBlock.from_size(np.array([[0.6], [1.2]]), 3.0)
    assert repr(masonry.simulate(blocks, masonry.Sine([2.5, 0.1], 1.0, 3))).startswith("History(2 x 2 cases: 0 overturn, 4 stand and rotate to at most ")


def test_a_run_that_ends_before_its_motion_says_so():
    block, sine = masonry.RockingBlock(0.2, 1.0), masonry.Sine(2.5, 1.0, 4)
    up = masonry.Sine(1.0, 1.0, 5)
    record = masonry.artificial_record(seed=7, peak=0.4 * 9.81, duration=12, frequency=1.2)
    part, whole = masonry.simulate(block, record, t_end=3), masonry.simulate(block, record)
    assert not part.overturned and part.motion_run == 0.25 and whole.overturned and whole.motion_run == 1
    assert "stands, " in repr(part) and repr(part).endswith(", after 3 of 12 s of the motion, still rocking at 3 s)") and "overturns in half cycle" in repr(whole)
    train = masonry.PulseTrain(0.02, half_cycles=3)  # of which the last pulse is at impact 3
    pulses = masonry.PulseTrain(0.02, times=[1, 2], assembly=True, shape="rectangular", duration=0.1)  # the last one, of I, lasts half as long
    for motion, options, share, words in (
            (sine, dict(t_end=3), 0.75, "after 3 of 4 s of the motion"), (sine, dict(t_end=4), 1, ""), (sine, {}, 1, ""), (masonry.Rectangular(0.1, 2), dict(t_end=1), 0.5, "of 2 s"),
            (masonry.HalfSine(0.1, 2), dict(t_end=1.5), 0.75, "of 2 s"), (sine, dict(t_end=3, vertical=up), 0.6, "after 3 of 5 s"), (None, dict(t_end=1, initial_angle=0.1), 1, ""),
            (None, {}, 1, ""), (train, dict(half_cycles=2), 0, "s of a motion without a known end"), (train, dict(half_cycles=3), 1, ""), (train, {}, 1, ""),
            (masonry.PulseTrain(0.02), dict(half_cycles=2), 0, "s of a motion without a known end"), (pulses, dict(t_end=1.025), 0.5, "after 1.025 of 2.05 s"),
            (pulses, dict(t_end=2.05), 1, ""), (masonry.PulseTrain(0.02, times=[1, 2]), dict(t_end=2), 1, ""), (record.scaled(0.01), dict(t_end=record.duration), 1, "")):
        history = masonry.simulate(block, motion, **options)
        assert history.motion_run == pytest.approx(share, rel=1e-12) and not history.overturned
        assert words in repr(history) and ("after" in repr(history)) == bool(words)
    cases = masonry.simulate(block, masonry.Sine(1.0, [0.5, 1.0, 4.0], 2), t_end=2)
    np.testing.assert_allclose(cases.motion_run, [0.5, 1, 1])
    assert repr(cases).endswith(", 1 of them after only a part of the motion)")
    # A block that is on its way over does not stand, and has not overturned yet.
    assert repr(masonry.simulate(block, initial_velocity=1.0, t_end=0.1)).endswith("of the critical angle, still rocking at 0.1 s)")


def test_the_version_is_that_of_the_build():
    assert masonry.__version__ == masonry._build.VERSION and masonry.__version__[0].isdigit()


def test_picture_of_a_history(tmp_path):
    block = masonry.RockingBlock(0.2, 1.0)
    record = masonry.Record(0.01, 3 * np.sin(2 * np.pi * 0.01 * np.arange(300)), unit="m/s^2")
    histories = [masonry.simulate(block, record), masonry.simulate(block, record.scaled(10)), masonry.simulate(block, masonry.PulseTrain(0.1), half_cycles=3),
                 masonry.simulate(block, initial_angle=0.1), masonry.simulate(block)]
    for k, history in enumerate(histories):
        history.draw(tmp_path / f"{k}.png")
        assert (tmp_path / f"{k}.png").stat().st_size > 10000
    with pytest.raises(ValueError, match=r"the history is of \(2,\) cases: must be of one block"):
        masonry.simulate(block, record.scaled([1, 2])).draw(tmp_path / "two.png")
    for name in ("picture", "picture.pgn"):
        with pytest.raises(ValueError, match=rf"path = .*{name}: must end in .png, .pdf, .svg"):
            histories[0].draw(tmp_path / name)
    with pytest.raises(IsADirectoryError, match="path = .*: is a folder: must be the name of a file"):
        histories[0].draw(tmp_path)
