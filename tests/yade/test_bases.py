"""Several bases, each with its own place and record, and a base that turns."""

import math

import numpy as np
import pytest
from masonry import artificial_record, dem, results
from rocking_scene import quiet_engines, refuses
from yade import HarmonicRotationEngine, InterpolatingHelixEngine, O


def stone(friction=0.7):
    return dem.BlockMat(density=2000, frictionAngle=math.atan(friction))


def shaken(which, peaks=(6.0, 1.0)):
    """(bases, history) of walls on two bases of their own, each under its own record; which of them have a wall."""
    O.reset()
    bases, motions = [], []
    for k, peak in enumerate(peaks):
        bases.append(dem.base((3, 1, 0.3), stone(), at=(4 * k, 0)))
        if k in which:
            dem.wall(courses=5, per_course=2, size=(0.4, 0.2, 0.2), material=stone(), on=bases[k])
        motions.append(dem.record_motion(artificial_record(seed=k + 1, peak=peak, duration=0.9), ids=[bases[k]]))
    recorder = dem.WallRecorder(virtPeriod=0.02, recordForces=True)
    O.engines = quiet_engines(motions, model="planar", method="localised", dt=5e-4, recorder=recorder)
    dem.run(until=motions)
    return bases, dem.wall_history(recorder)


def test_two_walls_with_their_own_records(tmp_path):
    """Each moves as if it were alone, and its results are those against its own base."""
    bases, both = shaken((0, 1))
    parts = [both.on_base(base) for base in bases]
    assert [len(part.ids) for part in parts] == [13, 13] and parts[0].drift().max() > 5 * parts[1].drift().max()
    assert np.array_equal(both.drift(), np.fmax(*(part.drift() for part in parts)))
    for k, part in enumerate(parts):
        assert {one["ids"][0] for one in part.about["motions"]} == {bases[k]}
        assert results.collapse(part).free == 12 and "12 blocks" in str(results.collapse(part))
        assert np.array_equal(results.base_reactions(part)["force"], results.base_reactions(both, base=bases[k])["force"])
        _, alone = shaken((k,))
        assert np.abs(alone.drift() - part.drift()).max() < 1e-9
    results.report(parts[1], tmp_path / "second.html")
    refuses(lambda: both.on_base(int(both.ids[both.free][0])), "id = ", str(bases))
    refuses(lambda: both.on_base(99), "id = 99")


MODELS = ({"model": "planar"}, {"model": "spatial", "method": "wall"}, {"model": "compliant", "penetration": 1e-4})


def turning(engine, slide, **engines):
    """Angle of the base, rad, at which a block on it has begun to rock (or to slide by 1 mm)."""
    base = dem.base((4, 2, 0.2), stone(0.3 if slide else 0.9))
    block = dem.block((0.4, 0.5, 0.4) if slide else (0.2, 0.5, 1.0), stone(0.3 if slide else 0.9), on=base)
    made = quiet_engines(**engines)
    motion = engine(base)
    # Rigid blocks: beside the forces of other engines; compliant: before NewtonIntegrator.
    O.engines = [*made[:-1], motion, made[-1]]

    def begun():
        down = math.asin(max(-1.0, min(1.0, -(O.bodies[base].state.ori.toRotationMatrix()[2, 0]))))
        place = O.bodies[base].state.ori.conjugate() * (O.bodies[block].state.pos - O.bodies[base].state.pos)
        return abs(place[0]) > 1e-3 if slide else abs(dem.angle(block) - down) > 2e-3

    assert dem.run(20, until=begun)
    ori = O.bodies[base].state.ori
    return 2 * math.atan2(ori[1], ori[3])


@pytest.mark.parametrize("engines", MODELS)
@pytest.mark.parametrize("slide", (False, True))
def test_a_base_that_turns(engines, slide):
    """A base that turns slowly about an axis in its upper face: a block slides from atan(friction) on, or rocks from its critical angle on."""
    rate = 0.05
    angle = turning(lambda base: InterpolatingHelixEngine(ids=[base], times=[0, 0.5, 100], angularVelocities=[0, rate, rate], rotationAxis=(0, 1, 0), rotateAroundZero=True,
                                                          zeroPoint=(0, 0, 0)), slide, **engines)
    critical = math.atan(0.3) if slide else math.atan(0.2)
    # From there on the block accelerates with g cos (tan - mu) or so: 1 mm takes (6 x 1e-3 / (g rate))^(1/3) s, a turn by 2e-3 rad less than twice that.
    assert critical - 2e-3 < angle < critical + rate * 2 * (6e-3 / (9.81 * rate)) ** (1 / 3), (angle, critical)


@pytest.mark.parametrize("engines", MODELS)
def test_a_base_that_swings(engines):
    """A stack stays on a base that swings by 0.02 rad, and the history sees it from there."""
    base = dem.base((4, 2, 0.2), stone())
    dem.stack(3, (0.6, 0.6, 0.3), stone(), on=base)
    recorder = dem.WallRecorder(virtPeriod=0.05)
    made = quiet_engines(recorder=recorder, **engines)
    swing = HarmonicRotationEngine(ids=[base], A=0.02, f=0.5, rotationAxis=(0, 1, 0), rotateAroundZero=True, zeroPoint=(0, 0, 0))
    O.engines = [*made[:-1], swing, made[-1]]
    dem.run(1.0)
    history = dem.wall_history(recorder)
    turned = 2 * np.arccos(np.abs(history.orientation[:, 0, 0]))
    assert abs(turned.max() - 0.02) < 1e-4
    # First order: blocks follow a base whose velocity a step sets; they slide or rock by less.
    assert history.drift().max() < 1e-3 and history.rotation[:, 1:].max() < 1e-3, (history.drift().max(), history.rotation.max())


@pytest.mark.parametrize("engines", MODELS)
def test_the_moment_on_a_base_that_turns(engines):
    """A block that rests on a base at the angle a: about the middle of its foot, which goes with the base, the moment is -W h/2 sin(a), wherever the axis is."""
    base = dem.base((8, 2, 0.2), stone())
    block = dem.block((0.4, 0.5, 0.8), stone(), on=base, at=(1.5, 0))
    recorder = dem.WallRecorder(virtPeriod=0.05, recordForces=True)
    made = quiet_engines(recorder=recorder, **engines)
    turn = InterpolatingHelixEngine(ids=[base], times=[0, 1.0, 2.0, 100], angularVelocities=[0, 0.1, 0, 0], rotationAxis=(0, 1, 0), rotateAroundZero=True, zeroPoint=(-2, 0, -1))
    O.engines = [*made[:-1], turn, made[-1]]
    dem.run(2.5)
    weight = 9.81 * O.bodies[block].state.mass
    moment = results.base_reactions(dem.wall_history(recorder), about=(1.5, 0, 0))["moment"][-1]
    # Compliant: the block leans by its springs; rigid: the tolerance of the solver in forces.
    assert np.abs(moment - [0, -weight * 0.4 * math.sin(0.1), 0]).max() < 2e-3 * weight * 0.4, (moment, weight * 0.4 * math.sin(0.1))
