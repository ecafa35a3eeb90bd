"""Pictures and films of a WallHistory. Files are written without a screen; matplotlib is imported where it is needed."""

import math

import numpy as np
from masonry._files import save_picture, written
from masonry._given import number_given, positive_given, shown
from masonry._progress import steps
from masonry.results.collapse import collapse, lies
from masonry.results.cracks import CRACKED
from masonry.results.forces import has_forces, thrust_at_first
from masonry.results.joints import gone_at_the_end, joints, patches, patches_of
from masonry.results.ties import tie_ends
from masonry.results.view import STILL, View, enlargement, largest, movement, nice, still
from masonry.results.wall_history import ENERGIES, history_given

# Movement of the farthest moved block in a picture, relative to the smallest block, where no factor is given.
_DRAWN = 0.5
# Error of a balance that closes by its definition, relative to the largest energy in it: round-off of 1e6 steps
# leaves 2e-13.
_CLOSED = 1e-12
_COLOURS = {"displacement": ("displacement relative\nto the base", "m"), "rotation": ("rotation", "rad")}
# Scales that end below this, m or rad, have their numbers in thousandths: mm, mrad.
_SMALL = 0.1
# Longest resultant of a joint, relative to the smallest height of a block.
_THRUST = 2.0
# Resultants smaller than this share of the largest are left out.
_FAINT = 0.02
# A wall is thinner than it is long by this factor at least.
_THIN = 0.5
# How far beside the structure a picture shows what has fallen, relative to its size: a wall that overturns lies within its height.
_BESIDE = 1.0
# Places so many times the width of the picture away are counted from another origin.
_FAR = 1e3
# Inches of an axis for each of its numbers.
_TICK = 0.5
# Inches: a page; the height of a picture of one panel; what labels and a scale take beside a panel and above it; the narrowest panel.
_PAGE, _TALLEST, _BORDER, _NARROWEST = (7.4, 9.0), 6.5, (2.0, 1.0), 3.6
_PRESCRIBED, _UNMOVED, _BEYOND = "0.62", "0.85", "tab:purple"


def scale_end(values, stands, least):
    """(end of a scale, whether what has fallen goes beyond it). The end: the largest value of what stands, or of all where most has fallen or what stands
    has not moved; at least `least`."""
    most, every = largest(values[stands]), largest(values)
    if most <= least or 2 * np.count_nonzero(stands) < np.size(stands):
        most = every
    return max(most, least), every > most


def shades(name, most):
    """Colour map from 0 to `most`, without the palest colours, which are lost on white."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    return ScalarMappable(Normalize(0, most), ListedColormap(colormaps[name](np.linspace(0.12, 1, 256))).with_extremes(over=_BEYOND))


def _colorbar(figure, axes, colours, label, unit, beyond):
    from matplotlib.ticker import FuncFormatter

    thousandths = unit in ("m", "rad") and colours.norm.vmax < _SMALL
    label = f"{label} ({'m' if thousandths else ''}{unit})" if unit else label
    bar = figure.colorbar(colours, ax=axes, label=f"{label}\npurple: fallen" if beyond else label, shrink=0.8, pad=0.02, extend="max" if beyond else "neither")
    if thousandths:
        bar.formatter = FuncFormatter(lambda value, _: f"{1e3 * value:g}")


def _check(color, enlarge):
    if color not in _COLOURS:
        raise ValueError(f"color = {shown(color)}: must be one of {', '.join(map(repr, _COLOURS))}")
    if enlarge is not None:
        positive_given("enlarge", enlarge, ", or None")


def _framed(history, samples, enlarge, view):
    """Points in the picture that it shows: the blocks as they were at first and as they stand in the samples, and of those that have fallen what lies
    beside the first shape, up to its size away: blocks that fall off their base do not shrink the others."""
    free, down = history.free, lies(history)
    first = history.corners(0)[free].reshape(-1, 3)
    reach = np.array([1, 1, 0]) * _BESIDE * np.ptp(first, axis=0).max()
    low, high = first.min(axis=0) - reach, first.max(axis=0) + reach
    points = [first]
    for k in samples:
        corners, fell = history.corners(k, enlarge), down[k]
        points += [corners[free & ~fell].reshape(-1, 3), np.clip(corners[free & fell].reshape(-1, 3), low, high)]
    points = np.concatenate(points)
    return view.place(points[np.isfinite(points).all(axis=1)])


def _layout(width, height, panels):
    """(columns, rows, inches a metre) of panels of that size, m, on a page: the ones that show the wall largest."""
    def scale(columns):
        rows = math.ceil(panels / columns)
        return min((_PAGE[0] / columns - _BORDER[0]) / width, ((_PAGE[1] if panels > 1 else _TALLEST) / rows - _BORDER[1]) / height)

    columns = max(range(1, panels + 1), key=scale)
    return columns, math.ceil(panels / columns), scale(columns)


def _figure(view, shown, panels=1):
    """Axes for a wall that fills `shown` (points in the picture), no wider than a page."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    (left, low), (right, high) = np.nanmin(shown, axis=0), np.nanmax(shown, axis=0)
    margin = 0.06 * max(right - left, high - low)
    width, height = right - left + 2 * margin, high - low + 2 * margin
    columns, rows, scale = _layout(width, height, panels)
    origin = round(left) if abs(left) > _FAR * width else 0
    figure = Figure(figsize=(min(max(width * scale + _BORDER[0], _NARROWEST) * columns, _PAGE[0]), (max(height * scale, 1.5) + _BORDER[1]) * rows), layout="constrained")
    FigureCanvasAgg(figure)
    all_axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in all_axes[panels:]:
        axes.set_axis_off()
    for axes in all_axes[:panels]:
        axes.set(aspect="equal", xlim=(left - margin, right + margin), ylim=(low - margin, high + margin))
        if view.from_side:
            axes.set(xlabel=view.label() if origin == 0 else f"{view.label()}, from {origin:.0f} m", ylabel="z (m)")
            axes.locator_params(axis="x", nbins=max(2, int(width * scale / _TICK)))
            if origin:
                axes.xaxis.set_major_formatter(lambda value, _: f"{value - origin:g}")
        else:
            axes.axis("off")
            bar = nice(width / 4)
            axes.plot([left, left + bar], [low - margin / 2] * 2, color="k", linewidth=2, zorder=3)
            axes.text(left + 1.1 * bar, low - margin / 2, f"{bar:g} m", va="center", fontsize="small", zorder=3)
    return figure, all_axes[:panels]


