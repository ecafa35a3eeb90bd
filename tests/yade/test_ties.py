"""Ties (dem.tie): closed forms, the balance of energies, both methods against each other, bits after loading, results."""

import math

import numpy as np
import pytest
from masonry import dem, results
from rocking_scene import Balance, quiet_engines, refuses, refuses_to_run, rigid_engines, stone
from yade import O, Vector3

import masonry

B, A = 0.25, 1.0  # half width and half height of a block, m
DEPTH = 0.8
STIFF = 1e8  # N/m: 2 x 10^-5 m under the weight of the block
EACH = [(model, walls) for model in ("planar", "spatial") for walls in (False, True)]
EVERY = [*EACH, ("compliant", False)]


def engines(model, walls=False, motion=None, **options):
    """walls: by the step of walls, also where there are few blocks."""
    if model == "compliant":
        return quiet_engines(motion, **options)
    made = rigid_engines(motion, model=model, method="wall" if walls else "localised", **options)
    made[-1].wallsOnly = walls
    return made


def held_block(stiffness=STIFF, **how):
    """(base, block, tie): a tie from the upper left edge of a block to a point of the base 3 m to the left."""
    O.reset()
    base = dem.base((12, 4, 0.5), stone(0.8))
    block = dem.block((2 * B, DEPTH, 2 * A), O.bodies[base].mat, on=base)
    return base, block, dem.tie(block, (-B, 0, 2 * A), base, (-B - 3, 0, 2 * A), stiffness, **how)


def weight(block=1):
    return 9.81 * O.bodies[block].state.mass


def needed(sideways):
    """Force of the tie at the top that keeps the block from turning about its right edge, under so many g to the right: moments."""
    return weight() * (sideways * A - B) / (2 * A)


def pull(sideways):
    O.engines[-1].gravity = (9.81 * sideways, 0, -9.81)


@pytest.mark.parametrize("model, walls", EVERY)
@pytest.mark.parametrize("strength", (0.9, 1.1))
def test_a_tie_holds_a_block_up_to_its_strength(model, walls, strength):
    """Moments about the toe give the force; with less strength than that the tie breaks and the block overturns, with more it stands. On compliant joints the block
    vibrates on the tie: the force is the mean."""
    _, block, tie = held_block(pretension=0)
    sideways = 0.45
    tie.pretension, tie.strength = needed(sideways), strength * needed(sideways) if strength > 1 else math.inf
    O.engines = engines(model, walls)
    pull(sideways)
    if strength < 1:
        forces = []
        while O.time < 0.1:
            O.step()
            forces.append(tie.force)
        assert not tie.broken and abs(np.mean(forces) / needed(sideways) - 1) < 0.02, (np.mean(forces), needed(sideways))
        tie.strength = strength * needed(sideways)
    dem.run(1.0)
    print(f"{model}, walls={walls}: force {tie.force:.1f} of {needed(sideways):.1f} N, broken {tie.broken} at {tie.brokenAt}, angle {dem.angle(block):.4f}")
    assert tie.broken == (strength < 1)
    assert (abs(dem.angle(block)) > 0.3) == (strength < 1)
    assert math.isfinite(tie.brokenAt) == tie.broken and (tie.force == 0) == tie.broken


@pytest.mark.parametrize("model, walls", EACH)
@pytest.mark.parametrize("stiffness", (1e6, 1e9, 1e12))
def test_no_stiffness_bounds_the_step(model, walls, stiffness):
    """The period of 1e12 N/m is 0.05 of the step. A block that is pulled at once settles in its equilibrium: its mean force is that of the moments, and
    dissipated and elastic energies close the balance. The step of walls leaves penetrations of 5e-6 of the half size, which a stiff tie takes for its own extension: then
    the base bears what the tie pulls more than it must."""
    _, block, tie = held_block(stiffness)
    O.engines = engines(model, walls)
    dt, sideways = O.dt, 0.4
    pull(sideways)
    balance, force = Balance(), []
    for _ in range(600):
        O.step()
        force.append(tie.force)
    e = dem.energy()
    mean = np.mean(force[100:])
    print(f"{model}, walls={walls}, k={stiffness:.0e}: mean {mean:.1f} of {needed(sideways):.1f} N, largest {max(force):.1f}, angle {dem.angle(block):.2e}, "
          f"balance {balance.error():.2e} J, {e}, failures {O.engines[-1].failures}")
    assert O.dt == dt and O.engines[-1].failures == 0
    assert not tie.broken and abs(mean - needed(sideways)) < 0.1 * needed(sideways) + (5e-6 * B * stiffness if walls else 0)  # the softest tie swings in the last period too
    # It swings between 0 and twice the static elongation at most.
    assert abs(dem.angle(block)) * 2 * A < 2.2 * needed(sideways) / stiffness + 1e-5
    assert abs(balance.error()) < 1e-3 * weight() * A


