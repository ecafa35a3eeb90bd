"""Joints with mortar: single bricks against closed forms, the ledger, saved runs, threads, and bad input."""

import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from masonry import dem, results
from mortar_hash import mortar_hash, wall
from mortar_scene import AREA, EINDHOVEN, SIZE, Loading, brick, brick_material, eindhoven
from rocking_scene import Balance, bits, joint_engine, quiet_engines, refuses, refuses_to_run, said_by, steps
from yade import O, PyRunner


def test_a_brick_that_is_pulled():
    """f_t A = 5.0 kN and G A = 0.36 J, of which the last 0.1 % is not spent; the work of the spring goes into crack, dashpots and motion."""
    _, one = brick()
    pull = Loading(one, "z", speed=0.02)
    row = pull.run()
    energy = dem.energy()
    assert pull.most == pytest.approx(5000, rel=2e-3)
    assert energy["crackDissip"] == pytest.approx(0.999 * 0.36, rel=1e-3)
    assert row["mode"] == "tension" and row["damage"] == row["worst"] == 1
    assert row["energy_tension"] == pytest.approx(energy["crackDissip"], rel=1e-12) and row["energy_shear"] == 0
    assert 0 < row["cracked"] < row["broken"] <= O.time
    engine = joint_engine()
    assert engine.madeEnergy + engine.lostEnergy < 1e-3 * energy["crackDissip"]


@pytest.mark.parametrize("given", ({"model": "auto"}, {"model": "planar", "method": "wall"}))
def test_the_energy_of_cracks_is_there_before_the_first_step(given):
    """By both methods dem.energy() has the same keys before and after it."""
    O.reset()
    material = brick_material()
    dem.block(SIZE, material, on=dem.base((0.5, 0.5, 0.1), material))
    O.engines = quiet_engines(**given)
    before = dem.energy()
    O.step()
    assert before["crackDissip"] == dem.energy()["crackDissip"] == 0 and before.keys() == dem.energy().keys()


@pytest.mark.parametrize("pressure", (0, 0.1e6))
def test_a_couplet(pressure):
    """c + mu s at the peak and mu s at the end; the energy G A of the crack."""
    _, one = brick()
    O.bodies[one].state.inertia = (1e6, 1e6, 1e6)  # so that it does not turn
    push = Loading(one, "x", speed=0.02, stiffness=2e8, force=(0, 0, -pressure * AREA))
    row = push.run()
    assert push.most == pytest.approx((0.35e6 + 0.75 * pressure) * AREA, rel=1e-2)
    assert dem.energy()["crackDissip"] == pytest.approx(0.999 * 125 * AREA, rel=1e-3)
    assert push.last == pytest.approx(0.75 * pressure * AREA, rel=1e-2, abs=2)
    assert row["mode"] == "shear" and row["opening"] < 1e-6


def test_a_wrench():
    """Peak moment over f_t b h^2/6: 2.50 where the edge has half of the stiffness of the face; 2.46 with the edge of these joints and four fibres."""
    _, one = brick()
    turn = Loading(one, "turn", speed=0.05, stiffness=2e6)
    turn.run(until=0.9, most=0.06)
    assert turn.most / (0.25e6 * SIZE[1] * SIZE[0] ** 2 / 6) == pytest.approx(2.50, rel=0.03)


def test_a_flexural_strength_is_that_of_the_wrench():
    """f_w = m(B) f_t: with f_w = 2.456 x 0.25 MPa at the stiffness of J4D the strength is that of J4D."""
    values = {**EINDHOVEN, "flexuralStrength": 2.456 * 0.25e6}
    del values["tensileStrength"]
    mortar = dem.JointMat(**values)
    assert mortar.directStrength == pytest.approx(0.25e6, rel=5e-3)
    stiff = dem.JointMat(**{**values, "normalStiffness": 1e15})
    assert stiff.directStrength == pytest.approx(values["flexuralStrength"] / 3, rel=5e-3)
    O.reset()
    material = brick_material(mortar)
    dem.block(SIZE, material, on=dem.base((1, 1, 0.1), material))
    said = said_by(lambda: setattr(O, "engines", dem.engines()))
    assert "a BlockMat has mortar" in said and "stands for the tensile strength" in said


