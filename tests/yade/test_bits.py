"""The same bits: in one run or two, through files and memory, with one thread or two; bodies that leave, objects that are copied."""

import copy
import pickle
from pathlib import Path
import subprocess

import numpy as np
import pytest
from masonry import dem
from rocking_scene import bits, one_block, quiet_engines, stone
from wall_hash import wall_hash
from yade import O


def pulsed():
    base, block, _ = one_block(5, restitution=0.7)
    O.engines = quiet_engines(dem.PulseTrainEngine(ids=[base], impulse=0.12, resonantBlock=block, halfCycles=6))


def run_to(step):
    O.run(step - O.iter, True)


@pytest.fixture(scope="module")
def whole():
    """A run in one piece: its second impact, steps right before, at and after it and in the middle of a half cycle, and the bits 5000 steps later."""
    pulsed()
    while len(dem.impacts()) < 2:
        O.step()
    impact = O.iter
    run_to(impact + 5000)
    assert len(dem.impacts()) >= 3
    return impact, (impact - 1, impact, impact + 1, impact + 700), bits()


def test_runs_in_pieces(whole):
    impact, stops, wanted = whole
    pulsed()
    for stop in stops:
        run_to(stop)
    run_to(impact + 5000)
    assert np.array_equal(bits(), wanted)


@pytest.mark.parametrize("ending", ("xml", "yade", "memory"))
def test_saved_and_loaded(ending, whole, tmp_path):
    impact, stops, wanted = whole
    path = str(tmp_path / f"scene.{ending}")
    for stop in stops:
        pulsed()
        run_to(stop)
        if ending == "memory":
            O.saveTmp()
            O.reset()
            O.loadTmp()
        else:
            O.save(path)
            O.reset()
            O.load(path)
        run_to(impact + 5000)
        assert np.array_equal(bits(), wanted), stop - impact


def critical_step():
    return next(e for e in O.engines if isinstance(e, dem.RockingJointEngine)).criticalTimeStep()


def test_the_critical_time_step_is_known_after_loading(whole):
    impact, _, _ = whole
    pulsed()
    run_to(impact)
    known = critical_step()
    O.saveTmp()
    O.loadTmp()
    assert np.isclose(critical_step(), known, rtol=1e-6)


def test_any_number_of_threads():
    """Here, after other scenes, one; there two."""
    own = wall_hash()
    script = Path(__file__).with_name("wall_hash.py")
    output = subprocess.run(["yade", "-j2", "-n", "-x", str(script)], capture_output=True, text=True, timeout=200).stdout
    assert f"hash {own}" in output, output[-300:]


def rocking(*places):
    """Ids of blocks that rock beside each other."""
    O.reset()
    material = stone(0.7)
    dem.base((6, 1, 0.2), material)
    ids = [dem.block((0.3, 0.3, 0.9), material, center=(x, 0, 0.45)) for x in places]
    for id in ids:
        dem.tilt(id, 0.2)
    O.engines = quiet_engines()
    return ids


def test_a_block_is_taken_away_while_it_rocks():
    """It leaves the others as if it had never been there (but for the order of sums)."""
    left, right = rocking(-1, 1)
    O.run(1000, True)
    O.bodies.erase(right)
    O.run(5000, True)
    alone = tuple(O.bodies[left].state.pos)
    assert all(right not in (i.id1, i.id2) for i in O.interactions if i.isReal)
    left, = rocking(-1)
    O.run(6000, True)
    assert np.allclose(O.bodies[left].state.pos, alone, rtol=0, atol=1e-10)


def test_what_a_scene_holds_is_copied_and_pickled():
    rocking(-1)
    O.run(6000, True)
    for thing in (*O.engines, *(i.phys for i in O.interactions), *(i.geom for i in O.interactions)):
        for twin in (copy.deepcopy(thing), pickle.loads(pickle.dumps(thing))):
            for name, value in thing.dict().items():
                if isinstance(value, (int, float, str)) or (isinstance(value, list) and value and isinstance(value[0], (int, float))):
                    assert np.array_equal(getattr(twin, name), value, equal_nan=not isinstance(value, str)), type(thing).__name__