@pytest.mark.parametrize("model, walls", EVERY)
def test_the_period_of_a_block_between_two_ties(model, walls):
    """x = v/w sin w t with w^2 = 2 k/m, while neither goes slack. The trapezoidal rule is slow by (w dt)^2/12 of the phase, the leapfrog scheme fast by (w dt)^2/24; walls start half a step off, and at their default tolerance
    velocities that change in each step lag behind."""
    O.reset()
    material = stone(noSlip=False, frictionAngle=0)
    base = dem.base((12, 4, 0.5), material)
    block = dem.block((1, 1, 1), material, on=base)
    omega, speed = 2 * math.pi * 5, 0.1
    k = O.bodies[block].state.mass * omega**2 / 2
    ties = [dem.tie(block, (side * 0.5, 0, 0.5), base, (side * 4, 0, 0.5), k, pretension=2 * k * speed / omega) for side in (-1, 1)]
    O.engines = engines(model, walls, **({} if model == "compliant" else {"dt": 1e-3}), **({"tolerance": 1e-5} if walls else {}))
    O.bodies[block].state.vel = Vector3(speed, 0, 0)
    balance, worst = Balance(), 0
    while O.time < 0.6:
        O.step()
        worst = max(worst, abs(O.bodies[block].state.pos[0] - speed / omega * math.sin(omega * O.time)))
    print(f"{model}, walls={walls}: off by {worst / speed * omega:.4f} of the amplitude, balance {balance.error():.2e} J, dissipated {dem.energy()['dampDissip']:.2e} J")
    assert worst < (0.02 if walls else 0.005) * speed / omega
    assert abs(balance.error()) < 1e-3 * O.bodies[block].state.mass * speed**2
    assert all(tie.force > 0 for tie in ties)


def two_stacks(base, material):
    return [dem.stack(3, (0.4, 0.6, 0.5), material, base, at=(x, 0)) for x in (-1, 1)]


def shaken(model, walls, stiffness=1e7, **how):
    """Two stacks joined at their tops, and one of them tied to the base, on a record."""
    O.reset()
    material = stone(0.5, noSlip=False, frictionAngle=0.6)
    base = dem.base((12, 4, 0.5), material)
    left, right = two_stacks(base, material)
    made = [dem.tie(left[-1], (-0.8, 0, 1.4), right[-1], (0.8, 0, 1.4), stiffness), dem.tie(left[-1], (-1.2, 0, 1.4), base, (-4, 0, 1.4), stiffness, 2e3, 4e4)]
    recorder = dem.WallRecorder(virtPeriod=0.01)
    motion = dem.record_motion(masonry.artificial_record(seed=5, peak=4, duration=2), ids=[base])
    O.engines = engines(model, walls, motion, recorder=recorder, **how)
    return made, recorder, motion


@pytest.mark.parametrize("model, walls", [("planar", False), ("planar", True), ("spatial", True), ("compliant", False)])
def test_the_balance_of_energies_on_a_record(model, walls):
    """The balance of compliant joints misses 3e-3 to 4e-3 of the work of the base at steps of 5e-6 to 4e-5 s, which is 4e-4 of what is turned over; without ties 2e-3."""
    made, _, motion = shaken(model, walls)
    balance = Balance()
    dem.run(until=motion)
    e = dem.energy()
    print(f"{model}, walls={walls}: balance {balance.error():.2e} J, {e}, forces {[tie.force for tie in made]}")
    in_ties = sum(tie.energy for tie in made)
    assert e["elastPotential"] > in_ties if model == "compliant" else e["elastPotential"] == pytest.approx(in_ties)  # joints have some too
    assert abs(balance.error()) < (5e-3 if model == "compliant" else 2e-3) * e["baseWork"]
    assert e["dampDissip"] > -1e-3 * e["baseWork"]