def test_a_wall_below_its_strength_stays_sound():
    wall(peak=10.0)
    balance = Balance()
    O.run(1500, True)
    table = dem.damage()
    assert len(table) == len(joint_engine().bondedIds) // 2 > 15
    assert not table["worst"].any() and np.isnan(table["cracked"]).all()
    assert abs(balance.error()) < 1e-3 * dem.energy()["baseWork"] + 1e-6


def test_the_energy_of_a_wall_that_cracks_closes():
    """Rows of dem.damage() add up to crackDissip; less than 1e-3 of what is dissipated is made, and the balance misses no more."""
    wall()
    balance = Balance()
    O.run(1500, True)
    table, energy = dem.damage(), dem.energy()
    assert (table["worst"] > 0.5).any() and energy["crackDissip"] > 0
    assert (table["energy_tension"] + table["energy_shear"]).sum() == pytest.approx(energy["crackDissip"], rel=1e-9)
    lost = sum(energy[key] for key in ("crackDissip", "dampDissip", "frictDissip"))
    assert abs(balance.error()) < 1e-3 * lost and joint_engine().madeEnergy < 1e-3 * lost


@pytest.mark.parametrize("ending", ("xml", "yade.gz"))
def test_a_saved_wall_goes_on_with_the_same_bits(ending, tmp_path):
    path = str(tmp_path / f"wall.{ending}")
    wall()
    O.run(700, True)
    O.save(path)
    steps(400)
    straight, state = bits(), np.array(joint_engine().bondedState)
    assert joint_engine().crackDissip > 0
    O.reset()
    O.load(path)
    steps(400)
    assert np.array_equal(bits(), straight)
    assert np.array_equal(np.array(joint_engine().bondedState), state, equal_nan=True)


def with_another_layout(row):
    return re.sub(r"<item>-1\.0[\d.e+]*<", "<item>-9.0e+00<", row, count=1)


def with_a_number_more(row):
    count = int(re.search(r"<count>(\d+)", row)[1])
    return row.replace(f"<count>{count}<", f"<count>{count + 1}<", 1).replace("</values>", "<item>0</item></values>")


def without_a_number(row):
    count = int(re.search(r"<count>(\d+)", row)[1])
    return re.sub(r"<item>[^<]*</item>\s*</values>", "</values>", row.replace(f"<count>{count}<", f"<count>{count - 1}<", 1))


@pytest.mark.parametrize("change", (with_another_layout, with_a_number_more, without_a_number))
def test_mortar_that_another_version_has_saved_is_refused(change, tmp_path):
    brick()
    steps(10)
    path = tmp_path / "brick.xml"
    O.save(str(path))
    O.reset()
    text = path.read_text()
    changed = re.sub(r"<bond>.*?</bond>", lambda found: change(found[0]), text, flags=re.DOTALL)
    assert changed != text
    path.write_text(changed)
    refuses(lambda: O.load(str(path)), "mortar", "saved by another version of yade-masonry", kind=RuntimeError)


def test_threads_give_the_same_bits():
    own, script = mortar_hash(), Path(__file__).with_name("mortar_hash.py")
    for threads in (1, 4):
        run = subprocess.run(["yade", f"-j{threads}", "-n", "-x", str(script)], capture_output=True, text=True, timeout=600,
                             env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}, stdin=subprocess.DEVNULL)
        assert re.search(r"hash (\w+)", run.stdout)[1] == own, (threads, run.stdout, run.stderr)


