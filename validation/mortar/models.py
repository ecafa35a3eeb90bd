"""The same wall with compliant and with rigid joints, shaken by a sine that cracks some of them: cracks, drift, energies, CPU. Run by ./run --models."""

import os
import time

import numpy as np
from masonry import Record, dem
from mortar_scene import brick_material, eindhoven
from rocking_scene import quiet_engines
from yade import O

G = 9.81
LENGTH, COURSES, BLOCK = 8, 8, (0.25, 0.2, 0.2)  # blocks a course; m
STRENGTH = 0.02e6  # Pa
RECORDS = ((1.5, 4), (2.0, 4), (2.5, 4))  # g, Hz; one second


def run(peak, frequency, **model):
    """(joints, cracked ones, broken ones, J of cracks, largest and last drift of the top in mm, CPU s, steps)."""
    O.reset()
    mortar = eindhoven(tensileStrength=STRENGTH, cohesion=1.4 * STRENGTH, fractureEnergy=4, shearFractureEnergy=28, normalStiffness=8.2e9, shearStiffness=3.6e9)
    material = brick_material(mortar)
    base = dem.base((6, 1, 0.2), material)
    ids = dem.wall(COURSES, LENGTH, BLOCK, material, on=base)
    times = np.arange(0, 0.5005, 1e-3)
    motion = dem.record_motion(Record(1e-3, peak * G * np.sin(2 * np.pi * frequency * times)), [base])
    O.engines = quiet_engines(motion, **model)
    top, begun, drift = ids[-1], time.process_time(), []
    start = O.bodies[top].state.pos[0]
    while O.time < 1:
        dem.run(0.02)
        drift.append(O.bodies[top].state.pos[0] - start - O.bodies[base].state.pos[0])
    table = dem.damage()
    return (len(table), (table["worst"] >= 0.02).sum(), (table["damage"] == 1).sum(), dem.energy()["crackDissip"], 1e3 * np.abs(drift).max(), 1e3 * drift[-1],
            time.process_time() - begun, O.iter)


def main():
    print("| sine | joints | | cracked | broken | energy of cracks, J | largest drift, mm | last drift, mm | CPU s | steps |\n|" + " --- |" * 10)
    for peak, frequency in RECORDS:
        found = {}
        for name, model in (("compliant", {"model": "compliant"}), ("wall, 1 ms", {"method": "wall", "model": "auto", "dt": 1e-3})):
            found[name] = run(peak, frequency, **model)
            joints, cracked, broken, energy, most, last, cpu, count = found[name]
            print(f"| {peak} g, {frequency} Hz | {joints} | {name} | {cracked} | {broken} | {energy:.2f} | {most:.2f} | {last:.2f} | {cpu:.1f} | {count} |", flush=True)
        print(f"CPU compliant over wall: {found['compliant'][6] / found['wall, 1 ms'][6]:.1f}", flush=True)


main()
os._exit(0)
