"""dem.push(): forces and displacements of closed forms; its ends; dem.pull_and_release() against the exact history of one block."""
import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, refuses, said_by
from yade import O, Vector3

import masonry

GRAVITY = 9.81
WIDTH, DEPTH, HEIGHT = 0.6, 0.5, 2.0
# Share by which forces may differ from those of bodies at rest. Platens change their speed by 0.02 m/s^2 at most, which takes 0.7 % of a friction of 0.3 times the
# weight, and of the force on a block of the slenderness 3.3 that turns about its toe (4/3 m R^2/z^2 times 0.02 m/s^2, over m g b/z).
CLOSE = 0.01


def stone(mu=0.7, **given):
    return dem.BlockMat(density=2000, frictionAngle=math.atan(mu), restitution=0, **given)


def ground(**given):
    return dem.base((6, 4, 0.2), dem.BlockMat(density=2000, **given) if given.get("noSlip") else stone(**given))


def weight(ids):
    return sum(O.bodies[id].state.mass for id in ids) * GRAVITY


def run(push, **options):
    O.engines = quiet_engines(push, **{"model": "auto", **options})
    dem.run(until=push)
    return push.averaged(0.02)


def rocking(displacement, height, load):
    """Force of a frictionless edge at that height on a block that turns about its toe, by the displacement of the edge, N. The block has turned by q when the
    edge is at z tan q - B (1/cos q - 1); the force N is across its face, at (z - B sin q)/cos q from the lower corner, and has the moment of the weight."""
    angles = np.linspace(0, math.atan(WIDTH / HEIGHT), 2000)
    places = height * np.tan(angles) - WIDTH * (1 / np.cos(angles) - 1)
    normal = load * (WIDTH / 2 * np.cos(angles) - HEIGHT / 2 * np.sin(angles)) / ((height - WIDTH * np.sin(angles)) / np.cos(angles))
    return np.interp(displacement, places, normal * np.cos(angles), right=0)


