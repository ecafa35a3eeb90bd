"""What a history says of its run (WallHistory.about) is what the scene has, for every model, and is kept in files; the report has it in words."""

import math

import pytest
from masonry import dem, results
from rocking_scene import quiet_engines
from yade import O

import masonry


def close(a, b):
    return abs(a - b) <= 1e-12 * abs(b)


RECORD = masonry.artificial_record(seed=11, peak=1.0, duration=0.5)


@pytest.mark.parametrize("model", ("planar", "spatial", "compliant"))
def test_every_model(model, tmp_path):
    stone = dem.BlockMat(density=2100, frictionAngle=math.atan(0.6), restitution=0.5)
    base = dem.base((4, 1, 0.2), dem.BlockMat(density=2100, frictionAngle=0.7))
    pier = dem.stack(3, (0.6, 0.5, 0.5), stone, on=base)
    motion = dem.record_motion(RECORD, ids=[base])
    recorder = dem.WallRecorder(virtPeriod=0.01)
    O.engines = quiet_engines(motion, model=model, recorder=recorder)
    dem.run(until=motion)
    history = dem.wall_history(recorder)
    about = history.about
    assert about["script"] == "run_pytest.py" and about["versions"]["masonry"] == masonry._build.VERSION, about
    assert about["model"]["model"] == model and close(about["model"]["dt"], O.dt) and about["model"]["steps"] == O.iter
    assert about["model"]["gravity"] == [0, 0, -9.81]
    floor, blocks = about["materials"]
    assert floor["ids"] == [base] and floor["restitution"] is None and blocks["ids"] == pier and close(blocks["restitution"], 0.5)
    assert close(blocks["density"], 2100) and close(math.tan(blocks["frictionAngle"]), 0.6)
    moved, = about["motions"]
    assert moved["record"] == RECORD.name == "artificial, seed 11" and close(moved["peak"], 1) and moved["ids"] == [base] and close(moved["end"], 0.5)
    engine = next(e for e in O.engines if hasattr(e, "worstResidual"))
    assert about["solver"]["worstResidual"] == engine.worstResidual and about["solver"]["failures"] == engine.failures
    assert history.impacts.tobytes() == dem.impacts().tobytes()
    path = tmp_path / "wall.npz"
    history.save(path)
    assert results.WallHistory.load(path).about == about
    results.report(results.WallHistory.load(path), tmp_path / "wall.html")
    text = (tmp_path / "wall.html").read_text(encoding="utf-8")
    for said in (f"{model}", "artificial, seed 11", "restitution 0.5", "density 2100 kg/m^3", "All 0.5 s of the motion have been run"):
        assert said in text


def test_notes_of_the_last_call():
    """What dem.engines() prints on what may not be meant is among the warnings, and only of the last call."""
    stone = dem.BlockMat(density=2, frictionAngle=0.6)
    base = dem.base((4, 1, 0.2), stone)
    dem.block((0.6, 0.5, 1.0), stone, on=base)
    recorder = dem.WallRecorder(virtPeriod=0.01)
    for _ in range(2):
        O.engines = quiet_engines(None, model="planar", recorder=recorder)
    dem.run(0.05)
    assert dem.wall_history(recorder).about["notes"] == ["a density is 2: densities are in kg/m^3"]
