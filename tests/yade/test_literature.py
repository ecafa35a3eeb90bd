"""Results of the literature beyond the single rocking block, each by its closed form."""

import math

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines, rigid_engines
from scipy.integrate import solve_ivp
from yade import O, Quaternion, Vector3

import masonry

G = 9.81
RADIANS, ACCELERATION, FRICTION = 4 * math.pi, 0.5 * G, 0.2  # of a base that goes round in a circle, and of the plates on it


@pytest.mark.parametrize("gamma", (0.5, 2))
def test_columns_with_a_beam_rock_as_one_block(gamma):
    """Two columns with a beam on them rock as one block with 4/3 (1 + 3 gamma) m R^2 for inertia and (1 + 2 gamma) m g R for weight, gamma the mass
    of the beam over that of the columns; the natural restitution is (1 - 3/2 sin^2 + 3 gamma cos 2 alpha)/(1 + 3 gamma) (Makris and Vassiliou
    2013). First impact, in s, and next peak."""
    stone = dem.BlockMat(density=2000, noSlip=True)
    heavy = dem.BlockMat(density=2000 * gamma * 2 * 0.5 * 3 / (4 * 0.4), noSlip=True)
    base = dem.base((10, 4, 0.2), stone)
    columns = [dem.block((0.5, 1, 3), stone, center=(x, 0, 1.5)) for x in (-1.5, 1.5)]
    beam = dem.block((4, 1, 0.4), heavy, center=(0, 0, 3.2))
    alpha, tilt = math.atan(0.5 / 3), 0.05
    for column in columns:
        dem.tilt(column, tilt)
    O.bodies[beam].state.pos += Vector3(0.5 - 0.5 * math.cos(tilt) + 3 * math.sin(tilt), 0, 0.5 * math.sin(tilt) + 3 * math.cos(tilt) - 3)
    O.engines = rigid_engines(dt=1e-3)
    peak = 0
    for _ in range(1200):
        O.step()
        peak = max(peak, -dem.angle(columns[0]))
        assert abs(dem.angle(columns[0]) - dem.angle(columns[1])) < 1e-5 and abs(dem.angle(beam)) < 1e-5
    # A block of this size has the same equation of motion.
    larger = (1 + 3 * gamma) / (1 + 2 * gamma)
    natural = (1 - 1.5 * math.sin(alpha) ** 2 + 3 * gamma * math.cos(2 * alpha)) / (1 + 3 * gamma)
    exact = masonry.simulate(masonry.RockingBlock(0.25 * larger, 1.5 * larger), restitution=natural, initial_angle=tilt, half_cycles=2)
    assert abs(peak / abs(exact.peak_angles[1]) - 1) < 1e-5
    first = dem.impacts()[0]
    assert abs(first["time"] - exact.impact_times[0]) < 1e-6 and abs(first["restitution"] - natural) < 1e-9


def test_a_block_slides_on_a_base_that_goes_round():
    """A flat block on a base that goes round in a circle with the acceleration A slides with the speed A/w sqrt(1 - (mu g/A)^2) relative to it."""
    times = np.arange(0, 6, 1e-3)
    plate = dem.BlockMat(density=2000, frictionAngle=math.atan(FRICTION))
    base = dem.base((20, 20, 0.2), plate)
    block = dem.block((0.8, 0.8, 0.02), plate, on=base)
    motions = [dem.record_motion(masonry.Record(1e-3, ACCELERATION * wave(RADIANS * times)), ids=[base], direction=direction)
               for wave, direction in ((np.cos, (1, 0, 0)), (np.sin, (0, 1, 0)))]
    O.engines = rigid_engines(motions, dt=1e-3)
    O.run(5000, True)
    speed = (O.bodies[block].state.vel - O.bodies[base].state.vel).norm()
    assert abs(speed / (ACCELERATION / RADIANS * math.sqrt(1 - (FRICTION * G / ACCELERATION) ** 2)) - 1) < 5e-5


