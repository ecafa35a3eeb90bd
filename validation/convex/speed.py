"""CPU time of an arch and of a vault at rest, beside Bullet's hulls and YADE's Polyhedra. Run by ./run --speed."""

import csv
import os
import statistics
import time

import numpy as np
import peers
import polyhedra
import statics
from masonry import dem
from rows import start
from structures import G, places, stone, weight
from yade import O

OUT = os.environ.get("CONVEX_OUT", "results/convex")
FRICTION, RADIUS, THICKNESS = 0.7, 2.0, 0.15  # m; of the radius
ROUNDS = 3
SETTING_UP = 0.02  # s before the clock starts: the first steps set the engines up
LIMIT = 20.0  # CPU seconds that a run of Polyhedra may take


def bases(length):
    return [dem.base((1.0, length, 0.5), stone(FRICTION), at=(side * RADIUS, 0)) for side in (-1, 1)]


def arch():
    on = bases(2.0)
    return on, dem.arch(2 * RADIUS, RADIUS, THICKNESS * RADIUS, 27, 1.0, stone(FRICTION), on=on, measured="middle")


def vault():
    on = bases(32.0)
    return on, dem.barrel_vault(2 * RADIUS, RADIUS, THICKNESS * RADIUS, 16, 31.0, 62, stone(FRICTION), on=on, measured="middle")


class Own:
    def __init__(self, method, model):
        self.mode = method, model
        self.name = f"`{method}`, {model}"

    def prepare(self):
        start(self.mode)

    def run(self, seconds):
        return seconds, timed(seconds)

    def places(self, ids):
        return places(ids)

    def force(self, id):
        return -dem.reactions(id)["force"].sum(axis=0)


class Bullet:
    def __init__(self, iterations):
        self.iterations, self.name = iterations, f"Bullet hulls, {iterations} iterations"

    def prepare(self):
        self.world = peers.Bullet(self.iterations)

    def run(self, seconds):
        return seconds, self.world.step(peers.STEP, round(seconds / peers.STEP))

    def places(self, ids):
        return self.world.states()[ids, :3].copy()

    def force(self, id):
        return self.world.force(id, peers.STEP)


class Polyhedra:
    name = "YADE Polyhedra"

    def prepare(self):
        polyhedra.replace_scene(FRICTION)

    def run(self, seconds):
        """As long as LIMIT allows."""
        each = timed(3 * O.dt) / 3
        steps = max(1, min(round(seconds / O.dt), round(LIMIT / each)))
        return steps * O.dt, timed(steps * O.dt)

    def places(self, ids):
        return places(ids)

    def force(self, id):
        return polyhedra.force_on(id)


def timed(seconds):
    begin = time.process_time()
    O.run(max(1, round(seconds / O.dt)), True)
    return time.process_time() - begin


def measure(scene, program, seconds):
    """CPU s per simulated s, simulated s, largest movement (mm), error of the vertical reaction and H, both over the weight."""
    O.reset()
    on, ids = scene()
    heavy = weight(ids)
    program.prepare()
    begin = program.places(ids)
    program.run(SETTING_UP)
    simulated, cpu = program.run(seconds)
    moved = np.linalg.norm(program.places(ids) - begin, axis=1).max()
    forces = [program.force(id) for id in on]
    return cpu / simulated, simulated, 1e3 * moved, -sum(force[2] for force in forces) / heavy - 1, abs(forces[0][0]) / heavy


# --- walls of boxes, given as polyhedra ---

BRICK = (1.0, 0.5, 0.5)  # m
LEANS = {"boxes of dem.wall": None, "the same by dem.convex": 0.0, "hexahedra by dem.convex": 1e-6}  # by how much, of its thickness, a brick is thinner above


