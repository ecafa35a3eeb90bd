"""The hard cases. Each builds its scene and says by what it is judged: a closed form, an exact history, an integration of its own, or an invariant."""

import math
from dataclasses import dataclass
from typing import Callable

import numpy as np
from masonry import dem
from measures import quiet_engines
from yade import O, Quaternion, Vector3

import masonry

G = 9.81
ALL = ("planar", "spatial", "wall", "wall in space", "compliant")
IN_SPACE = ("spatial", "wall in space", "compliant")
RIGID = ("planar", "spatial", "wall", "wall in space")
LOCALISED = ("planar", "spatial")


@dataclass
class Scene:
    engines: Callable                      # the list for O.engines
    seconds: float                         # to be run, s
    error: Callable = lambda: 0.0          # after the run, relative; 0 where only invariants judge
    watch: Callable = None                 # called after every step
    work: Callable = lambda: 0.0           # of forces that are not the plugin's, J


@dataclass
class Case:
    name: str
    oracle: str
    build: Callable
    models: tuple
    bound: dict            # of the error, by model; 'any': of the others
    quick: bool = True     # takes part in `run --quick`


CASES = {}


def case(oracle, bound, models=ALL, quick=True, **bounds):
    def take(build):
        name = build.__name__
        CASES[name] = Case(name, oracle, build, models, {"any": bound, **{k.replace("_", " "): v for k, v in bounds.items()}}, quick)
        return build
    return take


def variants(**named):
    """The same scene with other numbers: one case each, the name followed by the number."""
    def take(build_with):
        for label, (value, oracle, bound, options) in named.items():
            def build(value=value, **how):
                return build_with(value, **how)
            build.__name__ = f"{build_with.__name__}_{label}"
            case(oracle, bound, **options)(build)
        return build_with
    return take


def stone(**attributes):
    return dem.BlockMat(**{"density": 2000, **attributes})


def drift(ids):
    """Function that gives the largest way that blocks have gone since now, relative to their smallest half size."""
    start = {i: Vector3(O.bodies[i].state.pos) for i in ids}
    size = min(min(O.bodies[i].shape.extents) for i in ids)
    return lambda: max((O.bodies[i].state.pos - start[i]).norm() for i in ids) / size


def turn_all(ids, angle, pivot):
    """Turns blocks as one rigid body about the y axis through a point."""
    q = Quaternion(Vector3.UnitY, angle)
    for i in ids:
        state = O.bodies[i].state
        state.pos, state.ori = pivot + q * (state.pos - pivot), q * state.ori


# --- one block ---


def rocking(slenderness, restitution, seconds, half_width=0.1, start=0.5, **how):
    block = masonry.RockingBlock(half_width, half_width * slenderness)
    material = stone(noSlip=True, **({} if restitution is None else {"restitution": restitution}))
    base = dem.base((2 + 8 * half_width * (1 + slenderness), 2, 0.2), material)
    id = dem.block((2 * half_width, 0.5, 2 * half_width * slenderness), material, on=base)
    angle = start * block.critical_angle
    dem.tilt(id, angle)
    exact = masonry.simulate(block, restitution=max(0.0, block.natural_restitution) if restitution is None else restitution, initial_angle=angle, t_end=2 * seconds)
    return Scene(lambda: quiet_engines(**how), seconds, lambda: abs(dem.angle(id) - np.nan_to_num(exact.sample(O.time)[0])) / angle)


@variants(**{label: ((slenderness, seconds), "exact history", 1e-2, {"models": ALL}) for label, slenderness, seconds in
             (("0_2", 0.2, 0.4), ("1", 1.0, 0.5), ("5", 5.0, 1.5), ("50", 50.0, 2.0))})
def slenderness(given, **how):
    return rocking(given[0], None, given[1], half_width=0.1 if given[0] < 10 else 0.02, **how)