class _Painter:
    """The blocks in one picture, drawn anew for each sample."""

    def __init__(self, history, samples, enlarge, color, view, title):
        from matplotlib.collections import LineCollection, PolyCollection
        from matplotlib.colors import to_rgb

        _check(color, enlarge)
        self._history, self._view, self._title = history, View(history, view), title
        self._enlarge = enlargement(history, samples, _DRAWN) if enlarge is None else float(enlarge)
        self._values = np.linalg.norm(history.displacement, axis=2) if color == "displacement" else history.rotation
        self._moved = movement(history, samples) > still(history)
        # One block on the floor would leave no colours to the others.
        values, stands = self._values[samples][:, history.free], ~lies(history)[samples][:, history.free]
        most, beyond = scale_end(values, stands, still(history) if color == "displacement" else STILL)
        self._map = shades("YlOrRd", most)
        self._prescribed, self._unmoved = np.array(to_rgb(_PRESCRIBED)), np.array(to_rgb(_UNMOVED))
        start, free = history.corners(0), np.flatnonzero(history.free)
        self.figure, (self._axes,) = _figure(self._view, _framed(history, samples, self._enlarge, self._view))
        self._axes.add_collection(LineCollection(self._view.outlines(start[free], free), colors="0.6", linewidths=0.6, linestyles="--", zorder=1))
        self._blocks = PolyCollection([], edgecolors="0.2", linewidths=0.5 if len(start) < 300 else 0.25, zorder=2)
        self._ties = LineCollection([], colors="tab:blue", linewidths=1.5, capstyle="round", zorder=3)
        self._axes.add_collection(self._ties)
        self._axes.add_collection(self._blocks)
        if self._moved:
            _colorbar(self.figure, self._axes, self._map, *_COLOURS[color], beyond)

    def paint(self, sample):
        corners = self._history.corners(sample, self._enlarge)
        there = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
        polygons, rows, bright = self._view.faces(corners[there], there)
        rows = there[rows]
        colors = self._map.to_rgba(self._values[sample, rows])[:, :3] if self._moved else self._unmoved
        colors = np.where(self._history.free[rows, None], colors, self._prescribed)
        self._blocks.set_verts(polygons)
        self._blocks.set_facecolor(np.clip(colors * bright[:, None], 0, 1))
        self._ties.set_segments(self._view.place(tie_ends(self._history, sample, self._enlarge)))
        drawn = ("" if self._moved else ", nothing moved") + ("" if self._enlarge == 1 else f", movement drawn {self._enlarge:.3g} times")
        self._axes.set_title(f"{self._title + ': ' if self._title else ''}t = {self._history.time[sample]:.3f} s{drawn}", fontsize="small")


