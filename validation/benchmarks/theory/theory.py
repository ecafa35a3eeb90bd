"""Rate of sweeps from Python: 1e5 cases a call, all cores."""

import os
import time

import numpy as np

import masonry

CASES = 100_000
G = 9.81
BLOCKS = masonry.RockingBlock(0.3, 0.3 * np.linspace(3, 12, CASES))
PERIODS = np.linspace(0.1, 2.0, CASES)


def rate(name, call):
    start = time.perf_counter()
    call()
    seconds = time.perf_counter() - start
    print(f"{name:58s}{seconds:8.2f} s{CASES / seconds:12.3g} cases/s")


print(f"{CASES} cases, {os.cpu_count()} cores")
rate("stabilised phase, closed form", lambda: masonry.closed_form.stabilised(BLOCKS, 0.0125 * G, 0.7))
rate("resonant pulse train, 30 half cycles", lambda: masonry.simulate(BLOCKS, masonry.PulseTrain(0.0125 * G), 0.7, half_cycles=30))
rate("rectangular pulse, until rest", lambda: masonry.simulate(BLOCKS, masonry.Rectangular(0.4 * G, PERIODS / 4), 0.7))
rate("one sine, until rest", lambda: masonry.simulate(BLOCKS, masonry.Sine(0.4 * G, 1 / PERIODS), 0.7))
rate("one sine, five half cycles", lambda: masonry.simulate(BLOCKS, masonry.Sine(0.4 * G, 1 / PERIODS), 0.7, half_cycles=5))
