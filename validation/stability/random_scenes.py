"""Random scenes, one seed each, judged by invariants alone; appends one JSON line a scene. Run by `run --long`: of every ten scenes that are thrown one
more is pressed by bodies with prescribed motion, one has convex blocks, one has unions, one has bricks with mortar (random_mortar.py), and one is a building
(plans.py). STABILITY_MODEL=compliant (or another name of measures.MODELS): all seeds with that model (buildings are always walls in space).
STABILITY_KIND=pressed (or thrown, convex, union, mortar, building): these scenes alone. STABILITY_FIRST: their first seed."""

import contextlib
import io
import json
import math
import os
import random
import time
import warnings

import boxes
import plans
import random_mortar
import random_unions
from masonry import dem
from measures import MODELS, MOST_DEPTH, MOST_GAIN, OTHER_DEPTH, Energies, engine, quiet_engines
from polyhedra import Solids
from yade import O, Quaternion, Vector3, utils

import numpy as np

SECONDS = 0.4
# In flight: how much a body's velocity may change beside gravity, relative to the fastest (1 m/s at least), and its angular momentum, relative to its
# own or to that of 1 rad/s about its largest axis.
FLIGHT = 1e-9
# By how much friction may be beyond its cone, relative to the largest normal force of the scene. The friction of `wall` goes by the mean of loads
# that lag.
CONE = {"wall": 1e-2, "wall in space": 1e-2}
OTHER_CONE = 1e-6
# Energy that joints may make, or lose, though nothing accounts for it, relative to what is turned over.
MOST_OFF = 2e-2
# Energy that pressing bodies may bring in, relative to ten weights of all blocks at each of up to eight points, all along their way; in walls besides
# to what gives all blocks their largest speed in a step.
MOST_WORK = 1
pressing = {}  # of the scene: way of the pressing bodies, m, and their largest speed, m/s
NAMES = (os.environ["STABILITY_MODEL"],) if "STABILITY_MODEL" in os.environ else tuple(MODELS)


def build(seed):
    """One to five boxes above or on a base, in any pose, thrown or resting; the model follows from the seed."""
    r = random.Random(seed)
    model = NAMES[seed % len(NAMES)]
    O.reset()
    plane = model in ("planar", "wall")
    law = {} if r.random() < 0.4 else {"restitution": r.choice((0, 0.3, 0.7, 1, r.random()))}
    material = dem.BlockMat(density=10 ** r.uniform(2.5, 4), frictionAngle=math.atan(r.choice((0, 0.3, 0.7, 1.5))), **law)
    base = dem.base((8, 8, 0.4), material)
    z = 0.0
    for k in range(r.randint(1, 5)):
        size = [10 ** r.uniform(-1.2, 0) for _ in range(3)]
        if r.random() < 0.5:  # stands on what is below
            z += size[2] / 2
            dem.block(tuple(size), material, center=(r.uniform(-0.02, 0.02), 0, z))
            z += size[2] / 2
            continue
        reach = math.hypot(*size) / 2 * 1.01
        if plane:
            q = Quaternion(Vector3.UnitY, r.uniform(-math.pi, math.pi))
        else:
            q = Quaternion(*[r.gauss(0, 1) for _ in range(4)])
            q.normalize()
        z += reach
        state = O.bodies[dem.block(tuple(size), material, center=(r.uniform(-0.2, 0.2), 0 if plane else r.uniform(-0.2, 0.2), z), orientation=q)].state
        z += reach
        state.vel = (r.gauss(0, 1), 0 if plane else r.gauss(0, 1), r.gauss(0, 1))
        state.angVel = (0 if plane else r.gauss(0, 3), r.gauss(0, 3), 0 if plane else r.gauss(0, 3))
        turned = state.ori.conjugate() * state.angVel
        state.angMom = state.ori * Vector3(*(state.inertia[k] * turned[k] for k in range(3)))
    motion = dem.PulseTrainEngine(ids=[base], impulse=r.uniform(0.1, 1), times=[0.05, 0.15]) if r.random() < 0.3 else None
    O.engines = quiet_engines(motion, **MODELS[model])
    return model


