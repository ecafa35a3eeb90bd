"""Random scenes of bricks with mortar, judged by invariants: stacks, piers side by side and walls that are shaken, jolted or kicked.

Cracks are compared with the places of the blocks alone. With g the gap between the two faces of a joint and d their movement across it since it was bonded,
both affine over the face, the pull of a sound fibre is K_n max(0, g) and its shear K_s |d|. The pull, and shear + mu pull, are convex over the face: where they do not
reach f_t and c at a corner of the face, no fibre may crack; where the pull is more than f_t in the middle, one has cracked."""

import math
import random
import time
import warnings

import boxes
import numpy as np
from masonry import dem
from measures import MOST_DEPTH, MOST_GAIN, Energies, engine, quiet_engines
from yade import NewtonIntegrator, O

import masonry

SECONDS = 0.08
MOST_OFF = 2e-2  # energy that no account explains, relative to what is turned over
# By how much a joint may seem to crack below its strength, or not to crack above it: turning of the faces and the step in between. Least damage that is a crack.
NEAR, SOUND = 2e-2, 1e-12
UNSPENT = 1e-3  # share of the fracture energy that a broken fibre has not spent (docs/mortar.md)
# D may differ by so much until a joint is broken: bits depend on the order in which corners are found, and dry blocks that land double such differences in each impact.
MIRRORED = 1e-6


def mortar_of(r, weight):
    """From mortar that the weight of the blocks above (Pa) would break to a hundred times that; smaller shares of its largest stored energy are brittle."""
    mu, strength, stiffness = r.choice((0.4, 0.75, 1.1)), weight * 10 ** r.uniform(-0.3, 2), 10 ** r.uniform(9, 10.3)
    cohesion, shear = strength * mu * r.choice((1, 1.5, 4)), stiffness * r.uniform(0.2, 1)
    return dem.JointMat(tensileStrength=strength, fractureEnergy=strength**2 / stiffness / 10 ** r.uniform(-2.5, -0.5), cohesion=cohesion,
                        shearFractureEnergy=cohesion**2 / shear / 10 ** r.uniform(-2.5, -0.5), frictionAngle=math.atan(mu), normalStiffness=stiffness,
                        shearStiffness=shear, scatter=r.choice((0, 0, 0.3)), seed=r.randint(0, 99))


def build(seed, side):
    """The scene, mirrored in x where side is -1. Returns its mortar and what kicks it after the first step: (id, velocity, spin), or None."""
    r = random.Random(-3000001 - seed)
    O.reset()
    size = [10 ** r.uniform(-1, -0.4) for _ in range(3)]
    density, courses, piers = 10 ** r.uniform(3, 3.5), r.randint(1, 4), r.choice((1, 1, 2, 3))
    mortar = mortar_of(r, density * 9.81 * courses * size[2])
    material = dem.BlockMat(density=density, frictionAngle=mortar.frictionAngle, mortar=mortar)
    dry = dem.BlockMat(density=density, frictionAngle=mortar.frictionAngle, normalStiffness=mortar.normalStiffness, shearStiffness=mortar.shearStiffness)
    base = dem.base((8, 8, 0.4), dry if r.random() < 0.2 and courses > 1 else material)
    if piers > 1 and r.random() < 0.5:
        ids = dem.wall(courses, piers, size, material, on=base)
    else:
        ids = [dem.block(size, material, center=((k - (piers - 1) / 2) * size[0], 0, (row + 0.5) * size[2])) for k in range(piers) for row in range(courses)]
    for b in O.bodies:
        b.state.pos = (side * b.state.pos[0], b.state.pos[1], b.state.pos[2])
    along = r.choice(((side, 0, 0), (0, 1, 0), (0, 0, 1), (0.6 * side, 0.8, 0)))
    kick, load = None, r.choice(("pulses", "record", "kick"))
    strong = 10 ** r.uniform(-2, 0)
    if load == "pulses":
        motions = dem.PulseTrainEngine(ids=[base], impulse=strong, times=[0.01, 0.03], direction=along)
    elif load == "record":
        sine = masonry.Record(1e-3, strong * 300 * np.sin(2 * np.pi * r.uniform(10, 60) * np.arange(200) * 1e-3))
        motions = dem.record_motion(sine, [base], direction=along)
    else:
        motions, spin = None, [r.gauss(0, 3 * strong) for _ in range(3)]
        velocity = [r.gauss(0, strong) for _ in range(3)]
        kick = r.choice(ids), (side * velocity[0], velocity[1], velocity[2]), (spin[0], side * spin[1], side * spin[2])
    O.engines = quiet_engines(motions, model="auto")
    return mortar, kick


