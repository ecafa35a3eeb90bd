"""A wall with a door in push-over tests, monotonic and cyclic, and the joint that opened most. `scripts/gallery push` runs it; the pictures are written into the current folder."""
import math

from yade import O

from masonry import dem, results


def scene(**given):
    """The wall carries a beam, which is bedded so that it does not slide, and 5 kN."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.75), restitution=0)
    base = dem.base((6, 3, 0.2), stone)
    dem.wall(length=2.4, height=1.6, size=(0.4, 0.2, 0.2), material=stone, on=base, openings=[(0.6, 0, 1.2, 1.2)])
    beam = dem.block((2.4, 0.2, 0.2), dem.BlockMat(density=2500, noSlip=True), center=(0, 0, 1.7))
    push = dem.push(ids=[beam], vertical="load", force=5e3, **given)
    recorder = dem.WallRecorder(virtPeriod=0.05, recordForces=True)
    O.engines = dem.engines(push, recorder=recorder)
    dem.run(until=push)
    print(f"{push.ended}: at most {push.largest_force[0] / 1e3:.2f} kN, at {1e3 * push.largest_force[1]:.1f} mm")
    return push, dem.wall_history(recorder)


_, history = scene(displacement=0.4, drop=0.6)
results.draw(history, "push_shape.png", enlarge=1, color="rotation")
joint = results.joint_history(history)
print(joint)
joint.picture("push_joint.png")

push, _ = scene(cycles=[5e-3, -5e-3, 1e-2, -1e-2])
push.picture("push_cycles.png", title="wall with a door, cycles of 5 and 10 mm")