def _save(figure, path):
    save_picture(figure, path, dpi=150)


def shape_figure(history, time=None, enlarge=None, color="displacement", view=None, title=""):
    """The matplotlib figure of draw()."""
    sample = history_given(history).sample(collapse(history).peak_drift_time if time is None else time)
    painter = _Painter(history, [sample], enlarge, color, view, title)
    painter.paint(sample)
    return painter.figure


def draw(history, path, time=None, enlarge=None, color="displacement", view=None, title=""):
    """Writes a picture (.png, .pdf, .svg) of the displaced structure: relative to its base, with the blocks as they were at first dashed
    behind it. It shows all that stands, and of the blocks that have fallen those that lie beside the first shape, up to its size away. Ties are blue lines, until they break. Where no corner has moved by more than 1e-6 of the structure's size, blocks are grey and the title says so.

    time       the sample nearest to it is drawn, s; None: the one in which the drift (WallHistory.drift) is largest, before the first block falls where
               one does
    enlarge    factor on the movement, positive; None: so that the largest is drawn as half of the smallest block, at least 1; 1 where nothing moved
    color      'displacement' (of the centre, m) or 'rotation' (rad), since the first sample and relative to the base; the scale ends at the
               largest of the blocks that have not fallen, and those beyond it are purple; at the largest of all where most have fallen
    view       direction from the scene to the viewer (x, y, z); None: across the plane in which all blocks move (of two, the one across which the
               structure is thinner), else from the right, the front and above
    """
    _save(shape_figure(history, time, enlarge, color, view, title), path)


def film(history, path, start=None, end=None, frames_per_second=20, speed=1.0, enlarge=1.0, color="displacement", view=None, title="", progress=None):
    """Writes a film of the recorded motion, relative to the base: .gif, or .mp4 where ffmpeg is installed.

    start, end           part of the history, s; None: all of it. One picture where it holds a single sample.
    frames_per_second    of the film, above 0 and at most 60; a frame is the sample nearest to its instant, so more than were
                         recorded show nothing new
    speed                seconds of motion in a second of the film, positive
    enlarge, color, view, title    as in draw(); None for enlarge chooses as there, for the largest movement of the film
    progress             a progress bar (tqdm); None: where stderr is a terminal
    """
    from matplotlib import animation

    history_given(history)
    if not 0 < number_given("frames_per_second", frames_per_second) <= 60:
        raise ValueError(f"frames_per_second = {frames_per_second}: must be above 0 and at most 60")
    positive_given("speed", speed)
    if str(path).endswith(".mp4"):
        if not animation.FFMpegWriter.isAvailable():
            raise ValueError(f"path = {path}: .mp4 needs ffmpeg (Debian: apt install ffmpeg); a path that ends in .gif needs nothing")
        writer = animation.FFMpegWriter(fps=frames_per_second)
    elif str(path).endswith(".gif"):
        writer = animation.PillowWriter(fps=frames_per_second)
    else:
        raise ValueError(f"path = {path}: must end in .gif or .mp4")
    first, last = (history.time[history.sample(t, name) if t is not None else k] for t, name, k in ((start, "start", 0), (end, "end", -1)))
    if not first <= last:
        raise ValueError(f"start = {start}, end = {end}: start must not come after end")
    step = speed / frames_per_second
    samples = [history.sample(min(first + k * step, last)) for k in range(int((last - first) / step + 1e-9) + 1)]
    painter = _Painter(history, samples, enlarge, color, view, title)
    with written(path) as beside, writer.saving(painter.figure, beside, dpi=100):
        for sample in steps(samples, progress, "film", "frame"):
            painter.paint(sample)
            writer.grab_frame()
            painter.figure.set_layout_engine("none")  # the first frame has laid it out


