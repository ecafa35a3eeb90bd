"""Layouts of arches, vaults and domes: geometry alone, NumPy arrays, no YADE.

A layout is a list of arrays (k, 3), the corners of one convex block each, in m: x along the span, y along the depth, z up from the springing line. The
layout is its own mirror image, to the bit. A joint line is computed once, and both blocks at the joint get the same numbers. Blocks are straight: their
corners lie on the curves and their faces are plane."""

import math

import numpy as np
from masonry._given import number_given, shown
from masonry.dem.layouts import SIZES, check_extent, whole

SHAPES, MEASURED, BONDS = ("circular", "pointed"), ("intrados", "middle"), ("running", "stack")


def length_given(name, value):
    """The length as a float; ValueError unless it is one that a block may have."""
    if not SIZES[0] <= number_given(name, value) <= SIZES[1]:
        raise ValueError(f"{name} = {value}: must be positive, from {SIZES[0]:g} to {SIZES[1]:g}, in m")
    return float(value)


def choice_given(name, value, allowed):
    if value not in allowed:
        raise ValueError(f"{name} = {shown(value)}: must be {' or '.join(repr(one) for one in allowed)}")
    return value


def _mirrored(half, n):
    """All n + 1 joints from those of the left half (the middle one included if n is even)."""
    return np.concatenate([half, (half[: (n + 1) // 2] * [-1, 1])[::-1]])


def _radial(center, inner, outer, angles):
    """Joints (k, 2, 2): points at the radii `inner` and `outer` around (center, 0), at angles from the horizontal on the left."""
    along = np.stack([-np.cos(angles), np.sin(angles)], axis=-1)
    return np.stack([inner * along, outer * along], axis=1) + [center, 0]


def _upright(joint, inner, outer):
    """The joint on the axis x = 0 goes from the height `inner` to the height `outer`."""
    joint[0], joint[1] = (0, inner), (0, outer)


def _circular_joints(span, rise, thickness, n, side):
    if not rise <= span / 2:
        raise ValueError(f"rise = {rise}: must be at most half of the span, {span / 2:g} m, where the shape is 'circular'")
    radius = (span * span / 4 + rise * rise) / (2 * rise)
    half_angle = math.atan2(span / 2, radius - rise)
    inner, outer = radius - thickness * side, radius + thickness * (1 - side)
    lift = rise - radius
    angles = math.pi / 2 - half_angle + 2 * half_angle / n * np.arange(n // 2 + 1)
    joints = _radial(0, inner, outer, angles)
    if rise == span / 2:
        joints[0, :, 1] = 0
    if n % 2 == 0:
        _upright(joints[-1], inner, outer)
    return inner, _mirrored(joints, n) + [0, lift], None


def _pointed_joints(span, rise, thickness, n, side):
    if not rise > span / 2:
        raise ValueError(f"rise = {rise}: must be above half of the span, {span / 2:g} m, where the shape is 'pointed'")
    radius = rise * rise / span + span / 4
    center = radius - span / 2  # of the left arc
    inner, outer = radius - thickness * side, radius + thickness * (1 - side)
    if not inner > center:
        raise ValueError(f"thickness = {thickness}: must be below {(radius - center) / side:g} m, where the two arcs have no opening between them")
    apex = [math.sqrt(r * r - center * center) for r in (inner, outer)]
    crown = math.acos(center / ((inner + outer) / 2))
    joints = _radial(center, inner, outer, 2 * crown / n * np.arange(n // 2 + 1))
    joints[0, :, 1] = 0
    if n % 2 == 0:
        _upright(joints[-1], *apex)
    elif not joints[-1, 1, 0] < 0:
        raise ValueError(f"n = {n}: must be even, or smaller, where the keystone of a pointed arch this thick has no extrados left")
    return inner, _mirrored(joints, n), np.array([0, apex[1]])


def arch_joints(span, rise, thickness, n, shape="circular", measured="intrados"):
    """(joints (n + 1, 2, 2), crown): intrados and extrados point (x, z) of every joint, left to right, and the crown that the keystone of a pointed arch
    of odd n has besides its four corners (else None)."""
    span, rise, thickness, n = length_given("span", span), length_given("rise", rise), length_given("thickness", thickness), whole("n", n, 2)
    choice_given("shape", shape, SHAPES)
    side = 0.0 if choice_given("measured", measured, MEASURED) == "intrados" else 0.5
    joints = _circular_joints if shape == "circular" else _pointed_joints
    inner, found, crown = joints(span, rise, thickness, n, side)
    if not inner > 0:
        raise ValueError(f"thickness = {thickness}: must be below {2 * (inner + thickness / 2):g} m, where the intrados vanishes")
    check_extent(np.concatenate(found[:2]), f"span = {span:g}, rise = {rise:g}, thickness = {thickness:g}, n = {n}: voussoirs")
    return found, crown if n % 2 else None


def flat_arch_joints(span, depth, n, below):
    """Joints of a flat arch: equal lengths at the soffit (z = 0), directions through the point `below` under the middle of the soffit."""
    span, depth, n, below = length_given("span", span), length_given("depth", depth), whole("n", n, 1), length_given("below", below)
    x = span * (np.arange(n // 2 + 1) / n - 0.5)
    top = x * ((below + depth) / below)
    half = np.stack([np.stack([x, np.zeros_like(x)], axis=-1), np.stack([top, np.full_like(x, depth)], axis=-1)], axis=1)
    joints = _mirrored(half, n)
    check_extent(np.concatenate(joints[:2]), f"span = {span:g}, depth = {depth:g}, n = {n}: voussoirs")
    return joints


def springer_profiles(joints, below):
    """Outlines of the left and the right springer: their upper face is the first and the last joint, their lower face is level, `below` under the joint."""
    (inner, outer), foot = joints[0], joints[0, :, 1].min() - below
    left = np.array([[outer[0], foot], [inner[0], foot], inner, outer])
    return left, left * [-1, 1]


def profiles(joints, crown=None):
    """Outlines (k, 2) of the blocks between joints: two points of one joint, two of the next, and the crown where the keystone has one."""
    outlines = [np.array([left[0], right[0], right[1], left[1]]) for left, right in zip(joints[:-1], joints[1:])]
    if crown is not None:
        middle = len(outlines) // 2
        outlines[middle] = np.concatenate([outlines[middle], [crown]])
    return outlines


def extruded(outline, front, back):
    """Corners (2k, 3) of the prism over an outline (x, z), from y = front to y = back."""
    return np.concatenate([np.insert(outline, 1, y, axis=1) for y in (front, back)])


def springing(blocks):
    """(2, 2, 2): intrados and extrados point (x, z) of the first and of the last joint of a layout without springers, by the numbers that profiles() gives corners."""
    return np.stack([blocks[0][[0, 3]], blocks[-1][[1, 2]]])[..., [0, 2]]


def arch_layout(span, rise, thickness, n, depth, shape="circular", measured="intrados", springers=False):
    """Blocks of an arch, left to right."""
    joints, crown = arch_joints(span, rise, thickness, n, shape, measured)
    return _in_depth(joints, crown, depth, thickness if springers else 0)


def flat_arch_layout(span, depth, n, below, width, springers=False):
    """Blocks of a flat arch, left to right."""
    return _in_depth(flat_arch_joints(span, depth, n, below), None, width, depth if springers else 0)


def _in_depth(joints, crown, depth, springer):
    half = length_given("depth", depth) / 2
    return [extruded(outline, -half, half) for outline in _with_springers(joints, crown, springer)]


def _with_springers(joints, crown, below):
    """Outlines of the blocks between joints, and first and last those of the springers, `below` high under the joint; 0: there are none."""
    outlines = profiles(joints, crown)
    if not below:
        return outlines
    left, right = springer_profiles(joints, below)
    return [left, *outlines, right]


def barrel_vault_layout(span, rise, thickness, n, length, along, shape="circular", measured="intrados", bond="running", springers=False):
    """Blocks of a barrel vault, course by course from left to right, along y in each. The axis of the vault is y."""
    length, along = length_given("length", length), whole("along", along, 1)
    choice_given("bond", bond, BONDS)
    joints, crown = arch_joints(span, rise, thickness, n, shape, measured)
    whole_blocks = length * (np.arange(along + 1) / along - 0.5)
    halves = length * (np.arange(2 * along + 1) / (2 * along) - 0.5)
    shifted = np.concatenate([halves[:1], halves[1::2], halves[-1:]])
    cuts = whole_blocks, shifted if bond == "running" else whole_blocks
    return [extruded(outline, front, back) for course, outline in enumerate(_with_springers(joints, crown, thickness if springers else 0))
            for front, back in zip(cuts[course % 2][:-1], cuts[course % 2][1:])]


def dome_layout(radius, thickness, courses, per_course, oculus=0.0, half_angle=math.pi / 2):
    """Blocks of a spherical dome, ring by ring from the springing up, counter-clockwise from +x in each. The last one is the closing stone if there is no
    oculus. Meridian joints run through all rings, because the upper bed of a stone that bridges one would be concave."""
    radius, thickness = length_given("radius", radius), length_given("thickness", thickness)
    courses, per_course = whole("courses", courses, 1), whole("per_course", per_course, 3)
    if not thickness < 2 * radius:
        raise ValueError(f"thickness = {thickness}: must be below {2 * radius:g} m, where the intrados vanishes")
    if not 0 < number_given("half_angle", half_angle) <= math.pi / 2:
        raise ValueError(f"half_angle = {half_angle}: must be above 0 and at most pi/2, in rad")
    if not 0 <= number_given("oculus", oculus) < radius * math.sin(half_angle):
        raise ValueError(f"oculus = {oculus}: must be 0 or positive, and below {radius * math.sin(half_angle):g} m, the radius at the springing")
    inner, outer = radius - thickness / 2, radius + thickness / 2
    # The closing stone takes half of the angle of a course.
    end = math.asin(oculus / radius) if oculus else half_angle / (2 * courses + 1)
    colatitude = half_angle + (end - half_angle) * np.arange(courses + 1) / courses
    flat, height = np.sin(colatitude), np.cos(colatitude)
    height[0] = 0 if half_angle == math.pi / 2 else height[0]
    meridian = 2 * math.pi * np.arange(per_course) / per_course
    ring = np.stack([np.cos(meridian), np.sin(meridian)], axis=-1)
    # corners[course, meridian, inside or outside]
    corners = np.stack([np.concatenate([r * flat[:, None, None] * ring, np.broadcast_to(r * height[:, None, None], (courses + 1, per_course, 1))], axis=2)
                        for r in (inner, outer)], axis=2) - [0, 0, radius * height[0]]
    blocks = [np.concatenate([corners[level, m] for level in (course, course + 1) for m in (k, (k + 1) % per_course)])
              for course in range(courses) for k in range(per_course)]
    check_extent(blocks[0], f"radius = {radius:g}, thickness = {thickness:g}, courses = {courses}, per_course = {per_course}: stones")
    return blocks if oculus else [*blocks, corners[-1].reshape(-1, 3)]
