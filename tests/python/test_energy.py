"""The exact histories keep their energy: between impacts w^2/2 + p^2 cos(alpha - |theta|) changes by the work of the base alone."""

import numpy as np
import pytest

import masonry

BLOCK = masonry.RockingBlock(0.3, 1.5)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def energy(angle, velocity):
    return velocity**2 / 2 + BLOCK.frequency_parameter**2 * np.cos(BLOCK.critical_angle - np.abs(angle))


@pytest.mark.parametrize("motion", [None, masonry.Sine(0.35 * 9.81, 1.2, cycles=2)])
def test_energy_closes_between_impacts(motion):
    start = 0.6 * BLOCK.critical_angle if motion is None else 0.0
    history = masonry.simulate(BLOCK, motion, restitution=0.9, initial_angle=start, t_end=3.0)
    assert not history.overturned
    kinks = [] if motion is None else [2 / 1.2]
    lifted = 0.0 if motion is None else history.impact_times[0]  # before: the instant of uplift is a kink as well
    ends = np.sort([lifted, *history.impact_times[history.impact_times > lifted], *kinks])
    barrier = BLOCK.frequency_parameter**2 * (1 - np.cos(BLOCK.critical_angle))
    checked = 0
    for left, right in zip(ends, ends[1:]):
        margin = 1e-9 * (right - left)  # an impact belongs to the half cycle after it
        left, right = left + margin, right - margin
        time = (left + right) / 2 + (right - left) / 2 * NODES
        angle, velocity = history.sample(time)
        pull = 0.0 if motion is None else motion.acceleration(time) / 9.81
        power = -BLOCK.frequency_parameter**2 * pull * np.cos(BLOCK.critical_angle - np.abs(angle)) * velocity
        work = (right - left) / 2 * np.sum(WEIGHTS * power)  # 40 Gauss points on a smooth half cycle: round-off
        (a0, a1), (v0, v1) = history.sample(np.array([left, right]))
        assert abs(energy(a1, v1) - energy(a0, v0) - work) < 1e-10 * barrier
        checked += 1
    assert checked >= 3
