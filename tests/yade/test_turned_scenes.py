"""The same scene in another frame: turned with its base and its gravity, it has the same structures, methods and motion."""

import math

import numpy as np
import pytest
from masonry import dem
from yade import O, Quaternion, Vector3

SKEW = Vector3(1, 2, -3).normalized()
TURNS = [(Vector3.UnitZ, angle) for angle in (0.3, 0.8, 1, math.pi / 2, 4)] + [(SKEW, angle) for angle in (0.4, 1.3, 2.6)]


def wall_and_flying_block(turn, of_base=True):
    """A block flies against the end of a wall of fourteen, which it is near to 0.2 s later, as it falls beside it."""
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.5)
    base = dem.base((20, 20, 1), stone)
    dem.wall(courses=4, per_course=3, size=(0.4, 0.2, 0.2), material=stone, on=base)
    flying = dem.block((0.3, 0.5, 0.25), stone, center=(-1.0, 0, 0.75))
    O.bodies[flying].state.vel = (1, 0, 0)
    for body in O.bodies:
        state = body.state
        if of_base or body.id != base:
            state.pos, state.ori, state.vel = turn * state.pos, turn * state.ori, turn * state.vel
            state.refOri = turn * state.refOri
    O.engines = dem.engines(model="spatial", dt=5e-4)
    O.engines[-1].gravity = turn * O.engines[-1].gravity
    return flying


def motion(turn, **options):
    """(sizes of the structures; after each step localised blocks and the place of the block that flies, turned back; and at the end places of all blocks); up to
    0.24 s: before they touch."""
    flying = wall_and_flying_block(turn, **options)
    structures, localised, way, back = [len(ids) for ids in dem.structures()], [], [], turn.conjugate()
    for _ in range(480):
        O.step()
        localised.append(O.engines[-1].localisedBlocks)
        way.append(tuple(back * O.bodies[flying].state.pos))
    return structures, localised, np.array(way), np.array([tuple(back * b.state.pos) for b in O.bodies if b.dynamic])


@pytest.fixture(scope="module")
def unturned():
    return motion(Quaternion.Identity)


def test_the_block_joins_the_wall_when_it_is_near(unturned):
    """It flies on its own, by its parabola, until it is within a tenth of the smallest size, 0.02 m, of the wall's end, 0.25 m ahead at 1 m/s."""
    structures, localised, way, _ = unturned
    joins = localised.index(0)
    assert structures == [14, 1] and set(localised[:joins]) == {1} and set(localised[joins:]) == {0}
    assert 0.23 - 0.011 <= joins * 5e-4 <= 0.24, joins
    assert np.abs(way[joins - 1] - (-1 + joins * 5e-4, 0, 0.75 - 9.81 / 2 * (joins * 5e-4) ** 2)).max() < 1e-12


@pytest.mark.parametrize("axis, angle", TURNS)
def test_turned(unturned, axis, angle):
    """Structures and methods are the same at every step. Places are the same but for round-off (1e-12 m, some thousand units of the last digit) while the
    block flies on its own, and for what the tolerance of walls leaves (1e-9 m, 1e-3 of what gravity gives in a step is 2e-9 m) in the end."""
    structures, localised, way, places = motion(Quaternion(axis, angle))
    alone = localised.count(1)
    assert structures == unturned[0] and localised == unturned[1]
    assert np.abs(way - unturned[2])[:alone].max() < 1e-12
    assert np.abs(places - unturned[3]).max() < 1e-9


@pytest.mark.parametrize("angle", (0.3, 0.8))
def test_a_wall_turned_on_its_base(unturned, angle):
    """The base is the ground, whose axes lie as they like."""
    structures, localised, *_ = motion(Quaternion(Vector3.UnitZ, angle), of_base=False)
    assert structures == unturned[0] and localised[:400] == unturned[1][:400]
