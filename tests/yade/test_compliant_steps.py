"""The time step of compliant joints while blocks come to lie on other faces than those that they stood on."""

import math

from masonry import dem
from rocking_scene import Balance, quiet_engines, refuses
from yade import O


def board(thickness, dt=None):
    """A thin board on its edge, tilted so that it falls on its large face. Returns the joint engine."""
    O.reset()
    material = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((10, 10, 0.2), material)
    dem.tilt(dem.block((thickness, 1, 1), material, on=base), 0.05 if thickness < 0.05 else 0.1)
    O.engines = quiet_engines(dt=dt)
    return O.engines[3]


def turned_over():
    return sum(value for key, value in dem.energy().items() if key not in ("potential", "baseWork"))


# The face on which a board lands has the area of its edge times 1 / thickness, and so has its stiffness: the step chosen for the edge is too
# long for it, is lowered before it makes energy, and the velocities follow. Wanted: 2 % of what is turned over, either way.
for thickness in (0.05, 0.02):
    joints = board(thickness)
    first = O.dt
    balance = Balance()
    while O.time < 1.2:
        O.run(1000, True)
    error = balance.error() / turned_over()
    print(f"    thickness {thickness} m: dt {first:.2e} s, then {O.dt:.2e} s; energy {error:.1e}")
    assert abs(error) < 0.02, error
    assert O.dt < first * math.sqrt(thickness) * 1.5, (first, O.dt)
    assert max(O.bodies[1].state.pos[2], abs(O.bodies[1].state.pos[0])) < 1.1  # it lies, and has flown nowhere

# A given step is not touched: the run ends in an error where the face needs a shorter one.
board(0.02)
given = 2 * O.dt
board(0.02, given)


def run():
    while O.time < 1.2:
        O.step()
        assert O.dt == given


print("   ", refuses(run, "O.dt", "below", kind=RuntimeError))
# What has been made until then is no more than what was there: the board has fallen by half of its height.
assert dem.energy()["kinetic"] < 1.02 * O.bodies[1].state.mass * 9.81 * 0.5


def bounce(step, seconds=2):
    """Joints without dashpots under a block that falls flat and bounces; `step` relative to the critical one. Returns the joint engine, the error of the
    sum of energies, and the share of the kinetic energy at the landing that one step may take at a landing, or give at a take-off."""
    O.reset()
    material = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((6, 4, 0.4), material)
    dem.block((0.6, 0.6, 0.4), material, center=(0, 0, 0.3))
    O.engines = quiet_engines(penetration=1e-3)
    critical = O.dt / joints_of().stepFraction
    O.engines = quiet_engines(penetration=1e-3, dt=step * critical)
    O.engines[2].lawDispatcher.functors[0].dampingRatio = 0
    block = O.bodies[1]
    stiffness = block.mat.normalStiffness * 0.6 * 0.6
    balance = Balance()
    while O.time < seconds or any(i.isReal for i in O.interactions):
        O.step()
    return joints_of(), balance.error(), stiffness / block.state.mass * O.dt**2 / 4


def joints_of():
    return next(e for e in O.engines if isinstance(e, dem.RockingJointEngine))


# Springs act from the start of the step in which their points land: the bodies lose k d (v dt - d)/2 over what is stored, at most (w dt)^2/4 of the
# kinetic energy, and get as much back where they part. The sum of energies, in flight, knows the difference to rounding.
for step in (0.5, 0.1, 0.03):
    joints, error, most = bounce(step)
    made, lost = joints.madeEnergy, joints.lostEnergy
    fall = O.bodies[1].state.mass * 9.81 * 0.1
    landings = 2 / 0.28  # of 0.1 m: one each 0.29 s
    print(f"    bounces at {step:g} of the critical step: made {made / fall:.1e}, lost {lost / fall:.1e} of the fall, failures {joints.failures}")
    assert abs(error - (made - lost)) < 1e-9 * fall, (error, made, lost)
    assert 0.2 * landings * most * fall < min(made, lost) and max(made, lost) < 1.1 * (landings + 1) * most * fall, (made, lost, most * fall)
    told = (made > 0.05 * joints.turnedOver) + (lost > 0.05 * joints.turnedOver)
    block = O.bodies[1]  # it lands at v = sqrt(2 g h) and goes as deep as its kinetic energy presses the spring in
    depth = (2 * 9.81 * 0.1 * block.state.mass / (block.mat.normalStiffness * 0.6 * 0.6)) ** 0.5
    deep = depth > 0.02 * min(block.shape.extents)
    assert deep and joints.failures == told + deep and (step > 0.1) == (told > 0), (joints.failures, told, depth)

# dem.engines() refuses a given step where the run would, with the same number in the message, and nowhere else: the dashpots count in both.
for make in (lambda: dem.block((0.5, 0.5, 1), stone, on=0), lambda: dem.stack(3, (0.3, 0.3, 0.6), stone, on=0), lambda: dem.tilt(dem.block((0.3, 0.6, 1), stone, on=0), 0.05)):

    def scene(dt=None):
        O.reset()
        dem.base((4, 4, 0.4), stone)
        make()
        O.engines = quiet_engines(dt=dt, model="compliant")

    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    scene()
    largest, critical = joints_of().largestTimeStep, joints_of().criticalTimeStep()
    assert 0.3 * critical < largest < 0.75 * critical, (largest, critical)  # one mode of the damping ratio 0.5: 0.62
    said = refuses(lambda: scene(1.001 * largest), "dt", "below")
    scene(largest)
    O.step()
    O.dt *= 1.01
    print("   ", said, "|", refuses(O.step, "O.dt", "below", kind=RuntimeError))