def pressed(seed):
    """Two to six boxes, stacked, in a row or (a fifth of the seeds) a wall of more than twenty, and two boxes with prescribed motion that press them: jaws
    that move together or close, a ram against a fixed body, a weight from above."""
    r = random.Random(-1 - seed)
    model = NAMES[seed % len(NAMES)]
    O.reset()
    plane = model in ("planar", "wall")
    material = dem.BlockMat(density=10 ** r.uniform(2.5, 4), frictionAngle=math.atan(r.choice((0.1, 0.3, 0.7, 1.2, r.uniform(0, 1.5)))))
    base = dem.base((20, 20, 0.4), material)
    size = [10 ** r.uniform(-1, 0) for _ in range(3)]
    built = r.choice(("stack", "row", "stack", "row", "wall"))
    if built == "wall" and model in ("wall", "wall in space"):
        ids = dem.wall(courses=5, per_course=5, size=(size[0], size[1], size[0] * r.uniform(0.3, 1)), material=material, on=base)
    elif built == "row":
        count = r.randint(2, 6)
        ids = [dem.block(size, material, center=((k - (count - 1) / 2) * size[0] * 1.001, 0, size[2] / 2)) for k in range(count)]
    else:
        ids = dem.stack(r.randint(2, 6), size, material, on=base)
    places, halves = [O.bodies[i].state.pos for i in ids], [O.bodies[i].shape.extents for i in ids]
    reach = max(p[0] + h[0] for p, h in zip(places, halves))
    top = max(p[2] + h[2] for p, h in zip(places, halves))
    small = min(min(h) for h in halves)
    half = Vector3(r.uniform(0.3, 1) * small, r.uniform(0.5, 1.5) * size[1] / 2, r.uniform(0.2, 1) * small)
    gap, way = 10 ** r.uniform(-4, -1.5) * small, r.uniform(0.02, 0.3) * small
    beside = 0 if plane else r.uniform(-0.2, 0.2) * size[1]
    def add(x, z):
        return O.bodies.append(utils.box((x, beside, z), tuple(half), material=material, fixed=True))
    kind = r.choice(("together", "close", "ram", "above"))
    heights = [r.uniform(half[2], top - 0.1 * half[2]) for _ in range(2)] if r.random() < 0.5 else [r.uniform(half[2], top)] * 2
    if kind == "above":
        jaws = [add(r.uniform(-reach, reach), top + gap + half[2])]
    else:
        jaws = [add(side * (reach + gap + half[0]), height) for side, height in zip((-1, 1), heights)]
    beat = r.choice((1, 2, 4))
    times = np.arange(0, 1.5 * SECONDS, 0.005)
    curve = (gap + way) * np.sin(np.pi * beat * times / SECONDS / 2) ** 3
    rates = np.abs(np.diff(curve))
    pressing.update(way=len(jaws) * rates.sum(), speed=rates.max() / 0.005)
    axis = (0, 0, 1) if kind == "above" else (1, 0, 0)
    def moved(ids, sign):
        return dem.RecordMotionEngine(ids=ids, displacement=(sign * curve).tolist(), interval=0.005, direction=axis)
    motion = {"together": lambda: moved(jaws, 1), "close": lambda: [moved(jaws[:1], 1), moved(jaws[1:], -1)], "ram": lambda: moved(jaws[:1], 1),
              "above": lambda: moved(jaws, -1)}[kind]()
    O.engines = quiet_engines(motion, **MODELS[model])
    return model


def polygon(r, size):
    """Corners (n, 2) of a random convex polygon of 3 to 10 corners on an ellipse, of which the last two may be near each other."""
    wide = size * (r.choice((1, 1, 0.03)) if r.random() < 0.5 else r.uniform(0.2, 1))
    angles = sorted(r.uniform(0, 2 * math.pi) for _ in range(r.randint(3, 10)))
    return [(size * math.cos(a), wide * math.sin(a)) for a in angles]


def hull(r, size):
    """Points on an ellipsoid: a hull of 4 to 30 corners, flat ones (slivers) among them."""
    half = size * np.array([1, r.uniform(0.3, 1), r.choice((0.03, r.uniform(0.3, 1), r.uniform(0.3, 1)))])
    points = np.array([[r.gauss(0, 1) for _ in range(3)] for _ in range(r.choice((4, 5, 6, 8, 12, 30)))])
    return (points / np.linalg.norm(points, axis=1)[:, None] * half).tolist()


