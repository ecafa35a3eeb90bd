"""Collapse multipliers of blocks on ties against statics. mu: tangent of the friction angle."""

import math

import pytest
from masonry import dem
from rocking_scene import refuses
from yade import O

# Bisection ends within 1e-3 of the multiplier; the mean of the bracket is off by at most half of that.
CLOSE = 1e-3
METHODS = ("wall", "localised")


def ground(mu=2.0, mortar=None):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(mu), restitution=0, mortar=mortar)
    return dem.base((12, 4, 0.2), stone), stone


def mortared(strength, length):
    """A mortar with that tensile strength, Pa, whose cracks have let go after some times that length, m: fractureEnergy over tensileStrength."""
    return dem.JointMat(tensileStrength=strength, fractureEnergy=length * strength, cohesion=2.8 * strength, shearFractureEnergy=14 * length * strength)


def slender(mortar=None):
    """(base, block): a block of 0.4 x 1.2 m that turns about its toe."""
    base, stone = ground(mortar=mortar)
    return base, dem.block((0.4, 0.4, 1.2), stone, on=base)


def weight(*ids):
    return 9.81 * sum(O.bodies[id].state.mass for id in ids)


def anchor(base, block, height, stiffness, strength, y=0.0, **how):
    """A level tie from the middle of the block to a point 2 m towards x."""
    return dem.tie(block, (0, y, height), base, (2, y, height), stiffness, strength=strength, **how)


def holds(block, moment):
    """Multiplier at which a slender block turns against a moment of ties about its toe: (W b/2 + M) / (W h/2)."""
    return (0.2 * weight(block) + moment) / (0.6 * weight(block))


def found(**options):
    return dem.TiltTable(direction="-x", **options).bisect(progress=False)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("stiffness", (1e6, 1e7, 1e9))
def test_a_block_on_a_tie(method, stiffness):
    """It turns by T/(k z) until the tie breaks; its arm shortens by h/2 of that, 0.3 mm of 200 with the softest tie."""
    base, block = slender()
    tie = anchor(base, block, 1.0, stiffness, 500)
    exact, turned = holds(block, 500), 500 / stiffness
    result = found(method=method)
    print(f"{method}, k = {stiffness:.0e}: {result.multiplier / exact - 1:.1e}, {len(result.trials)} trials", *result.remarks)
    assert exact == pytest.approx(0.5545, abs=1e-4) and abs(result.multiplier / (exact - turned) - 1) < CLOSE
    assert not result.doubts and "jammed" not in [trial.verdict for trial in result.trials]
    assert (tie.broken, tie.strength, tie.force, tie.extension) == (False, 500, 0, 0) and math.isnan(tie.brokenAt) and O.time == 0
    assert found(method=method).trials == result.trials


@pytest.mark.parametrize("method", METHODS)
def test_pretension_adds_nothing_to_a_tie_that_breaks(method):
    base, block = slender()
    anchor(base, block, 1.0, 1e7, 500, pretension=300)
    assert abs(found(method=method).multiplier / holds(block, 500) - 1) < CLOSE


@pytest.mark.parametrize("method", METHODS)
def test_ties_beside_the_middle_plane(method):
    base, block = slender()
    for y in (-0.15, 0.15):
        anchor(base, block, 1.0, 1e7, 250, y)
    assert abs(found(method=method).multiplier / holds(block, 500) - 1) < CLOSE


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("stiffness", (1e6, 1e7, 1e9))
def test_a_sliding_block_on_a_tie(method, stiffness):
    """It slides at mu + T/W. Friction holds a block that has swung too far on its tie, so a load that broke the tie is tried again from just below."""
    base, stone = ground(0.3)
    block = dem.block((0.6, 0.4, 0.4), stone, on=base)
    anchor(base, block, 0.2, stiffness, 500)
    result = found(method=method)
    assert abs(result.multiplier / (0.3 + 500 / weight(block)) - 1) < CLOSE and not result.doubts, result


