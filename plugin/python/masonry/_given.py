"""Checks of what a script gives: a ValueError names the argument, its value and what it must be."""

import math
import numbers
import reprlib

import numpy as np

_SHORT = reprlib.Repr()
_SHORT.maxstring, _SHORT.maxother, _SHORT.maxlong = 60, 200, 60


def shown(value):
    """The value as a message names it: long ones are cut."""
    return _SHORT.repr(value)


def number_given(name, value):
    """The value; ValueError unless it is a number (NaN is one)."""
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        raise ValueError(f"{name} = {shown(value)}: must be a number")
    return value


def positive_given(name, value, more=""):
    """The value; ValueError unless it is a positive and finite number. more: what the message says of it besides."""
    if not 0 < number_given(name, value) < math.inf:
        raise ValueError(f"{name} = {value}: must be positive and finite{more}")
    return value


def is_whole(value, least, most=math.inf):
    """Whether it is a whole number (2.0 is one) from `least` to `most`."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and least <= value <= most and value < math.inf and value == int(value)


def whole_given(name, value, least, most=math.inf):
    """The value as an int; ValueError unless it is a whole number (2.0 is one) from `least` to `most`."""
    if not is_whole(value, least, most):
        raise ValueError(f"{name} = {shown(value)}: must be a whole number, at least {least}" + (f" and at most {most}" if most < math.inf else ""))
    return int(value)


def array_given(name, values):
    """The values, numbers of any shape, as an array of floats; ValueError unless they are that."""
    try:
        array = np.asarray(values)
        if array.dtype.kind in "biufO":
            return array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError(f"{name} = {shown(values)}: must be a number or an array of numbers")


def finite_numbers(name, values, count, what):
    """`count` finite numbers as floats; or ValueError, that they must be `what`."""
    try:
        found = [float(number_given(name, v)) for v in values]
    except (TypeError, ValueError, OverflowError):
        found = []
    if len(found) != count or not all(math.isfinite(v) for v in found):
        raise ValueError(f"{name} = {shown(tuple(values) if isinstance(values, (list, np.ndarray)) else values)}: must be {what}")
    return found