def one_convex(r, size, material, plane):
    """A hull, a wedge or a drum; in the plane a prism. Returns its id and whether it has no side to stand on."""
    kind = "prism" if plane else r.choice(("hull", "hull", "wedge", "drum"))
    pose = {"center": (0, 0, 0)}
    if kind == "prism":
        made = dem.prism(polygon(r, size), 1.0, material, axis="y", **pose)
    elif kind == "wedge":
        made = dem.wedge((size, r.uniform(0.2, 1) * size, r.uniform(0.2, 1) * size), material, top=r.choice((0, 0.3 * size)), shift=r.uniform(-0.3, 0.3) * size, **pose)
    elif kind == "drum":
        with contextlib.redirect_stdout(io.StringIO()):
            made = dem.drum(size, r.uniform(0.2, 2) * size, material, sides=r.randint(3, 16), **pose)
    else:
        made = dem.convex(hull(r, size), material, **pose)
    return made, kind in ("prism", "hull")


def one_union(r, size, material, plane):
    """L, T and U blocks and others of cuboids; prisms that are cut or have a dovetail; in space hulls that are cut or have pyramids on their faces."""
    kind = r.choice(("angles", "angles", "sections" if plane else r.choice(("faces", "cut"))))
    parts = {"angles": lambda: random_unions.angles(r, size, plane), "sections": lambda: random_unions.sections(r, polygon(r, size)),
             "faces": lambda: random_unions.on_faces(r, hull(r, size)), "cut": lambda: random_unions.cut(r, hull(r, size))}[kind]()
    return dem.union(parts, material, center=(0, 0, 0)), kind != "angles"


def convex(seed):
    """One to five convex blocks, thrown or let go above a base or each other. Shapes that are refused are drawn anew."""
    return let_go(seed, random.Random(-1000001 - seed), one_convex)


def union(seed):
    """The same of unions."""
    return let_go(seed, random.Random(-2000001 - seed), one_union)


def let_go(seed, r, one):
    names = [name for name in NAMES if name != "compliant"]
    model = names[seed % len(names)]
    O.reset()
    plane = model in ("planar", "wall")
    law = {} if r.random() < 0.4 else {"restitution": r.choice((0, 0.3, 0.7, 1, r.random()))}
    material = dem.BlockMat(density=10 ** r.uniform(2.5, 4), frictionAngle=math.atan(r.choice((0, 0.3, 0.7, 1.5))), **law)
    base = dem.base((8, 8, 0.4), material)
    z, wanted = 0.0, r.randint(1, 5)
    while len(O.bodies) <= wanted:
        size = 10 ** r.uniform(-0.9, -0.1)
        try:
            made, turns = one(r, size, material, plane)
        except ValueError:
            continue
        state = O.bodies[made].state
        if turns or r.random() < 0.5:
            q = Quaternion(Vector3.UnitY, r.uniform(-math.pi, math.pi)) if plane else Quaternion(*[r.gauss(0, 1) for _ in range(4)]).normalized()
            state.ori = q * state.ori
        heights = dem.geometry(made).vertices[:, 2]
        state.pos = Vector3(r.uniform(-0.1, 0.1), 0 if plane else r.uniform(-0.1, 0.1), z - heights.min() + r.choice((0, 1e-3, 0.1)) * size)
        z += np.ptp(heights) + 0.1 * size
        if r.random() < 0.5:
            state.vel = Vector3(r.gauss(0, 1), 0 if plane else r.gauss(0, 1), r.gauss(0, 1))
            state.angVel = Vector3(0 if plane else r.gauss(0, 3), r.gauss(0, 3), 0 if plane else r.gauss(0, 3))
    motion = dem.PulseTrainEngine(ids=[base], impulse=r.uniform(0.1, 1), times=[0.05, 0.15]) if r.random() < 0.3 else None
    O.engines = quiet_engines(motion, **MODELS[model])
    engine().wallsOnly = model in ("wall", "wall in space")  # few blocks, too, are stepped as walls
    return model


# Mortar has invariants of its own.
KINDS = {"thrown": build, "pressed": pressed, "convex": convex, "union": union, "mortar": None, "building": plans.building}


