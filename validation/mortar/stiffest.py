"""Largest stiffness of a joint with mortar over that of its closed face, whatever opens: what the critical time step counts (plugin/core/dynamics/compliant/time_step.cpp).

The normal stiffness acts on the opening and the two turns of a joint: K of the corners that press, by the compliance of joint_contact.hpp, plus that of the fibres that
pull. The largest eigenvalue of K_closed^-1 K, over planes of gaps that part the corners from the fibres in every way."""

import numpy as np

_FIBRES = 4  # a direction


def _cut(polygon, direction, least):
    """The part of a convex polygon in which direction.x >= least."""
    kept = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        at_a, at_b = a @ direction - least, b @ direction - least
        if at_a >= 0:
            kept.append(a)
        if at_a * at_b < 0:
            kept.append(a + at_a / (at_a - at_b) * (b - a))
    return np.array(kept).reshape(-1, 2)


def _triangles(polygon, about):
    p, q = polygon - about, np.roll(polygon, -1, axis=0) - about
    return p, q, (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]) / 2


def _centroid(polygon):
    p, q, areas = _triangles(polygon, polygon[0])
    return polygon[0] + (areas[:, None] * (p + q)).sum(axis=0) / 3 / areas.sum(), areas.sum()


def _fibres(polygon):
    low, size = polygon.min(axis=0), np.ptp(polygon, axis=0) / _FIBRES
    found = []
    for i, j in np.ndindex(_FIBRES, _FIBRES):
        start, cell = low + size * (i, j), polygon
        for axis in (0, 1):
            for side, bound in ((1.0, start[axis]), (-1.0, -start[axis] - size[axis])):
                cell = _cut(cell, side * np.eye(2)[axis], bound)
        if len(cell) > 2 and _centroid(cell)[1] > 1e-9:
            found.append((*_centroid(cell)[0], _centroid(cell)[1]))
    return np.array(found)


def stiffest(polygon, tries=4000, seed=1):
    """The factor of a convex polygon, counter-clockwise."""
    centre, area = _centroid(np.asarray(polygon, dtype=float))
    corners, fibres = polygon - centre, _fibres(polygon - centre)
    p, q, areas = _triangles(corners, np.zeros(2))
    weights = (areas + np.roll(areas, 1)) / (2 * area)
    face = (areas * ((p * p).sum(axis=1) + (q * q).sum(axis=1) + (p * q).sum(axis=1))).sum() / 6 / area
    share = face / (weights @ (corners**2).sum(axis=1))
    rows, fibre_rows = np.c_[np.ones(len(corners)), corners], np.c_[np.ones(len(fibres)), fibres[:, :2]]

    def pressing(on):
        first, among = (weights[on, None] * rows[on]).sum(axis=0), weights[on].sum()
        return share * (rows[on].T * weights[on]) @ rows[on] + (1 - share) * share / (1 - (1 - share) * among) * np.outer(first, first)

    closed, random, most = np.linalg.inv(pressing(np.ones(len(corners), dtype=bool))), np.random.default_rng(seed), 0.0
    for _ in range(tries):
        turn = random.uniform(0, 2 * np.pi)
        slope, mean = np.array([np.cos(turn), np.sin(turn)]) / corners.std(axis=0), random.uniform(-2, 2)
        on, pulls = corners @ slope + mean < 0, fibres[:, :2] @ slope + mean > 0
        pulling = (fibre_rows[pulls].T * fibres[pulls, 2]) @ fibre_rows[pulls] / area
        most = max(most, np.linalg.eigvals(closed @ (pressing(on) + pulling)).real.max())
    return most


def table():
    from scipy.spatial import ConvexHull

    print("\n| patch | stiffest state over the closed face |\n| --- | --- |")
    regular = {n: np.c_[np.cos(2 * np.pi * np.arange(n) / n), np.sin(2 * np.pi * np.arange(n) / n)] for n in (3, 6, 8)}
    for name, polygon in (("rectangle", np.array([(0, 0), (2, 0), (2, 1), (0, 1)])), ("triangle", regular[3]), ("regular hexagon", regular[6]), ("regular octagon", regular[8])):
        print(f"| {name} | {stiffest(polygon):.3f} |")
    random = np.random.default_rng(3)
    hulls = (points[ConvexHull(points).vertices] for points in (random.normal(size=(random.integers(3, 8), 2)) for _ in range(60)))
    print(f"| 60 random convex polygons, the largest | {max(stiffest(one, 2000) for one in hulls):.3f} |")