def test_bonds_are_made_where_they_are_asked_for():
    """A brick with mortar on a base without is dry; dem.bond() bonds it as it stands, and it holds what a dry one would not."""
    O.reset()
    dry = dem.BlockMat(density=1900, frictionAngle=0.6435, normalStiffness=82e9, shearStiffness=36e9)
    base = dem.base((0.5, 0.5, 0.1), dry)
    one, two = dem.stack(2, SIZE, brick_material(), on=base)
    O.engines = quiet_engines(model="auto")
    steps(3)
    assert [(row["body1"], row["body2"]) for row in dem.damage()] == [(one, two)]
    assert dem.bond([], eindhoven()) == 0
    refuses(lambda: dem.bond([base, two], eindhoven()), f"ids = [{base}, {two}]", "no two of these bodies touch")
    refuses(lambda: dem.bond([one, one], eindhoven()), f"ids = [{one}, {one}]", "two different bodies")
    assert dem.bond([base, one], eindhoven()) == 1
    O.step()
    assert len(dem.damage()) == 2
    start = O.bodies[two].state.pos[2]
    O.forces.setPermF(two, (0, 0, 1000))
    O.run(3000, True)
    assert O.bodies[two].state.pos[2] - start < 1e-5 and not dem.damage()["worst"].any()
    O.forces.setPermF(two, (0, 0, 0))


def test_a_broken_brick_rocks_with_its_restitution():
    base, one = brick(gravity=9.81, restitution=0.6)
    Loading(one, "turn", speed=1.0, stiffness=2e5).run()
    assert not len(dem.impacts())
    O.engines = [engine for engine in O.engines if type(engine).__name__ != "PyRunner"]
    while not len(dem.impacts()) and O.time < 1:
        O.run(1000, True)
    assert dem.impacts()["restitution"][0] == pytest.approx(0.6, rel=1e-6)


def test_scatter():
    mortar = dem.scatter(eindhoven(), cov=0.3, seed=1)
    factors = np.array([mortar.factor(a, b) for a in range(60) for b in range(a + 1, 60)])
    assert factors.mean() == pytest.approx(1, abs=4 * 0.3 / math.sqrt(len(factors)))
    assert factors.std() == pytest.approx(0.3, rel=0.1)
    assert mortar.factor(3, 7) == mortar.factor(7, 3) == dem.scatter(eindhoven(), 0.3, 1).factor(3, 7) != dem.scatter(eindhoven(), 0.3, 2).factor(3, 7)
    assert eindhoven().factor(3, 7) == 1
    refuses(lambda: dem.scatter(eindhoven(), cov=1.5), "cov = 1.5")
    refuses(lambda: dem.scatter(eindhoven(), seed=-1), "seed = -1")


@pytest.mark.parametrize("changes, words", (
    (dict(fractureEnergy=math.nan), ("fractureEnergy", "brittle")),
    (dict(shearFractureEnergy=math.nan), ("shearFractureEnergy", "brittle")),
    (dict(tensileStrength=math.nan), ("fractureEnergy", "tensileStrength")),
    (dict(cohesion=math.nan, shearFractureEnergy=math.nan), ("cohesion",)),
    (dict(flexuralStrength=0.6e6), ("flexuralStrength", "one of the two")),
    (dict(tensileStrength=-1), ("tensileStrength = -1", "0 or positive")),
    (dict(tensileStrength=math.inf), ("tensileStrength = inf",)),
    (dict(fractureEnergy=0), ("fractureEnergy = 0", "positive")),
    (dict(cohesion=0.18e6), ("cohesion", "187500")),
    (dict(frictionAngle=1.6), ("frictionAngle = 1.6", "pi/2")),
    (dict(normalStiffness=3e9), ("normalStiffness", "3.47222e+09")),
    (dict(shearStiffness=0.9e9), ("shearStiffness", "9.8e+08")),
    (dict(normalStiffness=-1), ("normalStiffness = -1", "Pa/m")),
    (dict(scatter=2), ("scatter = 2",)),
))
def test_bad_mortar(changes, words):
    assert "\n" not in refuses(lambda: eindhoven(**changes), *words)