def joints_figure(history, time=None, view=None, title="", thrust=True):
    """The matplotlib figure of draw_joints(). thrust: False leaves the third map out."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import to_rgba

    table, polygons, view = joints(history, time), patches(history), View(history, view)
    corners = history.corners(0)
    flat = view.place(polygons)
    when = "largest" if time is None else f"at {history.time[history.sample(time)]:.3f} s"
    least = 1e3 * still(history)
    stands = ~gone_at_the_end(history) if time is None else np.ones(len(table), dtype=bool)
    thrust = thrust and has_forces(history)
    figure, panels = _figure(view, view.place(corners[history.free]).reshape(-1, 2), panels=3 if thrust else 2)
    if thrust:
        _thrust_panel(history, panels[2], view, collapse(history).peak_drift_time if time is None else time)
    if title:
        figure.suptitle(title, fontsize="medium")
    for axes, name, colours, none in zip(panels, ("opening", "slip"), ("YlOrRd", "YlGnBu"), ("nothing opened", "nothing slid")):
        values = 1e3 * table[name]
        most, beyond = scale_end(values, stands, least)
        colours = shades(colours, most)
        order = np.argsort(np.nan_to_num(values))
        # What opens or slides by less than a hundredth of the most is left grey and thin. Edge on, the line of a joint is its outline.
        moves = np.nan_to_num(values) > max(0.01 * most, least)
        axes.add_collection(LineCollection(view.outlines(corners[history.free], np.flatnonzero(history.free)), colors="0.8", linewidths=0.4, zorder=1))
        width = np.where(moves, 3.0 if view.from_side else 0.8, 0.8)
        colors = np.where(moves[:, None], colours.to_rgba(np.nan_to_num(values), alpha=1.0 if view.from_side else 0.6), to_rgba(_UNMOVED, 0.3))
        axes.add_collection(PolyCollection(flat[order], facecolors=colors[order], edgecolors=colors[order], linewidths=width[order], zorder=2))
        axes.set_title(f"{name}{' while closed' if name == 'slip' else ''}, {when}{'' if moves.any() else f': {none}' if len(table) else ': no blocks touch at first'}", fontsize="small")
        if moves.any():
            _colorbar(figure, axes, colours, name, "mm", beyond)
    return figure


def _face(corners):
    """Direction from a wall along x or y towards the viewer of its face; None: there is no such wall."""
    along_x, along_y = np.ptp(corners[..., :2].reshape(-1, 2), axis=0)
    return (0, -1, 0) if along_y <= _THIN * along_x else (1, 0, 0) if along_x <= _THIN * along_y else None


def cracks_figure(history, cracks, view=None, title=""):
    """The matplotlib figure of Cracks.picture()."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import to_rgba

    corners, free = history.corners(0), np.flatnonzero(history.free)
    view = View(history, _face(corners[free]) if view is None else view)
    which, rows = patches_of(history, cracks["body1"], cracks["body2"])
    order = np.argsort(cracks["damage"][which], kind="stable")
    which, flat = which[order], view.place(patches(history)[rows[order]])
    figure, (axes,) = _figure(view, view.place(corners[free]).reshape(-1, 2))
    axes.add_collection(LineCollection(view.outlines(corners[free], free), colors="0.8", linewidths=0.4, zorder=1))
    own, colours = cracks["worst"][which] >= CRACKED, shades("YlOrRd", 1)
    colors = np.where(own[:, None], colours.to_rgba(cracks["damage"][which], alpha=1.0 if view.from_side else 0.6), to_rgba(_UNMOVED, 0.3))
    axes.add_collection(PolyCollection(flat, facecolors=colors, edgecolors=colors, linewidths=np.where(own, 3.0 if view.from_side else 0.8, 0.8), zorder=2))
    said = f"{len(cracks.cracked)} of {len(cracks)} joints cracked at {cracks.time:.3f} s"
    axes.set_title(f"{title + ': ' if title else ''}{said}", fontsize="small")
    if own.any():
        _colorbar(figure, axes, colours, "mean damage D of the joint", "", False)
    return figure


def thrust_figure(history, time, view=None):
    """The third map of draw_joints() alone."""
    view = View(history, view)
    figure, (axes,) = _figure(view, view.place(history.corners(0)[history.free]).reshape(-1, 2))
    _thrust_panel(history, axes, view, time)
    return figure


