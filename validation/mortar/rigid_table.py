"""The cases of rigid blocks (method='wall'), each with steps of 0.25, 1 and 2 ms: rows of the table that table.py prints."""

import math

import numpy as np
from masonry import Record, dem
from masonry.dem.platens import platen
from mortar_scene import AREA, EINDHOVEN, SIZE, brick_material, eindhoven
from rocking_scene import quiet_engines, steps
from yade import O, Vector3

STEPS = 2.5e-4, 1e-3, 2e-3  # s
G = 9.81
HEAVY = 2e3  # kg: its weight is four times what mortar pulls
STRENGTH, ENERGY, COHESION, SHEAR_ENERGY = (EINDHOVEN[name] for name in ("tensileStrength", "fractureEnergy", "cohesion", "shearFractureEnergy"))
FRICTION = math.tan(EINDHOVEN["frictionAngle"])


def rigid(*arguments, dt, **options):
    O.engines = quiet_engines(*arguments, model="auto", method="wall", dt=dt, **options)


def brick(dt):
    """Id of a brick on a base, bonded."""
    O.reset()
    material = brick_material()
    one = dem.block(SIZE, material, on=dem.base((0.5, 0.2, 0.1), material))
    rigid(dt=dt)
    steps(5)
    return one


def guided(dt):
    """Ids of a heavy block, which stays where it is, and of a brick that is bonded to it and goes where its velocity says."""
    O.reset()
    stone = dem.BlockMat(density=1900, frictionAngle=EINDHOVEN["frictionAngle"])
    foot = dem.block((0.5, SIZE[1], 0.1), brick_material(), on=dem.base((2, SIZE[1], 0.1), stone))
    O.bodies[foot].state.mass, O.bodies[foot].state.inertia = HEAVY, (HEAVY, HEAVY, HEAVY)
    one = dem.block(SIZE, brick_material(), on=foot)
    O.bodies[one].dynamic = False
    rigid(dt=dt)
    steps(5)
    return foot, one


def ramp(load, most, dt):
    """A load that grows evenly to `most` in 2 s. Returns the one at which the joint cracks."""
    first, begun = None, O.time
    while O.time - begun < 2 and dem.damage()["damage"][0] < 1:
        now = most * (O.time - begun) / 2
        load(now)
        O.step()
        if first is None and dem.damage()["worst"][0] > 0.02:
            first = now
    return first


def a1_pull(dt):
    one = brick(dt)
    first = ramp(lambda force: O.forces.setPermF(one, (0, 0, force)), 5500, dt)
    yield "pull: force at which it cracks, N", 5000 + G * O.bodies[one].state.mass, first, 1e-2
    yield "energy of the crack, J (the last 0.1 % is not spent)", 0.999 * ENERGY * AREA, dem.energy()["crackDissip"], 1e-2


def grown(speed, begun):
    """A speed that grows evenly in 50 ms: a blow would be another case."""
    return speed * min(1, (O.time - begun + O.dt) / 0.05)


def slip(speed, pressure, dt):
    """(slips, stresses) of a couplet whose base moves while a platen at the foot of the brick stops it, m and Pa, until the mortar is broken, and 20 steps more.
    Stresses are means over steps, slips those at their middle."""
    O.reset()
    material = brick_material()
    base = dem.base((0.5, 0.2, 0.1), material)
    one = dem.block(SIZE, material, on=base, at=(0.2, 0))  # flush with the end of the base
    stop = platen(one, np.array([1.0, 0, 0]), 2e-3 * SIZE[2], 1, 0.0)
    O.forces.setPermF(one, (0, 0, G * O.bodies[one].state.mass - pressure * AREA))
    rigid(dt=dt)
    steps(5)
    begun, found, left, state = O.time, [], 20, O.bodies[base].state
    while left:
        before = state.pos[0]
        state.vel = Vector3(grown(speed, begun), 0, 0)
        O.step()
        found.append(((before + state.pos[0]) / 2, abs(dem.reactions(stop)["force"].sum(axis=0)[0]) / AREA))
        left -= dem.damage()["damage"][0] == 1
    return np.array(found).T