@pytest.mark.parametrize("sides", ((0.8, 0.8), (1.6, 0.4), (0.4, 1.6)))
@pytest.mark.parametrize("model, error", (("spatial", 1e-3), ("compliant", 1e-2)))
def test_a_face_that_turns_on_its_bed_is_slowed(sides, model, error):
    """A face that turns on its bed is slowed by the torque of an even pressure, mu N times the mean distance from the centre. Compliant joints are
    right to 1 %: they are elastic until they slip, and their pressure wavers."""
    along, across = np.meshgrid(*[(np.arange(400) + 0.5) / 400 * side - side / 2 for side in sides])
    arm = np.hypot(along, across).mean()
    inertia = (sides[0] ** 2 + sides[1] ** 2) / 12
    plate = dem.BlockMat(density=2000, frictionAngle=math.atan(FRICTION))
    block = dem.block((*sides, 0.1), plate, on=dem.base((4, 4, 0.2), plate))
    O.engines = quiet_engines(penetration=1e-5) if model == "compliant" else rigid_engines(model=model, dt=1e-3)
    O.bodies[block].state.angVel = (0, 0, 3)
    while O.time < 0.05:
        O.step()
    slowed = (3 - O.bodies[block].state.angVel[2]) / O.time
    assert abs(slowed * inertia / (FRICTION * G * arm) - 1) < error


@pytest.mark.parametrize("model", ("spatial", "compliant"))
@pytest.mark.parametrize("share, turns", ((0.97, False), (1.03, True)))
def test_a_couple_twists_a_block_on_its_bed(model, share, turns):
    """A block that a couple twists on its bed stands below the torque of an even pressure and turns above it."""
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(FRICTION))
    block = dem.block((0.8, 0.8, 0.3), stone, on=dem.base((4, 4, 0.2), stone))
    torque = share * FRICTION * O.bodies[block].state.mass * G * 0.4 * (math.sqrt(2) + math.log(1 + math.sqrt(2))) / 3
    O.engines = quiet_engines(model=model, **({"penetration": 1e-5} if model == "compliant" else {}))
    grown = 0.2  # s, over which the couple grows
    while O.time < 0.5:
        O.forces.setPermT(block, (0, 0, torque * min(1, O.time / grown)))
        O.step()
    spin = O.bodies[block].state.angVel[2]
    assert (spin > 0.01) == turns


@pytest.mark.parametrize("ratio, count, mu, half, tilt", (
    (20, 1, 0.6, (0.4, 0.4, 0.6), 0.04), (500, 1, 0.6, (0.4, 0.4, 0.6), 0.04), (1.5, 2, 0.8, (0.4, 0.2, 0.3), 0.02),
))
def test_a_stack_lands_as_one_body(ratio, count, mu, half, tilt):
    """A stack that lands as one body, its top heavier by far, goes on with 1 - 2 M b^2/I of its speed (angular momentum about the new edge; M, I:
    mass and moment of inertia about that of the whole), until the next peak; squat alike blocks too."""
    stone, heavy = (dem.BlockMat(density=density, frictionAngle=math.atan(mu)) for density in (2000, 2000 * ratio * half[1] / half[2]))
    base = dem.base((10, 4, 0.2), stone)
    b, heights = half[0], [half[1]] * count + [half[2]]
    centers = 2 * np.cumsum(heights) - heights
    ids = [dem.block((2 * b, 1, 2 * a), material, orientation=Quaternion((0, 1, 0), tilt),
                     center=(b - b * math.cos(tilt) + z * math.sin(tilt), 0, b * math.sin(tilt) + z * math.cos(tilt)))
           for a, z, material in zip(heights, centers, [stone] * count + [heavy])]
    O.engines = rigid_engines(model="planar", dt=1e-3)
    masses = np.array([O.bodies[id].state.mass for id in ids])
    mass, inertia = masses.sum(), (masses * ((b**2 + np.square(heights)) / 3 + b**2 + centers**2)).sum()
    middle = (masses * centers).sum() / mass
    alike = 0.75 * inertia / (mass * (b**2 + middle**2))  # one block so many times as large has the same equation of motion
    exact = masonry.simulate(masonry.RockingBlock(alike * b, alike * middle), restitution=1 - 2 * mass * b**2 / inertia, initial_angle=tilt, half_cycles=2)
    peak = 0
    while O.time < exact.impact_times[0] + 0.6 * (exact.impact_times[1] - exact.impact_times[0]):
        O.step()
        peak = max(peak, -dem.angle(ids[-1]))
    state = O.bodies[ids[0]].state
    pivot = (state.pos + state.ori * Vector3(-b, 0, -half[1]))[0]
    assert abs(peak / abs(exact.peak_angles[1]) - 1) < 1e-4 and abs(pivot + b) < 1e-4, exact.peak_angles


