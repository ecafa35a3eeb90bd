"""Curves of a report: SVG figures that share the time with the 3D view, and pictures that do not."""

import hashlib
import io
import re

import numpy as np
from masonry.results.collapse import lies
from masonry.results.forces import base_reactions
from masonry.results.joints import movement
from masonry.results.pictures import cracks_figure, energy_figure, joints_figure, shape_figure, thrust_figure
from masonry.results.view import largest, still

_STYLE = {"svg.fonttype": "none", "svg.hashsalt": "masonry", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
          "grid.color": "0.9", "axes.edgecolor": "0.5", "legend.frameon": True, "legend.framealpha": 0.8, "legend.edgecolor": "none", "lines.linewidth": 1.3}
_WIDTH = 7.4  # inches
# Collections of more paths are drawn as pictures, of so many dots an inch.
_PATHS, _DPI = 1500, 200
# Courses, blocks or joints in one set of axes.
_LINES = 6
# Samples of curves that are computed sample by sample.
_SAMPLES = 400
# Room above the largest value that stands, relative to it.
_ROOM = 0.15
# Axes of forces end at so many times what 95 of 100 samples stay below: impacts are far above.
_USUAL = 1.5
# Components below this share of the largest are left out.
_FAINT = 1e-3


def styled(build):
    """The function, with the style of reports."""
    def within(*arguments):
        from matplotlib import rc_context

        with rc_context(_STYLE):
            return build(*arguments)

    return within