@variants(**{label: (C, "exact history", 1e-2, {"models": ALL}) for label, C in (("0", 0.0), ("0_5", 0.5), ("1", 1.0))})
def restitution(C, **how):
    return rocking(5.0, C, 1.5, **how)


@case("exact history: at rest", 1e-3)
def zeno_end(**how):
    return rocking(4.0, 0.5, 2.0, **how)


@case("exact history: the half cycle in which it overturns", 0.5, models=("planar", "spatial", "compliant"), quick=False)
def resonant_train_to_overturning(**how):
    block = masonry.RockingBlock(0.3, 1.5)
    material = stone(noSlip=True, restitution=0.8)
    base = dem.base((8, 4, 0.2), material)
    id = dem.block((0.6, 1, 3), material, on=base)
    train = dem.PulseTrainEngine(ids=[base], impulse=0.0125 * G, resonantBlock=id)
    exact = masonry.simulate(block, masonry.PulseTrain(0.0125 * G), restitution=0.8, half_cycles=20)
    return Scene(lambda: quiet_engines(train, **how), float(exact.impact_times[-1]) + 2,
                 lambda: abs(len(dem.impacts()) + 1 - int(exact.overturn_half_cycle)) if id in dem.overturned() else 99.0)


@case("energy alone: an unstable equilibrium has no other oracle", 1.0)
def balance_on_an_edge(**how):
    return rocking(3.0, 0.7, 1.0, start=1.0, **how)