def begin(seed, side=1):
    mortar, kick = build(seed, side)
    O.step()
    if kick:
        state = O.bodies[kick[0]].state
        state.vel, state.angVel = kick[1:]
        turned = state.ori.conjugate() * state.angVel
        state.angMom = state.ori * type(turned)(*(state.inertia[k] * turned[k] for k in range(3)))
    return mortar


def rows():
    """The numbers of each joint with mortar (RockingJointEngine.bondedState)."""
    return np.array(engine().bondedState).reshape(-1, 13)


class Joints:
    """The joints with mortar: their damage, and what the places of the blocks say of it."""

    def __init__(self, mortar):
        self.pairs = np.array(engine().bondedIds, dtype=int).reshape(-1, 2)
        factor = np.array([mortar.factor(int(a), int(b)) for a, b in self.pairs])
        self.mortar, self.tension, self.cohesion = mortar, factor * mortar.tensileStrength, factor * mortar.cohesion
        self.energies = np.stack([factor * mortar.fractureEnergy, factor * mortar.shearFractureEnergy], axis=1)
        centre, turn = self.places()
        half = np.array([[tuple(O.bodies[int(i)].shape.extents) for i in pair] for pair in self.pairs])
        low, high = (centre - half).max(axis=1), (centre + half).min(axis=1)  # the boxes stand upright when they are bonded
        across = (high - low).argmin(axis=1)
        signs = np.array([(x, y) for x in (-1, 1) for y in (-1, 1)] + [(0, 0)])
        self.normal, self.local = np.zeros((len(across), 3)), np.zeros((len(across), 2, 5, 3))
        for k, axis in enumerate(across):
            side = np.sign(centre[k, 1, axis] - centre[k, 0, axis])
            self.normal[k, axis] = side
            flat = [a for a in range(3) if a != axis]
            at = np.tile((low[k] + high[k]) / 2, (2, 5, 1))
            at[:, :, flat] += signs * ((high - low)[k, flat] / 2)
            at[:, :, axis] = (centre[k, :, axis] + side * np.array([1, -1]) * half[k, :, axis])[:, None]  # the face of either body
            self.local[k] = np.einsum("bki,bck->bci", turn[k], at - centre[k, :, None])
        gap, self.start = self.moved()
        self.rest = np.maximum(0, gap)
        self.reached = np.zeros(len(across))  # largest of stress over strength at a corner so far
        self.damage, self.below, self.above, self.wrong = rows()[:, 4:6], 0.0, 0.0, 0.0
        self.unbroken = O.iter, self.damage  # the last step before a joint breaks

    def places(self):
        """Centres (joints, 2, 3) of the two bodies of each joint, and their axes (joints, 2, 3, 3)."""
        states = [[O.bodies[int(i)].state for i in pair] for pair in self.pairs]
        centre = np.array([[tuple(s.pos) for s in pair] for pair in states])
        return centre, np.array([[np.array(s.ori.toRotationMatrix()).reshape(3, 3) for s in pair] for pair in states])

    def moved(self):
        """Of the corners and the middle of each joint: gap (joints, 5), and place of body 2 against body 1 along the face, in the axes of body 1 (joints, 5, 3)."""
        centre, turn = self.places()
        first, second = np.moveaxis(np.einsum("jbik,jbck->jbci", turn, self.local) + centre[:, :, None], 1, 0)
        apart = np.einsum("jki,jck->jci", turn[:, 0], second - first)
        gap = np.einsum("jci,ji->jc", apart, self.normal)
        return gap, apart - gap[:, :, None] * self.normal[:, None]

    def look(self):
        """Before a step, which sees the blocks where they are."""
        if (self.damage[:, 1] > SOUND).all():
            return  # each has cracked
        gap, place = self.moved()
        slipped = np.linalg.norm(place - self.start, axis=2)
        pull = self.mortar.normalStiffness * np.maximum(0, gap - self.rest)
        shear = self.mortar.shearStiffness * slipped + math.tan(self.mortar.frictionAngle) * pull
        with np.errstate(divide="ignore"):
            corners = np.maximum(pull / self.tension[:, None], shear / self.cohesion[:, None])[:, :4]
        self.reached = np.maximum(self.reached, corners.max(axis=1))
        self.middle = pull[:, 4] / self.tension

    def judge(self):
        """After the step: D rises, in [0, 1]; the energies of the crack are its share of the fracture energies; nothing cracks before its strength is reached."""
        now = rows()
        damage = now[:, 4:6]
        cracked, first = damage[:, 1] > SOUND, self.damage[:, 1] <= SOUND
        if (cracked & first).any():
            self.below = max(self.below, 1 - self.reached[cracked & first].min())
        if not cracked.all():
            self.above = max(self.above, self.middle[~cracked].max() - 1)
        spent = (now[:, 9:11] / (now[:, 3:4] * self.energies)).sum(axis=1)
        self.wrong = max(self.wrong, (self.damage - damage).max(), damage.max() - 1, -damage.min(), np.abs(spent - damage[:, 0]).max() - UNSPENT)
        self.damage = damage
        if not (damage[:, 1] == 1).any():
            self.unbroken = O.iter, damage


