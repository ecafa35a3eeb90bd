"""The rocking block with this plugin in YADE: compliant joints at several stiffnesses, set by the penetration of the standing block
as a share of its width, with the time step that dem.engines() chooses and a quarter of it."""
import measures
from masonry import dem
from yade import O
from yade_runs import measure


def compliant(penetration, step_share=1.0):
    def create():
        stone = dem.BlockMat(density=measures.DENSITY, noSlip=True)
        base = dem.base((4, 2, 0.2), stone)
        block = dem.block((2 * measures.HALF_WIDTH, measures.DEPTH, 2 * measures.HALF_HEIGHT), stone, on=base)
        dem.tilt(block, measures.START_ANGLE)
        O.engines = dem.engines(model="compliant", penetration=penetration, gravity=measures.GRAVITY)
        O.dt *= step_share
        return lambda: dem.angle(block)

    return create


for name, step_share in (("chosen step", 1.0), ("a quarter of it", 0.25)):
    for penetration in (1e-3, 1e-4, 1e-5, 1e-6):
        measure("yade-masonry in YADE", f"{name}; penetration {penetration:g} of the width", compliant(penetration, step_share))
