"""Base motions: a block that rocks under pulses and records, and the base that carries it."""

import numpy as np
import pytest
from driven_block import IMPULSE, compare_record, compare_schedules, compare_shapes, keep_place
from masonry import dem
from rocking_scene import Balance, one_block, quiet_engines, run_impacts
from yade import O

import masonry


TIMES = [0.0, 0.15, 0.5]


def engines(motion):
    return quiet_engines(motion, penetration=1e-6)


def test_resonant():
    """Velocities of Eq. 7, which Dirac pulses make exact; times and base displacement of the rigid block; a base that ends at rest."""
    n = 20
    base, id, block = one_block(5, restitution=0.7)
    train = dem.PulseTrainEngine(ids=[base], impulse=IMPULSE, resonantBlock=id, halfCycles=n)
    O.engines = engines(train)
    balance = Balance()
    exact = masonry.simulate(block, masonry.PulseTrain(IMPULSE, half_cycles=n), restitution=0.7, half_cycles=n)
    impacts = run_impacts(n, 1.05 * exact.impact_times[-1])
    wanted = masonry.closed_form.pulse_sequence(block, IMPULSE, 0.7, n).angular_velocity
    # Eq. 7 is the speed after each pulse, which energy brings back at the end of the half cycle.
    assert np.max(np.abs(impacts["velocity"][:n] / wanted - 1)) <= 1e-3
    assert np.max(np.abs(impacts["time"][:n] / exact.impact_times - 1)) <= 1e-3
    assert np.array_equal(train.pulseJumps, IMPULSE * np.array([1] + [2 * (-1) ** k for k in range(1, n)] + [1]))
    assert train.pulseTimes == [0.0] + list(impacts["time"][:n])
    O.step()
    rest = O.bodies[base].state.pos
    assert O.bodies[base].state.vel.norm() == 0  # sums of I, -2I, 2I, ... I: exact in binary
    # Displacement is the sum of velocity times interval: it inherits the error of the times.
    assert abs(rest[0] - train.residualDisplacement) < 1e-12
    assert abs(rest[0] / exact.base_displacement - 1) <= 1e-3, rest
    O.run(1000, True)
    assert (O.bodies[base].state.pos - rest).norm() < 1e-13  # round-off of a sum of 20 terms I t
    assert abs(balance.error()) <= 1e-4 * dem.energy()["baseWork"]
    print("resonant:", np.max(np.abs(impacts["velocity"][:n] / wanted - 1)), balance.error() / dem.energy()["baseWork"])


def test_schedules():
    compare_schedules(engines, TIMES, 1e-3)


def test_shapes():
    """What the springs of the face sway by ends when the block lifts. Before, it has stood for as long as they take to unload, of the order of
    sqrt(penetration x width / g) = 2.5e-4 s, of the 0.06 s of the pulse."""
    compare_shapes(engines, TIMES, 2.5e-4 / 0.06)


def test_a_record():
    compare_record(engines, 1e-3)


def test_a_base_keeps_its_place():
    keep_place(engines)


@pytest.mark.parametrize("shape, duration, impulse", (("rectangular", 0.05, 0.2), ("rectangular", 0.1, 0.4), ("half-sine", 0.05, 0.2)))
def test_a_base_whose_acceleration_jumps(shape, duration, impulse):
    """A base whose acceleration jumps: the block lifts then, as the rigid one does, and lands when that does; nothing lands before. What stands
    elsewhere changes nothing (times are right to the root of the penetration, 3e-3)."""
    seen = []
    for model, far in (("planar", False), ("compliant", False), ("compliant", True)):
        base, id, block = one_block(5, restitution=0.7)
        if far:
            dem.block((0.6, 1, 3), O.bodies[base].mat, center=(0, 3, 1.5))
        train = dem.PulseTrainEngine(ids=[base], impulse=impulse, resonantBlock=id, shape=shape, duration=duration)
        O.engines = quiet_engines(train, model=model)
        O.run(int(1 / O.dt), True)
        seen.append(list(train.pulseTimes))
        assert len(dem.impacts()) == len(train.pulseTimes) - 1, model
    assert [len(times) for times in seen] == 3 * [len(seen[0])] and len(seen[0]) >= 2, seen
    print(f"resonant {shape} pulses of {duration} s at", *seen)
    assert np.allclose(seen[1], seen[0], rtol=3e-3, atol=0) and np.allclose(seen[2], seen[1], rtol=1e-3, atol=0), seen


@pytest.mark.parametrize("shape, keeps, slenderness", (
    ("rectangular", "amplitude", 5), ("half-sine", "amplitude", 5), ("rectangular", "duration", 10),
))
def test_finite_resonant_trains(shape, keeps, slenderness):
    """Finite resonant trains against the exact history of the same train; the paper's own pulse (0.25 g for 0.1 s) lifts the block at once."""
    base, id, block = one_block(slenderness, restitution=0.6)
    train = dem.PulseTrainEngine(ids=[base], impulse=IMPULSE, resonantBlock=id, halfCycles=6, shape=shape, duration=0.1, singleKeeps=keeps)
    O.engines = quiet_engines(train, model="planar")
    exact = masonry.simulate(block, masonry.PulseTrain(IMPULSE, half_cycles=6, shape=shape, duration=0.1, single_keeps=keeps), restitution=0.6, half_cycles=6)
    impacts = run_impacts(6, 1.05 * exact.impact_times[-1])
    error = np.max(np.abs(impacts["time"][:6] / exact.impact_times - 1)), np.max(np.abs(impacts["velocity"][:6] / np.abs(exact.impact_velocities) - 1))
    print(f"resonant {shape} pulses that keep their {keeps}: times {error[0]:.1e}, velocities {error[1]:.1e}")
    assert max(error) <= 1e-3