def a2_couplet(dt):
    for pressure in (0, 0.1e6, 1e6):
        ways, stresses = slip(0.01, pressure, dt)
        name = f", {1e-6 * pressure:g} MPa"
        yield "couplet: peak stress, MPa" + name, 1e-6 * (COHESION + FRICTION * pressure), 1e-6 * stresses.max(), 2e-2
        yield "cohesion at the slip G/c, MPa" + name, 1e-6 * COHESION / np.e, 1e-6 * (np.interp(SHEAR_ENERGY / COHESION, ways, stresses) - FRICTION * pressure), 2e-2
        yield "residual stress, MPa" + name, 1e-6 * FRICTION * pressure, 1e-6 * stresses[-1], 1e-2
        yield "energy of the crack, J" + name, 0.999 * SHEAR_ENERGY * AREA, dem.energy()["crackDissip"], 1e-2


def a3_wrench(dt):
    """M(q) = f_t b h^2 (1 - (1 + q) exp(-q))/q^2, q = turn h f_t/G, about the edge. Two points, at h (1/2 - 1/(2 sqrt(3))) and h (1/2 + 1/(2 sqrt(3))), have its
    integral and are within 2 % of it up to q = 1.5; where they are farther off, theirs is the right value."""
    one = brick(dt)
    weight = G * O.bodies[one].state.mass
    expected = (STRENGTH * AREA + weight) * SIZE[0] / 2
    yield "wrench: moment at which it cracks, N m", expected, ramp(lambda moment: O.forces.setPermT(one, (0, moment, 0)), 1.1 * expected, dt), 2e-2
    yield "wrench: energy of the crack, J", 0.999 * ENERGY * AREA, dem.energy()["crackDissip"], 2e-2
    foot, one = guided(dt)
    spin, edge, state = 0.01, Vector3(SIZE[0] / 2, 0, -SIZE[2] / 2), O.bodies[one].state  # rad/s; from the centre to the edge
    begun, found = O.time, []
    while dem.angle(one) < 3.1e-3:
        to_edge = state.ori * edge
        turn, now = dem.angle(one), grown(spin, begun)
        state.angVel, state.vel = Vector3(0, now, 0), Vector3(0, now, 0).cross(-to_edge)
        at = np.array(state.pos + to_edge)
        O.step()
        force = next(each for each in dem.joint_forces() if {each["id1"], each["id2"]} == {foot, one})
        found.append((abs(turn + dem.angle(one)) / 2, abs(np.cross(force["point"] - at, force["force"])[1])))
    turns, moments = np.array(found).T
    whole, points = STRENGTH * SIZE[1] * SIZE[0] ** 2, 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3)
    for turn in (1e-4, 5e-4, 1e-3, 3e-3):
        q = turn * SIZE[0] * STRENGTH / ENERGY
        exact, two = whole * (1 - (1 + q) * math.exp(-q)) / q**2, whole * (points * np.exp(-q * points)).mean()
        yield f"wrench: moment at {turn:g} rad, N m (two points; even mortar {exact:.1f})", two, np.interp(turn, turns, moments), 2e-2


def a5_thrown(dt):
    for ratio in (0.5, 1.1, 1.5, 3, 10):
        one, energy = brick(dt), ENERGY * AREA
        state = O.bodies[one].state
        O.forces.setPermF(one, (0, 0, G * state.mass))
        steps(2)
        state.vel = (0, 0, math.sqrt(2 * ratio * energy / state.mass))
        steps(max(20, int(0.02 / dt)))
        yield f"brick thrown with {ratio:g} G A: kinetic energy spent, of G A", min(ratio, 0.999), ratio - 0.5 * state.mass * state.vel.squaredNorm() / energy, 2e-2
        yield "mean damage", min(ratio, 1), dem.damage()["damage"][0], 3e-2


