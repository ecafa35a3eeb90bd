"""BlockRecorder: what it keeps is what the exact block does, and it outlives saving and loading."""

import numpy as np
import pytest
from masonry import dem
from rocking_scene import one_block, quiet_engines, refuses, rigid_engines, stone
from scipy.integrate import trapezoid
from yade import O

import masonry


def rocked():
    """A block that rocks for 20000 steps: (id, theory, angle at the start, recorder)."""
    base, block, theory = one_block(5, restitution=0.9)
    tilt = 0.5 * theory.critical_angle
    dem.tilt(block, tilt)
    recorder = dem.BlockRecorder(ids=[block], iterPeriod=25)
    O.engines = quiet_engines(recorder=recorder)
    O.run(20000, True)
    return block, theory, tilt, recorder


def test_a_block_that_rocks():
    block, theory, tilt, recorder = rocked()
    table = dem.history(recorder)
    assert len(table) >= 799 and np.all(np.diff(table["time"]) > 0)
    angle = table["rotation"][:, 0, 1]
    exact = masonry.simulate(theory, restitution=0.9, initial_angle=tilt, t_end=table["time"][-1])
    # Elastic angle 2e-5 rad = 1e-4 of the critical angle, and time errors of as much of a half cycle.
    assert np.max(np.abs(angle - exact.sample(table["time"])[0])) < 3e-4 * theory.critical_angle
    # A block that rocks without sliding: the far edge is up by 2b sin(angle), up to the compression of 1.2e-5 m.
    assert np.max(np.abs(table["uplift"][:, 0] - 0.6 * np.sin(np.abs(angle)))) < 2e-5
    # Newton's law, averaged: the mean force carries the weight but for the change of momentum.
    weight = O.bodies[block].state.mass * 9.81
    velocity = np.gradient(table["position"][:, 0, 2], table["time"])
    mean = trapezoid(table["force"][:, 0, 2], table["time"]) / (table["time"][-1] - table["time"][0])
    # Each impact turns the centre of the block from down (b w) to up (b C w).
    impulses = sum(im["velocity"] * (1 + im["restitution"]) for im in dem.impacts()) * theory.half_width * O.bodies[block].state.mass
    change = O.bodies[block].state.mass * (velocity[-2] - velocity[1])
    expected = weight + (change - impulses) / (table["time"][-1] - table["time"][0])  # impulses are not among the recorded forces
    assert abs(mean / expected - 1) < 2e-3  # trapezoidal rule across seven impacts, 4e-3 s apart in 3 s


def test_files(tmp_path):
    block, _, _, recorder = rocked()
    table, npz, csv, scene = dem.history(recorder), str(tmp_path / "h.npz"), str(tmp_path / "h.csv"), str(tmp_path / "scene.xml")
    dem.save_history(recorder, npz)
    assert np.array_equal(np.load(npz)["rotation"], table["rotation"])
    dem.save_history(recorder, csv)
    read = np.genfromtxt(csv, delimiter=",", names=True)
    assert np.allclose(read[f"rotation_y_of_{block}_rad"], table["rotation"][:, 0, 1], rtol=0, atol=1e-15)
    O.save(scene)
    O.load(scene)
    loaded, = (e for e in O.engines if isinstance(e, dem.BlockRecorder))
    assert np.array_equal(dem.history(loaded), table)
    refuses(lambda: dem.save_history(loaded, "h.txt"), "h.txt")


def test_a_wall_with_head_joints():
    """With head joints of 1 mm, a block stands on what is below it, not on what is beside it."""
    base = dem.base((4, 1, 0.2), stone())
    ids = dem.wall(courses=2, per_course=4, size=(0.4, 0.2, 0.2), material=O.bodies[base].mat, on=base, gap=0.001)
    recorder = dem.BlockRecorder(ids=ids, iterPeriod=10)
    O.engines = rigid_engines(recorder=recorder)
    O.run(100, True)
    last = dem.history(recorder)[-1]
    assert np.max(np.abs(last["uplift"])) < 1e-12
    weights = np.array([O.bodies[id].state.mass * 9.81 for id in ids])
    lower = [O.bodies[id].state.pos[2] < 0.2 for id in ids]
    assert abs(last["force"][lower, 2].sum() / weights.sum() - 1) < 1e-6 and np.all(np.abs(last["force"][~np.array(lower), 2] / weights[~np.array(lower)] - 1) < 1e-6)