def wall(courses, per_course, lean):
    """(base, ids) of a wall in running bond."""
    O.reset()
    base = dem.base((per_course + 4, 4, 1), stone(FRICTION))
    ids = dem.wall(courses, per_course, BRICK, stone(FRICTION), on=base)
    if lean is None:
        return base, ids
    bricks = [(np.array(O.bodies[id].state.pos), np.array(O.bodies[id].shape.extents)) for id in ids]
    O.reset()
    base = dem.base((per_course + 4, 4, 1), stone(FRICTION))
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return base, [dem.convex(center + half * corners * np.stack([np.ones(8), 1 - lean * (corners[:, 2] > 0), np.ones(8)], axis=1), stone(FRICTION)) for center, half in bricks]


def shaken(courses, per_course, lean, model):
    """CPU s per s at rest and at 0.3 g, 2 Hz, 2 s each."""
    base, ids = wall(courses, per_course, lean)
    samples = np.concatenate([np.zeros(2010), 0.3 * G * np.sin(4 * np.pi * np.arange(0, 2.01, 1e-3))])
    start(("wall", model), motion=dem.RecordMotionEngine(ids=[base], samples=list(samples), interval=1e-3, direction=(1, 0, 0)), dt=1e-3)
    O.run(10, True)  # the first steps set the engines up
    return timed(2.0) / 2, timed(2.0) / 2


def walls():
    table = [["wall of", "model", "bricks", "CPU s per s at rest", "at 0.3 g", "over boxes, at rest", "at 0.3 g"]]
    print("\n| " + " | ".join(table[0]) + " |\n" + "| --- " * len(table[0]) + "|", flush=True)
    for courses, per_course in ((10, 10), (20, 20)):
        for model in ("planar", "spatial"):
            given = {name: lean for name, lean in LEANS.items() if model == "spatial" or not lean}  # bricks that lean are no prisms across the plane
            found = {name: [] for name in given}
            for _ in range(ROUNDS):
                for name, lean in given.items():
                    found[name].append(shaken(courses, per_course, lean, model))
            medians = {name: np.median(values, axis=0) for name, values in found.items()}
            ratios = {name: np.median(np.array(values) / found["boxes of dem.wall"], axis=0) for name, values in found.items()}  # of each round
            for name in given:
                numbers = [*medians[name], *ratios[name]]
                table.append([len(wall(courses, per_course, None)[1]), model, name, *(f"{value:.3g}" for value in numbers)])
                print("| " + " | ".join(map(str, table[-1])) + " |", flush=True)
    return table


def main():
    hulls = [Bullet(10), Bullet(100)] if peers.has_bullet() else []
    if not hulls:
        print("Bullet is left out: install libbullet-dev, and build the target convex_bullet.")
    scenes = [("arch of 27", arch, 3.0, statics.arch(27, THICKNESS), [Own("localised", "planar"), Own("wall", "planar"), Own("wall", "spatial")]),
              ("vault of 1,000", vault, 0.5, statics.arch(16, THICKNESS), [Own("wall", "spatial")])]
    table = [["scene", "program", "CPU s per s", "simulated, s", "moved, mm", "error of the vertical reaction", "H/W", "bounds of H/W by statics"]]
    print("| " + " | ".join(table[0]) + " |\n" + "| --- " * len(table[0]) + "|", flush=True)
    for name, scene, seconds, structure, own in scenes:
        least, most = statics.thrust(structure, FRICTION)
        programs = [*own, *hulls, Polyhedra()]
        found = {program: [] for program in programs}
        for turn in range(ROUNDS):
            for program in programs:
                if turn == 0 or not isinstance(program, Polyhedra):
                    found[program].append(measure(scene, program, seconds))
        for program in programs:
            cpu, simulated, *errors = (statistics.median(values) for values in zip(*found[program]))
            table.append([name, program.name, f"{cpu:.3g}", f"{simulated:.3g}", *(f"{value:.2g}" for value in errors[:2]), f"{errors[2]:.4f}", f"{least:.4f} to {most:.4f}"])
            print("| " + " | ".join(table[-1]) + " |", flush=True)
    os.makedirs(OUT, exist_ok=True)
    with open(os.path.join(OUT, "speed.csv"), "w", newline="") as file:
        csv.writer(file).writerows([*table, *walls()])


if __name__ == "__main__":
    main()
    os._exit(0)  # yade -x would end with status 0 whatever happens
