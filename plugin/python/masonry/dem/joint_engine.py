"""The engine of the joints in the scene, and what it has counted: impacts and energies."""

import numpy as np
from masonry.dem.loads import potential_of_loads
from yade import O, wrapper


def joint_engine():
    """The engine of the joints, or None."""
    return next((one for one in O.engines if isinstance(one, (wrapper.MoreauJeanIntegrator, wrapper.RockingJointEngine)) and not one.dead), None)


def joint_engine_given():
    """The same; ValueError without one."""
    engine = joint_engine()
    if engine is not None:
        return engine
    raise ValueError("O.engines has no MoreauJeanIntegrator and no RockingJointEngine: set O.engines = dem.engines(...)")


_IMPACT_FIELDS = [("time", float), ("body", int), ("support", int), ("restitution_asked", float), ("restitution", float), ("velocity", float),
                  ("energy_lost", float), ("friction_demand", float), ("application", float), ("switched", bool), ("capped", bool)]


def impacts():
    """The rocking impacts so far: a structured array, one row an impact.

    time                  s
    body, support         ids of the block and of what it lands on
    restitution_asked     C; NaN: the natural one
    restitution           C that came out
    velocity              relative angular velocity before, rad/s
    energy_lost           J, of all joints that land at the same instant; in the row of the first one
    friction_demand       friction coefficient that the impact takes; where it is the joint's own, the pivot has slipped and more was asked for
    application           distance of the resultant impulse from the new pivot, m
    switched              False: the impact stopped the rotation; a pivot that has slipped may start it again
    capped                True: the restitution asked for did not come out, because energy would have appeared, or because no impulses obey all laws (a
                          failure of the step)

    Restitution and velocity are relative to the motion with which the block would stay on its old and its new support: on supports that move in
    different ways, a block with restitution 0 follows both. The walls of method='wall' list only
    impacts with a given restitution, each in the step after it: beside blocks with localised impacts the rows may be out of order by a step."""
    e = joint_engine_given()
    table = np.zeros(len(e.impactTimes), dtype=_IMPACT_FIELDS)
    before, after = np.array(e.impactBefore), np.array(e.impactAfter)
    columns = (e.impactTimes, e.impactBlocks, e.impactSupports, e.impactAsked, np.divide(after, before, out=np.zeros_like(before), where=before > 0),
               before, e.impactEnergy, e.impactFriction, e.impactApplication, e.impactSwitched, e.impactCapped)
    for (name, _), values in zip(_IMPACT_FIELDS, columns):
        table[name] = values
    return table


def energy():
    """Energies in J, a dict.

    kinetic, potential                       now, dead loads included; of walls of method='wall', whose velocities belong to the middle of a step, potential half a step earlier
    frictDissip, impactDissip, baseWork      since dem.engines() made the engines: dissipated by friction and by impacts, and the work of the base
    elastPotential, dampDissip               compliant joints, and scenes with ties: elastic energy now; dissipated by dashpots, and by ties that break or are damped numerically,
                                             so far
    crackDissip                              joints with mortar: spent by their cracks so far

    The sum of all others less baseWork is constant, except for madeEnergy less lostEnergy of the engine (in walls of method='wall' they are part of
    impactDissip), and for the work of other engines' forces, a change of gravity or velocities by a script, and erased blocks. With compliant joints all energies are 0 before the first step."""
    e = joint_engine_given()
    keys = ("kinetic", "potential", "elastPotential", "frictDissip", "dampDissip", "impactDissip", "baseWork")
    elastic = isinstance(e, wrapper.RockingJointEngine) or bool(e.ties)
    bonded = ("crackDissip",) if getattr(e, "bondedIds", None) or any(getattr(b.mat, "mortar", None) for b in O.bodies) else ()
    found = {key: getattr(e, key) for key in keys + bonded if elastic or key not in ("elastPotential", "dampDissip")}
    if found["potential"] != 0 or not isinstance(e, wrapper.RockingJointEngine):
        found["potential"] += potential_of_loads()
    return found