@case("energy alone", 1.0, models=IN_SPACE)
def balance_on_a_corner(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((4, 4, 0.2), material)
    up = Quaternion()
    up.setFromTwoVectors(Vector3(1, 1, 1), Vector3.UnitZ)
    dem.block((0.2, 0.2, 0.2), material, center=(0, 0, 0.1 * math.sqrt(3)), orientation=up)
    return Scene(lambda: quiet_engines(**how), 1.0)


@case("Euler's equations, integrated by DOP853", 1e-2, models=IN_SPACE)
def spin_about_the_middle_axis(**how):
    from scipy.integrate import solve_ivp

    material = stone(frictionAngle=0.5)
    dem.base((1, 1, 0.2), material)
    O.bodies[0].state.pos = (0, 0, -60)
    id = dem.block((0.2, 0.3, 0.5), material, center=(0, 0, 0))
    state = O.bodies[id].state
    spin = Vector3(0.01, 6, 0.01)
    state.angVel, state.angMom = spin, Vector3(*(state.inertia[k] * spin[k] for k in range(3)))
    inertia = np.array(tuple(state.inertia))
    momentum = np.array(tuple(state.angMom))

    def right(_, y):
        w, q = y[:3], y[3:]
        v, s = q[:3], q[3]
        return np.concatenate([np.cross(inertia * w, w) / inertia, 0.5 * (s * w + np.cross(v, w)), [-0.5 * v @ w]])

    def error():
        end = solve_ivp(right, (0, O.time), [*spin, 0, 0, 0, 1], method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        q = Quaternion(end[6], *end[3:6])
        turned = np.array(tuple(state.ori * Vector3.UnitY)) - np.array(tuple(q * Vector3.UnitY))
        now = np.array(tuple(state.ori * Vector3(*(inertia[k] * (state.ori.conjugate() * state.angVel)[k] for k in range(3)))))
        return max(np.linalg.norm(turned) / 2, np.linalg.norm(now - momentum) / np.linalg.norm(momentum))

    return Scene(lambda: quiet_engines(**how), 3.0, error)


@case("kinetic energy: no gravity, so it cannot rise", 1e-3, models=("spatial", "wall in space"))
def fast_spin(**how):
    for size, pos, q, w, mu, C in (((.3374, .0777, .0699), (.014, -.389, .427), (-.357, -.461, .298, .756), (-.9, -17.4, 18.1), 1.7, 1),
                                   ((.3374, .0084, .0108), (.388, -.088, .304), (.254, .788, -.552, -.095), (424.3, -1064.5, 121.3), 0, math.nan)):
        q = Quaternion(*q)
        q.normalize()
        id = dem.block(size, stone(frictionAngle=math.atan(mu), restitution=C), center=pos, orientation=q)
        O.bodies[id].state.angVel = Vector3(*w)
    how.setdefault("dt", 1e-3)
    return Scene(lambda: quiet_engines(gravity=0, **how), 0.1)


@case("v^2/(2 mu g) of sliding", 1e-3)
def conveyor(**how):
    mu, v = 0.3, 0.5
    material = stone(frictionAngle=math.atan(mu))
    base = dem.base((4, 4, 0.2), material)
    id = dem.block((0.4, 0.4, 0.2), material, on=base)
    O.bodies[base].state.vel = (v, 0, 0)
    way = v * v / (2 * mu * G)

    def error():
        slip = O.bodies[base].state.pos[0] - O.bodies[id].state.pos[0]
        return abs(slip - way) / way

    return Scene(lambda: quiet_engines(**how), 0.4, error)


@case("mu g t: the block stays behind and slides", 1e-2)
def jerk_of_100_m_s(**how):
    mu = 0.3
    material = stone(frictionAngle=math.atan(mu))
    base = dem.base((60, 4, 0.2), material)
    id = dem.block((0.4, 0.4, 0.1), material, on=base)
    engine = dem.PulseTrainEngine(ids=[base], impulse=100.0, times=[0.01])
    return Scene(lambda: quiet_engines(engine, **how), 0.11, lambda: abs(O.bodies[id].state.vel[0] / (mu * G * (O.time - 0.01)) - 1))


@case("no faster than mu g t, flat, energy", 1e-3)
def base_at_200_hertz(**how):
    mu = 0.3
    material = stone(frictionAngle=math.atan(mu))
    base = dem.base((4, 4, 0.2), material)
    id = dem.block((0.4, 0.4, 0.2), material, on=base)
    t = np.arange(0, 0.3, 2.5e-4)
    record = masonry.Record(2.5e-4, 5 * G * np.sin(2 * math.pi * 200 * t))
    return Scene(lambda: quiet_engines(dem.record_motion(record, ids=[base]), **how), 0.25,
                 lambda: max(abs(dem.angle(id)), abs(O.bodies[id].state.vel[0]) / (mu * G * O.time) - 1))


@case("stays flat; energy", 1e-3, compliant=1e-2)
def vertical_1_5_g(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((4, 4, 0.2), material)
    id = dem.block((0.2, 0.4, 0.8), material, on=base)
    t = np.arange(0, 1.001, 5e-3)
    record = masonry.Record(5e-3, 1.5 * G * np.sin(2 * math.pi * 3 * t))
    return Scene(lambda: quiet_engines(dem.record_motion(record, ids=[base], direction=(0, 0, 1)), **how), 1.0, lambda: abs(dem.angle(id)))


@case("the planar answer: no yaw, angle of masonry.simulate", 2e-2, models=("spatial", "wall in space"))
def jerked_base_no_slip(**how):
    material = stone(noSlip=True)
    base = dem.base((6, 6, 0.2), material)
    id = dem.block((0.3, 0.2, 1.5), material, on=base)
    record = masonry.Record(1e-3, [2 * G] * 20)
    exact = masonry.simulate(masonry.RockingBlock(0.15, 0.75), record, t_end=1)
    state = O.bodies[id].state
    return Scene(lambda: quiet_engines(dem.record_motion(record, ids=[base]), **how), 0.2,
                 lambda: max(abs(dem.angle(id) - exact.sample(O.time)[0]), abs(2 * state.ori[2]), abs(state.pos[1])) / abs(exact.sample(O.time)[0]))


@case("energy", 1.0)
def falling_board(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((10, 10, 0.2), material)
    id = dem.block((0.02, 1, 1), material, on=base)
    dem.tilt(id, 0.05)
    return Scene(lambda: quiet_engines(**how), 1.5)


@case("speed while its edge is on the base: no friction; energy", 1e-2)
def corner_over_a_border(**how):
    """A block on one edge slides over the end of its base, where nothing holds it up."""
    v, half, worst = 4.0, Vector3(0.1, 0.2, 0.3), [0.0]
    material = stone(frictionAngle=0)
    base = dem.base((1, 2, 0.2), material)
    id = dem.block(2 * half, material, on=base)
    dem.tilt(id, 0.2)
    state = O.bodies[id].state
    state.vel = (v, 0, 0)

    def watch():
        if O.time < 0.4 / v:  # the way of the edge to the end of the base
            worst[0] = max(worst[0], abs(state.vel[0] / v - 1))

    return Scene(lambda: quiet_engines(**how), 0.3, lambda: worst[0], watch)


@case("does not move: no friction", 1e-6, compliant=1e-2)
def cube_in_a_groove(**how):
    material, side, half = stone(frictionAngle=0), 0.2, math.pi / 4
    for s in (-1, 1):
        state = O.bodies[dem.base((1, 1, 0.2), material)].state
        state.ori = Quaternion(Vector3.UnitY, -s * half)
        state.pos = s * 0.5 * Vector3(math.cos(half), 0, s * math.sin(half)) - 0.1 * (state.ori * Vector3.UnitZ)
    id = dem.block((side, side, side), material, center=(0, 0, side / math.sqrt(2)), orientation=Quaternion(Vector3.UnitY, half))
    return Scene(lambda: quiet_engines(**how), 0.3, drift([id]))


@variants(**{label: (share, f"{'stands' if share < 1 else 'slides'}: tan of its lean {share} of (2 mu + (1 + mu^2) t/L)/(1 - mu^2)", 1e-3 if share < 1 else 0.5, {"models": ALL, "compliant": 1e-2 if share < 1 else 0.5})
             for label, share in (("0_97", 0.97), ("1_03", 1.03))})
def leaning_plank(share, **how):
    """A plank of length L and thickness t that leans against a wall with one edge on the floor and one on the wall. All friction is mobilised at the
    limit: N2 = mu N1, N1 + mu N2 = W, and the moments about the lower edge are N2 L (cos + mu sin) = W (L sin - t cos)/2."""
    mu, length, thick = 0.3, 1.0, 0.1
    lean = math.atan(share * (2 * mu + (1 + mu * mu) * thick / length) / (1 - mu * mu))
    material = stone(frictionAngle=math.atan(mu))
    dem.base((6, 2, 0.2), material)
    wall = O.bodies[dem.base((0.2, 2, 3), material)].state
    wall.pos = (0.1, 0, 1.5)
    along, across = Vector3(math.sin(lean), 0, math.cos(lean)), Vector3(math.cos(lean), 0, -math.sin(lean))
    foot = Vector3(-length * math.sin(lean), 0, 0)
    id = dem.block((thick, 0.5, length), material, center=foot + along * length / 2 - across * thick / 2, orientation=Quaternion(Vector3.UnitY, lean))
    moved = drift([id])
    if share < 1:
        return Scene(lambda: quiet_engines(**how), 0.5, moved)
    return Scene(lambda: quiet_engines(**how), 1.0, lambda: 0.0 if moved() > 1 else 1.0)


@case("free flight: the boxes are 12 mm apart", 1e-12, models=("spatial", "wall in space"))
def apart(**how):
    """Two turning boxes whose edges pass each other beyond their ends."""
    states = []
    for size, pos, q, v, w in (((.0376, .0296, .0502), (.1678, 0, .0251), (.9556, .2919, .0397, -.0039), (1.08, 0, -.04), (20.6, 2, -.7)),
                               ((.0258, .0296, .0502), (.1277, 0, .0827), (-.0281, 0, .9996, 0), (1.59, 0, -2.51), (0, 38.3, 0))):
        q = Quaternion(*q)
        q.normalize()
        states.append(O.bodies[dem.block(size, stone(frictionAngle=0, restitution=1), center=pos, orientation=q)].state)
        states[-1].vel, states[-1].angVel = Vector3(*v), Vector3(*w)
    start = [Vector3(state.vel) for state in states]
    how.setdefault("dt", 2.5e-4)
    return Scene(lambda: quiet_engines(gravity=0, **how), 1e-3, lambda: max((s.vel - v).norm() / v.norm() for s, v in zip(states, start)))


# --- several blocks ---


@variants(**{str(n): (n, "does not move sideways", 1e-6, {"models": ALL, "quick": n <= 20, "compliant": 1e-3}) for n in (20, 50, 200)})
def tower(n, **how):
    material = stone(frictionAngle=0.6)
    base = dem.base((4, 4, 0.2), material)
    ids = dem.stack(n, (0.4, 0.4, 0.2), material, base)
    # Sideways alone: compliant joints sink in under the weight.
    return Scene(lambda: quiet_engines(**how), 0.3, lambda: max(abs(O.bodies[i].state.pos[0]) for i in ids) / 0.1)


@variants(**{label: (ratio, "does not move sideways", 1e-6, {"models": ALL, "quick": ratio < 1e5}) for label, ratio in (("1e3", 1e3), ("1e5", 1e5))})
def heavy_on_light(ratio, **how):
    light, heavy = stone(frictionAngle=0.6), stone(frictionAngle=0.6, density=2000 * ratio)
    base = dem.base((4, 4, 0.2), light)
    ids = dem.stack(3, (0.4, 0.4, 0.2), light, base)
    ids.append(dem.block((0.4, 0.4, 0.2), heavy, on=ids[-1]))
    return Scene(lambda: quiet_engines(**how), 0.3, lambda: max(abs(O.bodies[i].state.pos[0]) for i in ids) / 0.1)


@case("does not move sideways", 1e-6)
def two_sizes_1_to_1000(**how):
    material = stone(frictionAngle=0.6)
    base = dem.base((4, 4, 0.2), material)
    large = dem.block((1.0, 1.0, 1.0), material, on=base)
    small = dem.block((1e-3, 1e-3, 1e-3), material, on=large)
    return Scene(lambda: quiet_engines(**how), 0.1, lambda: abs(O.bodies[small].state.pos[0]) / 5e-4)


@variants(**{label: (share, f"{'stands' if share < 1 else 'falls'} (moments of each joint)", 1e-3 if share < 1 else 0.5, {"models": ALL, "compliant": 1e-2})
             for label, share in (("0_998", 0.998), ("1_002", 1.002))})
def harmonic_overhang(share, **how):
    """Each block overhangs the one below by L/(2k), k blocks above the joint: the limit. Falls: the top sinks by its height at least."""
    material, length, n = stone(frictionAngle=0.8), 0.4, 5
    base = dem.base((2, 2, 0.2), material)
    x, z, ids = 0.0, 0.05, []
    for k in range(n, 0, -1):
        ids.append(dem.block((length, 0.4, 0.1), material, center=(x, 0, z)))
        x, z = x + share * length / (2 * max(k - 1, 1)), z + 0.1
    moved, top = drift(ids), O.bodies[ids[-1]].state
    height = top.pos[2]
    if share < 1:
        return Scene(lambda: quiet_engines(**how), 0.5, moved)
    return Scene(lambda: quiet_engines(**how), 2.5, lambda: 0.0 if top.pos[2] < height - 0.1 else 1.0)


@case("stands at mu = 0.2 > (tan 0.3 - t/L)/2; mirror image of itself", 1e-4, compliant=1e-3)
def a_frame(**how):
    material, length, thick, lean = stone(frictionAngle=math.atan(0.2)), 1.0, 0.1, 0.3
    dem.base((9, 9, 0.2), material)
    ids = [dem.block((thick, 0.5, length), material, orientation=Quaternion(Vector3.UnitY, -s * lean),
                     center=(s * (math.cos(lean) * thick + math.sin(lean) * length) / 2, 0, (math.sin(lean) * thick + math.cos(lean) * length) / 2))
           for s in (-1, 1)]
    return Scene(lambda: quiet_engines(**how), 0.5, drift(ids))


@case("spin v/L of a beam that follows both supports", 1e-2)
def settling_support(**how):
    v, material = 0.1, stone(frictionAngle=math.atan(0.6), restitution=0.5)
    for x in (-1, 1):
        O.bodies[dem.base((1, 1, 0.2), material)].state.pos = (x, 0, -0.1)
    beam = dem.block((2.4, 0.5, 0.3), material, center=(0, 0, 0.15))
    worst = [0.0]

    def watch():
        O.bodies[1].state.vel = (0, 0, -v)
        if O.time > 0.2:
            worst[0] = max(worst[0], abs(O.bodies[beam].state.angVel[1] * 1.7 / v - 1))

    return Scene(lambda: quiet_engines(**how), 0.4, lambda: worst[0], watch)


@case("Coulomb's law: does not move", 1e-4)
def flat_row_under_thrust(**how):
    n, end = 12, 0.2 * 12 + 0.3
    material, smooth = stone(frictionAngle=math.atan(0.4), restitution=0), stone(frictionAngle=0)
    for size, at, m in (((1, 1, 3), (-.5, 0, 0), material), ((.58, 1, .1), (end, 0, -.55), smooth), ((.58, 1, .1), (end, 0, .55), smooth)):
        O.bodies[dem.base(size, m)].state.pos = at
    boxes = [dem.block((.2, .4, .4), material, center=(.1 + .2 * k, 0, 0)) for k in range(n)]
    push = dem.block((.6, .4, 1), material, center=(end, 0, 0))
    weight = n * O.bodies[boxes[0]].state.mass * G
    start = {i: O.bodies[i].state.pos[2] for i in boxes}
    thrust = 6 * max(weight / .8, weight * n / 16)

    def engines():
        listed = quiet_engines(**how)
        O.forces.setPermF(push, (-thrust, 0, 0))
        return listed

    return Scene(engines, 0.4, lambda: max(abs(O.bodies[i].state.pos[2] - start[i]) for i in boxes) / .1, work=lambda: thrust * (end - O.bodies[push].state.pos[0]))


@case("energy; the last falls", 0.5)
def domino_row(**how):
    material = stone(frictionAngle=0.6)
    dem.base((6, 2, 0.2), material)
    ids = [dem.block((0.05, 0.3, 0.4), material, center=(0.15 * k, 0, 0.2)) for k in range(6)]
    dem.tilt(ids[0], 1.2 * math.atan(0.125))
    return Scene(lambda: quiet_engines(**how), 2.5, lambda: 0.0 if abs(dem.angle(ids[-1])) > 0.5 else 1.0)


@case("energy that stays after a flat landing: 0.603 (enumeration of contact states)", 2e-2, models=RIGID)
def restitution_in_a_stack(**how):
    material = stone(restitution=0.5, noSlip=True)
    ids = dem.stack(2, (0.6, 1, 1.2), material, on=dem.base((8, 4, 0.2), material))
    turn_all(ids, 0.02, Vector3(0.3, 0, 0))
    fall = 0.3 * math.sin(0.02) - 1.2 * (1 - math.cos(0.02))  # of the centre of mass until it lands
    landing = 2 * O.bodies[ids[0]].state.mass * G * fall

    def total():
        e = dem.energy()
        return e["kinetic"] + e["potential"]

    start = []
    how.setdefault("dt", 2e-4)
    return Scene(lambda: quiet_engines(**how), 0.185, lambda: abs((1 - (start[0] - total()) / landing) / 0.603 - 1), lambda: start or start.append(total()))


# --- one scene seen otherwise: the answer must not change ---


def standard(place=lambda v: v, turn=Quaternion(1, 0, 0, 0), scale=1.0, reverse=False, seconds=0.3, **how):
    """Three blocks that a push of their base sets rocking and sliding. Returns (Scene, function giving their centres in the scene's own axes)."""
    material = stone(frictionAngle=0.6, restitution=0.6)
    base = dem.base((4 * scale, 4 * scale, 0.2 * scale), material)
    O.bodies[base].state.pos = place(turn * (scale * Vector3(0, 0, -0.1)))
    O.bodies[base].state.ori = turn
    sizes, height, todo = ((0.4, 0.4, 0.5), (0.35, 0.4, 0.3), (0.3, 0.3, 0.6)), 0.0, []
    for k, size in enumerate(sizes):
        todo.append((k, size, Vector3(0.02 * k, 0, height + size[2] / 2)))
        height += size[2]
    ids = {}
    for k, size, at in reversed(todo) if reverse else todo:
        ids[k] = dem.block(tuple(scale * s for s in size), material, center=place(turn * (scale * at)), orientation=turn)
    along = turn * Vector3.UnitX
    slower = math.sqrt(scale)
    samples = [0.7 * G * math.sin(2 * math.pi * k / 40) for k in range(41)]
    motion = dem.RecordMotionEngine(ids=[base], samples=samples, interval=0.01 * slower, direction=tuple(along))
    back = turn.conjugate()
    if "dt" in how:
        how["dt"] *= slower
    return (lambda: quiet_engines(motion, **how)), seconds * slower, lambda: np.array([tuple(back * (O.bodies[ids[k]].state.pos - place(Vector3.Zero)) / scale) for k in sorted(ids)])


def seen(**change):
    def build(change=change, **how):
        step = how.pop("dt", None)
        given = {} if step is None else {"dt": step / math.sqrt(change.get("scale", 1))}
        engines, seconds, centres = standard(**how, **given)
        O.engines = engines()
        given.setdefault("dt", O.dt)
        for _ in range(math.ceil(seconds / O.dt)):
            O.step()
        plain = centres()
        O.reset()
        engines, seconds, centres = standard(**how, **given, **change)
        return Scene(engines, seconds, lambda: float(np.abs(centres() - plain).max()) / 0.15)
    return build


# Rocking lets round-off grow; compliant springs make 1e-11 of their load of 1e-16 of a position, and 1e6 m away positions are right to 1e-10 m.
for label, change, bound in (("turned", {"turn": Quaternion(Vector3.UnitZ, 0.5)}, 1e-6), ("mirrored", {"turn": Quaternion(Vector3.UnitZ, math.pi)}, 1e-6),
                             ("scaled_by_100", {"scale": 100.0}, 1e-6), ("moved_by_1e6_m", {"place": lambda v: v + Vector3(1e6, 0, 0)}, 1e-3),
                             ("in_another_order", {"reverse": True}, 1e-6)):
    build = seen(**change)
    build.__name__ = f"scene_{label}"
    case("the same scene as it was", bound, models=("spatial", "wall in space", "compliant"), compliant=max(bound, 1e-5))(build)


@case("the same bits as without", 0.0, models=ALL, quick=False)
def saved_and_loaded_in_every_step(**how):
    engines, seconds, centres = standard(**how)
    O.engines = engines()
    step = O.dt
    for _ in range(100):
        O.step()
    plain = centres()
    O.reset()
    how["dt"] = step
    engines, _, centres = standard(**how)

    def again():
        O.saveTmp("stability")
        O.loadTmp("stability")

    return Scene(engines, 99.5 * step, lambda: float(np.abs(centres() - plain).max()), again)