class Account:
    """Energy less the work put in: constant. Of the kinetic energy, that of the mean velocity of an instant, what it has beyond the leapfrog's v1 m v2/2 is taken off,
    with the forces F and torques F^2 dt^2/8m (docs/numerics.md, energy)."""

    def __init__(self):
        self.start, self.off, self.beyond = None, 0.0, 0.0
        self.free = [b for b in O.bodies if b.dynamic]
        self.gravity = next(e for e in O.engines if isinstance(e, NewtonIntegrator)).gravity

    def look(self):
        self.beyond = 0.0
        for b in self.free:
            s = b.state
            force, torque = O.forces.f(b.id, True) + s.mass * self.gravity, s.ori.conjugate() * O.forces.t(b.id, True)
            self.beyond += O.dt**2 / 8 * (force.dot(force) / s.mass + sum(torque[k] ** 2 / s.inertia[k] for k in range(3)))
        e = dem.energy()
        total = sum(e.values()) - 2 * e["baseWork"] - self.beyond
        self.start = total if self.start is None else self.start  # after the first step, which knows the kick
        self.off = max(self.off, abs(total - self.start))


def go_on(joints, until):
    """Runs until a time; returns the largest depth, the largest difference of the account (J), and the energies."""
    account, deepest, k = Account(), 0.0, 0
    energies = Energies(lambda: account.beyond)
    while O.time < until:
        joints.look()
        O.step()
        joints.judge()
        account.look()
        energies.look()
        k += 1
        if k % 100 == 0:
            deepest = max(deepest, boxes.depth())
    return deepest, account.off, energies


def run(seed):
    """One row, as random_scenes.run."""
    row = {"kind": "mortar", "seed": seed, "model": "compliant", "gain": math.nan, "depth": math.nan, "off": math.nan, "damage": math.nan, "strength": math.nan,
           "mirror": math.nan, "cracked": 0, "bits": True, "said": ""}
    start = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            joints = Joints(begin(seed))
            deepest, off, energies = go_on(joints, SECONDS)
            own = engine()
            row.update(gain=energies.relative_gain(), depth=deepest, off=off / max(own.turnedOver, energies.floor), damage=float(joints.wrong),
                       strength=float(max(joints.below, joints.above)), cracked=int((joints.damage[:, 1] > 0.02).sum()), failures=own.failures)
            end = [tuple(b.state.pos) for b in O.bodies]
            begin(seed, side=-1)
            last, damage = joints.unbroken
            while O.iter < last:
                O.step()
            row["mirror"] = float(np.abs(rows()[:, 4:6] - damage).max())
            if seed % 10 == 0:
                begin(seed)
                while O.time < SECONDS:
                    O.step()
                    if O.iter % 97 == 0:
                        O.saveTmp("random")
                        O.loadTmp("random")
                row["bits"] = end == [tuple(b.state.pos) for b in O.bodies] and np.array_equal(rows()[:, 4:6], joints.damage)
            row["said"] = (["failures"] * bool(row["failures"]) + [str(w.message) for w in caught] + [""])[0][:200]
        except (RuntimeError, ValueError) as refused:
            row["said"] = f"refused: {refused}"[:200]
    row["cpu"] = time.process_time() - start
    limits = {"energy": ("gain", MOST_GAIN), "depth": ("depth", MOST_DEPTH["compliant"]), "off": ("off", MOST_OFF), "damage": ("damage", 1e-9),
              "strength": ("strength", NEAR), "mirror": ("mirror", MIRRORED)}
    row["broken"] = [name for name, (key, most) in limits.items() if not row[key] <= most] + ["bits"] * (not row["bits"])
    return row
