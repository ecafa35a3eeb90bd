"""BlockRecorder: what it keeps is what the exact block does, and it outlives saving and loading."""
import os
import tempfile

import numpy as np
from masonry import dem
from rocking_scene import one_block, quiet_engines
from yade import O

import masonry

base, block, exact_block = one_block(5, restitution=0.9)
tilt = 0.5 * exact_block.critical_angle
dem.tilt(block, tilt)
recorder = dem.BlockRecorder(ids=[block], iterPeriod=25)
O.engines = quiet_engines(recorder=recorder)
O.run(20000, True)
table = dem.history(recorder)
assert len(table) >= 799 and np.all(np.diff(table["time"]) > 0)

angle = table["rotation"][:, 0, 1]
exact = masonry.simulate(exact_block, restitution=0.9, initial_angle=tilt, t_end=table["time"][-1])
# Elastic angle 2e-5 rad = 1e-4 of the critical angle, and time errors of as much of a half cycle.
assert np.max(np.abs(angle - exact.sample(table["time"])[0])) < 3e-4 * exact_block.critical_angle
# A block that rocks without sliding: the far edge is up by 2b sin(angle), up to the compression of 1.2e-5 m.
assert np.max(np.abs(table["uplift"][:, 0] - 0.6 * np.sin(np.abs(angle)))) < 2e-5
# Newton's law, averaged: the mean force carries the weight but for the change of momentum.
weight = O.bodies[block].state.mass * 9.81
velocity = np.gradient(table["position"][:, 0, 2], table["time"])
mean = np.trapz(table["force"][:, 0, 2], table["time"]) / (table["time"][-1] - table["time"][0])
# Each impact turns the centre of the block from down (b w) to up (b C w).
impulses = sum(im["velocity"] * (1 + im["restitution"]) for im in dem.impacts()) * exact_block.half_width * O.bodies[block].state.mass
change = O.bodies[block].state.mass * (velocity[-2] - velocity[1])
expected = weight + (change - impulses) / (table["time"][-1] - table["time"][0])  # impulses are not among the recorded forces
assert abs(mean / expected - 1) < 2e-3, (mean, expected)  # trapezoidal rule across seven impacts, 4e-3 s apart in 3 s

with tempfile.TemporaryDirectory() as folder:
    dem.save_history(recorder, os.path.join(folder, "h.npz"))
    assert np.array_equal(np.load(os.path.join(folder, "h.npz"))["rotation"], table["rotation"])
    dem.save_history(recorder, os.path.join(folder, "h.csv"))
    read = np.genfromtxt(os.path.join(folder, "h.csv"), delimiter=",", names=True)
    assert np.allclose(read[f"rotation_y_of_{block}_rad"], angle, rtol=0, atol=1e-15)
    O.save(os.path.join(folder, "scene.xml"))
    O.load(os.path.join(folder, "scene.xml"))
loaded = [e for e in O.engines if isinstance(e, dem.BlockRecorder)][0]
assert np.array_equal(dem.history(loaded), table)

try:
    dem.save_history(loaded, "h.txt")
    raise AssertionError("a file of unknown kind was accepted")
except ValueError as error:
    assert "h.txt" in str(error)
print("recorder: angle, uplift, force, files, loading")
