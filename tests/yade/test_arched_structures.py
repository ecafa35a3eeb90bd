"""Arches, a dome, a wall above an arch, arches on piers: least thickness, multipliers, hinges and thrust against limit analysis (validation/convex, cases a16, a23
to a26, a28 and a29)."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from masonry import dem
from yade import O

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "validation" / "convex"))

import arches  # noqa: E402
import domes  # noqa: E402
import rows  # noqa: E402
import statics  # noqa: E402
import structures  # noqa: E402


@pytest.mark.parametrize("case", [*structures.IN_SECONDS, *arches.IN_SECONDS], ids=lambda case: case.__name__)
def test_against_limit_analysis(case, monkeypatch):
    monkeypatch.setattr(rows, "COMPLIANT", [])  # they take minutes
    found = list(case())
    for row in found:
        print(row)
        assert row.holds(), str(row)
    assert found


def names(speeds):
    """As 'e0 i2 e4 i7': hinges at the extrados or the intrados, and joints that slide (s), counted from the springer towards which the arch is pulled.
    speeds: (joints, 3), from the left: opening at the extrados, opening at the intrados, slip."""
    return " ".join(f"{letter}{k}" for k, joint in enumerate(speeds[::-1]) for letter, speed in zip("ies", joint, strict=True) if speed > 0)


def failure_in_simulation(friction, **options):
    """speeds as in names(), of the arch of a16 on a tilting table."""
    ids = arches.build(7, 0.15, friction, math.radians(157.5))
    table = dem.TiltTable(**options)
    result = table.bisect(progress=False)
    assert not result.doubts, result.doubts
    before = [O.bodies[id].state.ori for id in ids]
    table.trial(1.01 * result.multiplier)  # leaves the scene as it collapses, so that it shows on which side joints open
    turned = np.diff([(O.bodies[id].state.ori * ori.conjugate()).toRotationVector()[1] for id, ori in zip(ids, before, strict=True)])
    joints = np.sort(result.joints, order="id1")  # from the left
    opening, slip = joints["opening"] * joints["opens"], joints["slip"] * joints["slides"]
    return np.column_stack([opening * (turned > 0), opening * (turned < 0), slip])  # turned about y > 0: the right stone leans away at the extrados


@pytest.mark.parametrize("method", ("localised", "wall"))
@pytest.mark.parametrize("model", ("planar", "spatial"))
@pytest.mark.parametrize("friction, wanted", ((5.0, "e0 i2 e4 i7"), (0.5, "s0 i2 e4 i7"), (0.4, "s0 i2 e4 i7")))
def test_where_an_arch_fails(friction, wanted, model, method):
    """Hinges are where limit analysis has them, on the same side; with a friction coefficient of 0.4 three joints open and one slides. Without slip joints also open in
    the same proportion, which the movement of TiltTable changes, 2e-3 of the smallest size. With slip they do not, since the linear program lets slip dilate."""
    right = statics.mechanism(statics.arch(7, 0.15, math.radians(157.5)), friction)
    right[right < 1e-9] = 0  # round-off of the program
    found = failure_in_simulation(friction, model=model, method=method)
    print(found / found.max(), right)
    assert names(right) == wanted and names(found) == wanted
    if friction > 1:
        assert np.allclose(found / found.max(), right, rtol=0, atol=2e-3)


def test_limit_analysis_itself():
    """Oracles: the least thickness of a dome of many stones tends to that of a membrane without hoop tension, 0.042 of the radius (Heyman 1967, to its two
    digits); a block on two others bears on both; a row of voussoirs has the same thrust by sides that touch as by the joints that it was made of."""
    assert domes.least_thickness(24, 48, 0.5) == pytest.approx(0.042, abs=1e-3)
    pier = structures.rectangle(0, 1, 0, 2)
    beam = statics.assembly([pier, pier + (3, 0), structures.rectangle(-0.5, 4.5, 2, 2.5)], [structures.rectangle(-1, 5, -1, 0)])
    assert sorted((first is None, second) for first, second, *_ in beam.joints) == [(False, 0), (False, 1), (True, 0), (True, 1)]
    assert statics.stands(beam, 0.5)
    arch = statics.arch(16, 0.15)
    ground = [structures.rectangle(side - 0.2, side + 0.2, -1, 0) for side in (-1, 1)]
    again = statics.assembly(arch.blocks, ground)
    left = [k for k, (first, _, a, _) in enumerate(again.joints) if first is None and a[0] < 0]
    assert np.allclose(statics.thrust(again, 0.7, left), statics.thrust(arch, 0.7), rtol=1e-9)
