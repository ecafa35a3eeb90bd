"""Arches, a dome, a wall above an arch, arches on piers: least thickness, multipliers and thrust against limit analysis (validation/convex, cases a23 to a26,
a28 and a29)."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "validation" / "convex"))

import arches  # noqa: E402
import domes  # noqa: E402
import statics  # noqa: E402
import structures  # noqa: E402


@pytest.mark.parametrize("case", [*structures.IN_SECONDS, *arches.IN_SECONDS], ids=lambda case: case.__name__)
def test_against_limit_analysis(case):
    found = list(case())
    for row in found:
        print(row)
        assert row.holds(), str(row)
    assert found


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
