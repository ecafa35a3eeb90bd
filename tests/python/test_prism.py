"""Blocks of any convex section in the theory: RockingBlock.of."""

import masonry
import numpy as np
import pytest

TRAPEZOID = [(0, 0), (0.8, 0), (0.4, 2), (0, 2)]
MIRRORED = [(-x, y) for x, y in TRAPEZOID]
RECTANGLE = [(1, 1), (1.6, 1), (1.6, 4), (1, 4)]


def test_edges_of_a_trapezoid():
    """Convex blocks, cases a6 and a7."""
    block = masonry.RockingBlock.of(TRAPEZOID)
    assert block.left.critical_angle == pytest.approx(0.336675, rel=2e-6)
    assert block.right.critical_angle == pytest.approx(0.502843, rel=2e-6)
    assert block.left.natural_restitution == pytest.approx(0.717949, rel=1e-6)
    assert block.right.natural_restitution == pytest.approx(0.8, rel=1e-12)
    assert block.critical_angle == block.left.critical_angle
    assert "0.8 m base" in repr(block)


def test_free_rocking_of_a_trapezoid():
    """Case a8: by quadrature."""
    history = masonry.simulate(masonry.RockingBlock.of(TRAPEZOID), restitution=0.7, initial_angle=0.2, half_cycles=4)
    assert history.impact_times == pytest.approx([0.412276, 1.251559, 1.567592, 1.880957], abs=6e-7)
    assert np.abs(history.impact_velocities) == pytest.approx([1.059979, 0.741985, 0.519390, 0.363573], abs=6e-7)
    assert history.peak_angles == pytest.approx([0.2, -0.1411057, 0.0405007, -0.0280790], abs=6e-8)
    angle, velocity = history.sample(history.peak_times[1])
    assert angle == pytest.approx(history.peak_angles[1], rel=1e-12)
    assert velocity == pytest.approx(0, abs=1e-9)


def test_natural_restitution_by_direction():
    history = masonry.simulate(masonry.RockingBlock.of(TRAPEZOID), initial_angle=0.1, half_cycles=3)
    after = np.abs(history.impact_velocities[1:])  # free: the spin after an impact comes back at the next one
    assert after / np.abs(history.impact_velocities[:-1]) == pytest.approx([0.8, 0.7179487], abs=1e-6)


@pytest.mark.parametrize("motion", [masonry.HalfSine(5.0, 1.0), masonry.Sine(4.0, 1.1, cycles=4), masonry.PulseTrain(0.5, half_cycles=3)])
def test_rectangle_is_the_rectangular_block(motion):
    section, block = masonry.RockingBlock.of(RECTANGLE), masonry.RockingBlock.from_size(0.6, 3)
    one, other = masonry.simulate(section, motion, 0.8), masonry.simulate(block, motion, 0.8)
    assert one.impact_times == pytest.approx(other.impact_times, rel=1e-10)
    assert one.peak_angles == pytest.approx(other.peak_angles, rel=1e-9)
    assert masonry.overturning_amplitude(section, motion, 0.8) == pytest.approx(masonry.overturning_amplitude(block, motion, 0.8), rel=1e-9)


def test_overturning_of_the_mirrored_block_under_the_mirrored_motion():
    block, mirrored = masonry.RockingBlock.of(TRAPEZOID), masonry.RockingBlock.of(MIRRORED)
    push = masonry.HalfSine(3.0, 0.8)
    there = masonry.overturning_amplitude(block, push)
    assert there == pytest.approx(masonry.overturning_amplitude(mirrored, push.scaled(-1)), rel=1e-9)
    # A push to the left turns it about its right edge, whose critical angle is larger.
    assert masonry.overturning_amplitude(block, push.scaled(-1))[0] > 1.2 * there[0]


def test_peaks_are_measured_against_the_critical_angle_of_their_side():
    block = masonry.RockingBlock.of(TRAPEZOID)
    motion = masonry.HalfSine([4.0, -6.0], 0.3)
    history = masonry.simulate(block, motion, 0.5)
    critical = np.where(history.peak_angles > 0, block.right.critical_angle, block.left.critical_angle)
    expected = np.nanmax(np.abs(history.peak_angles) / critical, axis=-1)
    assert masonry.spectra.peak_ratio(block, motion, 0.5) == pytest.approx(expected, rel=1e-14)


def test_bad_sections():
    with pytest.raises(ValueError, match="level side"):
        masonry.RockingBlock.of([(0, 0), (1, 0.1), (0, 2)])
    with pytest.raises(ValueError, match="centre of mass"):
        masonry.RockingBlock.of([(0, 0), (0.2, 0), (1, 2), (0.8, 2)])
    with pytest.raises(ValueError, match=r"points \(x, y\)"):
        masonry.RockingBlock.of([1, 2, 3])
    with pytest.raises(ValueError, match="depth of a corner of the polygon in the hull of the others = 1: must be 0 m: a section is convex"):
        masonry.RockingBlock.of([(0, 0), (3, 0), (1, 1), (0, 4)])  # the centre of the circle in a triangle with the sides 3, 4, 5
    with pytest.raises(ValueError, match="number of vertices"):
        masonry.RockingBlock.of([(0, 0), (1, 1)])
    with pytest.raises(ValueError, match="symmetric"):
        masonry.closed_form.single_pulse(masonry.RockingBlock.of(TRAPEZOID), 0.1)