@pytest.mark.parametrize("other, stiffness, share", ((("planar", True), 1e7, 0.01), (("compliant", False), 1e6, 0.05)))
def test_localised_against_others(other, stiffness, share):
    """The ties of shaken stacks carry as much by all methods: the mean force of the one to the base, which has a pretension, within a hundredth, on compliant joints
    within 60 N, which is 0.06 mm of slip; of that between the stacks, which is slack most of the time, within a quarter, since single impacts are chaotic."""
    means = []
    for model, walls in (("planar", False), other):
        _, recorder, motion = shaken(model, walls, stiffness)
        dem.run(until=motion)
        history = dem.wall_history(recorder)
        means.append(history.ties["force"].mean(axis=0))
    print("mean forces", means)
    assert (np.abs(means[0] / means[1] - 1) < (0.25, share)).all()


def rows():
    return [x for b in O.bodies for x in (*b.state.pos, *b.state.ori, *b.state.vel, *b.state.angVel)] + [
        x for tie in dem.ties() for x in (tie.force, tie.extension, tie.energy, tie.broken)] + list(dem.energy().values())


@pytest.mark.parametrize("model, walls", EVERY)
def test_saved_and_loaded(model, walls, tmp_path):
    """The second tie breaks in the second half, which has the bits of a run that was not interrupted."""
    made, _, _ = shaken(model, walls, **({} if model == "compliant" else {"dt": 1e-3}))
    made[1].strength = 5e3  # the largest force is 7 to 9 kN, at 0.76 s
    half = round(0.6 / O.dt)
    O.run(half, True)
    O.save(str(tmp_path / "half.xml"))
    O.run(half, True)
    whole, broken = rows(), dem.ties()[1].broken
    O.load(str(tmp_path / "half.xml"))
    assert len(dem.ties()) == 2 and dem.ties()[0].stiffness == 1e7
    O.run(half, True)
    print(f"{model}, walls={walls}: broken {broken}")
    assert rows() == whole and broken


def test_a_tie_joins_structures():
    O.reset()
    material = stone()
    base = dem.base((12, 4, 0.5), material)
    left, right = two_stacks(base, material)
    assert [len(ids) for ids in dem.structures()] == [3, 3]
    tie = dem.tie(left[-1], (-0.8, 0, 1.4), right[-1], (0.8, 0, 1.4), 1e7)
    assert [len(ids) for ids in dem.structures()] == [6] and dem.ties() == [tie]
    tie.dead = True
    assert [len(ids) for ids in dem.structures()] == [3, 3]


def test_a_tie_that_comes_and_goes_during_a_run():
    """Without a tie the block overturns; one that is made in the run stops it, and one that is dead lets it go on."""
    O.reset()
    base = dem.base((12, 4, 0.5), stone(0.8))
    block = dem.block((2 * B, DEPTH, 2 * A), O.bodies[base].mat, on=base)
    O.engines = engines("auto")
    pull(0.4)
    dem.run(0.3)
    turned = dem.angle(block)
    top = O.bodies[block].state.pos + O.bodies[block].state.ori * Vector3(-B, 0, A)
    tie = dem.tie(block, top, base, (top[0] - 3, 0, top[2]), STIFF)
    dem.run(0.5)
    held = dem.angle(block)
    tie.dead = True
    dem.run(0.5)
    assert turned > 1e-3 and held < turned + 0.01 and dem.angle(block) > held + 0.1, (turned, held, dem.angle(block))


def test_a_hanging_block():
    """It hangs on one tie below a prescribed beam: the force is its weight, also where it swings by nothing."""
    O.reset()
    beam = dem.base((1, 1, 0.2), stone())
    block = dem.block((0.3, 0.3, 0.3), O.bodies[beam].mat, center=(0, 0, -2))
    mass = O.bodies[block].state.mass
    tie = dem.tie(beam, (0, 0, -0.2), block, (0, 0, -1.85), 1e9, pretension=9.81 * mass)
    O.engines = quiet_engines(model="auto")
    dem.run(0.5)
    assert abs(tie.force / (9.81 * mass) - 1) < 1e-6 and abs(O.bodies[block].state.pos[2] + 2) < 1e-8, tie.force


