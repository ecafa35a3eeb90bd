"""Content of the report of a masonry.History of one block."""

import math

import numpy as np
from masonry.history import part_of_motion, with_exact_moment
from masonry.results.view import largest
from masonry.results.wall_history import WallHistory

from . import curves, view3d

_SAMPLES, _SHOWN = 2000, 400
# A history without an end, under a motion without one, is drawn for this number of periods 2 pi / p.
_PERIODS = 20
# Rows of the table of impacts.
_IMPACTS = 200
# Depth and base of the block in the 3D view, relative to its width.
_DEPTH, _BASE = 1.0, 3.0


def content(history):
    """What report.html is filled with."""
    if history.shape != ():
        raise ValueError(f"history: holds cases of shape {history.shape}: must be that of one block")
    block, end = history.block, _end(history)
    time = np.linspace(0, end, _SAMPLES)
    angles, velocities = history.sample(time)
    known = np.isfinite(angles)
    time, angles, velocities = time[known], angles[known], velocities[known]
    exact = None
    if history.restoring != "exact":
        exact = with_exact_moment(history, end).sample(time)
    names = (f"restoring moment {history.restoring}", "exact")
    compared = "" if exact is None else f" Dashed: the exact solution; largest difference {largest(np.abs(angles - exact[0])):.3g} rad."
    sections = [{"name": "rotation", "heading": "Rotation", "figure": curves.rotation(time, angles, None if exact is None else exact[0], names, block.critical_angle),
                 "caption": "Rotation, positive towards +x." + (compared or " This is the exact solution.") + " Dotted: the critical angle, where it is near."},
                {"name": "phase-plane", "heading": "Phase plane", "figure": curves.phase_plane(angles, velocities, block.critical_angle, exact),
                 "caption": "Angular velocity over rotation; impacts are the vertical jumps."}]
    if len(history.impact_times):
        rows = [(str(k + 1), f"{t:.5f}", f"{v:.5g}") for k, (t, v) in enumerate(zip(history.impact_times, history.impact_velocities)) if k < _IMPACTS]
        sections.append({"name": "impacts", "heading": "Impacts", "caption": f"{len(history.impact_times)} impacts.", "figure": "", "columns": ["", "Time (s)", "Velocity before (rad/s)"],
                         "rows": rows, "more": "All of them." if len(rows) == len(history.impact_times) else f"The first {len(rows)}.", "fold": "List of impacts"})
    peak = int(np.argmax(np.abs(angles)))
    moving = _as_structure(history, time, angles)
    return {"title": "One rocking block", "kind": "collapsed" if history.overturned else "stands",
            "headline": f"Overturns in half cycle {history.overturn_half_cycle}" if history.overturned else
            f"Does not overturn{' so far' if history.motion_run < 1 else ''}", "sentences": _sentences(history, end), "warnings": [],
            "scene": view3d.scene(moving, time[peak]), "sections": sections, "known": True, "solver": [],
            "numbers": [("Largest rotation", f"{abs(angles[peak]):.4g} rad, {abs(angles[peak]) / block.critical_angle:.3g} of the critical angle", f"{time[peak]:.4g} s")],
            "facts": [("Block", f"{2 * block.half_width:g} m wide, {2 * block.half_height:g} m high, gravity {block.gravity:g} m/s^2"),
                      ("Slenderness", f"{block.slenderness:.4g}"), ("Critical angle", f"{block.critical_angle:.4g} rad"),
                      ("Frequency parameter p", f"{block.frequency_parameter:.4g} rad/s"),
                      ("Restitution", f"{block.natural_restitution:.4g} (natural)" if history.restitution is None or np.isnan(history.restitution) else f"{history.restitution:g}"),
                      ("Restoring moment", history.restoring), ("Motion of the base", "none" if history.motion is None else repr(history.motion)),
                      *([] if history.vertical is None else [("Vertical motion", repr(history.vertical))]), ("Versions", _versions())]}


def _versions():
    from masonry import _build

    return f"masonry {_build.VERSION}"


def _end(history):
    """The last instant that is drawn, s."""
    if math.isfinite(history.end_time):
        return history.end_time
    last = max([0.0, *history.impact_times, *history.peak_times])
    return 1.1 * last if last > 0 else _PERIODS * 2 * math.pi / history.block.frequency_parameter


def _sentences(history, end):
    said = [f"The run ends at {end:.4g} s{part_of_motion(history)}."]
    if math.isfinite(history.rest_time):
        said.append(f"The block is at rest from {history.rest_time:.4g} s on.")
    elif not history.overturned:
        said.append("It is still rocking then.")
    return said


def _as_structure(history, time, angles):
    """The block on a base that moves, for the 3D view."""
    rows = np.unique(np.linspace(0, len(time) - 1, _SHOWN).round().astype(int))
    time, angles, block = time[rows], angles[rows], history.block
    b, a = block.half_width, block.half_height
    base = np.zeros((len(time), 3))
    base[:, 0] = np.nan_to_num(history.sample_base(time))
    base[:, 2] = -0.1 * b
    # The lower edge on the side that it leans to stays where it is.
    side = np.where(angles < 0, -1.0, 1.0)
    center = np.stack([side * b - side * b * np.cos(angles) + a * np.sin(angles), 0 * angles, side * b * np.sin(angles) + a * np.cos(angles)], axis=1)
    turn = np.stack([np.cos(angles / 2), 0 * angles, np.sin(angles / 2), 0 * angles], axis=1)
    still = np.tile([1.0, 0, 0, 0], (len(time), 1))
    sizes = [[2 * _BASE * b, 2 * _DEPTH * b * 1.5, 0.2 * b], [2 * b, 2 * _DEPTH * b, 2 * a]]
    positions = np.stack([base, center + base * [1, 0, 0]], axis=1)
    return WallHistory(time, [0, 1], sizes, [False, True], positions, np.stack([still, turn], axis=1))
