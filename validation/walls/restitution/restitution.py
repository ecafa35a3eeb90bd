"""How the overturning limit of one block, a column and a slender pier moves with C, under one cycle of a sine. Run by ./run."""

import contextlib
import io
import math
import os
import time

import numpy as np
from masonry import dem
from yade import O

import masonry

OUT = os.environ.get("RESTITUTION_OUT", "results/restitution")
WIDTH, HEIGHT, DEPTH, FREQUENCY = 0.6, 3.0, 1.0, 1.0  # m, Hz; slenderness 5 in all scenes
ALPHA = math.atan(WIDTH / HEIGHT)
NATURAL = 1 - 1.5 * math.sin(ALPHA) ** 2
RESTITUTIONS = (0.5, 0.7, 0.8, 0.9, NATURAL)
LIFTS = WIDTH / HEIGHT  # g: below it the monolith does not rock
TIME = 6.0  # s


def scene(blocks, amplitude, restitution, order):
    """A column of so many equal blocks, together as wide and as high as the one block. order 'wall': method='wall' instead."""
    O.reset()
    law = {} if restitution is None else {"restitution": restitution}
    # The exact block does not slip; joints of a structure that pull apart at their pivots have no solution without slip.
    stone = dem.BlockMat(density=2000, **({"noSlip": True} if blocks == 1 else {"frictionAngle": math.pi / 4}), **law)
    base = dem.base((4, 4, 0.2), stone)
    ids = dem.stack(blocks, (WIDTH, DEPTH, HEIGHT / blocks), stone, base)
    t = np.arange(0, 1 / FREQUENCY + 1e-9, 2e-3)
    motion = dem.RecordMotionEngine(ids=[base], samples=list(amplitude * 9.81 * np.sin(2 * np.pi * FREQUENCY * t)), interval=2e-3, direction=(1, 0, 0))
    with contextlib.redirect_stdout(io.StringIO()):
        O.engines = dem.engines(motion, dt=1e-3, **({"method": "wall"} if order == "wall" else {"method": "localised", "impact_order": order}))
    return ids


def falls(blocks, amplitude, restitution, order):
    ids = scene(blocks, amplitude, restitution, order)
    start = O.bodies[ids[-1]].state.pos[2]
    while O.time < TIME:
        for _ in range(200):  # O.run(200, True) looks every 40 ms only whether it has ended
            O.step()
        if O.bodies[ids[-1]].state.pos[2] < 0.8 * start:  # a lean beyond the critical angle may come back while the base moves
            return True
    return False


def limit(blocks, restitution, order="simultaneous"):
    """Smallest amplitude (g) on a ladder of 5 % that overturns, then bisected to 0.5 %: above it there may be safe windows again."""
    low = LIFTS
    high = low
    while not falls(blocks, high, restitution, order):
        low, high = high, 1.05 * high
        if high > 40 * LIFTS:
            return math.inf
    while high / low > 1.005:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if falls(blocks, middle, restitution, order) else (middle, high)
    return math.sqrt(low * high)


def exact(restitution):
    """The same of the single block, by the event-driven solution."""
    block = masonry.RockingBlock(WIDTH / 2, HEIGHT / 2)
    found = masonry.overturning_amplitude(block, masonry.Sine(1.0, FREQUENCY), bracket=(9.81 * LIFTS, 9.81 * 3), samples=2000, restitution=restitution)
    return found[0] / 9.81 if len(found) else math.inf


def left(restitution, order):
    """The restitution of one block that loses as much energy as the column does between its first landing and its second."""
    ids = scene(3, 1.35 * LIFTS, restitution, order)
    mass = sum(O.bodies[i].state.mass for i in ids)
    while O.time < 1.5 / FREQUENCY:
        O.step()
    impacts = dem.impacts()
    return math.sqrt(1 - impacts["energy_lost"].sum() / (mass * (WIDTH**2 + HEIGHT**2) / 6 * impacts["velocity"][0] ** 2))


