"""Rigid blocks on a base that moves: resonant and scheduled pulses, finite pulses, records, and a base with a velocity of its own."""

import numpy as np
from driven_block import IMPULSE, compare_record, compare_schedules, compare_shapes
from masonry import dem
from rocking_scene import Balance, Samples, one_block, rigid_engines
from yade import O

import masonry


def engines(motion, **options):
    return rigid_engines(motion, dt=1e-3, **options)


def resonant(model):
    """Eq. 7's velocities; times and base displacement of the exact history; a base that ends at rest."""
    n = 20
    base, id, block = one_block(5, restitution=0.7)
    train = dem.PulseTrainEngine(ids=[base], impulse=IMPULSE, resonantBlock=id, halfCycles=n)
    O.engines = engines(train, model=model)
    angles = Samples(lambda: dem.angle(id), 1)
    balance = Balance()
    exact = masonry.simulate(block, masonry.PulseTrain(IMPULSE, half_cycles=n), restitution=0.7, half_cycles=n)
    O.run(int(1.001 * exact.impact_times[-1] / O.dt), True)
    impacts = dem.impacts()
    wanted = masonry.closed_form.pulse_sequence(block, IMPULSE, 0.7, n).angular_velocity
    velocity = np.max(np.abs(impacts["velocity"][:n] / wanted - 1))
    times = np.max(np.abs(impacts["time"][:n] / exact.impact_times - 1))
    peaks = np.max(np.abs(angles.peaks()[:n] / np.abs(exact.peak_angles[:n]) - 1))
    print(f"resonant, {O.engines[1].chosenModel}: velocities {velocity:.1e}, times {times:.1e}, peaks {peaks:.1e}, energy {balance.error() / dem.energy()['baseWork']:.1e}")
    # Peaks as asked of the integrator. Late half cycles have nearly the same length: times inherit the error of the peaks.
    assert peaks <= 3e-6 and velocity <= 3e-6 and times <= 3e-6
    assert np.array_equal(train.pulseJumps, IMPULSE * np.array([1] + [2 * (-1) ** k for k in range(1, n)] + [1]))
    assert train.pulseTimes == [0.0] + list(impacts["time"][:n])
    rest = O.bodies[base].state.pos
    assert O.bodies[base].state.vel.norm() == 0  # sums of I, -2I, 2I, ... I: exact in binary
    assert abs(rest[0] / exact.base_displacement - 1) <= 3e-5  # a difference of displacements ten times as large
    O.run(100, True)
    assert (O.bodies[base].state.pos - rest).norm() < 1e-13  # round-off of a sum of 20 terms I t
    assert abs(balance.error()) <= 1e-5 * dem.energy()["baseWork"]


resonant("auto")
resonant("spatial")
TIMES = [0.0, 0.15037, 0.5]  # the second not at a step's end
compare_schedules(engines, TIMES, 1e-5)
compare_shapes(engines, TIMES, 1e-4)
compare_record(engines, 1e-4)

# A base that moves by itself carries its block along: nobody accelerates.
base, id, block = one_block(5)
for body in O.bodies:
    body.state.vel = (0.1, 0, 0)
O.engines = rigid_engines(dt=1e-3)
O.run(1000, True)
for body in O.bodies:
    assert abs(body.state.pos[0] - 0.1) < 1e-12 and abs(body.state.vel[0] - 0.1) < 1e-12, body.state.pos
