"""Closed form of the paper: numbers recomputed here from its equations with NumPy."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

import masonry

G = 9.81
I = 0.0125 * G  # the paper's pulse


def test_derived_quantities():
    b, a = np.array([0.1, 0.3]), np.array([[0.5], [1.5], [0.05]])
    block = masonry.RockingBlock(b, a)
    np.testing.assert_allclose(block.slenderness, a / b, rtol=1e-15)
    np.testing.assert_allclose(block.radius, np.hypot(a, b), rtol=1e-15)
    np.testing.assert_allclose(block.critical_angle, np.arctan(b / a), rtol=1e-15)
    np.testing.assert_allclose(block.frequency_parameter, np.sqrt(3 * G / 4 / np.hypot(a, b)), rtol=1e-15)
    np.testing.assert_allclose(block.angular_acceleration, 3 * G * b / 4 / (a**2 + b**2), rtol=1e-15)
    np.testing.assert_allclose(block.natural_restitution, np.maximum(0, 1 - 1.5 * np.sin(np.arctan(b / a))**2), atol=1e-15)
    assert isinstance(masonry.RockingBlock(0.3, 1.5).slenderness, float)


@pytest.mark.parametrize("C, period, ratio", [(0.6, 1.25, 0.233329), (0.7, 5 / 3, 0.414807), (0.8, 2.5, 0.933315)])
def test_example_of_the_paper(C, period, ratio):
    block = masonry.RockingBlock(0.3, 1.5)
    limit = masonry.closed_form.stabilised(block, I, C)
    assert limit.period == pytest.approx(period, rel=1e-14)  # 0.1 lambda/(1-C)
    w1 = 1.5 * I / (4 * (1.5**2 + 0.3**2) / 3)  # impulse times lever arm over moment of inertia
    assert limit.peak_angle == pytest.approx(2 * w1**2 / (block.angular_acceleration * (1 - C)**2), rel=1e-14)
    assert limit.ratio == pytest.approx(ratio, abs=5e-7)
    assert not limit.overturns


# Where theta* = alpha: root of 2 w1^2/(A (1-C)^2) = atan(1/lambda) with b fixed, so a single equation for lambda.
@pytest.mark.parametrize("C, base", [(0.7, 0.4), (0.7, 0.6), (0.8, 0.4), (0.8, 1.2)])
def test_slenderness_at_which_the_stabilised_phase_overturns(C, base):
    from scipy.optimize import brentq
    b = base / 2
    excess = lambda s: 2 * s**2 * (3 * G / (4 * b * (1 + s**2))) * 0.0125**2 / (1 - C)**2 - np.arctan(1 / s)
    crossing = brentq(excess, 1, 12, xtol=1e-14)
    for factor, expected in [(1 - 1e-12, False), (1 + 1e-12, True)]:
        block = masonry.RockingBlock(b, b * crossing * factor)
        assert masonry.closed_form.stabilised(block, I, C).overturns == expected


def test_sequence_and_single_pulse():
    block = masonry.RockingBlock(0.3, np.array([1.5, 3.0]))
    sequence = masonry.closed_form.pulse_sequence(block, I, 0.8, 7)
    assert sequence.angular_velocity.shape == (2, 7)
    s = np.array([1, 2.8, 4.24, 5.392, 6.3136, 7.05088, 7.640704])
    np.testing.assert_allclose(sequence.angular_velocity, s * sequence.angular_velocity[:, :1], rtol=1e-14)
    single = masonry.closed_form.single_pulse(block, I)
    np.testing.assert_allclose(single.duration, 2 * block.slenderness * 0.0125, rtol=1e-14)
    np.testing.assert_allclose(sequence.end_time, np.cumsum(sequence.duration, axis=1), rtol=1e-14)
    np.testing.assert_allclose(sequence.peak_angle[:, 0], single.peak_angle, rtol=1e-14)
    np.testing.assert_allclose(single.peak_angle, 0.5 * block.slenderness**2 * block.angular_acceleration * 0.0125**2, rtol=1e-14)


def test_time_to_stabilise_needs_and_obeys_its_tolerance():
    block = masonry.RockingBlock(0.3, 1.5)
    for tolerance in (0.1, 0.01):
        i = int(np.ceil(1 + np.log(2 * tolerance / 1.7) / np.log(0.7)))  # (1+C)/2 C^(i-1) <= tolerance, C = 0.7
        expected = masonry.closed_form.pulse_sequence(block, I, 0.7, i).end_time[-1]
        assert masonry.closed_form.time_to_stabilise(block, I, 0.7, tolerance) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("call, words", [
    (lambda: masonry.RockingBlock(0, 1), "half_width = 0: must be > 0"),
    (lambda: masonry.RockingBlock(1, [1, np.nan]), "half_height = nan"),
    (lambda: masonry.RockingBlock(1, 1, -1), "gravity = -1"),
    (lambda: masonry.RockingBlock("a", 1), "half_width = 'a': must be a number"),
    (lambda: masonry.RockingBlock(1, ["1", 2]), r"half_height = \['1', 2\]: must be a number"),
    (lambda: masonry.closed_form.single_pulse(masonry.RockingBlock(1, 1), -1), "impulse = -1"),
    (lambda: masonry.closed_form.stabilised(masonry.RockingBlock(1, 1), 1, 1.5), r"restitution = 1.5: must be in \[0, 1\]"),
    (lambda: masonry.closed_form.pulse_sequence(masonry.RockingBlock(1, 1), 1, 0.5, 0), "n = 0"),
    (lambda: masonry.closed_form.pulse_sequence(masonry.RockingBlock(1, 1), 1, 0.5, 2.5), "n = 2.5: must be a whole number, at least 1"),
    (lambda: masonry.closed_form.time_to_stabilise(masonry.RockingBlock(1, 1), 1, 0.5, 0), "tolerance = 0"),
])
def test_bad_input(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_restitution_left_out_is_the_natural_one():
    block = masonry.RockingBlock(0.1, np.array([0.4, 0.6]))
    natural = 1 - 1.5 * np.sin(np.arctan(block.half_width / block.half_height))**2
    for given in (None, np.nan, [np.nan, natural[1]]):
        np.testing.assert_allclose(masonry.closed_form.stabilised(block, 0.05, given).amplification, 4 / (1 - natural)**2, rtol=1e-12)
        np.testing.assert_allclose(masonry.closed_form.pulse_sequence(block, 0.05, given, 3).angular_velocity,
                                   masonry.closed_form.pulse_sequence(block, 0.05, natural, 3).angular_velocity, rtol=1e-12)
        assert masonry.closed_form.time_to_stabilise(block, 0.05, given, 0.01).shape == (2,)


def test_sizes_in_mm_are_named(recwarn):
    masonry.RockingBlock.from_size(width=[0.4, 8], height=40)
    assert not recwarn.list
    masonry.RockingBlock.from_size(width=[0.4, 400], height=2000)
    assert [str(warning.message) for warning in recwarn.list] == ["width = 400: is it in mm? Sizes are in m", "height = 2000: is it in mm? Sizes are in m"]


def test_a_package_without_its_compiled_module_says_how_to_build_it(tmp_path):
    shutil.copytree(os.path.dirname(masonry.__file__), tmp_path / "masonry", ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    done = subprocess.run([sys.executable, "-c", "import masonry"], env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 1
    assert "ImportError: masonry needs its compiled module masonry/_core.so: build it with `cmake --preset release" in done.stderr.splitlines()[-1]
