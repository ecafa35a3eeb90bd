"""Mass that moves with blocks and dead loads that do not: weights, momentum, energies, the tilting table in closed form, saving."""

import math

import numpy as np
import pytest
from masonry import dem, results
from rocking_scene import quiet_engines, refuses, said_by
from yade import O

import masonry

GRAVITY = 9.81
MODELS = ("planar", "spatial", "compliant")


def stone(**attributes):
    return dem.BlockMat(**{"density": 2000, "frictionAngle": math.atan(0.7), **attributes})


def rocking(density, more=0.0, **engines):
    """Angles of a block that rocks, and its energies at the end."""
    O.reset()
    block = dem.block((0.4, 0.5, 1.2), stone(density=density, restitution=0.8), on=dem.base((4, 2, 0.2), stone()))
    if more:
        dem.add_mass(block, more)
    dem.tilt(block, 0.1)
    O.engines = quiet_engines(**engines)
    angles = []
    for _ in range(40):
        dem.run(0.02)
        angles.append(dem.angle(block))
    return np.array(angles), dem.energy()


@pytest.mark.parametrize("engines", ({"model": "planar"}, {"model": "spatial", "method": "wall"}, {"model": "compliant", "penetration": 1e-4}))
def test_added_mass_makes_a_block_denser(engines):
    """A block of 480 kg with 240 kg more moves as one of 720 kg, with the same energies."""
    heavy, energy = rocking(3000, **engines)
    loaded, same = rocking(2000, more=240.0, **engines)
    assert np.abs(heavy).max() > 0.05 and np.abs(loaded - heavy).max() < 1e-7, np.abs(loaded - heavy).max()
    assert all(abs(energy[name] - same[name]) < 1e-6 * energy["potential"] for name in energy)


def test_mass_is_shared_by_area():
    base = dem.base((4, 2, 0.2), stone())
    small, large = dem.block((0.4, 0.5, 0.4), stone(), on=base, at=(-1, 0)), dem.block((0.8, 0.5, 0.2), stone(), on=base, at=(1, 0))
    before = [O.bodies[id].state.mass for id in (small, large)]
    inertia = np.array(O.bodies[small].state.inertia)
    assert np.allclose(dem.add_mass([small, large], 300), np.array(before) + [100, 200], rtol=1e-14)
    assert np.allclose(O.bodies[small].state.inertia, inertia * (1 + 100 / before[0]), rtol=1e-14)
    assert dem.loads.added_mass() == pytest.approx({small: 100, large: 200}, rel=1e-12)
    assert [dem.geometry(id).volume for id in (small, large)] == pytest.approx([0.08, 0.08], rel=1e-14)


def test_volume_of_loaded_convex_blocks():
    """A prism over a triangle and an L of two boxes have the volumes of their sections, whatever their mass."""
    prism = dem.prism([(0, 0), (0.8, 0), (0.3, 0.7)], 0.5, stone(), axis="y", center=(0, 0, 3))
    boxes = [[(x, y, z) for x in xs for y in (0, 0.4) for z in zs] for xs, zs in (((2, 3), (0, 0.2)), ((2, 2.3), (0.2, 1)))]
    union = dem.union(boxes, stone())
    dem.add_mass([prism, union], 700)
    assert [dem.geometry(id).volume for id in (prism, union)] == pytest.approx([0.28 * 0.5, (0.2 + 0.24) * 0.4], rel=1e-13)


def test_base_shear_over_the_weight_with_added_mass():
    """A block that stays on a base under a constant acceleration a has V/W = a/g, whatever is added to its mass."""
    base = dem.base((4, 2, 0.2), stone())
    block = dem.block((1.0, 1.0, 0.5), stone(), on=base)
    dem.add_mass(block, 1000.0)
    acceleration = 0.3 * GRAVITY
    motion = dem.RecordMotionEngine(ids=[base], samples=[0, *[acceleration] * 20, 0], interval=0.01, direction=(1, 0, 0), baseline="none")
    recorder = dem.WallRecorder(iterPeriod=5, recordForces=True)
    O.engines = quiet_engines(motion, recorder=recorder, model="planar")
    dem.run(0.15)
    history = dem.wall_history(recorder)
    assert history.about["masses"] == [{"mass": pytest.approx(2000, rel=1e-12), "ids": [block]}]
    assert abs(results.structure_history(history).numbers["the same over the weight (V/W along x)"] - 0.3) < 1e-3