@pytest.mark.parametrize("method", METHODS)
def test_ties_break_one_after_the_other(method):
    """A tie at 1.0 m and one at 0.5 m stretch as 2 to 1. The upper one breaks at 300 N, where the lower one bears 150: a moment of 375 N m. Alone, the lower one bears
    800 N, 400 N m."""
    base, block = slender()
    ties = anchor(base, block, 1.0, 1e7, 300), anchor(base, block, 0.5, 1e7, 800)
    result = found(method=method)
    assert abs(result.multiplier / holds(block, 400) - 1) < CLOSE and not result.doubts, result
    remark = next(one for one in result.remarks if "ties have broken" in one)
    first = float(remark.split("from ")[1].split()[0])
    assert holds(block, 375) * (1 - CLOSE) < first < holds(block, 400) and remark.split(": ")[-1].startswith("1 at"), remark
    assert not any(tie.broken for tie in ties)
    trial = dem.TiltTable(direction="-x", method=method).trial((holds(block, 375) + holds(block, 400)) / 2)
    assert trial.verdict == "rest" and [tie.broken for tie in ties] == [True, False] and [tie.strength for tie in ties] == [300, 800]
    assert abs(ties[1].force / 780 - 1) < 0.02  # that multiplier needs 387.5 N m, by 0.5 m 775 N


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("number", (1, 4))
def test_a_narrow_stack_on_a_wide_one(method, number):
    """Both turn at the sum of their W b over that of their W h; pulled apart from the tie, the narrow one falls alone, at b/h."""
    base, stone = ground()
    narrow = dem.stack(number, (0.3, 0.4, 1.2 / number), stone, base, at=(-1, 0))
    wide = dem.stack(number, (0.6, 0.4, 1.2 / number), stone, base, at=(1, 0))
    height = 1.2 - 0.6 / number
    dem.tie(narrow[-1], (-1, 0, height), wide[-1], (1, 0, height), 1e7)
    result = found(method=method)
    exact = (0.3 * weight(*narrow) + 0.6 * weight(*wide)) / (1.2 * weight(*narrow, *wide))
    assert abs(result.multiplier / exact - 1) < CLOSE and not result.doubts, result
    alone = dem.TiltTable(direction="x", method=method).bisect(progress=False)
    assert abs(alone.multiplier / 0.25 - 1) < CLOSE and not alone.doubts, alone


@pytest.mark.parametrize("model", ("planar", "spatial"))
@pytest.mark.parametrize("strength, length, stiffness, pretension, moment", (
    (5e3, 7e-6, 1e6, 0, 500 - 0.5e-3 * 0.6 * 3767), (20e3, 7e-6, 1e6, 0, 640), (20e3, 7e-6, 1e6, 300, 640 + 300), (20e3, 7e-5, 1e9, 0, 640 + 500)))
def test_a_mortared_block_on_a_tie(strength, length, stiffness, pretension, moment, model):
    """Sound, its joint bears f_t A b/2, 160 or 640 N m, and the tie 500 N m at its strength. By a soft tie the block holds until its joint cracks, or by the tie alone until this
    breaks, whichever is more; a pretension adds its moment to that of the sound joint. By a tie that bears its strength before the crack opens, both are there."""
    base, block = slender(mortared(strength, length))
    tie = anchor(base, block, 1.0, stiffness, 500, pretension=pretension)
    result = found(model=model)
    print(f"{strength:.0e} Pa, k = {stiffness:.0e}: {result.multiplier / holds(block, moment) - 1:.1e}", *result.remarks)
    assert abs(result.multiplier / holds(block, moment) - 1) < CLOSE and not result.doubts, result
    assert any("joints have cracked and the blocks stand" in remark for remark in result.remarks) == (moment < 500)
    assert not tie.broken and found(model=model).trials == result.trials


@pytest.mark.parametrize("strength", (0, 1e3, 2e3))
def test_a_mortared_parapet_above_a_tie(strength):
    """The uppermost of four blocks turns alone at (W b/2 + f_t A b/2) / (W h/2); those below it crack before, and the tie holds them."""
    base, stone = ground(mortar=mortared(strength, 7e-5) if strength else None)
    blocks = dem.stack(4, (0.4, 0.4, 0.3), stone, base)
    anchor(base, blocks[2], 0.75, 1e8, math.inf)
    result = found()
    exact = (0.2 * weight(blocks[3]) + 0.032 * strength) / (0.15 * weight(blocks[3]))
    assert abs(result.multiplier / exact - 1) < CLOSE and not result.doubts, result
    assert any("cracked" in remark for remark in result.remarks) == (strength > 0)


def test_a_tie_that_stretches_beyond_the_share(tmp_path):
    """A tie of 2e5 N/m stretches by 2.5 mm before it breaks, farther than 0.8 mm; with ten times the share it breaks."""
    base, block = slender()
    anchor(base, block, 1.0, 2e5, 500)
    result = found()
    assert any("larger share" in doubt for doubt in result.doubts) and result.multiplier < 0.8 * holds(block, 500), result
    result.report(tmp_path / "tilting.html")
    assert "ties have stretched" in (tmp_path / "tilting.html").read_text()
    wide = found(share=0.02)
    assert abs(wide.multiplier / (holds(block, 500) - 2.5e-3) - 1) < CLOSE and not wide.doubts, wide


def test_what_is_refused():
    base, block = slender()
    tie = anchor(base, block, 1.0, 1e7, 500)
    refuses(dem.TiltTable().ramp, "ramp()", "bisect()")
    tie.dead = True
    dem.TiltTable(direction="-x").ramp(progress=False)
