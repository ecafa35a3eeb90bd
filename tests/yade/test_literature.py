"""Results of the literature beyond the single rocking block, each by its closed form."""

import math

import numpy as np
from masonry import dem
from rocking_scene import rigid_engines
from yade import O, Vector3

import masonry

G = 9.81

# --- two columns with a beam on them rock as one block with 4/3 (1 + 3 gamma) m R^2 for inertia and (1 + 2 gamma) m g R for weight, gamma the mass of the beam over that of
# the columns; the natural restitution is (1 - 3/2 sin^2 + 3 gamma cos 2 alpha)/(1 + 3 gamma) (Makris and Vassiliou 2013). First impact, in s, and next peak ---
for gamma in (0.5, 2):
    for method, time_error, peak_error in (("localised", 1e-6, 1e-5), ("wall", None, 5e-3)):
        O.reset()
        stone = dem.BlockMat(density=2000, noSlip=True)
        heavy = dem.BlockMat(density=2000 * gamma * 2 * 0.5 * 3 / (4 * 0.4), noSlip=True)
        base = dem.base((10, 4, 0.2), stone)
        columns = [dem.block((0.5, 1, 3), stone, center=(x, 0, 1.5)) for x in (-1.5, 1.5)]
        beam = dem.block((4, 1, 0.4), heavy, center=(0, 0, 3.2))
        alpha, tilt = math.atan(0.5 / 3), 0.05
        for column in columns:
            dem.tilt(column, tilt)
        O.bodies[beam].state.pos += Vector3(0.5 - 0.5 * math.cos(tilt) + 3 * math.sin(tilt), 0, 0.5 * math.sin(tilt) + 3 * math.cos(tilt) - 3)
        O.engines = rigid_engines(method=method, dt=1e-3)
        peak = 0
        for _ in range(1200):
            O.step()
            peak = max(peak, -dem.angle(columns[0]))
            assert abs(dem.angle(columns[0]) - dem.angle(columns[1])) < 1e-5 and abs(dem.angle(beam)) < 1e-5
        # A block of this size has the same equation of motion.
        larger = (1 + 3 * gamma) / (1 + 2 * gamma)
        natural = (1 - 1.5 * math.sin(alpha) ** 2 + 3 * gamma * math.cos(2 * alpha)) / (1 + 3 * gamma)
        exact = masonry.simulate(masonry.RockingBlock(0.25 * larger, 1.5 * larger), restitution=natural, initial_angle=tilt, half_cycles=2)
        assert abs(peak / abs(exact.peak_angles[1]) - 1) < peak_error, (gamma, method, peak, exact.peak_angles)
        if time_error:  # 'wall' lists no natural impacts
            first = dem.impacts()[0]
            assert abs(first["time"] - exact.impact_times[0]) < time_error and abs(first["restitution"] - natural) < 1e-9

# --- a flat block on a base that goes round in a circle with the acceleration A slides with the speed A/w sqrt(1 - (mu g/A)^2) relative to it ---
radians, acceleration, friction = 4 * math.pi, 0.5 * G, 0.2
times = np.arange(0, 6, 1e-3)
for method in ("localised", "wall"):
    O.reset()
    plate = dem.BlockMat(density=2000, frictionAngle=math.atan(friction))
    base = dem.base((20, 20, 0.2), plate)
    block = dem.block((0.8, 0.8, 0.02), plate, on=base)
    motions = [dem.record_motion(masonry.Record(1e-3, acceleration * wave(radians * times)), ids=[base], direction=direction)
               for wave, direction in ((np.cos, (1, 0, 0)), (np.sin, (0, 1, 0)))]
    O.engines = rigid_engines(motions, method=method, dt=1e-3)
    O.run(5000, True)
    speed = (O.bodies[block].state.vel - O.bodies[base].state.vel).norm()
    assert abs(speed / (acceleration / radians * math.sqrt(1 - (friction * G / acceleration) ** 2)) - 1) < 5e-5, (method, speed)

# --- friction acts at the corners of a patch: a face that turns on its bed has the arm of its corners, not that of an even pressure (README, Limits) ---
for sides, even in (((0.8, 0.8), 1 / 1.848), ((1.6, 0.4), 1 / 1.943)):
    for method in ("localised", "wall"):
        O.reset()
        plate = dem.BlockMat(density=2000, frictionAngle=math.atan(friction))
        block = dem.block((*sides, 0.1), plate, on=dem.base((4, 4, 0.2), plate))
        O.engines = rigid_engines(model="spatial", method=method, dt=1e-3)
        O.bodies[block].state.angVel = (0, 0, 3)
        O.run(50, True)
        arm, inertia = 0.5 * math.hypot(*sides), (sides[0] ** 2 + sides[1] ** 2) / 12
        along, across = (np.meshgrid(*[(np.arange(400) + 0.5) / 400 * side - side / 2 for side in sides]))
        assert abs(np.hypot(along, across).mean() / arm / even - 1) < 1e-3
        slowed = (3 - O.bodies[block].state.angVel[2]) / O.time
        assert abs(slowed * inertia / (friction * G * arm) - 1) < 1e-6, (sides, method, slowed)
