"""The rocking block with this plugin in YADE: rigid, in the plane and in space, at several time steps; and on compliant joints at several
stiffnesses, set by the penetration of the standing block as a share of its width, with the time step that dem.engines() chooses and a
quarter of it."""
import measures
from masonry import dem
from yade import O
from yade_runs import measure


def scene():
    """The block on its edge; returns its id."""
    stone = dem.BlockMat(density=measures.DENSITY, noSlip=True)
    base = dem.base((4, 2, 0.2), stone)
    block = dem.block((2 * measures.HALF_WIDTH, measures.DEPTH, 2 * measures.HALF_HEIGHT), stone, on=base)
    dem.tilt(block, measures.START_ANGLE)
    return block


def rigid(model, time_step):
    def create():
        block = scene()
        O.engines = dem.engines(model=model, dt=time_step, gravity=measures.GRAVITY)
        return lambda: dem.angle(block)

    return create


def compliant(penetration, step_share=1.0):
    def create():
        block = scene()
        O.engines = dem.engines(model="compliant", penetration=penetration, gravity=measures.GRAVITY)
        O.dt *= step_share
        return lambda: dem.angle(block)

    return create


for model in ("planar", "spatial"):
    for time_step in (5.8e-2, 4e-2, 1e-2, 4e-3, 1e-3, 2.5e-4):
        measure("yade-masonry rigid", f"{model}; step {time_step:g} s", rigid(model, time_step))

for name, step_share in (("chosen step", 1.0), ("a quarter of it", 0.25)):
    for penetration in (1e-3, 1e-4, 1e-5, 1e-6):
        measure("yade-masonry compliant", f"{name}; penetration {penetration:g} of the width", compliant(penetration, step_share))