@pytest.fixture(scope="module")
def wobbling():
    """A block that wobbles from corner to corner (Chatzis and Smyth 2012): Euler's equations about the corner c that it stands on; one that lands becomes
    the pivot, with the angular momentum about it. In the block's axes, per mass; R turns them into the world's. Half sizes, centre and orientation at
    the start, and (time, R) from then on."""
    half = np.array([0.3, 0.3, 0.9])
    corners = half * [(x, y, -1) for x in (-1, 1) for y in (-1, 1)]
    central = np.diag((half @ half - half**2) / 3)
    about = [central + c @ c * np.eye(3) - np.outer(c, c) for c in corners]
    axis = np.array([1, 0.8, 0]) / math.hypot(1, 0.8)
    turn = Quaternion(tuple(axis), 0.1)
    matrix, spin, now, sampled = np.array(turn.toRotationMatrix()).reshape(3, 3), np.zeros(3), 0.0, []
    pivot = int(np.argmin(corners @ matrix[2]))
    start = -corners[pivot] @ matrix.T
    while now < 1.2:
        def rates(_, y):
            turned, w = y[:9].reshape(3, 3), y[9:]
            moment = np.cross(-corners[pivot], -G * turned[2]) - np.cross(w, about[pivot] @ w)
            return np.concatenate([np.cross(turned, w).ravel(), np.linalg.solve(about[pivot], moment)])

        others = [k for k in range(4) if k != pivot]
        events = [lambda _, y, k=k: y[6:9] @ (corners[k] - corners[pivot]) for k in others]
        for event in events:
            event.terminal, event.direction = True, -1
        part = solve_ivp(rates, (now, 1.2), np.concatenate([matrix.ravel(), spin]), method="DOP853", rtol=1e-11, atol=1e-12, events=events, dense_output=True)
        sampled += [(t, part.sol(t)[:9].reshape(3, 3)) for t in np.arange(0.05, 1.2, 0.05) if now < t <= part.t[-1]]
        now, matrix, spin = part.t[-1], part.y[:9, -1].reshape(3, 3), part.y[9:, -1]
        for k, times in zip(others, part.t_events):
            if len(times):
                momentum = central @ spin + np.cross(-corners[k], np.cross(spin, -corners[pivot]))
                pivot, spin = k, np.linalg.solve(about[k], momentum)
    return half, start, turn, sampled


def test_a_block_wobbles_from_corner_to_corner(wobbling):
    half, start, turn, sampled = wobbling
    stone = dem.BlockMat(density=2000, noSlip=True)
    dem.base((8, 8, 0.2), stone)
    id = dem.block(tuple(2 * half), stone, center=tuple(start), orientation=turn)
    O.engines = rigid_engines(model="spatial", dt=1e-3)
    worst = 0
    for t, wanted in sampled:
        while O.time < t - 1e-6:
            O.step()
        worst = max(worst, np.abs(np.array(O.bodies[id].state.ori.toRotationMatrix()).reshape(3, 3) - wanted).max())
    assert worst < 1e-6
