"""Limit analysis of rigid blocks in a plane: what statics allow, by linear programs.

Two corners of every joint carry a pressure each and share one shear force, which Coulomb's law bounds by friction times the sum of the
pressures. Pressures and shear forces that balance all weights are admissible; the programs look for extremes among them (Livesley 1978).
A failure that opens joints without slip meets the largest multiplier exactly. Where joints slip, the program lets them dilate
(an associative rule), so Coulomb's own multiplier lies at or below.

Lengths in m, forces in N; x to the right, z upwards. A block is its corners, counter-clockwise; a joint is (block 1, block 2, corner,
corner) with the numbers of its blocks, None for the ground.
"""
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

STEEP = 1e3  # a coefficient of friction with which nothing slips


@dataclass
class Structure:
    """Blocks and joints, with the area of a block for its weight (unit thickness and unit weight per area)."""
    blocks: list
    joints: list

    @property
    def weights(self):
        return np.array([area(block) for block in self.blocks])

    @property
    def centers(self):
        return np.array([centroid(block) for block in self.blocks])


def area(polygon):
    """Area of a polygon, m^2; positive if its corners (n, 2) go counter-clockwise."""
    x, z = np.transpose(polygon)
    return 0.5 * np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z)


def centroid(polygon):
    """Centre of the area of a polygon, (2,), m."""
    p, q = np.asarray(polygon), np.roll(polygon, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return (cross[:, None] * (p + q)).sum(axis=0) / (3 * cross.sum())


def _balance(structure):
    """(3 blocks, 3 joints) matrix of the forces and moments that two pressures and a shear force of every joint put on the blocks."""
    matrix = np.zeros((3 * len(structure.blocks), 3 * len(structure.joints)))
    centers = structure.centers
    for j, (first, second, a, b) in enumerate(structure.joints):
        a, b = np.asarray(a), np.asarray(b)
        along = (b - a) / np.linalg.norm(b - a)
        normal = np.array([-along[1], along[0]])  # from block 1 to block 2, which bears the pressures along it
        for block, sign in ((second, 1), (first, -1)):
            if block is None:
                continue
            for column, (force, at) in enumerate(((normal, a), (normal, b), (along, a))):
                x, z = at - centers[block]
                matrix[3 * block:3 * block + 3, 3 * j + column] = sign * force[0], sign * force[1], sign * (x * force[1] - z * force[0])
    return matrix


def _program(structure, friction, objective, load=None):
    """Solves for [joint forces, multiplier]; the multiplier scales `load` (blocks, 3). None where nothing is admissible."""
    joints = len(structure.joints)
    matrix = _balance(structure)
    weight = np.zeros((len(structure.blocks), 3))
    weight[:, 1] = -structure.weights
    load = np.zeros_like(weight) if load is None else load
    columns = np.hstack([matrix, load.reshape(-1, 1)])
    cone = np.zeros((2 * joints, 3 * joints + 1))
    for j in range(joints):
        for row, sign in ((2 * j, 1), (2 * j + 1, -1)):
            cone[row, 3 * j:3 * j + 3] = -friction, -friction, sign
    bounds = [(0, None), (0, None), (None, None)] * joints + [(None, None)]
    scale = structure.weights.sum()
    result = linprog(objective, A_ub=cone, b_ub=np.zeros(2 * joints), A_eq=columns / scale, b_eq=-weight.reshape(-1) / scale,
                     bounds=bounds, method="highs")
    return result if result.status in (0, 3) else None


def stands(structure, friction):
    """Whether statics allow the structure to stand."""
    return _program(structure, friction, np.zeros(3 * len(structure.joints) + 1)) is not None


def _largest(structure, friction, direction, load):
    """The program whose multiplier of a load (default: all weights, along `direction`) is the largest."""
    if load is None:
        load = np.zeros((len(structure.blocks), 3))
        load[:, :2] = structure.weights[:, None] * np.asarray(direction)
    objective = np.zeros(3 * len(structure.joints) + 1)
    objective[-1] = -1
    return _program(structure, friction, objective, load)


def multiplier(structure, friction, direction=(1, 0), load=None):
    """Largest multiplier of a load (default: all weights, along `direction`) with which the structure can stand; inf if there is none."""
    result = _largest(structure, friction, direction, load)
    return np.nan if result is None else np.inf if result.status == 3 else result.x[-1]


def mechanism(structure, friction, direction=(1, 0), load=None):
    """How the structure fails at that multiplier: (joints, 3) of the speeds at which the two corners of every joint open and at which it slips, relative to the
    largest. They are the prices of the constraints in the program (its dual): a corner opens where a negative pressure would let the multiplier grow, a joint slips
    where more friction would. Openings are without the dilation of slip."""
    result = _largest(structure, friction, direction, load)
    opens = result.lower.marginals[:-1].reshape(-1, 3)[:, :2]
    slips = np.abs(result.ineqlin.marginals.reshape(-1, 2)).sum(axis=1)
    speeds = np.column_stack([opens, slips])
    return speeds / speeds.max()


def thrust(structure, friction, joints=(0,)):
    """Least and largest sum of the horizontal forces through some joints, over the weight of the blocks; inf where it has no bound."""
    objective = np.zeros(3 * len(structure.joints) + 1)
    for joint in joints:
        _, _, a, b = structure.joints[joint]
        along = (np.asarray(b) - a) / np.linalg.norm(np.asarray(b) - a)
        objective[3 * joint:3 * joint + 3] = -along[1], -along[1], along[0]
    ends = []
    for sign in (1, -1):
        result = _program(structure, friction, sign * objective)
        ends.append(np.nan if result is None else -sign * np.inf if result.status == 3 else
                    objective @ result.x / structure.weights.sum())
    return tuple(sorted(np.abs(ends)))


def arch(voussoirs, thickness, embrace=np.pi, radius=1.0):
    """Circular arch of equal straight voussoirs, their corners on both circles, on two skewbacks. `thickness` over the mean radius."""
    angles = np.pi / 2 + embrace / 2 - embrace * np.arange(voussoirs + 1) / voussoirs  # of the joint lines, from the left one
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    inner, outer = radius * (1 - thickness / 2) * rays, radius * (1 + thickness / 2) * rays
    blocks = [np.array([inner[k], inner[k + 1], outer[k + 1], outer[k]]) for k in range(voussoirs)]
    numbers = [None, *range(voussoirs), None]
    joints = [(numbers[k], numbers[k + 1], outer[k], inner[k]) for k in range(voussoirs + 1)]
    return Structure(blocks, joints)


def flat_arch(span, depth, voussoirs, below):
    """Flat arch whose joints all point to the middle, `below` the soffit; the soffit is cut in equal lengths of the span."""
    x = np.linspace(-span / 2, span / 2, voussoirs + 1)
    inner = np.column_stack([x, np.zeros_like(x)])
    outer = np.column_stack([x * (below + depth) / below, np.full_like(x, depth)])
    blocks = [np.array([inner[k], inner[k + 1], outer[k + 1], outer[k]]) for k in range(voussoirs)]
    numbers = [None, *range(voussoirs), None]
    return Structure(blocks, [(numbers[k], numbers[k + 1], outer[k], inner[k]) for k in range(voussoirs + 1)])


def assembly(blocks, ground, tolerance=1e-9):
    """Blocks that stand on and between the polygons of `ground`: joints are what two sides share that look at each other."""
    numbered = [*enumerate(np.asarray(block) for block in blocks), *((None, np.asarray(polygon)) for polygon in ground)]
    joints = []
    for k, (second, polygon) in enumerate(numbered[:len(blocks)]):
        for first, other in numbered[k + 1:]:
            for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
                along = (b - a) / np.linalg.norm(b - a)
                for c, d in zip(other, np.roll(other, -1, axis=0)):
                    across = (c - a) @ (-along[1], along[0]), (d - a) @ (-along[1], along[0])
                    low, high = max(0, along @ (d - a)), min(along @ (b - a), along @ (c - a))
                    if np.abs(across).max() < tolerance < high - low:
                        joints.append((first, second, a + low * along, a + high * along))
    return Structure([polygon for _, polygon in numbered[:len(blocks)]], joints)


def frusta(drums, bottom, top, height):
    """Stack of drums in the plane: trapezoids, on the ground."""
    width = np.linspace(bottom, top, drums + 1) / 2
    level = np.linspace(0, height, drums + 1)
    blocks = [np.array([[-width[k], level[k]], [width[k], level[k]], [width[k + 1], level[k + 1]], [-width[k + 1], level[k + 1]]])
              for k in range(drums)]
    joints = [(None if k == 0 else k - 1, k, (-width[k], level[k]), (width[k], level[k])) for k in range(drums)]
    return Structure(blocks, joints)


def least_thickness(voussoirs, friction, embrace=np.pi):
    """Least thickness over the mean radius with which an arch can stand."""
    def margin(thickness):
        structure = arch(voussoirs, thickness, embrace)
        return 1 if stands(structure, friction) else -1
    low, high = 0.02, 0.9
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if margin(middle) > 0 else (middle, high)
    return 0.5 * (low + high)