class Flight:
    """Bodies whose distance from all others is more than they go in some steps get nothing but gravity. Distances are measured where a body has got more, and
    not again before it can be as far away."""

    def __init__(self, gaps):
        """gaps: of boxes.py or polyhedra.py."""
        self.worst, self.before, self.gaps = 0.0, None, gaps
        inertia = [b.state.inertia for b in O.bodies]
        self.inertia = np.array([tuple(i) if max(i) > 0 else (1, 1, 1) for i in inertia])
        self.free = np.array([b.dynamic for b in O.bodies])
        self.near = np.zeros(len(O.bodies))  # steps before a body can be far enough away

    def look(self):
        states = [b.state for b in O.bodies]
        velocity, spin = np.array([tuple(s.vel) for s in states]), np.array([tuple(s.angVel) for s in states])
        turning = np.array([tuple(s.ori * Vector3(*(m * w for m, w in zip(inertia, s.ori.conjugate() * s.angVel)))) for s, inertia in zip(states, self.inertia)])
        if self.before is not None:
            speed, turned = self.before
            change = np.abs(velocity - speed + np.array([0, 0, 9.81 * O.dt])).max(axis=1) / max(1.0, np.abs(velocity).max())
            size = np.maximum(np.linalg.norm(turned, axis=1), self.inertia.max(axis=1))
            error = np.where(self.free, np.maximum(change, np.linalg.norm(turning - turned, axis=1) / size), 0)
            if (error[self.near <= 0] > FLIGHT).any():
                error[~self.flies(velocity, spin)] = 0
                self.worst = max(self.worst, float(error.max()))
        self.near -= 1
        self.before = velocity, turning

    def flies(self, velocity, spin, steps=4):
        """Which bodies are farther from all others than two of them go in `steps` steps: they touched none in the last one."""
        ids, _, radii, first, second, gaps = self.gaps()
        apart = np.full(len(ids), np.inf)
        np.minimum.at(apart, first, gaps)
        np.minimum.at(apart, second, gaps)
        reach = O.dt * (np.linalg.norm(velocity[ids], axis=1) + np.linalg.norm(spin[ids], axis=1) * radii + 9.81 * O.dt).max()
        self.near[ids] = np.ceil(np.clip(steps - apart / (2 * reach), 0, steps)) - 1
        far = np.zeros(len(O.bodies), dtype=bool)
        far[ids] = apart > 2 * steps * reach
        return far


def one_normal(i, compliant):
    """Where corners meet corners, the reaction may turn between the normals of two faces: rigid blocks have two points there, a compliant joint a normal
    that is no face's."""
    if not compliant or i.geom.kind == 3:
        return all((n - i.geom.normals[0]).norm() < 1e-9 for n in i.geom.normals)
    return any(max(abs((O.bodies[b].state.ori.conjugate() * i.geom.normal)[k]) for k in range(3)) > 1 - 1e-12 for b in (i.id1, i.id2))


def beyond_cone(compliant):
    """By how much friction is larger than Coulomb's bound, relative to the largest normal force, or to 1e-3 of the lightest block's weight where no force is
    as large: of compliant joints at each point, else of each pair. Pairs whose reaction may turn are left out."""
    worst, largest = 0.0, 1e-3 * 9.81 * min(b.state.mass for b in O.bodies if b.dynamic)
    for i in O.interactions:
        normal = i.phys.normalForce.norm()
        largest = max(largest, normal)
        if not one_normal(i, compliant):
            continue
        n = i.geom.normal
        parts = [(n.dot(f), (f - n * n.dot(f)).norm()) for f in i.phys.forces] if compliant else [(normal, i.phys.shearForce.norm())]
        worst = max([worst] + [shear - i.phys.tangensOfFrictionAngle * pressure for pressure, shear in parts])
    return worst / largest


def most_work():
    """J, of the pressing bodies; see MOST_WORK."""
    mass = sum(b.state.mass for b in O.bodies if b.dynamic)
    return 8 * mass * pressing["way"] * (10 * 9.81 + (pressing["speed"] / O.dt if getattr(engine(), "method", "") == "wall" else 0))


