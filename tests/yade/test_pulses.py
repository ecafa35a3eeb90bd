"""Base motions: a block that rocks under pulses and records, and the base that carries it."""

import math

import numpy as np
from masonry import dem
from rocking_scene import Balance, Samples, one_block, quiet_engines, run_impacts
from yade import O

import masonry

impulse = 0.0125 * 9.81  # m/s: the paper's 2I = 0.025 g s


def resonant():
    """Velocities of Eq. 7, which Dirac pulses make exact; times and base displacement of the rigid block; a base that ends at rest."""
    n = 20
    base, id, block = one_block(5, restitution=0.7)
    train = dem.PulseTrainEngine(ids=[base], impulse=impulse, resonantBlock=id, halfCycles=n)
    O.engines = quiet_engines(train, penetration=1e-6)
    balance = Balance()
    exact = masonry.simulate(block, masonry.PulseTrain(impulse, half_cycles=n), restitution=0.7, half_cycles=n)
    impacts = run_impacts(n, 1.05 * exact.impact_times[-1])
    wanted = masonry.closed_form.pulse_sequence(block, impulse, 0.7, n).angular_velocity
    # Eq. 7 is the speed after each pulse, which energy brings back at the end of the half cycle.
    assert np.max(np.abs(impacts["velocity"][:n] / wanted - 1)) <= 1e-3
    assert np.max(np.abs(impacts["time"][:n] / exact.impact_times - 1)) <= 1e-3
    assert np.array_equal(train.pulseJumps, impulse * np.array([1] + [2 * (-1) ** k for k in range(1, n)] + [1]))
    assert train.pulseTimes == [0.0] + list(impacts["time"][:n])
    O.step()
    rest = O.bodies[base].state.pos
    assert O.bodies[base].state.vel.norm() == 0  # sums of I, -2I, 2I, ... I: exact in binary
    # Displacement is the sum of velocity times interval: it inherits the error of the times.
    assert abs(rest[0] - train.residualDisplacement) < 1e-12
    assert abs(rest[0] / exact.base_displacement - 1) <= 1e-3, (rest, exact.base_displacement)
    O.run(1000, True)
    assert (O.bodies[base].state.pos - rest).norm() < 1e-13  # round-off of a sum of 20 terms I t
    assert abs(balance.error()) <= 1e-4 * dem.energy()["baseWork"]
    print("resonant:", np.max(np.abs(impacts["velocity"][:n] / wanted - 1)), balance.error() / dem.energy()["baseWork"])


def compare(name, make, motion, t_end, bound, penetration=1e-6, slenderness=5, restitution=0.7):
    """The block's angle and the base's displacement at every tenth step against the exact history of the same motion."""
    base, id, block = one_block(slenderness, restitution=restitution)
    engine = make([base])
    O.engines = quiet_engines(engine, penetration=penetration)
    seen = Samples(lambda: (dem.angle(id), O.bodies[base].state.pos[0]), 10)
    balance = Balance()
    O.run(int(t_end / O.dt), True)
    angles, displacements = np.array(seen.values).T
    exact = masonry.simulate(block, motion, restitution=restitution, t_end=1.01 * t_end)
    wanted, _ = exact.sample(np.array(seen.times))
    error = np.max(np.abs(angles - wanted)) / np.max(np.abs(wanted))
    moved = motion.displacement(np.array(seen.times))
    drift = np.max(np.abs(displacements - moved)) / np.max(np.abs(moved))
    print(f"{name}: {len(exact.impact_times)} impacts, angle {error:.1e}, base {drift:.1e}, energy {balance.error() / dem.energy()['baseWork']:.1e}")
    assert np.max(np.abs(wanted)) > 0.02 * block.critical_angle and len(exact.impact_times) >= 2  # it does rock
    assert error <= bound, (name, error)
    # Position is origin + displacement(t) at every step: no sum, no drift; round-off of coordinates of a few metres.
    assert drift <= 1e-9, (name, drift)
    assert abs(balance.error()) <= 1e-4 * dem.energy()["baseWork"], (name, balance.error())
    return engine, base


resonant()
# Each pulse drives the block away from rest. One that drives it back pulls at the pivot: the exact history, which has a hinge
# there, and a block that may part from it, then rightly differ.
times = [0.0, 0.15, 0.5]
for assembly in (False, True):
    train, base = compare("schedule", lambda ids: dem.PulseTrainEngine(ids=ids, impulse=impulse, times=times, assembly=assembly),
                          masonry.PulseTrain(impulse, times=times, assembly=assembly), 2.0, 1e-3)
    assert train.pulseTimes == times
    assert train.pulseJumps == [impulse, -2 * impulse, impulse if assembly else 2 * impulse]
    assert O.bodies[base].state.vel[0] == sum(train.pulseJumps)
# Until it lifts, the block sways on its springs: by the elastic angle 2 penetration = 2e-6 rad, at the frequency
# sqrt(g b^2 / (4 d R^2)) = 400 rad/s, d = 6e-7 m, so with 8e-4 rad/s of the 6e-2 rad/s that the pulse gives it.
duration, bound = 0.06, 8e-4 / 6e-2
for shape in ("rectangular", "half-sine"):
    compare(shape, lambda ids: dem.PulseTrainEngine(ids=ids, impulse=2 * impulse, times=times, shape=shape, duration=duration),
            masonry.PulseTrain(2 * impulse, times=times, shape=shape, duration=duration), 1.0, bound)
t = np.arange(0, 3, 0.01)
record = 3.5 * np.sin(2 * math.pi * 1.1 * t) * np.sin(math.pi * t / 3) ** 2
compare("record", lambda ids: dem.RecordMotionEngine(ids=ids, samples=list(record), interval=0.01), masonry.Record(0.01, record), 4.0, 1e-3)