@pytest.mark.parametrize("model, walls", EVERY)
@pytest.mark.parametrize("strength", (1.9, 2.1))
def test_a_weight_at_once_breaks_what_holds_less_than_twice_its_force(model, walls, strength):
    """A block that is let go on a strut without load sinks by m g/k (1 - cos w t), w^2 = k/m, by all models: they do not damp what their steps resolve. Its force reaches twice the
    weight, less (w h)^2/12, where `force` is the mean of a step h; positions are right to half a step of `wall`, w h/2."""
    O.reset()
    base = dem.base((4, 4, 0.2), stone())
    block = dem.block((0.4, 0.4, 0.4), O.bodies[base].mat, center=(0, 0, 1))
    k, heavy = 1e6, weight(block)
    omega = math.sqrt(k * 9.81 / heavy)
    strut = dem.tie(block, (0, 0, 1.2), base, (0, 0, 3), k, tension_only=False, strength=strength * heavy)
    O.engines = engines(model, walls, dt=0.04 / omega)
    balance, worst, largest = Balance(), 0, 0
    while O.time < 6 * math.pi / omega and not strut.broken:
        O.step()
        worst = max(worst, abs(1 - O.bodies[block].state.pos[2] - heavy / k * (1 - math.cos(omega * O.time))))
        largest = max(largest, strut.force / heavy)
    print(f"{model}, walls={walls}: off by {worst * k / heavy:.4f} of m g/k, largest force {largest:.4f} m g, balance {balance.error() * k / heavy**2:.1e}")
    assert strut.broken == (strength < 2) and worst < 0.022 * heavy / k
    assert strut.broken or abs(largest - 2) < 2e-3 and abs(balance.error()) < 5e-3 * heavy**2 / k


def test_the_critical_step_counts_ties():
    """A block that hangs on one tie through its centre, and nothing else: 2 sqrt(m/k); a longer step is refused."""
    O.reset()
    beam = dem.base((1, 1, 0.2), stone())
    block = dem.block((0.3, 0.3, 0.3), O.bodies[beam].mat, center=(0, 0, -2))
    mass, k = O.bodies[block].state.mass, 1e7
    tie = dem.tie(beam, (0, 0, -0.2), block, (0, 0, -2), k, pretension=9.81 * mass)
    O.engines = quiet_engines()
    engine = next(one for one in O.engines if isinstance(one, dem.RockingJointEngine))
    limit = 2 * math.sqrt(mass / k)
    assert abs(engine.criticalTimeStep() / limit - 1) < 1e-6 and abs(engine.largestTimeStep / limit - 1) < 2e-3
    refuses(lambda: quiet_engines(dt=1.01 * limit), "dt = ", "largest stable step")
    dem.run(0.3)
    assert abs(tie.force / (9.81 * mass) - 1) < 1e-6 and abs(O.bodies[block].state.pos[2] + 2) < 1e-8, tie.force
    O.dt = 1.01 * limit
    refuses(O.step, "O.dt", "must be positive and below", kind=RuntimeError)


@pytest.mark.parametrize("model", ("auto", "compliant"))
def test_results(model, tmp_path):
    _, recorder, motion = shaken(model, model == "auto")
    dem.run(0.3)
    history = dem.wall_history(recorder)
    assert history.ties.shape == (len(history.time), 2) and history.ties["body2"][0].tolist() == [6, 0]
    assert history.ties["force"][-1, 1] > 0 and np.isfinite(history.ties["energy"]).all()
    history.save(tmp_path / "wall.npz")
    assert (results.WallHistory.load(tmp_path / "wall.npz").ties == history.ties).all()
    history.to_csv(tmp_path / "wall.csv")
    assert "force of tie 1 (N)" in (tmp_path / "wall.csv").read_text().splitlines()[0]
    table = results.ties(history)
    assert table["force"][0] == history.ties["force"][:, 0].max() and not table["broken"].any() and np.isnan(table["broken_time"]).all()
    results.draw(history, tmp_path / "wall.png")
    results.report(history, tmp_path / "wall.html")
    assert "Forces of 2 ties" in (tmp_path / "wall.html").read_text()
    results.write_paraview(history, tmp_path / "wall.pvd", every=10)
    first = (tmp_path / "wall/wall_ties_000000.vtu").read_text()
    assert 'NumberOfPoints="4" NumberOfCells="2"' in first and 'part="1"' in (tmp_path / "wall.pvd").read_text()
    plain = results.WallHistory(history.time, history.ids, history.sizes, history.free, history.position, history.orientation)
    assert plain.ties is None and len(results.ties(plain)) == 0


