"""Rocking masonry blocks in YADE: importing this module registers the plugin's classes in the running YADE.

    from masonry import dem
    stone = dem.BlockMat(density=2000, frictionAngle=0.6, restitution=0.7)

The classes also appear in the module `yade`, so that `from yade import *` brings them in, and a saved simulation that
holds them can be loaded once this module is imported.
"""

from masonry._calls import check_keywords as _check_keywords
from masonry.dem._load import load_classes as _load_classes

# Bound by name here: BlockMat, ...
globals().update(_load_classes())

from masonry.dem import records as _records  # noqa: E402, F401  (YADE's classes must be registered first)
from masonry.dem.buildings import building  # noqa: E402
from masonry.dem.checks import check_blocks  # noqa: E402
from masonry.dem.collapsing import collapsed  # noqa: E402
from masonry.dem.comparing import compare  # noqa: E402
from masonry.dem.convex import (Geometry, arch, barrel_vault, blocks_from_mesh, column, convex, dome, drum, flat_arch, from_yade, geometry,  # noqa: E402
                                prism, rubble_wall, wedge)
from masonry.dem.engines import engines, record_motion  # noqa: E402
from masonry.dem.joint_engine import energy, impacts  # noqa: E402
from masonry.dem.loads import add_mass, dead_load  # noqa: E402
from masonry.dem.mortar import bond, damage, scatter  # noqa: E402
from masonry.dem.plans import Arch, Beams, Opening, Slab  # noqa: E402
from masonry.dem.pushing import Push, pull_and_release, push  # noqa: E402
from masonry.dem.reactions import joint_forces, reactions  # noqa: E402
from masonry.dem.recording import history, save_history, wall_history  # noqa: E402
from masonry.dem.resting import at_rest  # noqa: E402
from masonry.dem.running import run  # noqa: E402
from masonry.dem.scene import (angle, base, block, blocks_from_table, overturned, pier, return_wall, save_blocks,  # noqa: E402
                               stack, tilt, two_wythe_wall, wall)
from masonry.dem.structures import structures  # noqa: E402
from masonry.dem.ties import tie, ties  # noqa: E402
from masonry.dem.tilting import TiltTable  # noqa: E402
from masonry.dem.unions import union  # noqa: E402

_check_keywords(__name__)