def axes_of(rows, height, ratios=None):
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, height), dpi=72, layout="constrained")
    FigureCanvasSVG(figure)
    return figure, figure.subplots(rows, 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": ratios or [1] * rows})[:, 0]


def svg(figure, over_time=True):
    """SVG text of a figure. over_time: its axes have the time (s) to the right; a line in each then follows the 3D view."""
    for axes in figure.axes if over_time else ():
        axes.axvline(axes.get_xlim()[0], color="0.35", linewidth=1, gid="cursor")
    for many in (one for axes in figure.axes for one in axes.collections if len(one.get_paths()) > _PATHS):
        many.set_rasterized(True)  # as a picture it is smaller
    data = io.BytesIO()
    figure.savefig(data, format="svg", dpi=_DPI, metadata={"Date": None, "Creator": None})
    text = data.getvalue().decode()
    text = text[text.index("<svg"):].replace('id="cursor"', 'class="cursor"')
    text = re.sub(r'<metadata>.*?</metadata>', "", text, flags=re.S)
    text = re.sub(r' id="[A-Za-z0-9]+_\d+"', "", text)  # of groups
    own = hashlib.sha1(text.encode()).hexdigest()[:8]  # names of clip paths and the like: no two figures of a page have the same
    text = re.sub(r'( id="|url\(#|href="#)', rf"\g<1>f{own}-", text)
    text = re.sub(r' xmlns(:xlink)?="[^"]*"', "", text)  # not needed in HTML
    share = min(1, figure.get_size_inches()[0] / _WIDTH)  # of the page: letters of narrow pictures are no larger than those of wide ones
    text = text.replace("<svg", f'<svg style="width: {100 * share:.4g}%"', 1) if share < 1 else text
    if over_time:
        start, end = figure.axes[0].get_xlim()
        left, right = (figure.axes[0].transData.transform((t, 0))[0] for t in (start, end))
        text = text.replace("<svg", f'<svg class="over-time" data-start="{start:.9g}" data-left="{left:.3f}" data-rate="{(right - left) / (end - start):.6g}"', 1)
    return text


@styled
def plain_svg(figure):
    """SVG text of a figure that shows no history."""
    return svg(figure, over_time=False)


def time_axis(axes, time, collapsed=None):
    """Limits and label of the lowest axes; what comes after the collapse is shaded."""
    for one in axes:
        one.set_xlim(time[0], time[-1])
        if collapsed is not None and np.isfinite(collapsed):
            one.axvspan(collapsed, time[-1], color="tab:red", alpha=0.08, linewidth=0)
    axes[-1].set_xlabel("time (s)")


def _limit(axes, values):
    """What lies on the floor would leave no room to what stands."""
    most = largest(np.abs(values))
    if most > 0:
        axes.set_ylim((-1 - _ROOM) * most if np.nanmin(values) < 0 else 0, (1 + _ROOM) * most)


@styled
def tie_forces(history, verdict):
    """Forces of the ties, of at most so many as a figure can tell apart: those that carried most."""
    figure, axes = axes_of(1, 2.6)
    forces = history.ties["force"]
    for k in np.sort(np.argsort(-np.abs(forces).max(axis=0), kind="stable")[:_LINES]).tolist():
        tie = history.ties[0, k]
        axes[0].plot(history.time, forces[:, k] / 1e3, label=f"{tie['body1']} – {tie['body2']}")
    axes[0].set_ylabel("force (kN)")
    axes[0].legend(title="bodies", ncols=2)
    time_axis(axes, history.time, verdict.time)
    return svg(figure)


@styled
def cracks(found, verdict):
    """How many joints have cracked, and what the cracks have spent."""
    figure, axes = axes_of(2, 3.6)
    table = found.timeline
    for name, color in (("tension", "tab:red"), ("shear", "tab:blue")):
        axes[0].step(table["time"], table[name], where="post", color=color, label=f"in {name}")
        axes[1].plot(table["time"], table[f"energy_{name}"], color=color, label=f"in {name}")
    axes[0].step(table["time"], table["broken"], where="post", color="0.4", linestyle="--", linewidth=1, label="broken")
    axes[0].set_ylabel("cracked joints")
    axes[1].set_ylabel("spent by cracks (J)")
    axes[0].yaxis.get_major_locator().set_params(integer=True)
    for one in axes:
        one.legend(loc="center right")
    time_axis(axes, table["time"], verdict.time)
    return svg(figure)


@styled
def crack_map(history, found):
    return svg(cracks_figure(history, found), over_time=False)


@styled
def drift(history, verdict):
    """Drift, and the way of the base where it moves."""
    bases = np.unique(history.bases[history.free]) if history.base is not None else []
    ways = [(f"base {history.ids[base]}, " if len(bases) > 1 else "", history.base_path(base)[0] - history.position[0, base]) for base in bases]
    moves = [(name, k, way[:, k]) for name, way in ways for k in range(3) if largest(np.abs(way[:, k])) > 1e-9 * history.sizes.max()]
    figure, axes = axes_of(2 if moves else 1, 3.6 if moves else 2.4, [3, 2] if moves else None)
    values = 100 * history.drift()
    axes[0].plot(history.time, values, color="tab:red")
    before = values[history.time < verdict.time] if verdict.collapsed else values
    _limit(axes[0], before if len(before) else values)
    axes[0].set_ylabel("drift (% of height)")
    for name, k, way in moves:
        axes[1].plot(history.time, 1e3 * way, color=f"C{k}" if len(bases) == 1 else None, label=f"{name}along {'xyz'[k]}")
    if moves:
        axes[1].set_ylabel("base (mm)")
        if len(moves) > 1:
            axes[1].legend()
    time_axis(axes, history.time, verdict.time)
    return svg(figure)


def _standing(history, values):
    """The values (s, n) up to the fall of each block."""
    return np.where(lies(history), np.nan, values)


@styled
def excursions(history, verdict):
    """Largest horizontal displacement in each course: of some courses, where there are many."""
    from matplotlib import colormaps

    way = _standing(history, 1e3 * np.linalg.norm(history.displacement[..., :2], axis=2))
    height = history.position[0, :, 2]
    tolerance = 0.1 * history.sizes[history.free].min()
    levels, courses = np.unique((height[history.free] / tolerance).round(), return_inverse=True)
    rows = np.flatnonzero(history.free)
    shown = np.unique(np.linspace(0, len(levels) - 1, min(_LINES, len(levels))).round().astype(int))
    figure, axes = axes_of(1, 2.6)
    for k in shown[::-1]:
        of = rows[courses == k]
        axes[0].plot(history.time, np.fmax.reduce(way[:, of], axis=1), color=colormaps["viridis"](0.9 * k / max(1, len(levels) - 1)),
                     label=f"{height[of].mean():.3g} m ({len(of)} block{'s' if len(of) != 1 else ''})")
    _limit(axes[0], way[:, rows])
    axes[0].set_ylabel("excursion (mm)")
    axes[0].legend(title="height of the centres", loc="upper left", fontsize="small", title_fontsize="small")
    time_axis(axes, history.time, verdict.time)
    return svg(figure)


@styled
def joints(history, verdict, table):
    """Opening and slip of the joints that moved most."""
    figure, axes = axes_of(2, 4.2)
    for one, part, name in zip(axes, (0, 1), ("opening", "slip")):
        one.set_ylabel(f"{name} (mm)")
        if largest(table[name]) <= still(history):  # round-off
            one.plot(history.time[[0, -1]], [0, 0], color="0.5", label="none")
            one.set_ylim(0, 1)
            continue
        most = np.argsort(-np.nan_to_num(table[name]), kind="stable")[:_LINES]
        even = np.linspace(0, len(history.time) - 1, min(_SAMPLES, len(history.time))).round().astype(int)
        samples = np.unique([*even, *np.searchsorted(history.time, table[name + "_time"][most])])
        values = 1e3 * movement(history, samples)[part][:, most]
        for k, way in zip(most, values.T):
            one.plot(history.time[samples], way, label=f"{table['id1'][k]} – {table['id2'][k]}")
        _limit(one, values)
        one.legend(title="blocks", loc="upper left", fontsize="small", title_fontsize="small", ncol=2)
    time_axis(axes, history.time, verdict.time)
    return svg(figure)


@styled
def of_joint(found, verdict):
    figure = found.figure(width=_WIDTH)
    figure.set_dpi(72)
    figure.axes[0].set_title("")
    for axes, (_, factor, names) in zip(figure.axes, found.panels()):
        values = factor * np.concatenate([found[name] for name, _ in names])
        loaded = np.abs(values[np.nan_to_num(values) != 0])
        usual = _USUAL * float(np.percentile(loaded, 95)) if "normal" in dict(names) and len(loaded) else 0  # forces alone have peaks
        if 0 < usual < largest(np.abs(values)):
            axes.set_ylim(-_ROOM * usual if np.nanmin(values) >= -_FAINT * usual else -usual, usual)
    time_axis(figure.axes, found["time"], verdict.time)
    return svg(figure)


@styled
def base_forces(history, verdict, base=None):
    """Base shear, vertical force and overturning moment, of one base or of all prescribed bodies."""
    table = base_reactions(history, base=base)
    figure, axes = axes_of(2, 3.6)
    for one, values, names in ((axes[0], 1e-3 * table["force"], ("base shear x", "base shear y", "vertical force")),
                               (axes[1], 1e-3 * table["moment"], ("about x", "about y", "about z"))):
        most = largest(np.abs(values))
        for k, name in enumerate(names):
            if largest(np.abs(values[:, k])) > _FAINT * most:
                one.plot(history.time, values[:, k], color=f"C{k}", linewidth=1, label=name)
        usual = _USUAL * float(np.nanpercentile(np.abs(values).max(axis=1), 95))
        if 0 < usual < most:
            one.set_ylim(-usual if np.nanmin(values) < -_FAINT * usual else 0, usual)
        one.legend(fontsize="small", loc="upper right")
    axes[0].set_ylabel("force (kN)")
    axes[1].set_ylabel("moment (kN m)")
    time_axis(axes, history.time, verdict.time)
    return svg(figure)


@styled
def energies(history):
    figure = energy_figure(history)
    figure.set_size_inches(_WIDTH, 4.2)
    figure.set_dpi(72)
    figure.axes[-1].set_xlim(history.time[0], history.time[-1])
    return svg(figure)


@styled
def impacts(table, time):
    """Energy that each impact has lost."""
    figure, axes = axes_of(1, 2.2)
    axes[0].vlines(table["time"], 0, table["energy_lost"], color="tab:purple", linewidth=1)
    axes[0].plot(table["time"], table["energy_lost"], ".", color="tab:purple", markersize=4)
    axes[0].set_ylabel("lost in an impact (J)")
    time_axis(axes, time)
    return svg(figure)


@styled
def shape(history, time):
    return svg(shape_figure(history, time), over_time=False)


@styled
def joint_map(history):
    return svg(joints_figure(history, thrust=False), over_time=False)


@styled
def thrust_map(history, time):
    return svg(thrust_figure(history, time), over_time=False)


@styled
def rotation(time, angles, exact=None, lines=None, critical=None):
    """Rotation of one block, rad, beside the exact one, and their difference. lines: names of the two."""
    names = lines or ("computed", "exact")
    figure, axes = axes_of(1 if exact is None else 2, 2.8 if exact is None else 4.0, None if exact is None else [3, 1])
    axes[0].plot(time, angles, color="tab:blue", label=names[0])
    if exact is not None:
        axes[0].plot(time, exact, "--", color="k", linewidth=1, label=names[1])
        axes[1].plot(time, angles - exact, color="tab:red", linewidth=1)
        axes[1].set_ylabel("difference (rad)")
        axes[0].legend(loc="upper right")
    if critical is not None and largest(np.abs(angles)) > 0.5 * critical:
        for side in (-1, 1):
            axes[0].axhline(side * critical, color="0.5", linestyle=":", linewidth=1)
    axes[0].set_ylabel("rotation (rad)")
    time_axis(axes, time)
    return svg(figure)


@styled
def phase_plane(angles, velocities, critical=None, exact=None):
    figure, axes = axes_of(1, 3.6)
    axes[0].plot(angles, velocities, color="tab:blue")
    if exact is not None:
        axes[0].plot(*exact, "--", color="k", linewidth=0.8)
    if critical is not None and largest(np.abs(angles)) > 0.5 * critical:
        for side in (-1, 1):
            axes[0].axvline(side * critical, color="0.5", linestyle=":", linewidth=1)
    axes[0].set(xlabel="rotation (rad)", ylabel="angular velocity (rad/s)")
    return svg(figure, over_time=False)
