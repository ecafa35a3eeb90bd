"""Loads on a structure besides its blocks: mass that moves with them, and dead loads that do not."""

import math

import numpy as np
from masonry._given import is_whole, number_given, shown
from masonry.dem.bodies import block_body, blocks, volume_of, world_shape
from yade import O, Vector3, wrapper

# Engines of dead loads have labels that begin so: dem.engines() and TiltTable know them by it, also in a scene that was loaded.
_LABEL = "deadLoad"
_OF_A_PUSH = _LABEL + "OfPush"
# Share of the mass of a block by which round-off may miss density times volume.
_ROUND_OFF = 1e-9


def _given(ids, name, value, unit):
    """The bodies, and the value; ValueError unless these are free blocks and the value is positive."""
    found = [ids] if is_whole(ids, 0) else list(ids) if np.iterable(ids) and not isinstance(ids, (str, bytes)) else []
    if not found:
        raise ValueError(f"ids = {shown(ids)}: must be the id of a block, or a list of them")
    bodies = [block_body(id, "ids") for id in found]
    for body in bodies:
        if not body.dynamic:
            raise ValueError(f"ids: {body.id} is prescribed (a base): must be free blocks")
    if len({body.id for body in bodies}) < len(bodies):
        raise ValueError("ids: a block stands there twice")
    if not 0 < number_given(name, value) < math.inf:
        raise ValueError(f"{name} = {value}: must be positive and finite, in {unit}")
    return bodies


def _shares(bodies):
    """Shares of the blocks, in proportion to their areas in plan."""
    areas = np.array([volume_of(body) / np.ptp(world_shape(body)[0][:, 2]) for body in bodies])
    return areas / areas.sum()


def add_mass(ids, mass):
    """Mass that moves with blocks: a floor or a roof that is not modelled, or the finish of one that is. Returns the mass of each block now, kg.

    ids     id of a free block, or a list of them
    mass    kg, of all of them together, shared in proportion to their areas in plan

    A block becomes as heavy as if it were denser: its moments of inertia grow with its mass, its centre of mass stays. Weight, inertia, energies and reactions
    follow for every model and method, and O.save keeps it. Call it before the first step, or between two."""
    bodies = _given(ids, "mass", mass, "kg")
    for body, share in zip(bodies, _shares(bodies)):
        ratio = 1 + mass * share / body.state.mass
        body.state.mass *= ratio
        body.state.inertia = body.state.inertia * ratio
    return [body.state.mass for body in bodies]


def added_mass():
    """{id: kg that dem.add_mass has added to the block}, from what its mass is more than density times volume."""
    more = {body.id: body.state.mass - body.mat.density * volume_of(body) for body in blocks() if body.dynamic}
    return {id: mass for id, mass in more.items() if mass > _ROUND_OFF * O.bodies[id].state.mass}


def dead_load(ids, force):
    """A dead load on blocks, that does not move as mass: a constant force downwards (-z), at the centres of the blocks. Returns its engines, which are in O.engines.

    ids      id of a free block, or a list of them
    force    N, of all of them together, positive, shared in proportion to their areas in plan

    dem.engines() takes the engines into the list that it returns; called later, dem.dead_load puts them behind the ForceResetter of O.engines. Reactions, joint forces and the potential energy of
    dem.energy() and histories have the load in them; O.save keeps it. On a dem.TiltTable it turns, or is pulled sideways, as the weights are. A load ends when
    its engines are taken out of O.engines or are `dead`."""
    bodies = _given(ids, "force", force, "N, downwards")
    by_force = {}
    for body, share in zip(bodies, _shares(bodies)):
        by_force.setdefault(float(force * share), []).append(body.id)
    number = sum(_is_load(engine) for engine in O.engines)
    made = [wrapper.ForceEngine(ids=own, force=Vector3(0, 0, -one), label=f"{_LABEL}{number + k}") for k, (one, own) in enumerate(by_force.items())]
    engines = list(O.engines)
    first = next((k + 1 for k, engine in enumerate(engines) if isinstance(engine, wrapper.ForceResetter)), len(engines))
    O.engines = engines[:first] + made + engines[first:]
    return made


def _is_load(engine):
    return isinstance(engine, wrapper.ForceEngine) and engine.label.startswith(_LABEL)


def load_of_a_push(ids, force):
    """The engine of a dead load of that many N downwards, on each of the ids the same share, that dem.engines(push) puts into O.engines."""
    return wrapper.ForceEngine(ids=ids, force=Vector3(0, 0, -force / len(ids)), label=_OF_A_PUSH)


def load_engines():
    """The engines of dead loads that are in O.engines."""
    return [engine for engine in O.engines if _is_load(engine) and not engine.dead]


def lasting_loads():
    """The engines of dem.dead_load alone: a load that dem.push() puts on blocks ends with its engines."""
    return [engine for engine in load_engines() if not engine.label.startswith(_OF_A_PUSH)]


def dead_loads():
    """{id: force (x, y, z), N} of the dead loads on blocks that are there."""
    found = {}
    for engine in load_engines():
        for id in engine.ids:
            if id < len(O.bodies) and O.bodies[id] is not None:
                found[id] = found.get(id, np.zeros(3)) + np.array(tuple(engine.force))
    return found


def potential_of_loads():
    """Potential energy of the dead loads now, J."""
    return -sum(float(force @ np.array(tuple(O.bodies[id].state.pos))) for id, force in dead_loads().items())
