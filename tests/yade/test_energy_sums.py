"""madeEnergy and lostEnergy of rigid blocks: what steps make and lose, never set off against each other, is the whole error of the balance."""

import math

from masonry import dem
from rocking_scene import quiet_engines, stone
from yade import O, Quaternion, Vector3


def integrator():
    return next(e for e in O.engines if isinstance(e, dem.MoreauJeanIntegrator))


def total():
    e = dem.energy()
    return e["kinetic"] + e["potential"] + e["frictDissip"] + e["impactDissip"] - e["baseWork"]


def rocks():
    base = dem.base((4, 4, 0.2), stone())
    dem.tilt(dem.block((0.2, 0.5, 1), stone(), on=base), 0.1)


def tumbles():
    dem.base((8, 8, 0.4), stone())
    turned = Quaternion(1, 0.3, 0.2, 0.5)
    turned.normalize()
    state = O.bodies[dem.block((0.2, 0.3, 0.5), stone(), center=(0, 0, 1), orientation=turned)].state
    state.vel, state.angVel = Vector3(1, 0.5, 0), Vector3(2, 3, 1)


errors = []
for build, model, seconds in ((rocks, "planar", 2.0), (rocks, "spatial", 1.0), (tumbles, "spatial", 0.8)):
    for dt in (2e-3, 2e-2):
        O.reset()
        build()
        O.engines = quiet_engines(model=model, method="localised", dt=dt)
        made, lost, start = 0.0, 0.0, total()
        for _ in range(math.ceil(seconds / dt)):
            O.step()
            e = integrator()
            assert e.madeEnergy >= made and e.lostEnergy >= lost, (build.__name__, model, dt)
            made, lost = e.madeEnergy, e.lostEnergy
            # Round-off of the sums of energies, of which the potential one is largest.
            assert abs(total() - start - (made - lost)) < 1e-9 * (abs(start) + e.turnedOver), (build.__name__, model, dt)
        errors.append((build.__name__, model, dt, made / e.turnedOver, lost / e.turnedOver))
assert max(made + lost for *_, made, lost in errors) > 1e-7, errors  # the sums are not always zero
