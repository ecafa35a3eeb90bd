"""Blocks that fall freely on compliant joints obey the law of a landing, as rigid blocks do: no rebound, and the restitution at the next corner."""

import math

import pytest
from masonry import dem
from rocking_scene import Balance, joint_engine, quiet_engines, turned_over
from yade import O, Quaternion, Vector3

GRAVITY = 9.81
POSES = {
    "flat": Quaternion.Identity,
    "edge": Quaternion((0, 1, 0), math.pi / 4),
    "corner": Quaternion((0, 1, 0), math.atan(math.sqrt(0.5))) * Quaternion((1, 0, 0), math.pi / 4),
}


def dropped(size, pose, height, model="compliant", restitution=None, noSlip=False):
    """The state of a block whose lowest point is at the height (m) above a wide base."""
    O.reset()
    given = {} if restitution is None else {"restitution": restitution}
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.8), noSlip=noSlip, **given)
    dem.base((30, 30, 1), stone)
    corners = [pose * Vector3(x * size[0] / 2, y * size[1] / 2, z * size[2] / 2) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    block = dem.block(size, stone, center=(0, 0, height - min(corner[2] for corner in corners)), orientation=pose)
    O.engines = quiet_engines(model=model)
    return O.bodies[block].state


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("size, height", (((1, 1, 1), 0.1), ((1, 1, 1), 1.0), ((0.05, 0.05, 0.05), 0.3)))
def test_no_rebound(pose, size, height):
    """The normal direction is plastic. Bound: the speed that gravity gives in some steps of the springs, sqrt(penetration) of that of a fall by the width."""
    state = dropped(size, POSES[pose], height)
    balance, upwards = Balance(), 0
    fall = math.sqrt(2 * height / GRAVITY)
    while O.time < 1.2 * fall:
        O.step()
        upwards = max(upwards, state.vel[2])
    error = abs(balance.error()) / turned_over()
    print(f"{pose}, {size[0]} m from {height} m: rebound {upwards / (GRAVITY * fall):.1e} of the speed, energy {error:.1e}")
    assert upwards < 5e-3 * GRAVITY * fall
    assert error < 1e-9 and joint_engine().failures == 0


@pytest.mark.parametrize("size", ((1, 1, 1), (0.5, 0.5, 1.5)))
@pytest.mark.parametrize("restitution", (None, 0, 0.5, 0.9, 1))
def test_second_corner(size, restitution):
    """A block that falls 1 m with a lean of 0.02 rad lands on an edge, turns about it and lands on the other: that multiplies its spin by C. The first landing
    is plastic: without slip the angular momentum about the edge remains, m v (b cos - a sin of the lean) over the inertia 4 m R^2/3."""
    lean, height = 0.02, 1.0
    state = dropped(size, Quaternion((0, 1, 0), lean), height, restitution=restitution, noSlip=True)
    b, a = size[0] / 2, size[2] / 2
    first = 0.75 * math.sqrt(2 * GRAVITY * height) * (b * math.cos(lean) - a * math.sin(lean)) / (a * a + b * b)
    while O.time < math.sqrt(2 * height / GRAVITY) + 0.15 and not len(dem.impacts()):
        O.step()
    impact = dem.impacts()[0]
    natural = 1 - 1.5 * b * b / (a * a + b * b)
    wanted = natural if restitution is None else restitution
    O.step()
    print(f"C = {restitution}: before {impact['velocity']:.3f} rad/s (first landing {first:.3f}), after {abs(state.angVel[1]):.4f}, ratio {impact['restitution']:.4f}")
    # On the way gravity adds m g b lean to the energy of the turn: 2 g b lean 3/(4 R^2) to the square of the spin.
    fallen = math.sqrt(first**2 + 1.5 * GRAVITY * b * lean / (a * a + b * b))
    assert abs(impact["velocity"] / fallen - 1) < 5e-3
    assert abs(impact["restitution"] - wanted) < 1e-3
    assert abs(state.angVel[1]) <= wanted * impact["velocity"] * (1 + 1e-2) + 1e-2
    assert len(dem.impacts()) == 1 and joint_engine().failures == 0


def test_as_rigid_blocks():
    """Places where a block comes to lie that falls on two others and topples, against rigid blocks, 0.4 s after it has landed."""
    places = {}
    for model in ("spatial", "compliant"):
        O.reset()
        stone = dem.BlockMat(density=2000, frictionAngle=0.7, restitution=0.3)
        base = dem.base((8, 4, 0.4), stone)
        dem.block((0.6, 0.6, 0.4), stone, on=base)
        falling = dem.block((0.3, 0.5, 0.6), stone, center=(0.25, 0, 1.0), orientation=Quaternion((0, 1, 0), 0.05))
        O.engines = quiet_engines(model=model)
        while O.time < 0.65:
            O.step()
        places[model] = O.bodies[falling].state.pos, dem.angle(falling)
    print(places)
    (rigid, angle), (springs, leaned) = places["spatial"], places["compliant"]
    assert (rigid - springs).norm() < 0.02 and abs(angle - leaned) < 0.05
