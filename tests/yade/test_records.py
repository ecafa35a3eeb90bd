"""Displacements and velocities as base motion: where the base is, how a block rocks on it, and what of it a saved run keeps."""

import contextlib
import io

import numpy as np
import pytest
from masonry import dem
from rocking_scene import Samples, one_block, refuses, rigid_engines
from yade import O

import masonry

INTERVAL, END = 0.01, 3.0
T = np.linspace(0, END, round(END / INTERVAL) + 1)


def displacement(t):
    """m; at rest at both ends, the last 0.03 m from the first."""
    return np.sin(np.pi * t / END) ** 4 * 0.06 * np.sin(7 * t) + 0.03 * (t / END - np.sin(2 * np.pi * t / END) / (2 * np.pi))


def run(make, **options):
    """(displacement at every step, at the times of the steps; angle there) of a base that starts at 0.5 s, and base and engine."""
    base, id, block = one_block(5, restitution=0.8)
    engine = make(base)
    O.engines = rigid_engines(engine, dt=1e-3, **options)
    seen = Samples(lambda: (O.bodies[base].state.displ()[0], dem.angle(id)), 1)
    O.run(round((END + 0.7) / O.dt), True)
    moved, angles = np.array(seen.values).T
    return np.array(seen.times) - 0.5, moved, angles, block, O.bodies[base].state, engine


ROUNDED = np.round(displacement(T), 4)
RECORD = masonry.Record(INTERVAL, displacement=ROUNDED, unit="m")
SPEEDS = 0.2 * np.sin(2 * np.pi * T / END) ** 2  # m/s


def test_a_base_moves_as_the_record_says():
    times, moved, angles, block, base, engine = run(lambda base: dem.record_motion(RECORD, ids=[base], start=0.5))
    inside = (times >= 0) & (times <= END)
    # The engine puts the base where the motion is: round-off of coordinates of a metre.
    assert np.abs(moved[inside] - RECORD.displacement(times[inside])).max() < 1e-13
    # At the samples the smooth motion differs from the rounded ones by at most one unit of their last digit, and so it does from the exact displacement.
    at = np.abs(times[:, None] - T[None, 1:-1]).argmin(axis=0)
    assert np.abs(times[at] - T[1:-1]).max() < 1e-9
    off = np.abs(moved[at] - ROUNDED[1:-1]).max(), np.abs(moved[inside] - displacement(times[inside])).max()
    print(f"base off the samples by {off[0]:.1e} m, off the exact displacement by {off[1]:.1e} m, at the end by {moved[-1] - ROUNDED[-1]:.1e} m")
    assert max(off) <= 1e-4
    # It ends at the last sample and stays there: 3000 steps of the sum of accelerations, in double precision.
    assert abs(moved[-1] - ROUNDED[-1]) < 1e-12 and base.vel.norm() < 1e-12
    # As exact as under any record (test_rigid_motion.py).
    exact = masonry.simulate(block, RECORD, restitution=0.8, t_end=END + 1)
    wanted = exact.sample(np.maximum(times, 0))[0]
    error = np.abs(angles - wanted).max() / np.abs(wanted).max()
    print(f"{len(exact.impact_times)} impacts, angle {error:.1e} of {np.abs(wanted).max():.3f} rad")
    assert len(exact.impact_times) >= 3 and error < 1e-4


def test_the_constructor_takes_any_unit():
    """The constructor takes them, in any unit."""
    wanted = RECORD.samples.tolist()
    for factor, unit in ((1, "m"), (1000, "mm")):
        made = dem.RecordMotionEngine(ids=[0], displacement=(factor * ROUNDED).tolist(), interval=INTERVAL, unit=unit)
        assert np.abs(np.array(made.samples) - wanted).max() < 1e-6 and made.baseline == "none"
    times, moved, *_, base, _ = run(lambda base: dem.RecordMotionEngine(ids=[base], velocity=SPEEDS, interval=INTERVAL, unit="m/s", start=0.5))
    # The integral of the velocity, 0.1 m/s over 3 s; its quadratic spline has an error of third order, 1e-6 of it at 300 samples.
    assert abs(moved[-1] - 0.3) < 3e-7 and base.vel.norm() < 1e-12
    plain = dem.RecordMotionEngine(ids=[0], samples=[0.0, 0.5, 0.0], unit="g")
    assert plain.samples[1] == 0.5 * 9.80665