def a5_struck(dt):
    """The same by a base that jumps down, a Dirac pulse."""
    for ratio in (0.5, 1.1, 1.5, 3, 10):
        O.reset()
        material, energy = brick_material(), ENERGY * AREA
        base = dem.base((0.5, 0.2, 0.1), material)
        one = dem.block(SIZE, material, on=base)
        state = O.bodies[one].state
        O.forces.setPermF(one, (0, 0, G * state.mass))
        rigid(dem.PulseTrainEngine(ids=[base], impulse=math.sqrt(2 * ratio * energy / state.mass), times=[2.5 * dt], direction=(0, 0, -1)), dt=dt)
        steps(10)
        left = 0.5 * state.mass * (state.vel - O.bodies[base].state.vel).squaredNorm() / energy
        yield f"brick struck by a Dirac pulse with {ratio:g} G A: energy spent, of G A", min(ratio, 0.999), ratio - left, 2e-2
        yield "mean damage", min(ratio, 1), dem.damage()["damage"][0], 3e-2


def pull_sideways(start, rate, most):
    """The sideways gravity, g, at which the first joint cracks: it grows by `rate` in g/s."""
    while O.time < most:
        O.engines[-1].gravity = Vector3(G * (start + rate * O.time), 0, -G)
        steps(max(1, round(5e-3 / O.dt)))
        if dem.damage()["worst"].max() > 0.02:
            break
    return start + rate * O.time


def a6_parapet(dt):
    O.reset()
    material = brick_material(eindhoven(tensileStrength=0.05e6, cohesion=0.07e6))
    dem.stack(8, (0.2, 0.5, 0.2), material, on=dem.base((2, 2, 0.1), material))
    rigid(dt=dt)
    right = 0.2 / 1.6 * (1 + 0.05e6 / (1900 * G * 1.6))
    found = pull_sideways(0.8 * right, 0.02, 10)
    yield "parapet of 8 blocks: acceleration that cracks it, g", right, found, 1e-2
    yield "the joint: 0 is the lowest", 0, float(np.argmax(dem.damage()["worst"])), 0


def a7_between_supports(dt):
    for height, thickness, courses, strength in ((2.4, 0.11, 12, 0.1e6), (3.0, 0.22, 20, 0.2e6)):
        places = np.arange(1, courses) * height / courses
        each = (strength + 1900 * G * (height - places)) * thickness / (1900 * places * (height - places)) / G
        O.reset()
        material = brick_material(eindhoven(tensileStrength=strength, cohesion=1.4 * strength))
        foot = dem.base((0.02 * thickness, 1, 0.1), dem.BlockMat(density=1900, frictionAngle=1.2))
        ids = dem.stack(courses, (thickness, 0.5, height / courses), material, on=foot)
        platen(ids[-1], np.array([1.0, 0, 0]), height * (1 - 2e-3), 1, 0.0)
        rigid(dt=dt)
        found = pull_sideways(0.8 * each.min(), 0.05, 20)
        yield f"wall of {height:g} x {thickness:g} m between supports: acceleration that cracks it, g", each.min(), found, 2e-2
        yield "the joint", 1 + each.argmin(), 1 + float(np.argmax(dem.damage()["worst"])), 0


def sine(peak, frequency, duration):
    times = np.arange(0, duration + 5e-4, 1e-3)
    return Record(1e-3, peak * G * np.sin(2 * np.pi * frequency * times))


def a8_sound(dt):
    for share in (0.8, 0.95):
        O.reset()
        material = brick_material(eindhoven(tensileStrength=0.1e6, cohesion=0.14e6, fractureEnergy=7, shearFractureEnergy=49))
        base = dem.base((2, 2, 0.1), material)
        dem.stack(20, (0.11, 0.5, 0.15), material, on=base)
        strength = 0.11 / 3 * (1 + 0.1e6 / (1900 * G * 3))
        rigid(dem.record_motion(sine(share * strength, 3, 5), [base]), dt=dt)
        O.run(int(5 / dt), True)
        yield f"stack of 20 shaken at {share:g} of its strength, 5 s: largest damage", 0, dem.damage()["worst"].max(), 0


