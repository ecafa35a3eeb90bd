"""Broadcasting: scalars in, scalars out; arrays in, arrays with the same leading dimensions out."""

import numpy as np


def shape_of(*values):
    """Common shape of the values; ValueError if they do not broadcast."""
    return np.broadcast_shapes(*(np.shape(value) for value in values))


def columns(shape, *values):
    """The values as flat float64 arrays of that shape's size."""
    return tuple(np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=float), shape)).ravel() for value in values)


def restore(array, shape):
    """A flat result, or table of one row a case, with the caller's shape in front; floats for scalars."""
    array = array.reshape(shape + array.shape[1:])
    return array.item() if array.ndim == 0 else array
