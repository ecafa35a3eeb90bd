"""Blocks and towers that sway on joints of a known stiffness: the period against the closed form of an even elastic bed."""

import numpy as np
import pytest
from masonry import dem
from rocking_scene import quiet_engines
from yade import O, Vector3

NORMAL, SHEAR, DENSITY, GRAVITY = 1e8, 5e7, 2000, 9.81


def slowest_mode(width, depth, height, blocks):
    """(period, displacements x, turns) of a tower that sways along its width. A joint has the stiffness k_s A against shear and
    k_n depth width^3 / 12 against a turn; a block that turns lowers its own weight and all above it."""
    m, a, area = DENSITY * width * depth * height, height / 2, width * depth
    K, M = np.zeros((2 * blocks, 2 * blocks)), np.zeros((2 * blocks, 2 * blocks))
    for k in range(blocks):
        M[2 * k, 2 * k], M[2 * k + 1, 2 * k + 1] = m, m * (width**2 + height**2) / 12
        slip, turn = np.zeros(2 * blocks), np.zeros(2 * blocks)
        slip[2 * k : 2 * k + 2], turn[2 * k + 1] = (1, -a), 1
        if k:
            slip[2 * k - 2 : 2 * k], turn[2 * k - 1] = (-1, -a), -1
        K += SHEAR * area * np.outer(slip, slip) + NORMAL * depth * width**3 / 12 * np.outer(turn, turn)
        K[2 * k + 1, 2 * k + 1] -= m * GRAVITY * a * (1 + 2 * (blocks - 1 - k))
    values, modes = np.linalg.eig(np.linalg.solve(M, K))
    first = np.argmin(values.real)
    return 2 * np.pi / np.sqrt(values[first].real), modes[0::2, first].real, modes[1::2, first].real


@pytest.mark.parametrize("width, depth, height, blocks, along", (
    (0.5, 0.5, 1.0, 1, 0), (0.5, 0.2, 1.0, 1, 0), (0.5, 0.2, 1.0, 1, 1), (0.3, 1.0, 0.5, 1, 0), (0.5, 0.4, 0.5, 4, 0), (0.4, 0.5, 0.3, 6, 1),
))
def test_period(width, depth, height, blocks, along):
    """The slowest mode, started with its own velocities, far from opening a joint. Bounds: steps are 1/200 of the shortest period, and joints turn with the
    blocks by g/(k_s A/m) of the stiffness; springs at the corners alone would give 0.56 to 0.7 of the period."""
    stone = dem.BlockMat(density=DENSITY, frictionAngle=1.2, normalStiffness=NORMAL, shearStiffness=SHEAR)
    ids = dem.stack(blocks, (width, depth, height) if along == 0 else (depth, width, height), stone, dem.base((6, 6, 0.2), stone))
    O.engines = quiet_engines(model="compliant")
    O.engines[2].lawDispatcher.functors[0].dampingRatio = 0
    O.step()
    period, places, turns = slowest_mode(width, depth, height, blocks)
    axis = Vector3.UnitY if along == 0 else -Vector3.UnitX
    scale = 1e-4 / np.max(np.abs(places))
    for id, place, turn in zip(ids, places, turns):
        state = O.bodies[id].state
        velocity = Vector3.Zero
        velocity[along] = scale * place
        state.vel += velocity
        state.angVel += scale * turn * axis
        state.angMom += scale * turn * state.inertia[1 - along] * axis
    start, before, crossings = O.bodies[ids[-1]].state.pos[along], 0, []
    while O.time < 5.2 * period:
        O.step()
        place = O.bodies[ids[-1]].state.pos[along] - start
        if before * place < 0:
            crossings.append(O.time - O.dt * place / (place - before))
        before = place
    measured = 2 * (crossings[8] - crossings[0]) / 8
    print(f"{blocks} blocks of {width} x {depth} x {height} m along {'xy'[along]}: period {measured:.5f} s, closed form {period:.5f} s")
    assert abs(measured / period - 1) < 5e-3
    assert len(dem.impacts()) == 0