@pytest.mark.parametrize("model, method, direction", (("planar", "auto", (1, 0, 0)), ("spatial", "auto", (-1, 0, 0)), ("planar", "wall", (-1, 0, 0)), ("spatial", "wall", (1, 0, 0))))
def test_a_block_that_rocks(model, method, direction):
    """F = W B / (2 z) at first, and down to 0 where the centre is above the toe."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.39, speed=0.1, direction=direction, height=1.5)
    table = run(push, model=model, method=method)
    assert push.ended in ("collapse", "displacement")
    expected = rocking(table["displacement"], 1.5, weight([block]))
    close = 0.02 if method == "wall" else CLOSE  # forces of `wall` are not solved to its tolerance
    before = table["displacement"] < 0.38
    assert np.abs(table["force"] - expected)[before][20:].max() < close * weight([block]) * WIDTH / 3, np.abs(table["force"] - expected)[before][20:].max()
    force, place = push.largest_force
    assert abs(force / (weight([block]) * WIDTH / 3) - 1) < close and place < 0.02


def test_a_block_that_slides():
    """F = mu W, all the way; back and forth too."""
    block = dem.block((WIDTH, DEPTH, 0.4), stone(0.3), on=ground(mu=0.3))
    push = dem.push(ids=[block], cycles=[0.01, -0.01, 0.005], speed=0.02, height=0.1, clearance=1e-3)
    table = run(push, model="planar")
    loaded = np.abs(table["force"]) > 1
    slides = loaded & (np.abs(np.gradient(table["displacement"], table["time"])) > 0.01)
    assert np.abs(np.abs(table["force"][slides]) / (0.3 * weight([block])) - 1)[30:-30].max() < CLOSE
    assert abs(table["moved"][-1] - 0.005) < 1e-3 + 1e-6 and table["force"].min() < 0 < table["force"].max()


def test_a_stack():
    """The k upper blocks turn about the edge of their lowest joint at F = k w (B/2)/(z - z_k); with friction enough the least k that gives the least force: all of them.
    Pushed at 0.35 of the height of the top block, the top block alone would take w B/2/(0.35 h)."""
    base, (width, height) = ground(mu=3), (0.6, 0.3)
    ids = dem.stack(4, (width, 0.5, height), stone(3), on=base)
    z = 3 * height + 0.35 * height
    push = dem.push(ids=[ids[-1]], displacement=0.01, height=z)
    run(push)
    least = min(k * width / 2 / (z - (4 - k) * height) for k in (1, 2, 3, 4)) * weight(ids[:1])
    force, _ = push.largest_force
    assert abs(force / least - 1) < CLOSE


@pytest.mark.parametrize("model", ("planar", "spatial"))
def test_a_shear_wall_under_a_dead_load(model):
    """A pier of full courses under 30 times its weight turns about its toe at (N + W) L/(2 z), however often the load is the weight."""
    ids = dem.stack(5, (1.0, 0.1, 0.2), stone(3), on=ground(mu=3))
    load = 30 * weight(ids)
    push = dem.push(ids=ids[-1:], displacement=2e-3, speed=5e-3, vertical="load", force=load)
    run(push, model=model, method="wall" if model == "planar" else "auto")
    force, _ = push.largest_force
    assert push.ended == "displacement" and O.engines[-1].failures == 0
    assert abs(force / ((load + weight(ids)) * 0.5 / 0.9) - 1) < CLOSE
    assert push.curve["force"][0] >= 0


@pytest.mark.parametrize("model", ("planar", "spatial", "compliant"))
def test_the_dead_load_of_a_push_is_in_energies_reactions_and_reports(model):
    """A block that is pushed up on its toe lifts the load N by dz; the work of the platen pays for it and for the weight. Later engines have the load no more."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(3), on=ground(mu=3))
    push = dem.push(ids=[block], displacement=0.1, height=1.5, vertical="load", force=30e3)
    recorder = dem.WallRecorder(virtPeriod=0.02, recordForces=True)
    O.engines = quiet_engines(push, recorder=recorder, model=model)
    assert quiet_engines(push, model=model).count(push.load) == 1
    dem.run(until=push)
    history = dem.wall_history(recorder)
    energy, lifted = history.energy, history.position[-1, 1, 2] - history.position[0, 1, 2]
    assert history.about["loads"] == [{"kind": "dead load", "size": pytest.approx(30e3), "ids": [block]}]
    assert lifted > 0.01 and abs(energy["potential"][-1] - energy["potential"][0] - (30e3 + weight([block])) * lifted) < 1e-6 * 30e3
    assert np.abs(energy["error"]).max() < 0.02 * 30e3 * lifted
    assert abs(dem.energy()["potential"] - energy["potential"][-1]) < 0.01 * 30e3 * lifted
    assert abs(dem.reactions(0)["force"].sum(axis=0)[2] / (30e3 + weight([block])) - 1) < 0.05  # of one instant: the block moves
    assert push.load not in quiet_engines(model=model) and dem.loads.dead_loads()[block][2] == -30e3


def test_a_wall_out_of_its_plane_and_the_tilting_table():
    """Pushed at the height of its centre of mass by platens at each block of that course, a wall turns about its foot at W t/(2 z): t/H of its weight, as TiltTable has it."""
    base = ground(mu=3)
    ids = dem.wall(courses=3, per_course=3, size=(0.4, 0.15, 0.2), material=stone(3), on=base)
    table = dem.TiltTable(direction="y").bisect(progress=False)
    course = [id for id in ids if abs(O.bodies[id].state.pos[2] - 0.3) < 1e-6]
    push = dem.push(ids=course, displacement=5e-3, direction=(0, 1, 0))
    run(push)
    assert len(push.platens) == len(course)
    force = push.largest_force[0] / weight(ids)
    assert abs(force / (0.15 / 0.6) - 1) < CLOSE and abs(force / table.multiplier - 1) < CLOSE