def _thrust_panel(history, axes, view, time):
    """The resultant of every joint: a line through the point where it crosses the joint, in its direction, as long as it is large."""
    from matplotlib.collections import LineCollection

    points, forces = thrust_at_first(history, time)
    sizes = np.linalg.norm(forces, axis=1)
    most = largest(sizes)
    shown = sizes > _FAINT * most
    corners = history.corners(0)[history.free]
    longest = np.ptp(corners[..., 2], axis=1).min() * _THRUST
    half, flat = view.place(forces[shown]) * longest / 2 / max(most, 1e-300), view.place(points[shown])
    axes.add_collection(LineCollection(view.outlines(corners, np.flatnonzero(history.free)), colors="0.8", linewidths=0.4, zorder=1))
    axes.add_collection(LineCollection(np.stack([flat - half, flat + half], axis=1), colors="tab:blue", linewidths=1 + 1.5 * sizes[shown] / max(most, 1e-300), zorder=2))
    axes.plot(*flat.T, ".", color="tab:red", markersize=2.5, zorder=3)
    said = f", at most {most / 1e3:.3g} kN" if len(forces) else ": no joint carries load"
    if most > 0:
        ends, margin = np.concatenate([flat - half, flat + half]), 0.03 * np.ptp(axes.get_xlim())
        axes.set(xlim=(min(axes.get_xlim()[0], ends[:, 0].min() - margin), max(axes.get_xlim()[1], ends[:, 0].max() + margin)),
                 ylim=(min(axes.get_ylim()[0], ends[:, 1].min() - margin), max(axes.get_ylim()[1], ends[:, 1].max() + 2 * margin)))
        (left, right), (_, high), bar = axes.get_xlim(), axes.get_ylim(), nice(most / 2)
        start, level = left + 0.03 * (right - left), high - 0.02 * (right - left)
        axes.plot([start, start + longest * bar / most], [level] * 2, color="tab:blue", linewidth=2, zorder=3)
        axes.text(start + longest * bar / most + margin / 3, level, f"{bar / 1e3:g} kN", va="center", fontsize="x-small", zorder=3)
    axes.set_title(f"thrust, at {history.time[history.sample(time)]:.3f} s{said}", fontsize="small")


def draw_joints(history, path, time=None, view=None, title=""):
    """Writes a picture with two maps on the undisplaced structure: opening and slip of each joint (joints()), in mm, which count until the first of the two
    blocks has fallen, a slip only while the joint is closed. time: the sample nearest to it, s; None: the largest of each joint, whose scales end at the
    largest of the joints whose blocks stand in the end (those beyond are purple), or of all where most have fallen. view: as in draw(). Where nothing
    opened, or slid, by more than 1e-6 of the structure's size, the map is grey and its title says so, as where no blocks touch in the first sample (a run that
    starts with a tilted block).

    Where the forces of the joints were recorded (WallRecorder.recordForces), a third map has the lines of thrust: the resultant of each joint at `time` (None:
    at the largest drift before the first block falls), as a line in its direction whose length is its size, to the scale drawn, and a dot where it crosses the joint; those
    below 2 % of the largest are left out."""
    _save(joints_figure(history, time, view, title), path)


def energy_figure(history, title=""):
    """The matplotlib figure of draw_energy()."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    energy = history_given(history).energy
    if np.isnan(energy["kinetic"]).all():
        raise ValueError("history: it has no energies: record with a WallRecorder while engines of dem.engines() run")
    closed = largest(np.abs(energy["error"])) <= _CLOSED * max(largest(np.abs(energy[key])) for key in ENERGIES)
    figure = Figure(figsize=(7.5, 4.7 if closed else 6), layout="constrained")
    FigureCanvasAgg(figure)
    if closed:
        upper = lower = figure.subplots()
    else:
        upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3, 1)})
        lower.plot(energy["time"], energy["error"], color="C3", linewidth=1)
        lower.set(ylabel="error of the\nbalance (J)")
    names = {"baseWork": "work of the base", "kinetic": "kinetic", "potential": "potential, since the start", "elastPotential": "elastic",
             "frictDissip": "dissipated by friction", "crackDissip": "spent by cracks of mortar", "impactDissip": f"dissipated by impacts{' and numerically' if closed else ''}",
             "dampDissip": "dissipated by dashpots and ties"}
    for k, (key, name) in enumerate((key, name) for key, name in names.items() if key in energy.dtype.names):
        values = energy[key] - (energy[key][0] if key == "potential" else 0)
        if values.any() or key in ("baseWork", "kinetic"):
            upper.plot(energy["time"], values, label=name, color="k" if key == "baseWork" else f"C{k - 1}", linewidth=1.2)
    upper.set(ylabel="energy (J)")
    upper.legend(fontsize="small")
    if title:
        upper.set_title(title, fontsize="small")
    lower.set(xlabel="time (s)")
    return figure


def draw_energy(history, path, title=""):
    """Writes a picture of WallHistory.energy over time: kinetic, potential (since the first sample), what friction, impacts and dashpots have
    dissipated and the work of the base; below, the error of their balance, in which the work of other engines' forces stands too
    (WallHistory.energy). Where the balance closes to round-off (method='wall' books what is left over as dissipated by impacts) there is no such error
    to show, and the curve of impacts says that it holds numerical losses."""
    _save(energy_figure(history, title), path)
