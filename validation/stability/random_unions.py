"""Convex parts that touch on faces, drawn at random: what dem.union() takes. Parts that overlap are among them; dem.union() refuses these."""

import math

import numpy as np
from scipy.spatial import ConvexHull


def extruded(polygon, y):
    """Corners (2 n, 3) of the prism over a polygon (n, 2) in x and z, between two y."""
    return np.array([(a, b, c) for b in y for a, c in polygon])


def cuboid(x, z, y):
    return extruded([(a, c) for a in x for c in z], y)


def angles(r, size, plane):
    """Two to five cuboids: a foot, stems on it, and a head on the first stem; in space of different depths."""
    half = 0.5 if plane else r.uniform(0.2, 0.5) * size
    foot, high = r.uniform(0.1, 0.4) * size, r.uniform(0.1, 0.9) * size
    def depth():
        return (-half, half) if plane or r.random() < 0.5 else (-half, r.uniform(-0.5, 0.9) * half)
    parts = [cuboid((-size / 2, size / 2), (0, foot), (-half, half))]
    wide = r.uniform(0.15, 0.45) * size
    places = r.choice(([-size / 2], [r.uniform(-0.5 * size, 0.5 * size - wide)], [-size / 2, size / 2 - wide], [-size / 2, size / 2 - wide]))
    for k, x in enumerate(places):
        parts.append(cuboid((x, x + wide), (foot, foot + high * (1 if k == 0 or r.random() < 0.7 else 0.6)), depth()))
    if r.random() < 0.3:
        parts.append(cuboid((places[0] - r.choice((0, 0.3)) * size, places[0] + wide), (foot + high, 1.2 * foot + high), depth()))
    if r.random() < 0.3:
        parts = [part * (1, 1, -1) for part in parts]
    return parts


def on_faces(r, points):
    """A hull, and on one or two of its triangles a pyramid or a frustum, which may be wider at its far end."""
    hull, parts = ConvexHull(points), [np.array(points)]
    for face in r.sample(range(len(hull.simplices)), r.choice((1, 1, 2))):
        base, normal = np.array(points)[hull.simplices[face]], hull.equations[face, :3]
        reach = np.sqrt(np.linalg.norm(np.cross(base[1] - base[0], base[2] - base[0])))
        middle = base.mean(axis=0)
        far = middle + normal * reach * r.uniform(0.3, 1) + (base[0] - middle) * r.uniform(0, 0.5)
        share = r.choice((0, 0.5, 1, 1.3))
        parts.append(np.vstack([base, far + share * (base - middle)] if share else [base, far]))
    return parts


def cut(r, points):
    """A hull in two, by a plane through the middle of its corners: flush faces all around the seam."""
    points = np.array(points)
    normal = np.array([r.gauss(0, 1) for _ in range(3)])
    return halves(points, ConvexHull(points).simplices, normal / np.linalg.norm(normal))


def halves(points, faces, normal):
    """The two parts of a hull on both sides of the plane with this normal through the middle of its corners."""
    height = (points - points.mean(axis=0)) @ normal
    edges = {tuple(sorted((int(a), int(b)))) for face in faces for a, b in zip(face, np.roll(face, 1))}
    crossings = [points[a] + (points[b] - points[a]) * height[a] / (height[a] - height[b]) for a, b in edges if height[a] * height[b] < 0]
    return [np.vstack([points[height > 0], crossings]), np.vstack([points[height < 0], crossings])]


def sections(r, polygon):
    """A prism cut by a line, and with a trapezoid on one of its sides: dovetails and beaks."""
    polygon = np.array(polygon)
    parts = [polygon]
    if r.random() < 0.5:
        slope = r.uniform(0, math.pi)
        parts = halves(polygon, [(k, (k + 1) % len(polygon)) for k in range(len(polygon))], np.array([math.cos(slope), math.sin(slope)]))
    else:
        k = r.randrange(len(polygon))
        first, second = polygon[k], polygon[(k + 1) % len(polygon)]
        along, out = second - first, np.array([second[1] - first[1], first[0] - second[0]]) * r.uniform(0.2, 1)
        inset = r.uniform(-0.2, 0.45)
        parts.append(np.array([first, second, second + out - inset * along, first + out + inset * along]))
    return [extruded(part, (-0.5, 0.5)) for part in parts]