def test_a_block_on_compliant_joints():
    """The same force at first, less what the joint gives."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.02, height=1.5)
    table = run(push, model="compliant")
    assert push.ended == "displacement"
    late = table["displacement"] > 5e-3
    assert np.abs(table["force"] / rocking(table["displacement"], 1.5, weight([block])) - 1)[late].max() < 0.02


def test_a_platen_that_presses_in_deep_is_told():
    """The joint of a platen gives by more than 2 % of its size: it is said once, in words that also fit a load."""
    stiff, soft = ({"normalStiffness": k, "shearStiffness": k} for k in (1e10, 1e8))
    block = dem.block((1.0, 0.5, 0.5), stone(3, **stiff), on=ground(mu=3, **stiff))
    push = dem.push(ids=[block], displacement=0.01, height=0.45, vertical="load", force=3e4)
    O.bodies[push.platens[0]].mat.updateAttrs(soft)
    run(push, model="compliant")
    joints = next(engine for engine in O.engines if isinstance(engine, dem.RockingJointEngine))
    assert joints.failures == 1 and push.largest_force[0] > 1e4


def test_an_oblique_push_of_a_column():
    """A block that is pushed along the diagonal of its plan turns over its corner, at W times half the diagonal over z, if it does not turn about the vertical."""
    block = dem.block((0.4, 0.4, 1.2), stone(3), on=ground(mu=3))
    root = math.sqrt(0.5)
    push = dem.push(ids=[block], displacement=5e-3, direction=(root, root, 0), height=0.8)
    run(push)
    assert abs(push.largest_force[0] / (weight([block]) * 0.2 * math.sqrt(2) / 0.8) - 1) < CLOSE


def test_cycles_of_a_block_that_rocks():
    """Forward and back along the same curve, to both sides: rocking dissipates nothing while it is slow."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], cycles=[0.05, -0.05, 0.02], height=1.5)
    table = run(push)
    assert push.ended == "displacement" and len(push.platens) == 2 and O.engines[-1].failures == 0
    assert abs(table["displacement"].max() - 0.05) < 1e-6 and abs(table["displacement"].min() + 0.05) < 1e-6
    out = (table["displacement"] > 5e-3) & (np.abs(table["displacement"]) < 0.045)
    expected = rocking(table["displacement"], 1.5, weight([block]))
    assert np.abs(table["force"] - expected)[out].max() < 2 * CLOSE * weight([block]) * WIDTH / 3
    assert table["force"].min() < -0.9 * weight([block]) * WIDTH / 3  # the platen in front pushes it back


@pytest.mark.parametrize("bricks", (False, True))
def test_the_largest_force_of_cycles(bricks):
    """Two piers with a beam under a dead load N, as a wall with a door. They rock to both sides, lift the beam by b q and themselves by b q/2 where it goes h q sideways:
    F = (W b + (W_beam + N) b)/h for the weight W of one pier. Courses of one block follow it to 2 %, the share of 10 mm over b; for bricks, which may crack along other
    lines too, this mechanism bounds the force from above. Platens that land and bricks that snap make spikes of single steps, of which the mean keeps the impulse alone."""
    base, (b, h), courses, mu = ground(mu=0.7), (0.5, 1.5), 10, 0.7
    if bricks:
        piers = dem.wall(length=2 + b, height=h, size=(0.25, 0.3, h / courses), material=stone(mu), on=base, openings=[(b, 0, 2 - b, h)])
    else:
        piers = [dem.block((b, 0.3, h / 6), stone(mu), center=(x, 0, (k + 0.5) * h / 6)) for x in (-1.0, 1.0) for k in range(6)]
    beam = dem.block((2.5, 0.3, 0.3), dem.BlockMat(density=2500, noSlip=True), center=(0, 0, h + 0.15))
    push = dem.push(ids=[beam], cycles=[5e-3, -5e-3, 1e-2, -1e-2], vertical="load", force=5e3)
    run(push, model="planar", method="wall")
    plateau, curve, (force, _) = (weight(piers) / 2 + weight([beam]) + 5e3) * b / h, push.curve, push.largest_force
    assert push.ended == "displacement" and np.abs(curve["step_force"]).max() > (2 if bricks else 1.2) * plateau
    assert (0.9 if bricks else 0.98) < abs(force) / plateau < 1.02
    assert abs(curve["force"].sum() - curve["step_force"].sum()) < 1e-3 * np.abs(curve["step_force"]).sum()


