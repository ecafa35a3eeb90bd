"""Blocks made from the top down before their base are the same scene as a base with blocks made from the bottom up."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, stone, steps
from yade import O

import masonry

TIMES = np.arange(0, 2, 0.01)


def sideways(base):
    return [dem.record_motion(masonry.Record(0.01, 4 * np.sin(2 * math.pi * 1.1 * TIMES)), [base])]


def both(base):
    return sideways(base) + [dem.record_motion(masonry.Record(0.01, 3 * np.sin(2 * math.pi * 2.9 * TIMES + 1)), [base], direction=(0, 0, 1))]


def pulses(base):
    return [dem.PulseTrainEngine(ids=[base], impulse=0.12, times=[0, 0.4])]


def run(from_above, places, size, motion, end, material, options):
    """What the scene is at the end and was on the way, bodies by their place in it: the base, then from the bottom up."""
    O.reset()
    material = stone(**material)
    makers = [lambda: dem.base((8, 2, 0.3), material)] + [lambda place=place: dem.block(size, material, center=place) for place in places]
    ids = {}
    for k in reversed(range(len(makers))) if from_above else range(len(makers)):
        ids[k] = makers[k]()
    rank = {id: k for k, id in ids.items()}
    recorder = dem.BlockRecorder(ids=[ids[k] for k in range(1, len(ids))], iterPeriod=5)
    O.engines = quiet_engines(motion(ids[0]), recorder=recorder, **options)
    steps(int(end / O.dt))
    table, history, energy = dem.impacts(), dem.history(recorder), dem.energy()
    joules = max(abs(value) for name, value in energy.items() if name != "potential")
    result = {"place": [O.bodies[ids[k]].state.pos for k in range(len(ids))], "energy": np.array(list(energy.values())) / joules,
              "bodies": [(rank[impact["body"]], rank[impact["support"]]) for impact in table], "energy_lost": table["energy_lost"] / joules,
              "uplift": history["uplift"], "force": history["force"].mean(axis=0) / np.abs(history["force"].mean(axis=0)).max()}
    result.update((name, table[name]) for name in ("time", "restitution", "velocity", "friction_demand", "application"))
    return {name: np.asarray(value, dtype=float) for name, value in result.items()}


one, two, bond = [(0, 0, 1.5)], [(0, 0, 0.75), (0, 0, 2.25)], [(-0.4, 0, 0.2), (0.4, 0, 0.2), (0, 0, 0.6), (0, 0, 1.0)]
slender, brick = (0.6, 1, 3), (0.8, 0.4, 0.4)
rocks, slips = dict(restitution=0.7), dict(restitution=0.5, noSlip=False, frictionAngle=0.6)


@pytest.mark.parametrize("places, size, motion, end, material, bound, options", (
    (one, slender, both, 1.5, rocks, 1e-6, dict(model="planar")),
    (one, slender, both, 1.5, rocks, 1e-6, dict(model="spatial")),
    (one, slender, pulses, 1.2, dict(restitution=0.7, noSlip=False, frictionAngle=1.2), 1e-6, dict(model="planar")),
    (one, slender, sideways, 1.0, rocks, 1e-6, dict(model="compliant", penetration=1e-5)),
    (two, (0.6, 1, 1.5), sideways, 1.2, rocks, 1e-5, dict(model="planar", impact_order="sequential")),
    (bond, brick, sideways, 0.6, slips, 1e-4, dict(model="planar")),
))
def test_the_same_whichever_is_made_first(places, size, motion, end, material, bound, options):
    """Contacts are solved in another order: what that leaves is the solver's tolerance, many times grown through impacts."""
    below, above = (run(from_above, places, size, motion, end, material, options) for from_above in (False, True))
    assert places is bond or len(below["time"]) > 0
    for name in below:
        assert below[name].shape == above[name].shape, name
        assert np.allclose(below[name], above[name], rtol=0, atol=bound, equal_nan=True), name
    print(f"{options}: {len(below['time'])} impacts, the same whichever is made first")