def test_the_largest_forces_of_a_strut_and_of_a_tie_that_breaks(tmp_path):
    """A block is thrown to and fro between a strut and its toe; a tie that breaks between two samples shows the strength."""
    base, block, strut = held_block(tension_only=False)
    weak = dem.tie(block, (B, 0, 2 * A), base, (B + 3, 0, 2 * A), STIFF, strength=1200.0)
    recorder = dem.WallRecorder(virtPeriod=0.05)
    O.engines = engines("planar", recorder=recorder)
    for sideways in (0.45, -0.45):
        pull(sideways)
        dem.run(0.3)
    pull(-1.0)
    dem.run(0.2)
    history = dem.wall_history(recorder)
    table = results.ties(history)
    assert table["force"][0] == history.ties["force"][:, 0].max() > 0 and table["compression"][0] == -history.ties["force"][:, 0].min() > 0
    assert weak.broken and table["broken"].tolist() == [False, True] and table["force"][1] == 1200 and history.ties["force"][:, 1].max() <= 1200
    results.report(history, tmp_path / "wall.html")
    page = (tmp_path / "wall.html").read_text()
    for words in ("Compression (kN)", "1 tie: stiffness 1e+08 N/m, does not break, presses too", "1 tie: stiffness 1e+08 N/m, breaks at 1.2 kN", "Mass of the free blocks",
                  "12 × 4 × 0.5 m"):
        assert words in page, words


@pytest.mark.parametrize("walls", (False, True))
def test_reactions_of_the_base_have_the_tie(walls):
    """With the tie they balance the block's weight, and its moment about the middle of its foot."""
    _, block, tie = held_block(stiffness=1e7, pretension=0)
    tie.pretension = needed(0.4)
    recorder = dem.WallRecorder(iterPeriod=100, recordForces=True)
    O.engines = engines("planar", walls, recorder=recorder)
    pull(0.4)
    O.run(501, True)
    last = results.base_reactions(dem.wall_history(recorder))[-1]
    assert np.allclose(last["force"] / weight(), (-0.4, 0, 1), atol=5e-3), last
    assert np.allclose(last["moment"] / (weight() * A), (0, -0.4, 0), atol=5e-3), last


def test_what_is_refused():
    base, block, tie = held_block()
    place, other = (0, 0, 1), (-3, 0, 1)

    def with_(**changes):
        given = {"block1": block, "point1": place, "block2": base, "point2": other, "stiffness": 1e7, **changes}
        return lambda: dem.tie(**given)

    refuses(with_(block2=block), "block2 = 1", "another body")
    refuses(with_(block1=7), "block1 = 7", "no such body")
    refuses(with_(point1=(0, 0)), "point1 = (0, 0)", "three finite numbers, in m")
    refuses(with_(point2=place), "point2 = (0, 0, 1)", "same place")
    refuses(with_(stiffness=0), "stiffness = 0", "positive and finite, in N/m")
    refuses(with_(stiffness=math.inf), "stiffness = inf", "positive and finite")
    refuses(with_(strength=0), "strength = 0", "positive, in N")
    refuses(with_(pretension=2, strength=1), "pretension = 2", "at most the strength")
    refuses(with_(pretension=-1), "pretension = -1", "tension_only=False")
    refuses(with_(pretension=math.nan), "pretension = nan", "finite, in N")
    second = dem.base((1, 1, 1), O.bodies[base].mat, at=(20, 0))
    refuses(with_(block1=base, block2=second), "both are prescribed")
    refuses(lambda: setattr(tie, "stiffness", -1), "BlockTie.stiffness = -1", "positive and finite, in N/m")
    tie.body1 = 9
    O.engines = [dem.MoreauJeanIntegrator(ties=[tie])]
    O.dt = 1e-3
    refuses_to_run("BlockTie.body1 = 9", "id of a block or a base")
    refuses(lambda: dem.MoreauJeanIntegrator(ties=[O.engines[0]]), "MoreauJeanIntegrator.ties", "list of ties (BlockTie)")
    refuses(lambda: dem.RockingJointEngine(ties=[O.engines[0]]), "RockingJointEngine.ties", "list of ties (BlockTie)")


def test_a_tie_outside_the_plane_makes_a_scene_spatial():
    base, block, _ = held_block()
    assert dem.MoreauJeanIntegrator(ties=dem.ties()).choice().startswith("planar")
    dem.tie(block, (0, 0.2, 2 * A), base, (3, 0.2, 2 * A), STIFF)
    assert "does not lie in the mid-plane" in dem.MoreauJeanIntegrator(ties=dem.ties()).choice()