def run(seed, kind):
    build = KINDS[kind]
    row = {"kind": kind, "seed": seed, "gain": math.nan, "depth": math.nan, "flight": math.nan, "cone": 0.0, "off": 0.0, "work": 0.0, "bits": True, "said": "",
           "reaction": 0.0, "sink": 0.0}
    begin = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            row["model"] = build(seed)
            steps = math.ceil((plans.RESTS + plans.SHAKEN if kind == "building" else SECONDS) / O.dt)
            saves = seed % 10 == 0 and steps < 5000
            shapes = Solids() if kind in ("convex", "union") else boxes
            energies, flight, deepest = Energies(lambda: 0.0, late=kind == "building" or getattr(engine(), "wallsOnly", False)), Flight(shapes.gaps), 0.0
            rest = plans.Rest() if kind == "building" else None
            look = max(1, steps // 100)
            compliant, impacts, own = row["model"] == "compliant", 0, engine()
            for k in range(steps):
                O.step()
                energies.look()
                if rest and O.time > plans.RESTS - 2 * O.dt:
                    row.update(rest.errors())
                    rest = None
                if not compliant and kind != "building":
                    flight.look()
                if k % look == 0:
                    deepest = max(deepest, shapes.depth())
                hits = len(own.impactTimes) if compliant else 0  # a hand-off sets the forces of its step
                if k % look == 0 or hits > impacts:
                    row["cone"] = max(row["cone"], beyond_cone(compliant))
                impacts = hits
            row.update(gain=energies.relative_gain(), depth=deepest, flight=flight.worst, failures=engine().failures)
            if compliant:
                e = engine()
                row["off"] = max(e.madeEnergy, e.lostEnergy) / max(e.turnedOver, energies.floor)
            if kind == "pressed":
                row["work"] = dem.energy()["baseWork"] / most_work()
            if saves:
                end = [tuple(b.state.pos) for b in O.bodies]
                build(seed)
                for k in range(steps):
                    O.step()
                    if k % 7 == 0:
                        O.saveTmp("random")
                        O.loadTmp("random")
                row["bits"] = end == [tuple(b.state.pos) for b in O.bodies]
            row["said"] = (["failures"] * bool(row["failures"]) + [str(w.message) for w in caught] + [""])[0][:200]
        except (RuntimeError, ValueError) as refused:
            row["said"] = f"refused: {refused}"[:200]
    row["cpu"] = time.process_time() - begin
    most = MOST_DEPTH.get(row.get("model"), OTHER_DEPTH)
    row["broken"] = [name for name, bad in (("energy", not row["gain"] <= MOST_GAIN), ("depth", not row["depth"] <= most),
                                            ("flight", not row["flight"] <= FLIGHT), ("cone", not row["cone"] <= CONE.get(row.get("model"), OTHER_CONE)), ("off", not row["off"] <= MOST_OFF), ("work", not row["work"] <= MOST_WORK),
                                            ("bits", not row["bits"]),
                                            ("reaction", not row["reaction"] <= plans.REACTION), ("sink", not row["sink"] <= plans.SINK)) if bad]
    return row


def main(path, scenes, part, parts):
    done = set()
    if os.path.exists(path):
        with open(path) as file:
            done = {(row.get("kind", "thrown"), row["seed"]) for row in map(json.loads, file)}
    first = int(os.environ.get("STABILITY_FIRST", 0))
    kinds = [os.environ["STABILITY_KIND"]] if "STABILITY_KIND" in os.environ else list(KINDS)
    counts = {kind: scenes // 10 if kind != "thrown" and len(kinds) > 1 else scenes for kind in kinds}
    for kind, seed in ((kind, seed) for kind in kinds for seed in range(first + part, counts[kind], parts)):
        if (kind, seed) in done:
            continue
        row = random_mortar.run(seed) if kind == "mortar" else run(seed, kind)
        with open(path, "a") as file:
            file.write(json.dumps(row) + "\n")
        if row["broken"]:
            print(f"seed {seed}, {kind}, {row.get('model')}: {', '.join(row['broken'])}: {', '.join(f'{k} {v:.1e}' for k, v in row.items() if isinstance(v, float) and k != 'cpu')} {row['said'][:80] or 'SILENT'}", flush=True)


main(os.environ["STABILITY_ROWS"], int(os.environ["STABILITY_SCENES"]), *map(int, os.environ.get("STABILITY_PART", "0/1").split("/")))
