"""Blocks that rock freely on compliant joints: one against the exact history of a rigid one, where it ends; the balance of a stack."""

import math

import numpy as np
import pytest
from rocking_scene import Balance, Samples, barrier, one_block, quiet_engines, run_impacts, steps, stone

import masonry
from masonry import dem
from yade import O


PENETRATION = 1e-6  # where the restitution counts


def rock(slenderness, restitution, half_cycles, penetration=1e-5, tilt=0.9):
    """(peaks, impacts, exact history, energy error relative to the energy put in, block)"""
    _, id, block = one_block(slenderness, restitution=restitution)
    dem.tilt(id, tilt * block.critical_angle)

    O.engines = quiet_engines(penetration=penetration)
    angles = Samples(lambda: dem.angle(id), 50)
    exact = masonry.simulate(block, restitution=restitution, initial_angle=tilt * block.critical_angle, half_cycles=half_cycles)
    balance = Balance()
    impacts = run_impacts(half_cycles, 1.05 * exact.impact_times[-1])
    put_in = barrier(id, block) * (1 - (1 - math.cos(block.critical_angle * (1 - tilt))) / (1 - math.cos(block.critical_angle)))
    return angles.peaks(), impacts, exact, abs(balance.error()) / put_in, block


@pytest.mark.parametrize("penetration, bound", ((1e-5, 1e-3), (1e-6, 1e-4)))
def test_peaks_and_times(penetration, bound):
    """The compressed pivot leans the block by about the penetration over the lever: an error of the angle that is proportional to
    the penetration, and is the bound asked of the law."""
    peaks, impacts, exact, energy, _ = rock(5, 0.9, 15, penetration)
    wanted = np.abs(exact.peak_angles[1:15])
    error = np.max(np.abs(peaks[:14] / wanted - 1))
    assert len(peaks) >= 14 and error <= bound
    assert np.max(np.abs(impacts["time"][:15] / exact.impact_times[:15] - 1)) <= bound
    assert np.all(impacts["switched"][:15]) and not np.any(impacts["capped"])
    assert np.all(np.abs(impacts["restitution"][:15] - 0.9) < 1e-12)  # a row of the impulse problem, met to round-off
    assert energy <= 1e-4
    print(f"penetration {penetration:g}: peaks {error:.1e}, energy {energy:.1e}")


@pytest.mark.parametrize("slenderness", (3, 5, 8, 12))
@pytest.mark.parametrize("restitution", (0.5, 0.7, 0.9, 1.0))
def test_the_restitution_that_comes_out(slenderness, restitution):
    """The restitution that comes out, from heights alone: the energy of a peak is m g R (cos(alpha - theta) - cos(alpha)), and the
    ratio of two is C^2. A compressed joint turns the block by an elastic angle, penetration times width over lever: peaks that it
    changes by more than the bound say nothing about C."""
    peaks, impacts, exact, energy, block = rock(slenderness, restitution, 8, PENETRATION)
    peaks = peaks[peaks > PENETRATION / 1e-3]
    height = np.cos(block.critical_angle - peaks) - math.cos(block.critical_angle)
    realised = np.sqrt(height[1:] / height[:-1])
    error = np.max(np.abs(realised - restitution))
    assert len(realised) >= 1 and error <= 1e-3
    assert energy <= 1e-4
    print(f"lambda {slenderness}, C {restitution}: {len(realised)} peaks, C within {error:.1e}, energy {energy:.1e}")


@pytest.mark.parametrize("slenderness", (2, 5))
def test_the_natural_restitution(slenderness):
    """The plastic impact on the corner gives the natural restitution by itself."""
    peaks, impacts, exact, energy, block = rock(slenderness, None, 4, PENETRATION)
    natural = 1 - 1.5 * math.sin(block.critical_angle) ** 2
    assert np.all(np.isnan(impacts["restitution_asked"]))
    assert np.max(np.abs(impacts["restitution"][:4] - natural)) < 1e-5  # the pivot's compression moves it by that share
    assert np.max(np.abs(impacts["application"][:4])) == 0
    assert energy <= 1e-4


@pytest.mark.parametrize("slenderness, restitution, penetration", ((5, 0.7, 1e-4), (2, 0.7, 1e-4), (3, 0.5, 1e-5)))
def test_rocking_ends(slenderness, restitution, penetration):
    """Rocking ends with the half cycle whose peak, w^2/(2 A), the springs' own angle would drown: the weight on two corners of four presses them in
    by twice the penetration of the width, on all by once. The last impact stops the block."""
    _, id, block = one_block(slenderness, restitution=restitution)
    dem.tilt(id, 0.5 * block.critical_angle)
    O.engines = quiet_engines(penetration=penetration)
    impacts = run_impacts(100, 4.0)
    peaks = (impacts["velocity"] * impacts["restitution"]) ** 2 / (2 * block.angular_acceleration)
    assert len(impacts) < 20 and not impacts["switched"][-1] and np.all(peaks[impacts["switched"]] > penetration), peaks / penetration


@pytest.mark.parametrize("blocks, slenderness, restitution", ((3, 2, 0.5), (4, 1.5, None)))
def test_a_stack_that_comes_apart(blocks, slenderness, restitution):
    """A stack that comes apart: the energy of springs that hand over is in the balance. Bound, of what the impacts take, set after seeing at most 2.2e-4
    in seven tilts of either stack; 1e-3 where the motion that hand-offs leave to the springs is counted twice, 6e-4 where a block that moves along the face
    of its neighbour opens the joint, and 1e-3 where the sway of a face without slip has centripetal accelerations, which no forces hold."""
    errors = []
    for tilt in (0.29, 0.3, 0.31):
        O.reset()
        material = stone(restitution)
        ids = dem.stack(blocks, (0.6, 1, 0.6 * slenderness), material, dem.base((8, 4, 0.3), material))
        dem.tilt(ids[-1], tilt * math.atan(1 / slenderness))
        O.engines = quiet_engines(penetration=1e-4)
        balance = Balance()
        while O.time < 1.5:
            steps(100)
        errors.append(abs(balance.error()) / dem.energy()["impactDissip"])
        print(f"{blocks} blocks, tilt {tilt}: {len(dem.impacts())} impacts, energy {errors[-1]:.1e} of what they take")
    assert max(errors) < 4e-4, errors


@pytest.mark.parametrize("touching", (False, True))
def test_a_base_that_turns(touching):
    """A base that turns lifts what stands on it: its work is what the blocks gain; and bases that touch each other do not push each other. Energies
    of the springs are of second order of the penetration."""
    base = dem.base((6, 1, 0.2), stone())
    block = dem.block((0.6, 1, 0.6), stone(), on=base, center=None)
    O.bodies[block].state.pos += (2, 0, 0)
    O.bodies[block].state.refPos = O.bodies[block].state.pos
    if touching:
        O.bodies[dem.block((1, 1, 1), stone(), center=(-3.5, 0, 0.3))].dynamic = False
    O.engines = quiet_engines()
    O.run(10, True)
    balance = Balance()
    O.bodies[base].state.angVel = (0, -0.02, 0)
    O.run(int(0.5 / O.dt), True)
    work = dem.energy()["baseWork"]
    print(f"on a base that turns{', beside another' if touching else ''}: work {work:.2f} J, energy {balance.error() / work:.1e} of it")
    assert work > 100 and abs(balance.error() / work) < 1e-3
