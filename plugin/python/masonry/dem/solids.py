"""Layouts of single convex blocks and of columns: geometry alone, NumPy arrays, no YADE. Corners (k, 3) in m, z up from the lower face at z = 0."""

import math

import numpy as np
from masonry._given import array_given, finite_numbers, number_given, shown
from masonry.dem.layouts import positive_size, whole
from masonry.dem.voussoirs import choice_given, length_given

AXES, FITS = ("z", "y"), ("area", "inside")


def prism_corners(polygon, height, axis="z"):
    """Corners of a prism. axis: along which the prism runs: 'z', over a polygon in x and y, or 'y', over one in x and z."""
    height = length_given("height", height)
    outline = array_given("polygon", polygon)
    if outline.ndim != 2 or outline.shape[1] != 2 or len(outline) < 3 or not np.isfinite(outline).all():
        raise ValueError(f"polygon = {shown(polygon)}: must be at least three points of two finite numbers, in m")
    _convex_outline(outline)
    if choice_given("axis", axis, AXES) == "y":
        return np.concatenate([np.insert(outline, 1, y, axis=1) for y in (-height / 2, height / 2)])
    return np.concatenate([np.insert(outline, 2, z, axis=1) for z in (0, height)])


def _convex_outline(outline):
    """ValueError unless the points, one after the other, go round a convex polygon once."""
    sides = np.roll(outline, -1, axis=0) - outline
    after = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0]
    least = 1e-12 * np.ptp(outline, axis=0).max() ** 2
    total = np.arctan2(turns, (sides * after).sum(axis=1)).sum()
    wrong = np.flatnonzero(turns * math.copysign(1, total) <= least)
    if len(wrong) or not math.isclose(abs(total), 2 * math.pi, rel_tol=1e-6):
        k = (int(wrong[0]) + 1) % len(outline) if len(wrong) else 0
        raise ValueError(f"polygon[{k}] = {tuple(outline[k].tolist())}: the outline must turn there as at its other points, so that it is convex")


def wedge_corners(size, top=0.0, shift=0.0):
    """Corners of a wedge: size (x and y of the lower face, height), the length of the upper face along x (0: an edge), and how far its middle lies from that
    of the lower face along x."""
    length, depth, height = positive_size("size", size)
    if not 0 <= number_given("top", top) < math.inf:
        raise ValueError(f"top = {top}: must be 0 or positive, in m")
    if not abs(number_given("shift", shift)) < math.inf:
        raise ValueError(f"shift = {shift}: must be finite, in m")
    upper = [[shift + top / 2, height], [shift - top / 2, height]] if top else [[shift, height]]
    return prism_corners([[-length / 2, 0], [length / 2, 0], *upper], depth, "y")


def circumradius(radius, sides, fit):
    """Radius of the corners of a polygon of so many equal sides: it has the area of the circle of that radius ('area'), or lies in it ('inside')."""
    if choice_given("fit", fit, FITS) == "inside":
        return radius
    return radius * math.sqrt(2 * math.pi / (sides * math.sin(2 * math.pi / sides)))


def _ring(sides):
    """Corners of the polygon of unit circumradius, with the middle of a side at +x."""
    angle = math.pi * (2 * np.arange(sides) + 1) / sides
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def column_layout(radii, heights, sides=24, fit="area"):
    """Drums of a column, bottom up, from the radii of the joints (one more than there are drums) and the heights of the drums."""
    sides = whole("sides", sides, 3)
    ring = _ring(sides)
    z = np.concatenate([[0], np.cumsum([length_given(f"heights[{k}]", h) for k, h in enumerate(heights)])])
    joints = [np.insert(circumradius(length_given(f"radii[{k}]", r), sides, fit) * ring, 2, height, axis=1) for k, (r, height) in enumerate(zip(radii, z))]
    return [np.concatenate(pair) for pair in zip(joints[:-1], joints[1:])]


def column_given(drums, radii, heights):
    """(radii of the joints, heights of the drums) from one number for all, or from a list."""
    drums = whole("drums", drums, 1)
    given = []
    for name, values, count in (("radii", radii, drums + 1), ("heights", heights, drums)):
        values = [number_given(name, values)] * count if np.ndim(values) == 0 else values
        given.append(finite_numbers(name, values, count, f"one number, or {count} numbers, in m"))
    return given


def critical_angles(radius, top_radius, height, sides, fit):
    """Critical angle, rad, of the drum of so many sides that rocks about a side, and that of the round drum."""
    share = top_radius / radius
    centroid = height / 4 * (1 + 2 * share + 3 * share * share) / (1 + share + share * share)
    return [math.atan2(half, centroid) for half in (circumradius(radius, sides, fit) * math.cos(math.pi / sides), radius)]
