"""The shear walls J4D and J5D of Eindhoven: push-over curve, crack pattern and first peak. Run by ./run --shear-wall.

Raijmakers and Vermeltfoort (1992): 990 x 1000 x 100 mm, courses of 210 x 52 x 100 mm bricks with 10 mm of mortar, 0.30 MPa, then the top is held at its height and
level, and pushed. Parameters as Lourenco (1996) has them for these walls. Writes shear_wall.csv, shear_wall.png and shear_wall_cracks.png into results/mortar."""

import math
import os
import sys
import time
from pathlib import Path

import numpy as np
from masonry import dem, results
from masonry.dem.units import units as split_units
from mortar_scene import eindhoven
from rocking_scene import joint_engine, quiet_engines
from yade import O

BRICK, COURSES, PER_COURSE = (0.22, 0.1, 1.0 / 16), 16, 4.5  # with half a joint at each side
AREA, HEIGHT = 0.99 * 0.1, 1.0  # m^2, m
PRESSURE = 0.30e6  # Pa
PUSH, SPEED = 1.8e-3, 0.03  # m, m/s
# kN: peaks of the two tests as they are quoted, see README.md.
PUBLISHED = 50.0, 57.0
MIDDLE = dict(tensileStrength=2e6, fractureEnergy=80, cohesion=2.8e6, shearFractureEnergy=500, frictionAngle=math.pi / 4, normalStiffness=2e11, shearStiffness=2e11)


def scene():
    O.reset()
    material = dem.BlockMat(density=1900, frictionAngle=math.atan(0.75), mortar=eindhoven())
    base = dem.base((2, 1, 0.2), material)
    ids = dem.wall(COURSES, PER_COURSE, BRICK, material, on=base, split=dem.JointMat(**MIDDLE))
    beam = dem.block((0.99, 0.1, 0.1), material, center=(0, 0, HEIGHT + 0.05))
    dem.dead_load(beam, PRESSURE * AREA - 9.81 * O.bodies[beam].state.mass)
    return base, ids, beam


def vertical(push):
    """Force of the wall on the held beam, upwards, N, at each sample."""
    recorder = push.recorder
    forces = np.frombuffer(recorder.jointForcesAsBytes()).reshape(-1, 8)
    one, two = (np.isin(forces[:, k], push.platens) for k in (0, 1))
    sign = np.where(one & ~two, 1.0, np.where(two & ~one, -1.0, 0.0))  # forces act on the second body
    sums = np.zeros(len(recorder.times))
    np.add.at(sums, np.repeat(np.arange(len(sums)), recorder.jointCounts), -sign * forces[:, 4])
    return sums


def first_peak(force):
    """Number of the first sample whose force is not exceeded in the next tenth of the test and falls by 2 % in it."""
    ahead = max(2, len(force) // 10)
    for k in range(len(force) - ahead):
        if force[k] > 0.3 * force.max() and force[k] >= force[k:k + ahead].max() and force[k:k + ahead].min() < 0.98 * force[k]:
            return k
    return int(np.argmax(force))


def picture(curve, table, peak, path):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    axes.axhspan(*PUBLISHED, color="tab:orange", alpha=0.25, label="peaks of J4D and J5D as quoted, 50 to 57 kN")
    axes.plot(1e3 * curve["displacement"], 1e-3 * curve["force"], color="tab:blue", label="force along the push")
    axes.plot(1e3 * curve["displacement"], 1e-3 * table, color="0.5", linewidth=1, label="vertical force of the held top")
    axes.plot(1e3 * curve["displacement"][peak], 1e-3 * curve["force"][peak], "o", color="tab:red", label="first peak, or the largest force")
    axes.set(xlabel="displacement of the top (mm)", ylabel="force (kN)", xlim=(0, None), ylim=(0, None))
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=130)


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    begun = time.process_time()
    base, ids, beam = scene()
    recorder = dem.WallRecorder(virtPeriod=5e-3)
    O.engines = quiet_engines(model="auto")
    dem.run(0.002)
    carried = -dem.reactions(base)["force"][:, 2].sum()
    print(f"{len(ids) + 1} blocks, {len(dem.damage())} joints with mortar, dt = {O.dt:.3g} s; the base carries {1e-3 * abs(carried):.2f} kN, damage {dem.damage()['worst'].max():g}", flush=True)
    push = dem.push([beam], displacement=PUSH, speed=SPEED, vertical="held", collapse=None)
    O.engines = quiet_engines(push, model="auto", recorder=recorder)
    dem.run(until=push)
    curve, down = push.curve, vertical(push)
    push.save(folder / "shear_wall.csv")
    peak = first_peak(curve["force"])
    history = dem.wall_history(recorder)
    cracks = results.cracks(history)
    cracks.picture(folder / "shear_wall_cracks.png")
    picture(curve, down, peak, folder / "shear_wall.png")
    engine, table = joint_engine(), dem.damage()
    halves = {pair for _, pairs in split_units().values() for pair in pairs}
    upright = np.array([abs(O.bodies[int(a)].state.refPos[2] - O.bodies[int(b)].state.refPos[2]) < 1e-3 for a, b in zip(table["body1"], table["body2"])])
    units = np.array([(int(a), int(b)) in halves for a, b in zip(table["body1"], table["body2"])])
    open_ = table["worst"] >= 0.95
    print(f"first peak {1e-3 * curve['force'][peak]:.1f} kN at {1e3 * curve['displacement'][peak]:.2f} mm (vertical {1e-3 * down[peak]:.1f} kN); "
          f"largest force {1e-3 * curve['force'].max():.1f} kN at {1e3 * curve['displacement'][curve['force'].argmax()]:.2f} mm; quoted {PUBLISHED[0]:g} to {PUBLISHED[1]:g} kN")
    print(f"cracked through (D > 0.95): {(open_ & ~upright).sum()} bed joints, {(open_ & upright & ~units).sum()} head joints, {(open_ & units).sum()} units")
    print(cracks)
    print(f"energy made {engine.madeEnergy / engine.turnedOver:.1e}, lost {engine.lostEnergy / engine.turnedOver:.1e} of what is turned over; {time.process_time() - begun:.0f} CPU s, {O.iter} steps", flush=True)
    return 0


os._exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/mortar")))  # yade -x would end with status 0