def shaken_wall(dt, courses, per_course, strength, peak, frequency, duration=0.5, at=0.0, mirrored=1, turned=False, threads=1):
    """A wall that a sine shakes until it cracks: (mean damage, dem.damage(), energy made over what has been turned over)."""
    O.reset()
    material = brick_material(eindhoven(tensileStrength=strength, cohesion=1.4 * strength))
    base = dem.base((4, 1, 0.2) if not turned else (1, 4, 0.2), material)
    dem.wall(courses, per_course, (0.2, 0.1, 0.1), material, on=base, along=(0, 1) if turned else (1, 0))
    rigid(dem.record_motion(sine(mirrored * peak, frequency, duration), [base], direction=(0, 1, 0) if turned else (1, 0, 0)), dt=dt)
    O.engines[-1].ompThreads = threads
    O.run(int(round(duration / dt)), True)
    table, engine = dem.damage(), O.engines[-1]
    return (table["damage"] * table["area"]).sum() / table["area"].sum(), table, engine.madeEnergy / engine.turnedOver


def a9_steps(dt):
    """Right values are those of the step of 0.25 ms of this run for the others: a comparison of steps."""
    for case in ((4, 3, 0.01e6, 3, 4), (6, 3, 0.02e6, 5, 3)):
        name = f"wall of {case[0]} x {case[1]}, {case[3]} g, {case[4]} Hz: "
        if case not in FIRST:
            FIRST[case] = shaken_wall(STEPS[0], *case)
        mean, _, made = FIRST[case] if dt == STEPS[0] else shaken_wall(dt, *case)
        yield name + "mean damage (right: that of 0.25 ms)", FIRST[case][0], mean, 5e-2
        yield name + "energy made, of what is turned over", 0, made, 1e-3


FIRST = {}


def a10_mixed(dt):
    """Opening and slip grow alike: (f_t + c)/(f_t/G_I + c/G_II) for each area."""
    _, one = guided(dt)
    begun = O.time
    while dem.damage()["damage"][0] < 1:
        O.bodies[one].state.vel = Vector3(1, 0, 1) * grown(0.01, begun)
        O.step()
    expected = (STRENGTH + COHESION) / (STRENGTH / ENERGY + COHESION / SHEAR_ENERGY)
    yield "slip equal to opening: energy of the crack, J/m^2", 0.999 * expected, dem.energy()["crackDissip"] / AREA, 1e-2


def a12_symmetry(dt):
    case = 6, 3, 0.02e6, 5, 3
    mean, table, _ = shaken_wall(dt, *case, duration=0.3)
    energy = (table["energy_tension"] + table["energy_shear"]).sum()
    yield "wall that cracks: energies of its joints over crackDissip", 1, energy / dem.energy()["crackDissip"], 1e-9
    for name, change in (("turned to y", {"turned": True}), ("with 4 threads", {"threads": 4})):
        yield f"largest difference of D to the wall {name}", 0, np.abs(shaken_wall(dt, *case, duration=0.3, **change)[1]["damage"] - table["damage"]).max(), 1e-9
    yield "difference of the mean damage to the mirrored wall", 0, abs(mean - shaken_wall(dt, *case, duration=0.3, mirrored=-1)[0]), 1e-6


# Rows that are known not to hold, and why they do not stands in the README.
MISSED = "cohesion at the slip G/c", "wall of 6 x 3, 5 g, 3 Hz: mean damage", "difference of the mean damage"
CASES = [a1_pull, a2_couplet, a3_wrench, a5_thrown, a5_struck, a6_parapet, a7_between_supports, a8_sound, a9_steps, a10_mixed, a12_symmetry]


def rows(case):
    """Rows of the case: (quantity, right value, [found, a step each], allowed)."""
    found = [list(case(dt)) for dt in STEPS]
    return [(*one[0][:2], [each[2] for each in one], one[0][3]) for one in zip(*found)]


def table(wanted, name_of):
    """Prints the rows; returns whether all of them hold."""
    good = True
    print("\n| case | quantity | right value | `wall` at 0.25, 1, 2 ms | allowed | holds |\n|" + " --- |" * 6)
    for case in CASES:
        for quantity, right, found, allowed in rows(case) if not wanted or name_of(case) in wanted else ():
            holds = all(abs(one - right) <= allowed * (abs(right) or 1) for one in found)
            good &= holds or quantity.startswith(MISSED)
            print(f"| {name_of(case)} | {quantity} | {right:.4g} | {', '.join(f'{one:.4g}' for one in found)} | {allowed:g} | {'yes' if holds else 'missed' if quantity.startswith(MISSED) else '**NO**'} |", flush=True)
    return good