@pytest.mark.parametrize("model", MODELS)
def test_reactions(model):
    """The base carries the weight, the added mass and the dead load; under a base that accelerates only what has mass asks for a force sideways."""
    base = dem.base((4, 1, 0.2), stone())
    ids = dem.stack(3, (0.6, 0.5, 0.4), stone(), on=base)
    dem.add_mass(ids[-1], 150.0)
    dem.dead_load(ids[-1:], 1200.0)
    mass, acceleration = sum(O.bodies[id].state.mass for id in ids), 0.8
    record = masonry.Record(0.01, acceleration * np.minimum(1, np.arange(101) / 50), unit="m/s^2")
    recorder = dem.WallRecorder(virtPeriod=0.05, recordForces=True)
    O.engines = quiet_engines(dem.record_motion(record, ids=[base]), model=model, recorder=recorder)
    dem.run(0.9)
    expected = np.array([mass * acceleration, 0, mass * GRAVITY + 1200.0])
    # Rigid: the tolerance of the solver; compliant: springs after half a second.
    assert np.abs(dem.reactions(base)["force"].sum(axis=0) - expected).max() < (2e-3 if model == "compliant" else 1e-7) * expected[2]
    assert np.abs(results.base_reactions(dem.wall_history(recorder))["force"][-1] - expected).max() < 4e-3 * expected[2]


@pytest.mark.parametrize("engines", ({"model": "planar"}, {"model": "planar", "method": "wall"}, {"model": "compliant"}))
def test_loads_that_come_during_a_run(engines):
    """The base carries them from then on; a load whose engine is dead is gone."""
    base = dem.base((4, 1, 0.2), stone())
    ids = dem.stack(2, (0.6, 0.5, 0.4), stone(), on=base)
    O.engines = quiet_engines(**engines)
    weight = GRAVITY * sum(O.bodies[id].state.mass for id in ids)

    def carried():
        dem.run(0.5 if engines["model"] == "compliant" else 0.1)
        return dem.reactions(base)["force"].sum(axis=0)[2]

    bound = 5e-3 * weight  # of 'wall' in forces, and springs that settle
    assert abs(carried() - weight) < bound
    dem.add_mass(ids[1], 100.0)
    assert abs(carried() - weight - 100 * GRAVITY) < bound
    (load,) = dem.dead_load(ids[1], 700.0)
    assert abs(carried() - weight - 100 * GRAVITY - 700) < bound
    load.dead = True
    assert abs(carried() - weight - 100 * GRAVITY) < bound and dem.loads.dead_loads() == {}


def test_a_dead_load_has_no_mass():
    """In free flight the acceleration is g + F/m, and kinetic and potential energy keep their sum."""
    dem.base((4, 1, 0.2), stone())
    block = dem.block((0.4, 0.4, 0.4), stone(), center=(0, 0, 10))
    (load,) = dem.dead_load(block, 256.0)
    O.engines = quiet_engines(model="spatial")
    assert load in O.engines and len(dem.loads.load_engines()) == 1
    dem.run(0.5)
    acceleration = GRAVITY + 256.0 / 128.0
    assert abs(O.bodies[block].state.vel[2] + acceleration * O.time) < 1e-9
    fallen = 10 - O.bodies[block].state.pos[2]
    assert abs(fallen - acceleration * O.time**2 / 2) < 1e-6


@pytest.mark.parametrize("engines", ({"model": "planar"}, {"model": "planar", "method": "wall"}, {"model": "compliant", "penetration": 1e-4}))
def test_balance_of_energies(engines):
    """A block that rocks under a dead load: what it loses is what its impacts take, in dem.energy() and in the history."""
    block = dem.block((0.4, 0.5, 1.2), stone(restitution=0.8), on=dem.base((4, 2, 0.2), stone()))
    dem.tilt(block, 0.1)
    dem.dead_load(block, 3000.0)
    recorder = dem.WallRecorder(virtPeriod=0.02)
    O.engines = quiet_engines(recorder=recorder, **engines)
    O.step()

    def total():
        energy = dem.energy()
        return sum(energy.values()) - 2 * energy["baseWork"]

    before = total()
    dem.run(1.0)
    lost = dem.energy()["impactDissip"]
    # Rigid: what the velocity of half a step makes of the dead load, F v dt/2, and the localised step's error of second order; compliant: its springs.
    bound = 3000.0 * 0.2 * O.dt
    assert len(dem.impacts()) >= 2 and lost > 20 and abs(total() - before) < bound, (total() - before, bound)
    error = dem.wall_history(recorder).energy["error"]
    assert np.abs(error[1:] - error[1]).max() < bound