def test_stuck_blocks_that_snap_make_no_energy():
    """Between two mechanisms of the wall of docs/gallery/push.py all contacts change in one step. Kinetic and potential energy (that of the dead load included) less the work of the
    base and of the platens can only fall. Bound: 1e-4 of the 179 J that the platens do and take back until then; a step that is not solved again makes 4.2 J."""
    wall = dem.wall(length=2.4, height=1.6, size=(0.4, 0.2, 0.2), material=stone(0.75), on=ground(mu=0.75), openings=[(0.6, 0, 1.2, 1.2)])
    beam = dem.block((2.4, 0.2, 0.2), dem.BlockMat(density=2500, noSlip=True), center=(0, 0, 1.7))
    push = dem.push(ids=[beam], cycles=[5e-3, -5e-3, 1e-2, -1e-2, 2e-2, -2e-2, 4e-2, -4e-2], vertical="load", force=5e3)
    O.engines = quiet_engines(push, model="planar", method="wall")
    rises, before, fastest = 0, math.inf, 0
    while O.time < 7.2:
        O.step()
        energy = dem.energy()
        now = energy["kinetic"] + energy["potential"] - energy["baseWork"]
        rises += max(0, now - before)
        before = now
        fastest = max(fastest, *(O.bodies[id].state.vel.norm() for id in wall))
    assert rises < 0.02 and fastest < 0.1 and O.engines[-1].failures == 0


def test_energy_from_nothing_is_told():
    """Ten times the usual step under a heavy load: the line names the energy of the engine, which is more than 1e-3 of the work of the platens. With the load of an eighth it is less."""
    for force, tells in ((4e4, True), (5e3, False)):
        O.reset()
        dem.wall(length=2.4, height=1.6, size=(0.4, 0.2, 0.2), material=stone(0.75), on=ground(mu=0.75), openings=[(0.6, 0, 1.2, 1.2)])
        beam = dem.block((2.4, 0.2, 0.2), dem.BlockMat(density=2500, noSlip=True), center=(0, 0, 1.7))
        push = dem.push(ids=[beam], cycles=[2e-2, -2e-2], vertical="load", force=force)
        O.engines = quiet_engines(push, model="planar", method="wall", dt=5e-3)
        said = said_by(lambda: dem.run(until=push))
        made, work = O.engines[-1].madeEnergy, np.abs(push.curve["step_force"][1:] * np.diff(push.curve["displacement"])).sum()
        assert (made > 1e-3 * work) == tells and (f"has made {made:.3g} J of nothing" in said) == tells, (made, work, said)


def test_the_ends():
    """A drop of the force; the collapse of a block that overturns; platens that press a block from two sides."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.4, speed=0.05, height=1.5, drop=0.2)
    table = run(push)
    assert push.ended == "drop" and 0.79 < table["force"][-1] / table["force"].max() < 0.81
    O.reset()
    block = dem.block((0.2, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.4, speed=0.05, height=1.5)
    run(push)
    assert push.ended == "collapse" and dem.collapsed() and dem.collapsed(2) is False
    O.reset()
    base = ground()
    block = dem.block((WIDTH, DEPTH, 0.4), stone(), on=base)
    wall = dem.base((0.2, 1, 0.5), stone(), at=(0.4 + 1e-3, 0))
    O.bodies[wall].state.pos = O.bodies[wall].state.pos + Vector3(0, 0, 0.5)
    push = dem.push(ids=[block], displacement=0.05, speed=0.05)
    assert "the push jams at" in said_by(lambda: run(push))
    assert push.ended == "jam" and 1e-3 <= push.curve["displacement"][-1] < 5e-3


def test_platens_of_a_script():
    """A prescribed body of the script's own pushes what it touches."""
    block = dem.block((WIDTH, DEPTH, 0.4), stone(0.3), on=ground(mu=0.3))
    plate = dem.base((0.1, 0.4, 0.3), dem.BlockMat(density=2000, frictionAngle=0), at=(-WIDTH / 2 - 0.05, 0))
    O.bodies[plate].state.pos = Vector3(-WIDTH / 2 - 0.05, 0, 0.2)
    push = dem.push(platens=[plate], displacement=0.01)
    run(push, model="planar")
    assert abs(push.largest_force[0] / (0.3 * weight([block])) - 1) < CLOSE and math.isnan(push.curve["moved"][-1])