def final(restitution):
    """State of a rocking block 3 s after the start of one cycle of a sine that it survives."""
    ids = scene(1, 1.2 * LIFTS, restitution, "simultaneous")
    O.run(3000, True)
    state = O.bodies[ids[0]].state
    return np.array([*state.pos, *state.ori, *state.vel, *state.angVel]), len(dem.impacts())


def main():
    os.makedirs(OUT, exist_ok=True)
    scenes = (("one block", 1, "simultaneous"), ("column of 3", 3, "simultaneous"), ("column of 3, sequential", 3, "sequential"), ("pier of 12, method='wall'", 12, "wall"))
    print("| C | exact, one block | " + " | ".join(name for name, *_ in scenes) + " |\n" + "| --- " * (len(scenes) + 2) + "|", flush=True)
    table = []
    for restitution in RESTITUTIONS:
        begin = time.process_time()
        row = [exact(restitution), *(limit(blocks, restitution, order) for _, blocks, order in scenes)]
        table.append(row)
        name = f"{restitution:.4g}" + (" (natural)" if restitution == NATURAL else "")
        print(f"| {name} | " + " | ".join(f"{v:.4f} g" for v in row) + f" | ({time.process_time() - begin:.0f} CPU s)", flush=True)
    table = np.array(table)
    as_one = np.array([[left(restitution, order) for _, blocks, order in scenes if blocks == 3] for restitution in RESTITUTIONS])
    print("\n| C of every joint | first landing of the column as a whole | sequential |\n| --- | --- | --- |")
    for restitution, (together, in_turn) in zip(RESTITUTIONS, as_one):
        print(f"| {restitution:.4g} | {together:.3f} | {in_turn:.3f} |")
    told = np.max(np.abs(table[:, 2:4] / np.vectorize(exact)(as_one) - 1))
    one = np.max(np.abs(table[:, 1] / table[:, 0] - 1))
    given, impacts = final(NATURAL)
    plastic, _ = final(None)
    apart = np.max(np.abs(given - plastic))
    checks = [("one block: limit against the exact solution, bisected to 0.5 %", one, one <= 5e-3),
              ("one block: the limit rises as C falls", np.max(np.diff(table[:, 1])), np.all(np.diff(table[:, 1]) <= 5e-3 * table[:-1, 1])),
              ("columns: limit against the exact one of one block that lands with what the column lands with", told, told <= 1e-2),
              (f"C = C_H against no C given (plastic), after {impacts} impacts: largest difference of the state", apart, apart <= 1e-6 and impacts > 0)]
    for text, value, holds in checks:
        print(f"{'holds' if holds else 'MISSED'}: {text}: {value:.2g}")
    draw(table, [name for name, *_ in scenes])
    return all(holds for *_, holds in checks)


def draw(table, names):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picture, (whole, near) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    for axis in (whole, near):
        axis.plot(RESTITUTIONS, table[:, 0], "k-", label="one block, exact")
        for column, (name, mark) in enumerate(zip(names, "os^D"), start=1):
            axis.plot(RESTITUTIONS, table[:, column], mark, linestyle="none" if column == 1 else "--", label=name)
        axis.axvline(NATURAL, color="0.7", linewidth=0.8)
        axis.set(xlabel="restitution C of every joint")
        axis.grid(alpha=0.3)
    near.set(ylim=(0.995 * table[:, 2:].min(), 1.02 * table[:, 2:].max()), title="the same, near the limits of columns")
    near.text(NATURAL, near.get_ylim()[1], " natural", va="top", ha="right", rotation=90, color="0.5", fontsize=8)
    whole.set(ylabel="smallest amplitude that overturns, g", title=f"One cycle of a sine, {FREQUENCY:g} Hz; 0.6 m x 3.0 m")
    whole.legend(fontsize=8)
    picture.savefig(os.path.join(OUT, "overturning.png"), dpi=110)


if not main():
    raise SystemExit("a line does not hold")