def test_bad_use_of_mortar():
    refuses(lambda: dem.BlockMat(mortar=eindhoven(), noSlip=True), "noSlip", "mortar")
    refuses(lambda: dem.BlockMat(mortar=dem.JointMat()), "mortar", "fractureEnergy")
    refuses(lambda: dem.BlockMat(mortar=3), "mortar = 3", "JointMat", kind=TypeError)
    refuses(lambda: dem.bond(material=3), "material = 3", "JointMat")
    O.reset()
    one, other = brick_material(), brick_material(eindhoven(fractureEnergy=20))
    base = dem.base((1, 1, 0.1), one)
    dem.block(SIZE, other, on=base)
    refuses(dem.engines, f"bodies {base} and 1", "different mortar")
    refuses(lambda: dem.bond(material=eindhoven()), "dem.engines")


def test_rigid_blocks_refuse_mortar_but_for_walls():
    O.reset()
    material = brick_material()
    base = dem.base((1, 1, 0.1), material)
    dem.block(SIZE, material, on=base)
    for model in ("planar", "spatial"):
        refuses(lambda: dem.engines(model=model), f"model = '{model}'", "compliant")
    refuses(lambda: dem.engines(method="localised"), "method = 'localised'", "mortar", "compliant")
    refuses(lambda: dem.engines(tolerance=1e-6), "tolerance = 1e-06", "mortar", "compliant")
    refuses(lambda: dem.TiltTable(method="localised"), "method", "'wall'")
    O.dt = 1e-4
    for model in ("planar", "spatial"):
        O.engines = [dem.MoreauJeanIntegrator(method="localised", model=model)]
        refuses_to_run("mortar", "compliant")


def test_a_tie_beside_mortar():
    """A vertical tie through the middle of a bonded brick, made before or after the engines: the base bears the weight and its tension, and the mortar stays whole."""
    for late in (False, True):
        O.reset()
        material = brick_material()
        base = dem.base((1, 1, 0.1), material)
        one = dem.block(SIZE, material, on=base)
        tie, force = (one, (0, 0, SIZE[2]), base, (0, 0, 0), 1e6), 50.0
        made = None if late else dem.tie(*tie, pretension=force)
        O.engines = quiet_engines(model="auto")
        made = made or dem.tie(*tie, pretension=force)
        dem.run(0.01)
        carried = dem.reactions(base)["force"].sum(axis=0)[2]
        print(f"late={late}: tie {made.force:.3f} N, base {carried:.3f} N")
        assert abs(made.force - force) < 0.01 * force and dem.damage()["worst"].max() == 0
        assert abs(carried - 9.81 * O.bodies[one].state.mass - force) < 0.02 * force


def test_a_gap_under_mortar():
    """A gap as wide as a joint is no joint, but an opening of half a brick is one."""
    for gap in (0.01, 0.03):
        O.reset()
        material = brick_material()
        base = dem.base((1, 1, 0.1), material)
        one = dem.block(SIZE, material, on=base)
        two = dem.block(SIZE, material, center=(0, 0, 0.075 + gap))
        if gap < SIZE[2] / 2:
            refuses(dem.engines, f"bodies {one} and {two}", "a gap of 0.01 m", "must touch")
        else:
            quiet_engines(model="auto")