def test_pull_and_release():
    """Let go at an angle, a block moves as the exact one does from there: impacts to 1e-3 s, which is where the platens leave it between two looks."""
    block = dem.block((WIDTH, DEPTH, HEIGHT), dem.BlockMat(density=2000, noSlip=True, restitution=0.9), on=ground(noSlip=True, restitution=0.9))
    pull = dem.pull_and_release(ids=[block], displacement=0.15, height=1.5)
    O.engines = quiet_engines(pull, model="planar")
    dem.run(until=pull)
    released, angle, speed = O.time, dem.angle(block), O.bodies[block].state.angVel[1]
    assert pull.ended == "displacement" and 0.09 < angle < 0.12 and abs(speed) < 1e-3
    assert all(O.bodies[id] is None for id in pull.platens)
    dem.run(3)
    exact = masonry.simulate(masonry.RockingBlock(WIDTH / 2, HEIGHT / 2), restitution=0.9, initial_angle=angle, initial_velocity=speed, t_end=3)
    times = dem.impacts()["time"] - released
    times = times[times > 0]
    assert len(times) >= 3 and np.abs(times[:3] - exact.impact_times[:3]).max() < 1e-3


def test_files_and_pictures(tmp_path):
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
    push = dem.push(ids=[block], displacement=0.02)
    refuses(lambda: push.picture(tmp_path / "none.png"), "nothing has been recorded")
    run(push)
    push.save(tmp_path / "curve.csv")
    table = np.genfromtxt(tmp_path / "curve.csv", delimiter=",", skip_header=1)
    assert (tmp_path / "curve.csv").read_text().startswith("displacement (m),force (N),time (s),moved (m),force of the step (N)\n")
    assert np.allclose(table, np.column_stack([push.curve[name] for name in push.curve.dtype.names]))
    push.picture(tmp_path / "curve.png", title="a block")
    assert (tmp_path / "curve.png").read_bytes()[:4] == b"\x89PNG"
    refuses(lambda: push.save(tmp_path / "curve.txt"), ".csv")


