"""Statics of a dome of stones, by linear programs.

A dome of equal sectors and its load are symmetric. If any pressures and shear forces balance its stones, so does the mean of what all turns and
mirror images make of them, and that is symmetric: one sector tells whether a dome can stand. In its middle plane a stone has two beds, each with a
pressure at either edge and a shear force along the radius, and the pressures of its two neighbours in the ring at the four corners of the joint
between them. Mirror images do not shear each other. The two pressures h of both neighbours add up to 2 h sin(pi/n) outwards.

With `edges` a stone also meets the four stones that it touches along an edge only, in the ring above or below and in the next sector: two pressures across
the bed, a shear force inwards, and two forces along the ring, by which the stones of both rings pull each other inwards. At the two corners of a stone,
which are pi/n from its middle plane, a pull t adds up to 2 t sin(pi/n) inwards.

Lengths in m, forces in N per unit weight of volume; (distance from the axis, height).
"""

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, Delaunay


def _solid(points):
    """(volume, centre) of the hull of points (k, 3)."""
    corners = points[Delaunay(points).simplices]
    edges = corners[:, 1:] - corners[:, :1]
    volumes = abs(np.linalg.det(edges)) / 6
    assert abs(volumes.sum() / ConvexHull(points).volume - 1) < 1e-9
    return volumes.sum(), volumes @ corners.mean(axis=1) / volumes.sum()


class Dome:
    """Half a sphere of mean radius 1 with a closing stone: `courses` rings of `per_course` stones, as dem.dome has them."""

    def __init__(self, thickness, courses, per_course):
        self.turn = np.pi / per_course
        end = np.pi / 2 / (2 * courses + 1)
        colatitude = np.pi / 2 + (end - np.pi / 2) * np.arange(courses + 1) / courses
        # joints[k]: inner and outer point of the meridian at the lower bed of ring k
        self.joints = np.array([[(r * np.sin(c), r * np.cos(c)) for r in (1 - thickness / 2, 1 + thickness / 2)] for c in colatitude])
        self.middle = self.joints * (np.cos(self.turn), 1)  # of the edges of the beds
        self.stones = [_solid(self._around(self.joints[k:k + 2].reshape(-1, 2), (-self.turn, self.turn))) for k in range(courses)]
        cap = self._around(self.joints[-1], 2 * self.turn * np.arange(per_course))
        self.closing = _solid(cap)[0] / per_course  # the share of a sector
        self.weight = sum(volume for volume, _ in self.stones) + self.closing

    @staticmethod
    def _around(points, angles):
        return np.array([(rho * np.cos(a), rho * np.sin(a), z) for rho, z in points for a in angles])

    def _program(self, friction, objective=None, edges=False):
        """Unknowns: of each bed, bottom up, pressures at its inner and outer edge and shear inwards; of each ring the pressures at the four corners; of
        each edge, at its inner and outer end, two pressures and two pulls, and shear inwards."""
        rings, beds = len(self.stones), len(self.joints)
        shared = range(1, rings) if edges else ()  # beds between two rings of stones
        unknowns = 3 * beds + 4 * rings + 5 * len(shared)
        matrix, right = np.zeros((3 * rings + 1, unknowns)), np.zeros(3 * rings + 1)
        for bed, (inner, outer) in enumerate(self.middle):
            along = (outer - inner) / np.linalg.norm(outer - inner)
            up = np.array([-along[1], along[0]])  # into the ring above
            for ring, sign in ((bed, 1), (bed - 1, -1)):
                for column, (force, at) in enumerate(((up, inner), (up, outer), (-along, inner))):
                    if 0 <= ring < rings:
                        _, (x, _, z) = self.stones[ring]
                        matrix[3 * ring:3 * ring + 3, 3 * bed + column] = *(sign * force), sign * ((at[0] - x) * force[1] - (at[1] - z) * force[0])
                    elif ring == rings:
                        matrix[-1, 3 * bed + column] = force[1]
        for ring, (volume, (_, _, z)) in enumerate(self.stones):
            outwards = 2 * np.sin(self.turn)
            for corner, (_, height) in enumerate(self.joints[ring:ring + 2].reshape(-1, 2)):
                matrix[3 * ring:3 * ring + 3, 3 * beds + 4 * ring + corner] = outwards, 0, -(height - z) * outwards
            right[3 * ring + 1] = volume
        right[-1] = self.closing
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        cone = np.zeros((2 * beds + 4 * len(shared), unknowns))
        for k, bed in enumerate(shared):
            first = 3 * beds + 4 * rings + 5 * k
            inner, outer = self.joints[bed]
            along = (outer - inner) / np.linalg.norm(outer - inner)
            up = np.array([-along[1], along[0]])
            for column, (force, pull, at) in enumerate(((up, 0, inner), (up, 0, outer), (0 * up, 1, inner), (0 * up, 1, outer), (-along, 0, inner))):
                for ring, sign in ((bed, 1), (bed - 1, -1)):
                    _, (x, _, z) = self.stones[ring]
                    outwards, upwards = 2 * (sign * force[0] * cosine - pull * sine), 2 * sign * force[1]
                    matrix[3 * ring:3 * ring + 3, first + column] = outwards, upwards, (at[0] * cosine - x) * upwards - (at[1] - z) * outwards
            for row, signs in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):  # |pull| + |shear| within the cone of the pressures
                cone[2 * beds + 4 * k + row, first:first + 5] = -friction, -friction, signs[0], signs[0], signs[1]
        for bed in range(beds):
            for row, sign in ((2 * bed, 1), (2 * bed + 1, -1)):
                cone[row, 3 * bed:3 * bed + 3] = -friction, -friction, sign
        bounds = [(0, None), (0, None), (None, None)] * beds + [(0, None)] * (4 * rings) + ([(0, None)] * 2 + [(None, None)] * 3) * len(shared)
        result = linprog(np.zeros(unknowns) if objective is None else objective, A_ub=cone, b_ub=np.zeros(len(cone)), A_eq=matrix / self.weight, b_eq=right / self.weight, bounds=bounds, method="highs")
        return result if result.status in (0, 3) else None

    def stands(self, friction, edges=False):
        return self._program(friction, edges=edges) is not None

    def thrust(self, friction):
        """Least and largest horizontal thrust of a sector on its springing, over its weight."""
        objective = np.zeros(3 * len(self.joints) + 4 * len(self.stones))
        inner, outer = self.middle[0]
        along = (outer - inner) / np.linalg.norm(outer - inner)
        objective[:3] = along[1], along[1], along[0]  # inwards
        ends = [sign * self._program(friction, sign * objective).fun / self.weight for sign in (1, -1)]
        return tuple(sorted(ends))


def least_thickness(courses, per_course, friction):
    """Least thickness over the mean radius with which a half sphere can stand."""
    low, high = 0.005, 0.5
    while high - low > 1e-7:
        middle = (low + high) / 2
        low, high = (low, middle) if Dome(middle, courses, per_course).stands(friction) else (middle, high)
    return (low + high) / 2
