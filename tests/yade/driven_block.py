"""What the tests of base motions share: one block whose base moves, against the exact history of the same motion."""

import math

import numpy as np
from masonry import dem
from rocking_scene import Balance, Samples, one_block, refuses_to_run
from yade import O

import masonry

IMPULSE = 0.0125 * 9.81  # m/s: the paper's 2I = 0.025 g s
_T = np.arange(0, 3, 0.01)
RECORD = 3.5 * np.sin(2 * math.pi * 1.1 * _T) * np.sin(math.pi * _T / 3) ** 2  # m/s^2, every 0.01 s


def compare(name, engines, make, motion, t_end, bound):
    """The block's angle and the base's displacement at every tenth step; engines(motion engine) are those of the run. Returns motion engine
    and base."""
    base, id, block = one_block(5, restitution=0.7)
    engine = make([base])
    O.engines = engines(engine)
    seen = Samples(lambda: (dem.angle(id), O.bodies[base].state.pos[0]), 10)
    balance = Balance()
    O.run(int(t_end / O.dt), True)
    angles, displacements = np.array(seen.values).T
    exact = masonry.simulate(block, motion, restitution=0.7, t_end=1.01 * t_end)
    wanted, _ = exact.sample(np.array(seen.times))
    error = np.max(np.abs(angles - wanted)) / np.max(np.abs(wanted))
    moved = motion.displacement(np.array(seen.times))
    # At the end of the step into which a Dirac pulse falls the base is where its old velocity has carried it, for that one step.
    falls = [any(0 <= time - pulse < O.dt for pulse in getattr(engine, "pulseTimes", ())) for time in seen.times]
    drift = np.max(np.abs(displacements - moved)[~np.array(falls)]) / np.max(np.abs(moved))
    print(f"{name}: {len(exact.impact_times)} impacts, angle {error:.1e}, base {drift:.1e}, energy {balance.error() / dem.energy()['baseWork']:.1e}")
    assert np.max(np.abs(wanted)) > 0.02 * block.critical_angle and len(exact.impact_times) >= 2  # it does rock
    assert error <= bound, (name, error)
    # Position is origin + displacement(t) at every step: no sum, no drift; round-off of coordinates of a few metres.
    assert drift <= 1e-12, (name, drift)
    assert abs(balance.error()) <= 1e-4 * dem.energy()["baseWork"], (name, balance.error())
    return engine, base


def compare_schedules(engines, times, bound):
    """Dirac pulses, each of which is to drive the block away from rest: one that drives it back pulls at the pivot, and the exact history,
    which has a hinge there, and a block that may part from it rightly differ."""
    for assembly in (False, True):
        train, base = compare("schedule", engines, lambda ids: dem.PulseTrainEngine(ids=ids, impulse=IMPULSE, times=times, assembly=assembly),
                              masonry.PulseTrain(IMPULSE, times=times, assembly=assembly), 2.0, bound)
        assert train.pulseTimes == times
        assert train.pulseJumps == [IMPULSE, -2 * IMPULSE, IMPULSE if assembly else 2 * IMPULSE]
        assert O.bodies[base].state.vel[0] == sum(train.pulseJumps)


def compare_shapes(engines, times, bound, rectangular=None):
    """Pulses of finite duration; rectangular ones with a bound of their own, if given."""
    for shape, least in (("rectangular", rectangular or bound), ("half-sine", bound)):
        compare(shape, engines, lambda ids: dem.PulseTrainEngine(ids=ids, impulse=2 * IMPULSE, times=times, shape=shape, duration=0.06, singleKeeps="duration"),
                masonry.PulseTrain(2 * IMPULSE, times=times, shape=shape, duration=0.06, single_keeps="duration"), 1.0, least)


def compare_record(engines, bound):
    """With a scale and a baseline of its own, which the engine must take over."""
    record = masonry.Record(0.01, RECORD / 2, baseline="constant").scaled(2)
    compare("record", engines, lambda ids: dem.record_motion(record, ids), record, 4.0, bound)


def keep_place(engines):
    """A base that has begun to move is not put back: neither where the scene's time starts anew, nor by a motion that was left out for a while."""
    base, _, _ = one_block(2)
    O.engines = engines(dem.RecordMotionEngine(ids=[base], samples=[1.0] * 201, interval=0.01))
    steps, state = round(0.05 / O.dt), O.bodies[base].state
    O.run(steps, True)
    at = state.pos[0]
    assert abs(at - O.time**2 / 2) < 1e-9
    O.resetTime()
    O.run(steps, True)
    assert abs(state.pos[0] - at - O.time**2 / 2) < 1e-9
    kept = O.engines
    O.engines = [e for e in kept if type(e).__name__ not in ("RecordMotionEngine", "MoreauJeanIntegrator")]
    O.run(10, True)
    O.engines = kept
    refuses_to_run("RecordMotionEngine.start = 0 s has passed", "start=O.time")
    # Nor is one missed that is no longer there.
    base, _, _ = one_block(2)
    O.engines = engines(dem.RecordMotionEngine(ids=[base], samples=[1.0] * 201, interval=0.01))
    O.run(5, True)
    O.bodies.erase(base)
    refuses_to_run(f"RecordMotionEngine.ids has {base}", "no such body")
