"""The rocking block."""

import numpy as np

from . import _core
from ._arrays import columns, restore, shape_of
from ._calls import warn
from ._given import array_given

_LARGEST = 50  # m; larger sizes are rather mm


class RockingBlock:
    """Rigid rectangular block(s) on a rigid base, rocking about the two lower edges without sliding. RockingBlock.of(polygon): a block of another
    section.

    half_width (b), half_height (a) in m and gravity in m/s^2, each > 0, scalars or arrays that broadcast.

    slenderness           lambda = a/b
    radius                R = sqrt(a^2 + b^2), m
    critical_angle        alpha = atan(b/a), rad
    frequency_parameter   p = sqrt(3 g/(4 R)), rad/s
    angular_acceleration  A = 3 g b/(4 R^2), rad/s^2: what gravity does to the block at angle 0 (Eq. 2)
    natural_restitution   1 - 1.5 sin^2(alpha): angular velocity ratio of a plastic impact on the new edge; 0 where that is
                          negative (slenderness below 1/sqrt(2)): the block stops
    right, left           the same for each edge: the block turns about its right edge (+x) while its angle is positive. Of rectangles
                          both are the block itself
    """

    _gyration_squared = None  # m^2, of other sections

    def __init__(self, half_width, half_height, gravity=9.81):
        for name, value in (("half_width", half_width), ("half_height", half_height), ("gravity", gravity)):
            array_given(name, value)
        self.half_width = half_width
        self.half_height = half_height
        self.gravity = gravity
        self.shape = shape_of(half_width, half_height, gravity)
        self.right = self.left = self
        self._set_properties(columns_of(self, self.shape))

    def _set_properties(self, geometry):
        (self.slenderness, self.radius, self.critical_angle, self.frequency_parameter, self.angular_acceleration,
         self.natural_restitution) = (restore(value, self.shape) for value in _core.block_properties(geometry))

    @classmethod
    def from_size(cls, width, height, gravity=9.81):
        """The block of that whole width (2b) and height (2a), m."""
        width, height = array_given("width", width), array_given("height", height)
        for name, size in (("width", width), ("height", height)):
            if np.max(size, initial=0) > _LARGEST:
                warn(f"{name} = {np.max(size):g}: is it in mm? Sizes are in m")
        return cls(width / 2, height / 2, gravity)

    @classmethod
    def of(cls, polygon, gravity=9.81):
        """One block whose section is the convex polygon with these corners (x, y), m, in any order. It stands on its lowest side, which must be level.

        Its own half_width, critical_angle, ... are those of the edge with the smaller critical angle: half_width is the distance of the
        centre of mass from the edge, half_height its height. natural_restitution of an edge is that of the impacts that end a turn about it;
        given values of C are lowered where they would make energy, to the root of the ratio of the moments of inertia about the old and
        the new edge."""
        points = array_given("polygon", polygon)
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(f"polygon: must be a list of points (x, y), not an array of shape {points.shape}")
        right, left, height, gyration_squared = _core.prism_of(*(np.ascontiguousarray(column) for column in points.T))
        block, *edges = (cls(min(right, left), height, float(gravity)) for _ in range(3))
        for edge, lever, other in zip((block, *edges), (min(right, left), right, left), (max(right, left), left, right)):
            edge.half_width = lever
            edge._set_properties(columns((), lever, other, height, gyration_squared, gravity))
        block._gyration_squared = gyration_squared
        block.right, block.left = edges
        return block

    def __repr__(self):
        if self._gyration_squared is not None:
            return (f"RockingBlock of {self.right.half_width + self.left.half_width:g} m base, centre of mass {self.half_height:g} m high and "
                    f"{self.left.half_width:g} m from the left edge")
        return f"RockingBlock(half_width={self.half_width}, half_height={self.half_height}, gravity={self.gravity})"


def columns_of(block, shape):
    """The cases' geometry and gravity, for the compiled functions."""
    if block._gyration_squared is not None:
        return columns(shape, block.right.half_width, block.left.half_width, block.half_height, block._gyration_squared, block.gravity)
    return columns(shape, block.half_width, block.half_height, block.gravity)


def critical_angle_of(block, angle):
    """That of the edge about which a block of this angle turns."""
    return np.where(np.asarray(angle) < 0, block.left.critical_angle, block.right.critical_angle)


def restitution_of(block, given):
    """C as given; the natural one where it is None or NaN."""
    given = array_given("restitution", np.nan if given is None else given)
    return np.where(np.isnan(given), block.natural_restitution, given)
