"""A block on a base that jumps right after each of its impacts: run with `yade -n -x scripts/01_pulse_train.py`."""
import masonry
from masonry import dem
from yade import O

stone = dem.BlockMat(density=2000, restitution=0.7, noSlip=True)
base = dem.base((4, 2, 0.2), stone)
block = dem.block((0.6, 1.0, 3.0), stone, on=base)  # full sizes, m
train = dem.PulseTrainEngine(ids=[base], impulse=0.0125 * 9.81, resonantBlock=block)
O.engines = dem.engines(train)
O.run(30000, True)
impacts = dem.impacts()
exact = masonry.simulate(masonry.RockingBlock(0.3, 1.5), masonry.PulseTrain(0.0125 * 9.81), restitution=0.7, half_cycles=len(impacts))
for impact, time in zip(impacts, exact.impact_times):
    print(f"impact at {impact['time']:.6f} s (exact {time:.6f}), restitution {impact['restitution']:.6f}, {impact['energy_lost']:.1f} J lost")