def test_several_blocks(tmp_path):
    """Each has its own columns in a file."""
    base = dem.base((8, 2, 0.3), stone())
    ids = [dem.block((0.6, 1, height), O.bodies[base].mat, center=(x, 0, height / 2)) for x, height in ((-2, 3), (2, 2))]
    for id, angle in zip(ids, (0.05, -0.08)):
        dem.tilt(id, angle)
    recorder = dem.BlockRecorder(ids=ids, iterPeriod=5)
    O.engines = rigid_engines(recorder=recorder)
    O.run(100, True)
    table = dem.history(recorder)
    dem.save_history(recorder, path := str(tmp_path / "two.csv"))
    read = np.genfromtxt(path, delimiter=",", names=True)
    for k, id in enumerate(ids):
        for name, unit in (("rotation", "rad"), ("position", "m"), ("force", "N")):
            for axis, letter in enumerate("xyz"):
                assert np.array_equal(read[f"{name}_{letter}_of_{id}_{unit}"], table[name][:, k, axis]), (name, letter, id)
        assert np.array_equal(read[f"uplift_of_{id}_m"], table["uplift"][:, k]), id


def test_samples_are_a_period_apart():
    """Samples are a period apart, though O.time is a sum of steps."""
    base, block, _ = one_block(5)
    recorders = [dem.BlockRecorder(ids=[block], virtPeriod=0.01), dem.WallRecorder(virtPeriod=0.01)]
    O.engines = rigid_engines(recorder=recorders, dt=1e-3)
    O.run(3000, True)
    for times in (dem.history(recorders[0])["time"], dem.wall_history(recorders[1]).time):
        assert len(times) >= 299 and np.allclose(np.diff(times), 0.01, rtol=0, atol=1e-9), np.diff(times).max()


@pytest.mark.parametrize("model", ("planar", "compliant"))
def test_an_erased_block(model):
    """It has NaN from then on, and what was recorded stays; blocks are fixed by the first sample, and a recorder is of one run."""
    base = dem.base((4, 1, 0.2), stone())
    first, second = (dem.block((0.4, 0.4, 0.4), O.bodies[base].mat, center=(x, 0, 0.2)) for x in (-1, 1))
    recorder = dem.BlockRecorder(ids=[first, second], iterPeriod=1)
    wall = dem.WallRecorder(iterPeriod=1)
    O.engines = quiet_engines(model=model, recorder=[recorder, wall])
    O.run(5, True)
    before = len(recorder.times)
    O.bodies.erase(first)
    O.run(5, True)
    table = dem.history(recorder)["position"]
    assert len(table) == before + 5 > 5 and np.isfinite(table[:before]).all() and np.isnan(table[before:, 0]).all() and np.isfinite(table[before:, 1]).all()
    recorder.ids = [second]
    refuses(O.step, "BlockRecorder.ids has been changed after the first sample", kind=(RuntimeError, ValueError))
    O.reset()
    dem.block((0.4, 0.4, 0.4), stone(), on=dem.base((4, 1, 0.2), stone()))
    for old in (recorder, wall):
        refuses(lambda: quiet_engines(model=model, recorder=old), f"{type(old).__name__}.times ends at", "make a new")


def test_a_body_in_the_place_of_an_erased_one(tmp_path):
    """It is not recorded for it."""
    base = dem.base((4, 1, 0.2), stone())
    block = dem.block((0.4, 0.4, 0.4), O.bodies[base].mat, on=base)
    wall, few = dem.WallRecorder(iterPeriod=1), dem.BlockRecorder(iterPeriod=1, ids=[base, block])
    O.engines = quiet_engines(model="planar", recorder=[wall, few])
    O.run(2, True)
    other = dem.block((0.4, 0.4, 0.4), O.bodies[base].mat, center=(1, 0, 0.2))  # as large
    taken, replaced = O.bodies[other], O.time - O.dt / 2
    O.bodies.erase(other)
    O.bodies.erase(block)
    O.bodies.insertAtId(taken, block)
    O.run(2, True)
    path = str(tmp_path / "scene.yade.gz")
    O.save(path)
    O.load(path)
    O.run(2, True)
    wall, few = (next(e for e in O.engines if type(e) is kind) for kind in (dem.WallRecorder, dem.BlockRecorder))
    for times, positions in ((dem.wall_history(wall).time, dem.wall_history(wall).position), (dem.history(few)["time"], dem.history(few)["position"])):
        before = times < replaced
        assert before.sum() > 0 and (~before).sum() == 4 and np.isfinite(positions[before]).all()
        assert np.isnan(positions[~before, 1]).all() and np.isfinite(positions[:, 0]).all()