def test_new_engines_go_on_with_the_damage():
    """Engines that are made anew in a run have the bonds as they are; without those of before, the joints could not be told from sound ones."""
    wall()
    O.run(1000, True)
    before, spent, elastic = dem.damage(), dem.energy()["crackDissip"], dem.energy()["elastPotential"]
    assert before["worst"].max() > 0.5
    engines = list(O.engines)
    place = engines.index(joint_engine())
    O.engines = quiet_engines(model="auto")
    assert dem.damage().tobytes() == before.tobytes()
    O.step()
    after = dem.damage()
    assert (after["damage"] >= before["damage"]).all() and len(after) == len(before)
    assert spent <= dem.energy()["crackDissip"] < 1.05 * spent  # a step of the cracks that grow
    assert dem.energy()["elastPotential"] == pytest.approx(elastic, rel=0.2)
    table = dem.damage()
    assert (table["energy_tension"] + table["energy_shear"]).sum() == pytest.approx(dem.energy()["crackDissip"], rel=1e-9)
    assert joint_engine().madeEnergy < 1e-3 * elastic
    O.engines = [*engines[:place], dem.RockingJointEngine(), *engines[place + 1:]]
    refuses_to_run("another RockingJointEngine", "keep that engine")


def test_what_is_said_of_mortar(tmp_path):
    """Of a restitution where one is given, and of its strengths in a report."""
    for restitution, says in ((math.nan, False), (0.6, True)):
        O.reset()
        material = brick_material(restitution=restitution)
        base = dem.base((1, 1, 0.1), material)
        dem.block(SIZE, material, on=base)
        assert ("restitution" in said_by(dem.engines)) == says
    recorder = dem.WallRecorder(iterPeriod=5)
    O.engines = quiet_engines(model="auto", recorder=recorder)
    steps(11)
    results.report(dem.wall_history(recorder), tmp_path / "brick.html")
    text = (tmp_path / "brick.html").read_text()
    assert "tensile strength 2.5e+05 Pa" in text and "cohesion 3.5e+05 Pa" in text and "fracture energy 18 J/m^2" in text


def test_joints_that_would_snap_or_gape_do_not_run():
    O.reset()
    material = brick_material(eindhoven(normalStiffness=math.nan), normalStiffness=3e9, shearStiffness=36e9)
    base = dem.base((1, 1, 0.1), material)
    dem.block(SIZE, material, on=base)
    O.engines = quiet_engines(model="auto")
    refuses_to_run("normalStiffness = 3e+09", "3.47222e+09")
    O.reset()
    material = brick_material()
    base = dem.base((1, 1, 0.1), material)
    dem.block(SIZE, material, center=(0, 0, 0.025 + 3e-5))
    O.engines = quiet_engines(model="auto")
    refuses_to_run("gap of 3e-05 m", "must touch")


class Kept:
    """dem.damage() at every sample, by a second way."""

    tables = []


def test_the_history_has_the_damage_of_every_sample(tmp_path):
    """The oracle is dem.damage(), called at the samples. Energies of the cracks add up to crackDissip; a crack is between the sample that shows it and that before."""
    recorder = dem.WallRecorder(iterPeriod=50)
    wall(recorder=recorder)
    Kept.tables = []
    place = O.engines.index(recorder)
    O.engines = [*O.engines[:place], PyRunner(command="import test_mortar; test_mortar.Kept.tables.append(test_mortar.dem.damage())", iterPeriod=50, initRun=True), *O.engines[place:]]
    O.run(1001, True)
    history, kept = dem.wall_history(recorder), Kept.tables
    assert len(history.time) == len(kept) == 21 and len(history.bonds) > 15
    assert not history.damage["worst"][0].any()
    for sample, table in enumerate(kept):
        found = results.cracks(history, history.time[sample])
        assert all(np.array_equal(found[name], table[name], equal_nan=name in ("cracked", "broken")) for name in table.dtype.names), sample
        line = found.timeline[-1]
        assert line["tension"] + line["shear"] == (table["worst"] >= 0.02).sum() == len(found.cracked)
    last = results.cracks(history)
    assert 0 < len(last.cracked) < len(last)
    first = (history.damage["worst"] >= 0.02).argmax(axis=0)  # sample that shows the crack
    for k in np.flatnonzero(last["worst"] >= 0.02):
        assert history.time[first[k] - 1] < last["cracked"][k] <= history.time[first[k]]
    assert last.energy == pytest.approx(dem.energy()["crackDissip"], rel=1e-9) and history.energy["crackDissip"][-1] == last.energy
    energy = history.energy  # less than 1e-3 of what is dissipated is made
    assert np.abs(energy["error"]).max() < 1e-3 * sum(energy[name][-1] for name in ("crackDissip", "dampDissip", "frictDissip"))
    history.save(tmp_path / "wall.npz")
    assert np.array_equal(results.WallHistory.load(tmp_path / "wall.npz").damage, history.damage)
    results.write_paraview(history, tmp_path / "wall.pvd", every=10)
    results.report(history, tmp_path / "wall.html")
    last.picture(tmp_path / "cracks.png")


