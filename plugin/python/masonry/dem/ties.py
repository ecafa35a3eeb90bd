"""Ties and anchors between blocks."""

import math

from masonry._given import finite_numbers, number_given, positive_given, shown
from masonry.dem.bodies import block_body
from masonry.dem.notes import scene_mark
from yade import O, Vector3, wrapper

_PLACE = "a place in the world, three finite numbers, in m"
_ENGINES = wrapper.MoreauJeanIntegrator, wrapper.RockingJointEngine
_made = []  # (BlockTie, mark of the scene that a script has made it in)


def tie(block1, point1, block2, point2, stiffness, pretension=0.0, strength=math.inf, tension_only=True):
    """A tie rod, an anchor or a strut: a straight elastic bar without mass between a point of a block and a point of another block, or of a base. Returns
    a dem.BlockTie, whose `force` (N), `extension` (m), `energy` (J) and `broken` say how it is after each step; a WallRecorder keeps them
    (WallHistory.ties).

    block1, block2    ids of two bodies, of which one at least is free
    point1, point2    where the tie is fixed to them: places in the world as the bodies are now (x, y, z), m. They need not be in the blocks, and move with
                      them
    stiffness         force per extension, E A / L of a steel bar, N/m
    pretension        force at the present length, N
    strength          tensile force at which it breaks for good, N; positive
    tension_only      True: it goes slack; False: a strut, which also presses (and breaks by tension alone)

    Its force is pretension + stiffness * extension, with tension_only at least 0; before it breaks it is at most `strength`. Steps of rigid blocks take it implicitly:
    no stiffness asks for a smaller O.dt, and a vibration that is faster than the step resolves is damped (the energy is in dampDissip). With model='compliant' it is
    a spring of the explicit step, without damping: a stiff tie makes the critical step, and with it O.dt, smaller; while the joints settle under the weight before
    the first step, it keeps its force. A tie carries no impulse at an impact. dem.engines() finds the ties of the scene; one made after that acts from the next
    step. `dead = True` takes a tie away. Ties do not touch blocks.
    """
    bodies = block_body(block1, "block1"), block_body(block2, "block2")
    if bodies[0].id == bodies[1].id:
        raise ValueError(f"block2 = {block2}: must be another body than block1")
    if not any(body.dynamic for body in bodies):
        raise ValueError(f"block1 = {block1}, block2 = {block2}: both are prescribed: one of them must be a free block")
    places = [Vector3(finite_numbers(name, point, 3, _PLACE)) for name, point in (("point1", point1), ("point2", point2))]
    if not (places[1] - places[0]).norm() > 0:
        raise ValueError(f"point2 = {shown(point2)}: must not be the same place as point1")
    if not math.isfinite(number_given("pretension", pretension)):
        raise ValueError(f"pretension = {pretension}: must be finite, in N")
    if not number_given("strength", strength) > 0:
        raise ValueError(f"strength = {strength}: must be positive, in N")
    if pretension > strength:
        raise ValueError(f"pretension = {pretension}: must be at most the strength, {strength:g} N")
    if tension_only and pretension < 0:
        raise ValueError(f"pretension = {pretension}: must not be negative, or give tension_only=False")
    own = [body.state.ori.conjugate() * (place - body.state.pos) for body, place in zip(bodies, places)]
    made = wrapper.BlockTie(body1=bodies[0].id, body2=bodies[1].id, point1=own[0], point2=own[1], length=(places[1] - places[0]).norm(),
                            stiffness=float(positive_given("stiffness", stiffness, ", in N/m")), pretension=float(pretension), strength=float(strength),
                            tensionOnly=bool(tension_only))
    for engine in O.engines:
        if isinstance(engine, _ENGINES) and not engine.dead:
            engine.ties = [*engine.ties, made]
    _made.append((made, scene_mark()))
    return made


def ties():
    """The ties of the scene (dem.BlockTie), in the order in which they were made."""
    here = scene_mark()
    _made[:] = [(one, mark) for one, mark in _made if mark == here]
    found = [one for engine in O.engines if isinstance(engine, _ENGINES) for one in engine.ties]
    return found + [one for one, _ in _made if not any(one is known or one == known for known in found)]


def tied():
    """Pairs of ids that ties of the scene join."""
    return [(one.body1, one.body2) for one in ties() if not one.dead]