@pytest.mark.parametrize("load", ("force", "turned"))
def test_on_a_tilting_table(load):
    """A stack of two blocks turns about its edge at b (W1 + W2 + P) / (W1 z1 + (W2 + P) z2), with P of an added mass or of a dead load."""
    width, height, more = 0.4, 1.0, 12000.0
    for put in (lambda top: dem.dead_load(top, more), lambda top: dem.add_mass(top, more / GRAVITY)):
        O.reset()
        ids = dem.stack(2, (width, 0.5, height), stone(frictionAngle=math.atan(0.9)), on=dem.base((4, 2, 0.2), stone(frictionAngle=math.atan(0.9))))
        weight = GRAVITY * O.bodies[ids[0]].state.mass
        put(ids[1])
        table = dem.TiltTable(load=load)
        expected = width / 2 * (2 * weight + more) / (weight * height / 2 + (weight + more) * 3 * height / 2)
        upper = width / height  # of the upper block alone
        assert expected < upper
        found = table.bisect(tolerance=1e-3, lower=0.8 * expected, progress=False)
        assert abs(found.multiplier - expected) < 2e-3 * expected, (found.multiplier, expected)
        assert all(tuple(engine.force)[:2] == (0, 0) and abs(engine.force[2] + more) < 1e-9 for engine in dem.loads.load_engines())


def test_saved_and_loaded():
    """A run that is loaded goes on with the same bits, and dem.engines() of a loaded scene has the loads."""
    ids = dem.stack(2, (0.4, 0.5, 0.6), stone(), on=dem.base((4, 2, 0.2), stone()))
    dem.tilt(ids[1], 0.05)
    dem.add_mass(ids[0], 50.0)
    dem.dead_load(ids, 900.0)
    O.engines = quiet_engines(model="planar")
    dem.run(0.1)
    O.saveTmp()
    ends = []
    for _ in range(2):
        dem.run(0.2)
        ends.append([tuple(O.bodies[id].state.pos) for id in ids])
        O.loadTmp()
    assert ends[0] == ends[1]
    O.engines = quiet_engines(model="planar")
    assert sum(-engine.force[2] * len(engine.ids) for engine in dem.loads.load_engines()) == pytest.approx(900, rel=1e-14)
    assert dem.loads.added_mass() == pytest.approx({ids[0]: 50.0}, rel=1e-9)


def test_a_table_says_that_it_lacks_them(tmp_path):
    ids = dem.stack(2, (0.4, 0.5, 0.6), stone(label="stone"), on=dem.base((4, 2, 0.2), stone()))
    assert said_by(dem.save_blocks, tmp_path / "blocks.csv") == ""
    dem.add_mass(ids[0], 50.0)
    assert "added to 1 blocks" in said_by(dem.save_blocks, tmp_path / "blocks.csv")


def test_the_report_names_them(tmp_path):
    ids = dem.stack(2, (0.4, 0.5, 0.6), stone(), on=dem.base((4, 2, 0.2), stone()))
    dem.add_mass(ids, 50.0)
    dem.dead_load(ids[1], 900.0)
    recorder = dem.WallRecorder(virtPeriod=0.02)
    O.engines = quiet_engines(model="planar", recorder=recorder)
    dem.run(0.1)
    history = dem.wall_history(recorder)
    history.save(tmp_path / "run.npz")
    loads = results.WallHistory.load(tmp_path / "run.npz").about["loads"]
    assert [one["kind"] for one in loads] == ["mass", "dead load"] and [one["size"] for one in loads] == pytest.approx([50, 900]) and loads[0]["ids"] == ids
    results.report(history, tmp_path / "run.html")
    text = (tmp_path / "run.html").read_text()
    assert "50 kg on 2 blocks" in text and "0.9 kN on 1 block," in text


@pytest.mark.parametrize("call", (dem.add_mass, dem.dead_load))
def test_bad_loads(call):
    base = dem.base((4, 2, 0.2), stone())
    block = dem.block((0.4, 0.5, 0.6), stone(), on=base)
    name = "mass" if call is dem.add_mass else "force"
    for ids, value, words in ((base, 10, (f"{base} is prescribed",)), ([], 10, ("ids = []",)), ([block, block], 10, ("twice",)), (99, 10, ("ids = 99",)),
                              (block, -1, (f"{name} = -1", "positive")), (block, math.nan, (f"{name} = nan",)), (block, "1", (f"{name} = '1'",))):
        refuses(lambda: call(ids, value), *words)
    assert O.engines == [] and dem.loads.added_mass() == {}