def test_a_saved_recorder_goes_on_with_the_same_damage(tmp_path):
    recorder = dem.WallRecorder(iterPeriod=40)
    wall(recorder=recorder)
    O.run(700, True)
    O.save(str(tmp_path / "wall.yade.gz"))
    steps(300)
    straight = dem.wall_history(recorder)
    O.reset()
    O.load(str(tmp_path / "wall.yade.gz"))
    steps(300)
    loaded = dem.wall_history(next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder)))
    assert straight.damage["worst"].any() and np.array_equal(straight.damage, loaded.damage) and straight.bonds.tobytes() == loaded.bonds.tobytes()


@pytest.mark.parametrize("along, mode", (("z", "tension"), ("x", "shear")))
def test_what_has_cracked_a_brick(along, mode, tmp_path):
    """A brick that is pulled cracks in tension, a couplet that is sheared in shear. The energy is crackDissip; the other mode has next to nothing of it, since the
    couplet, whose inertia is finite, turns a little."""
    base, one = brick()
    O.bodies[one].state.inertia = (1e6, 1e6, 1e6)  # so that it does not turn
    recorder = dem.WallRecorder(iterPeriod=20)
    Loading(one, along, speed=0.02, stiffness=1e9 if along == "z" else 2e8).run()
    O.engines = [*O.engines[:-1], recorder, O.engines[-1]]
    steps(30)
    found = results.cracks(dem.wall_history(recorder))
    (row,) = found.cracked
    assert (row["body1"], row["body2"], row["mode"]) == (base, one, mode) and row["damage"] == 1 and np.isfinite(row["broken"])
    assert found.energy == pytest.approx(dem.energy()["crackDissip"], rel=1e-12)
    assert row["energy_shear" if mode == "tension" else "energy_tension"] < 1e-6 * found.energy
    found.save(tmp_path / "cracks.csv")
    assert f",{mode}," in (tmp_path / "cracks.csv").read_text().splitlines()[1]


def test_a_joint_that_is_bonded_later_is_sound_before():
    O.reset()
    dry = dem.BlockMat(density=1900, frictionAngle=0.6435, normalStiffness=82e9, shearStiffness=36e9)
    base = dem.base((0.5, 0.5, 0.1), dry)
    one, two = dem.stack(2, SIZE, brick_material(), on=base)
    recorder = dem.WallRecorder(iterPeriod=5)
    O.engines = quiet_engines(model="auto", recorder=recorder)
    steps(12)
    assert len(dem.wall_history(recorder).bonds) == 1
    dem.bond([base, one], eindhoven())
    steps(10)
    history = dem.wall_history(recorder)
    assert [(row["body1"], row["body2"]) for row in history.bonds] == [(base, one), (one, two)] and history.damage.shape == (len(history.time), 2)
    assert recorder.bondCounts[-1] == 2 and not history.damage["worst"].any()


def test_a_comparison_has_the_damage():
    def scene(**changes):
        wall(**changes)
        return O.engines

    compared = dem.compare(scene, seconds=0.02)
    assert "mean damage" in str(compared) and len(compared.runs) == 2
    damages = [run.damage for run in compared.runs]
    assert 0 < min(damages) <= max(damages) < 1 and (max(damages) < 1.1 * min(damages) + 0.01) == (not any("mean damage of the mortar" in doubt for doubt in compared.doubts))
