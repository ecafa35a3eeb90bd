"""BlockMat: defaults, and bad values refused where they are given."""

import math
import os

from masonry import dem
from rocking_scene import refuses

stone = dem.BlockMat()
assert all(math.isnan(getattr(stone, name)) for name in ("restitution", "normalStiffness", "shearStiffness"))
assert stone.noSlip is False

stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.7, normalStiffness=1e9, shearStiffness=5e8, noSlip=True)
assert (stone.density, stone.frictionAngle, stone.restitution) == (2000, 0.6, 0.7)
assert (stone.normalStiffness, stone.shearStiffness, stone.noSlip) == (1e9, 5e8, True)
for edge in (0, 1, math.nan):
    dem.BlockMat(restitution=edge).restitution = edge

for attribute, bad, allowed in [
    ("restitution", -0.1, "from 0 to 1"),
    ("restitution", 1.0000001, "from 0 to 1"),
    ("restitution", math.inf, "from 0 to 1"),
    ("normalStiffness", 0, "positive"),
    ("normalStiffness", -1e9, "positive"),
    ("shearStiffness", 0, "positive"),
    ("shearStiffness", math.inf, "positive"),
]:
    refuses(lambda: dem.BlockMat(**{attribute: bad}), attribute, allowed)
    old = getattr(stone, attribute)
    refuses(lambda: setattr(stone, attribute, bad), attribute, allowed)
    if "MASONRY_YADE_TREE" not in os.environ:  # YADE's own attribute macros keep the refused value
        assert getattr(stone, attribute) == old, "a refused value must not stay"
    refuses(lambda: stone.updateAttrs({attribute: bad}), attribute, allowed)
    setattr(stone, attribute, old)
