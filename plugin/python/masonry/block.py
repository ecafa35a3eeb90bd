"""The rocking block."""

import warnings

import numpy as np

from . import _core
from ._given import array_given
from ._arrays import columns, restore, shape_of

_LARGEST = 50  # m; larger sizes are rather mm


class RockingBlock:
    """Rigid rectangular block(s) on a rigid base, rocking about the two lower edges without sliding.

    half_width (b), half_height (a) in m and gravity in m/s^2, each > 0, scalars or arrays that broadcast.

    slenderness           lambda = a/b
    radius                R = sqrt(a^2 + b^2), m
    critical_angle        alpha = atan(b/a), rad
    frequency_parameter   p = sqrt(3 g/(4 R)), rad/s
    angular_acceleration  A = 3 g b/(4 R^2), rad/s^2: what gravity does to the block at angle 0 (Eq. 2)
    natural_restitution   1 - 1.5 sin^2(alpha): angular velocity ratio of a plastic impact on the new edge; 0 where that is
                          negative (slenderness below 1/sqrt(2)): the block stops
    """

    def __init__(self, half_width, half_height, gravity=9.81):
        for name, value in (("half_width", half_width), ("half_height", half_height), ("gravity", gravity)):
            array_given(name, value)
        self.half_width = half_width
        self.half_height = half_height
        self.gravity = gravity
        self.shape = shape_of(half_width, half_height, gravity)
        (self.slenderness, self.radius, self.critical_angle, self.frequency_parameter, self.angular_acceleration,
         self.natural_restitution) = (restore(value, self.shape) for value in _core.block_properties(columns_of(self, self.shape)))

    @classmethod
    def from_size(cls, width, height, gravity=9.81):
        """The block of that whole width (2b) and height (2a), m."""
        width, height = array_given("width", width), array_given("height", height)
        for name, size in (("width", width), ("height", height)):
            if np.max(size, initial=0) > _LARGEST:
                warnings.warn(f"{name} = {np.max(size):g}: is it in mm? Sizes are in m", stacklevel=2)
        return cls(width / 2, height / 2, gravity)

    def __repr__(self):
        return f"RockingBlock(half_width={self.half_width}, half_height={self.half_height}, gravity={self.gravity})"


def columns_of(block, shape):
    """Half widths, half heights and gravities of the cases, for the compiled functions."""
    return columns(shape, block.half_width, block.half_height, block.gravity)


def restitution_of(block, given):
    """C as given; the natural one where it is None or NaN."""
    given = array_given("restitution", np.nan if given is None else given)
    return np.where(np.isnan(given), block.natural_restitution, given)