def test_bad_input():
    base = ground()
    block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=base)
    ids = {"ids": [block]}
    for arguments, words in (({}, "give one of the two"), (dict(ids, displacement=0), "displacement = 0"), (dict(ids, displacement=math.nan), "displacement"),
                             (dict(ids, displacement=0.1, cycles=[1]), "give one of the two"), (dict(ids, cycles=[]), "cycles = []"), (dict(ids, cycles=[0.1, 0.1]), "cycles"),
                             (dict(ids, displacement=0.1, direction=(1, 1, 0)), "direction"), (dict(ids, displacement=0.1, direction=(0, 0, 1)), "direction"),
                             (dict(ids, displacement=0.1, speed=0), "speed = 0"), (dict(ids, displacement=1.0, speed=1e-9), "speed"),
                             (dict(ids=[base], displacement=0.1), "body 0 is prescribed"), (dict(ids=[7], displacement=0.1), "ids = 7"), (dict(ids=[], displacement=0.1), "ids = []"),
                             (dict(ids=[block, block], displacement=0.1), "once"), (dict(ids, displacement=0.1, height=2.5), "height = 2.5: must be from 0.002 to 1.998 m"),
                             (dict(ids, displacement=0.1, vertical="held", force=1.0), "force = 1"), (dict(ids, displacement=0.1, vertical="held", height=0.5), "height = 0.5"),
                             (dict(platens=[0], displacement=0.1, vertical="held"), "vertical = 'held'"), (dict(ids, displacement=0.1, vertical="load"), "force = None"),
                             (dict(ids, displacement=0.1, force=3.0), "vertical='load'"), (dict(ids, displacement=0.1, drop=2), "drop = 2"), (dict(ids, displacement=0.1, collapse=0), "collapse"),
                             (dict(ids, displacement=0.1, platens=[base]), "give one of the two"), (dict(platens=[block], displacement=0.1), "platens: 1"),
                             (dict(ids, cycles=[0.1, -0.1], clearance=-1), "clearance = -1")):
        refuses(lambda: dem.push(**arguments), words)
    assert len(O.bodies) == 2
    dem.block((WIDTH, DEPTH, HEIGHT), stone(), center=(-WIDTH, 0, HEIGHT / 2))
    refuses(lambda: dem.push(ids=[block], displacement=0.1), "block 2 is in the way of a platen at block 1")
    push = dem.push(ids=[2], displacement=0.1)
    refuses(lambda: dem.run(until=push), "O.engines is empty")
    O.engines = quiet_engines()
    refuses(lambda: dem.run(until=push), "this push moves nothing")
    for wrong in (0, 1.5, "1"):
        refuses(lambda: dem.collapsed(wrong), "blocks")


def test_a_push_that_is_saved(tmp_path):
    """It goes on with the same bits; the recorder of the loaded scene has the whole curve. Only the sample at which it was saved has, once loaded, the forces of the step
    after it: of two joints, eight numbers each."""
    def scene():
        O.reset()
        block = dem.block((WIDTH, DEPTH, HEIGHT), stone(), on=ground())
        push = dem.push(ids=[block], displacement=0.01, vertical="load", force=1e4)
        O.engines = quiet_engines(push, model="planar")
        return push

    push = scene()
    dem.run(until=push)
    whole = [np.frombuffer(numbers) for numbers in (push.recorder.jointForcesAsBytes(), push.recorder.posesAsBytes())]
    scene()
    dem.run(0.5)
    O.save(str(tmp_path / "push.yade.gz"))
    O.load(str(tmp_path / "push.yade.gz"), quiet=True)
    dem.run(until=O.engines[-1].motions)
    recorder = next(engine for engine in O.engines if isinstance(engine, dem.WallRecorder))
    for before, numbers, differ in zip(whole, (recorder.jointForcesAsBytes(), recorder.posesAsBytes()), (16, 0)):
        after = np.frombuffer(numbers)
        assert abs(len(before) - len(after)) < 100 < len(after)
        count = min(len(before), len(after))
        assert np.count_nonzero(before[:count] != after[:count]) <= differ


def test_a_surface_without_friction():
    """A block whose contacts do not slip slides on a base with the friction angle 0: the force is that of its inertia, at most 0.02 m/s^2, and its speed gives work that no
    friction takes. On a base with friction it does not slide but turns."""
    for angle, slides in ((0, True), (0.5, False)):
        O.reset()
        base = dem.base((6, 4, 0.2), dem.BlockMat(density=2000, frictionAngle=angle))
        block = dem.block((WIDTH, DEPTH, 0.6), dem.BlockMat(density=2000, noSlip=True), on=base)
        push = dem.push(ids=[block], displacement=0.01, height=0.4)
        run(push, model="planar")
        force = push.largest_force[0]
        if slides:
            assert force < 1.05 * 0.02 * O.bodies[block].state.mass and dem.energy()["frictDissip"] < 1e-9 and abs(dem.angle(block)) < 1e-9
        else:
            assert abs(force / (weight([block]) * WIDTH / 2 / 0.4) - 1) < 2 * CLOSE and dem.angle(block) > 0.01  # squat: more inertia for its height