@pytest.mark.parametrize("options, words", (
    (dict(displacement=[0.0, 1.0]), "displacement has 2 samples: must be at least 8"),
    (dict(displacement=ROUNDED, unit="g"), "unit = 'g': must be one of m, cm, mm"),
    (dict(displacement=ROUNDED, baseline="constant"), "baseline = 'constant': must be 'none' for a displacement"),
    (dict(velocity=SPEEDS, samples=[1.0, 2.0]), "acceleration and velocity of acceleration, velocity and displacement is given"),
    (dict(velocity=SPEEDS + 1), "velocity[0] = 1: must be 0"),
    (dict(unit="g"), "unit = 'g': must come with samples, velocity or displacement"),
))
def test_what_is_refused(options, words):
    """It names what it does not take."""
    refuses(lambda: dem.RecordMotionEngine(ids=[0], **options), words)
    refuses(lambda: dem.RecordMotionEngine(ids=[0], sample=[0.0, 0.5], unit="g"), "has no `sample`; did you mean `samples`", kind=AttributeError)


@pytest.mark.parametrize("make", (
    lambda: dem.RecordMotionEngine(ids=[0], displacement=ROUNDED[:150]), lambda: dem.record_motion(masonry.Record(INTERVAL, displacement=ROUNDED[:150]), ids=[0]),
))
def test_a_motion_that_is_cut_off_is_named_once(make):
    """A motion that is cut off while it is under way is named, once."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        make()
    assert said.getvalue().startswith("masonry.dem: The record of a displacement does not begin or end at rest")
    assert said.getvalue().count("\n") == 1


def test_filtered_records():
    """They are given as they are filtered; their padding is part of the motion."""
    filtered = masonry.Record(INTERVAL, np.sin(7 * T) + 0.2, baseline="high-pass", corner=0.5)
    engine = dem.record_motion(filtered, ids=[0])
    assert engine.baseline == "none" and engine.samples == filtered.samples.tolist() and engine.end == filtered.duration


def test_a_saved_run_goes_on_with_the_same_bits(tmp_path):
    path = str(tmp_path / "scene.yade.gz")
    times, moved, *_ = run(lambda base: dem.record_motion(RECORD, ids=[base], start=0.5))
    O.save(path)
    end = O.time
    O.run(100, True)
    kept = [tuple(b.state.pos) for b in O.bodies]
    O.load(path)
    assert O.time == end
    O.run(100, True)
    assert [tuple(b.state.pos) for b in O.bodies] == kept


def lifted(samples, interval, model, blocks=1, share=1):
    """The largest error of the angle of a block, in one piece or cut in two, until it has landed and risen again, relative to its largest angle."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.73, noSlip=True)
    base = dem.base((6, 3, 0.2), stone)
    ids = dem.stack(blocks, (0.3, 0.5, 1.5 / blocks), stone, on=base) if blocks > 1 else [dem.block((0.3, 0.5, 1.5), stone, on=base)]
    record = masonry.Record(interval, samples, unit="m/s^2")
    with contextlib.redirect_stdout(io.StringIO()):
        O.engines = dem.engines(dem.record_motion(record, ids=[base]), model=model, method="localised")
    O.dt /= share
    exact = masonry.simulate(masonry.RockingBlock(0.15, 0.75), record, t_end=3)
    worst = peak = 0
    while O.time < 0.29:
        O.step()
        wanted = exact.sample(O.time)[0]
        worst, peak = max(worst, abs(dem.angle(ids[0]) - wanted)), max(peak, abs(wanted))
    return worst / peak


@pytest.mark.parametrize("model, blocks", (("planar", 1), ("spatial", 1), ("planar", 2)))
@pytest.mark.parametrize("interval, after", ((1e-4, 2), (1e-4, 57), (2.5e-4, 2), (2.5e-4, 57), (1e-3, 2), (1e-3, 57), (2e-3, 2), (1e-2, 2)))
def test_a_block_lifts_at_the_instant_within_the_step(interval, model, blocks, after):
    """A square pulse whose samples are finer or coarser than the step (0.7 ms), against the exact history. Bounds: the error of a step under a smooth
    motion, of second order; at half the step a quarter, twice that where the two steps meet the jumps otherwise."""
    samples = np.zeros(after + round(0.1 / interval) + 40)
    samples[after : after + round(0.1 / interval)] = 3.5
    errors = [lifted(samples, interval, model, blocks, share) for share in (1, 2, 4)]
    print(interval, model, blocks, after, ["%.1e" % e for e in errors])
    assert errors[0] < 3e-5 and errors[1] < 1e-5 and errors[2] < 3e-6
