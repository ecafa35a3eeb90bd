"""A block without slip on compliant joints under fast changes of the base's acceleration, against the exact history."""

import masonry
import numpy as np
import pytest
from masonry import dem
from rocking_scene import Balance, quiet_engines, turned_over
from yade import O


def error_of(record, until, **options):
    """Largest error of the angle of a block of 0.3 x 1.5 m, relative to its peak. The ledger of energies closes."""
    exact = masonry.simulate(masonry.RockingBlock(0.15, 0.75), record, t_end=until + 0.1)
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.73, noSlip=True)
    base = dem.base((6, 3, 0.2), stone)
    block = dem.block((0.3, 0.5, 1.5), stone, on=base)
    O.engines = quiet_engines(dem.record_motion(record, ids=[base]), **options)
    balance = Balance()
    times, angles = [], []
    while O.time < until:
        O.step()
        times.append(O.time)
        angles.append(dem.angle(block))
    # The springs take (w dt)^2/4 of the energy that sways from the motion between two steps.
    assert abs(balance.error()) < 1e-4 * turned_over()
    wanted = exact.sample(np.array(times))[0]
    return np.max(np.abs(angles - wanted)) / np.max(np.abs(wanted))


@pytest.mark.parametrize("penetration, bound", ((1e-5, 1e-2), (1e-6, 2e-3), (1e-7, 1e-3)))
def test_a_trapezoid(penetration, bound):
    """A pulse of 0.1 s that rises to 0.48 g within 25 ms. The block lifts by as much too late as its springs take to unload, of the order of
    sqrt(penetration x width / g), against 0.1 s: 5e-3 of it at 1e-5."""
    record = masonry.Record(0.025, np.array([0, 0, 1, 1, 1, 0, 0, 0, 0]) * 0.35 / 0.075, unit="m/s^2")
    error = error_of(record, 0.4, penetration=penetration)
    print(f"trapezoid, penetration {penetration:g}: error {error:.1e} of the peak")
    assert error < bound


@pytest.mark.parametrize("peak, coarse, fine", ((4.0, 0.3, 1.5e-2), (8.0, 0.05, 2e-2)))
def test_artificial_records(peak, coarse, fine):
    """Records that set a block rocking again and again: what it does next depends on the instants at which it has lifted and landed, and errors grow with
    every half cycle, so that single histories may be wrong. The median of ten falls with the penetration as the delays do, with its square root: between
    1e-5 and 1e-6 by 3.2, of which the scatter of ten leaves at least 2. Bounds, also of rigid blocks: three times what was seen."""
    medians = []
    for options in ({"penetration": 1e-5}, {"penetration": 1e-6}, {"model": "auto"}):
        errors = [error_of(masonry.artificial_record(seed, peak, duration=3.0), 1.5, **options) for seed in range(10)]
        medians.append(np.median(errors))
        print(f"records of {peak} m/s^2, {options}: median {medians[-1]:.1e} of the peak, of", " ".join(f"{e:.1e}" for e in errors))
    assert medians[0] < coarse and medians[1] < min(fine, medians[0] / 2) and medians[2] < 1e-3
