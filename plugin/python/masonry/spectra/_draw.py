"""Pictures of spectra."""

import itertools
import math

import numpy as np

from .._files import save_picture
from .._given import shown
from .._optional import needs

_CURVES, _MAPS = 12, 6
_WORDS = {"ratio": "rotation over critical angle", "gravity_ratio": "rotation over critical angle (gravity)", "overturned": "overturned",
          "amplitude_over_uplift": "amplitude over that of uplift", "scale_over_uplift": "peak acceleration over that of uplift",
          "gravity_period": "period (gravity)"}


def draw(spectrum, path, value=None, x=None, y=None):
    with needs("python3-matplotlib", "a picture of a spectrum"):
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

    value = next(iter(spectrum.values)) if value is None else value
    if value not in spectrum.values:
        raise ValueError(f"value = {shown(value)}: must be one of {', '.join(spectrum.values)}")
    if not spectrum.dims:
        raise ValueError("a spectrum of one point has no picture: give a list for one of its numbers")
    longest = max(spectrum.dims, key=lambda name: len(spectrum.coords[name]))
    x = longest if x is None else x
    for name, known in (("x", (x, (*spectrum.dims, *spectrum.values))), ("y", (y, (None, *spectrum.dims)))):
        if known[0] not in known[1]:
            raise ValueError(f"{name} = {shown(known[0])}: must be one of {', '.join(filter(None, known[1]))}")
    if y is None:
        figure = _curves(plt, spectrum, value, x, x if x in spectrum.dims else longest)
    else:
        if x == y or x not in spectrum.dims:
            raise ValueError(f"x = {shown(x)}, y = {shown(y)}: must be two dimensions of {', '.join(spectrum.dims)}")
        figure = _maps(plt, spectrum, value, x, y)
    save_picture(figure, path, dpi=120)
    plt.close(figure)


def label(spectrum, name):
    unit = spectrum.units.get(name, "")
    return _WORDS.get(name, name.replace("_", " ")) + (f" ({unit})" if unit else "")


def _others(spectrum, taken, most):
    """[(index of the grid without the dimensions taken, words)] of at most so many of the other points, evenly chosen."""
    others = [name for name in spectrum.dims if name not in taken]
    points = list(itertools.product(*(range(len(spectrum.coords[name])) for name in others)))
    points = [points[k] for k in np.unique(np.linspace(0, len(points) - 1, min(most, len(points))).round().astype(int))]
    result = []
    for point in points:
        at = dict(zip(others, point))
        words = ", ".join(f"{name.replace('_', ' ')} {_number(spectrum.coords[name][k])}" + (f" {spectrum.units[name]}" if spectrum.units.get(name) else "")
                          for name, k in at.items())
        result.append((tuple(at.get(name, slice(None)) for name in spectrum.dims), words))
    return result


def _number(value):
    return f"{value:.4g}" if isinstance(value, (float, np.floating)) else str(value)


def _scale(values):
    """'log' where positive values span a wide range."""
    values = values[np.isfinite(values)] if values.dtype.kind == "f" else values
    return "log" if values.dtype.kind == "f" and len(values) > 2 and values.min() > 0 and values.max() > 20 * values.min() else "linear"


def ends(values):
    """The places of the finite values beside infinite ones: where a curve ends."""
    infinite = np.isinf(values)
    beside = np.zeros_like(infinite)
    beside[1:] |= infinite[:-1]
    beside[:-1] |= infinite[1:]
    return np.flatnonzero(beside & np.isfinite(values))


def _curves(plt, spectrum, value, x, along):
    figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
    stops = 0
    for index, words in _others(spectrum, (along,), _CURVES):
        ordinate = np.asarray(spectrum.values[value][index], dtype=float)
        abscissa = spectrum.coords[x] if x in spectrum.dims else spectrum.values[x][index]
        line, = axes.plot(abscissa, np.where(np.isfinite(ordinate), ordinate, np.nan), label=words or None, marker="." if len(ordinate) < 15 else None)
        last = ends(ordinate)
        axes.plot(np.asarray(abscissa)[last], ordinate[last], "x", color=line.get_color())
        stops += len(last)
    if stops:
        axes.plot([], [], "x", color="0.3", label="grows without end beyond" if value == "oscillator_amplification" else "overturns beyond")
    axes.set(xlabel=label(spectrum, x), ylabel=label(spectrum, value), xscale=_scale(np.ravel(spectrum[x])) if spectrum[x].dtype.kind == "f" else "linear")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8)
    return figure


def _maps(plt, spectrum, value, x, y):
    shown_points = _others(spectrum, (x, y), _MAPS)
    columns = min(3, len(shown_points))
    rows = math.ceil(len(shown_points) / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(1.2 + 3.8 * columns, 0.8 + 3.2 * rows), layout="constrained", squeeze=False, sharex=True, sharey=True)
    finite = spectrum.values[value][np.isfinite(spectrum.values[value])]
    top = float(finite.max()) if len(finite) else 1.0
    if value == "ratio":
        top = min(top, 1.0)
    colours = plt.get_cmap("viridis").with_extremes(over="0.85")
    turned = spectrum.dims.index(x) < spectrum.dims.index(y)
    for ax, (index, words) in zip(axes.flat, shown_points):
        values = np.asarray(spectrum.values[value][index], dtype=float)
        values = values.T if turned else values
        mesh = ax.pcolormesh(spectrum.coords[x], spectrum.coords[y], np.where(np.isinf(values), 2 * top + 1, values), cmap=colours, vmin=0, vmax=top,
                             shading="nearest", rasterized=True)
        ax.set(xscale=_scale(spectrum.coords[x]), yscale=_scale(spectrum.coords[y]))
        ax.set_title(words, fontsize=9)
    for ax in axes.flat[len(shown_points):]:
        ax.set_visible(False)
    for ax in axes[-1]:
        ax.set_xlabel(label(spectrum, x))
    for ax in axes[:, 0]:
        ax.set_ylabel(label(spectrum, y))
    overturned = bool(np.isinf(spectrum.values[value]).any())
    figure.colorbar(mesh, ax=axes, extend="max" if overturned else "neither", label=label(spectrum, value) + ("; grey: overturned" if overturned else ""))
    return figure
