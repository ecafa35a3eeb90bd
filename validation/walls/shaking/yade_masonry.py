"""The wall in this plugin: `yade -n -x yade_masonry.py '<JSON>'`; prints one JSON line for each phase.

courses, per_course, amplitude (g), rest, shaking (s); model, restitution (null: natural), dt, tolerance (null: as dem.engines() chooses), strict (forces), pillar
(two slender blocks upon each other on the wall: drift and sink are those of the wall).
"""
import hashlib
import json
import math
import resource
import sys
import time

import numpy as np
from masonry import dem
from yade import O, PyRunner

case = json.loads(sys.argv[1])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
law = {} if case.get("restitution") is None else {"restitution": case["restitution"]}
stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7), **law)
base = dem.base((case["per_course"] + 4, 4, 1), stone)
ids = dem.wall(case["courses"], case["per_course"], (1.0, 0.5, 0.5), stone, on=base)
pillar = [dem.block((0.3, 0.5, 1.2), stone, center=(0.3, 0, 0.5 * case["courses"] + 0.6 + 1.2 * k)) for k in range(2 if case.get("pillar") else 0)]
STARTED = 5  # steps of a millisecond before anything is measured: the first finds the forces
rate, omega = 1000, 4 * math.pi
times = np.arange(0, case["shaking"] + 0.01, 1 / rate)
samples = np.concatenate([np.zeros(round(case["rest"] * rate) + STARTED), case["amplitude"] * 9.81 * np.sin(omega * times)])
motion = dem.RecordMotionEngine(ids=[base], samples=list(samples), interval=1 / rate, direction=(1, 0, 0))
O.engines = dem.engines(motion, model=case.get("model", "auto"), method="wall", dt=case.get("dt", 1e-3), tolerance=case.get("tolerance"))
integrator = O.engines[-1]
integrator.ompThreads = case.get("threads", 1)
integrator.strictForces = case.get("strict", False)
# O.run(n, True) looks every 40 ms only whether it has ended: the clock is read in the last step itself.
ended = PyRunner(command="ends = time.perf_counter()", nDone=1, dead=True)
O.engines = O.engines + [ended]


def places():
    return np.array([O.bodies[i].state.pos for i in ids]) - np.array(O.bodies[base].state.pos)


def losses():
    return integrator.impactDissip + integrator.frictDissip


def mechanical():
    """Kinetic and potential energy of the blocks, J, from the states of YADE's bodies alone."""
    total = 0
    for i in ids + pillar:
        state = O.bodies[i].state
        spin = state.ori.conjugate() * state.angVel
        total += state.mass * (state.vel.squaredNorm() / 2 + 9.81 * state.pos[2]) + sum(state.inertia[k] * spin[k] ** 2 for k in range(3)) / 2
    return total


start = places()
courses = np.rint((start[:, 2] - start[:, 2].min()) / 0.5)
top = np.flatnonzero(courses == courses.max())
corners = top[[start[top, 0].argmin(), start[top, 0].argmax()]]  # the base's first stroke throws the first one out
O.run(round(STARTED * 1e-3 / O.dt), True)
memory = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 / len(ids)  # bytes
sunk = 0
for phase in ("rest", "shaking"):
    if not case[phase]:
        continue
    moving = integrator.movingSteps
    steps, excursion, corner, rise, lost, cpu, wall, deepest = round(case[phase] / O.dt), 0, np.zeros(2), 0, losses(), 0, 0, 0
    first, solved, held, worked = lost, integrator.sweeps, mechanical(), integrator.baseWork
    # Energy and excursion are looked at on the way where the wall moves only.
    sample = max(1, round(0.01 / O.dt)) if case.get("fine") else max(1, round(0.1 / O.dt)) if case["amplitude"] > 0.7 and phase == "shaking" else steps
    for k in range(0, steps, sample):
        ended.dead, ended.iterPeriod, ended.iterLast = False, min(sample, steps - k), O.iter - 1
        c, w = time.process_time(), time.perf_counter()
        O.run(min(sample, steps - k), True)
        cpu, wall = cpu + time.process_time() - c, wall + ends - w
        now = losses()
        rise, lost = max(rise, lost - now), now
        deepest = max([deepest] + [-gap for i in O.interactions for gap in i.geom.gaps])
        if (k + sample) * O.dt <= 0.5 + 1e-9:
            shift = places()[:, 0] - start[:, 0]
            excursion = max(excursion, abs(shift[top].mean()))
            corner = np.maximum(corner, abs(shift[corners]))
    work = integrator.baseWork - worked
    unbalanced = mechanical() - held + lost - first - work
    moved = places() - start
    sink = -moved[top, 2].mean() / case["courses"]
    bits = hashlib.sha256(np.array([x for i in ids for v in (O.bodies[i].state.pos, O.bodies[i].state.vel) for x in v]).tobytes()).hexdigest()[:12]
    print(json.dumps(dict(case, phase=phase, blocks=len(ids), cpu=cpu / case[phase], wall=wall / case[phase], drift=1e3 * float(np.linalg.norm(moved[:, :2], axis=1).max()),
                          sink=1e3 * float(sink - sunk), excursion=float(excursion), thrown=float(corner[0]), follows=float(corner[1]), deepest=float(deepest), steps=steps, moving=integrator.movingSteps - moving,
                          movingBlocks=integrator.movingBlocks, impacts=len(integrator.impactTimes), solves=integrator.sweeps - solved, velocityResidual=integrator.velocityResidual,
                          forceResidual=integrator.forceResidual, rise=float(rise), lost=float(lost - first), impactDissip=integrator.impactDissip, work=work, unbalanced=unbalanced, memory=memory, bits=bits)), flush=True)
    sunk = sink
