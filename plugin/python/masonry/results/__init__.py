"""What a wall study needs from the recorded motion of its blocks: pictures and films, openings and slip of the joints, energies, collapse, files for
ParaView. Needs no YADE: a history saved by one script is drawn by another.

    history = dem.wall_history(recorder)            # in YADE; or results.WallHistory.load("wall.npz")
    print(results.collapse(history))
    results.draw(history, "wall.png")
    results.report(history, "wall.html")
"""

from masonry._calls import check_keywords as _check_keywords
from masonry._shapes import Shapes

from .collapse import CollapseReport, collapse, fallen
from .cracks import Cracks, cracks
from .forces import base_reactions, thrust
from .joint_energies import JointEnergies, joint_energies
from .joints import joints, patches
from .paraview import write_paraview
from .pictures import draw, draw_energy, draw_joints, film
from .reporting import report
from .ties import ties
from .time_histories import TimeHistory, joint_history, structure_history
from .wall_history import WallHistory

__all__ = ["CollapseReport", "Cracks", "JointEnergies", "Shapes", "TimeHistory", "WallHistory", "base_reactions", "collapse", "cracks", "draw", "draw_energy", "draw_joints", "fallen", "film",
           "joint_energies", "joint_history", "joints", "patches", "report", "structure_history", "thrust", "ties", "write_paraview"]

_check_keywords(__name__)
