"""Results on a grid whose dimensions have names."""

import csv
import math

import numpy as np

from .._files import written
from .._given import array_given, shown
from .._optional import needs

UNITS = {"amplitude": "m/s^2", "duration": "s", "frequency": "Hz", "cycles": "", "impulse": "m/s", "scale": "", "width": "m", "slenderness": "",
         "restitution": "", "period": "s", "damping": "", "record": ""}


# Points of a grid that memory holds, some hundred bytes each.
_MOST = 10**7


def outer(**parameters):
    """(dims, coords, arrays) of a grid: each list among the parameters is a dimension of that name, in the order given; the arrays broadcast against
    each other over all of them. Single numbers add no dimension."""
    given, parameters = parameters, {name: array_given(name, value) for name, value in parameters.items()}
    for name, value in parameters.items():
        if value.ndim > 1 or value.size == 0:
            raise ValueError(f"{name} = {shown(given[name])}: must be a number or a list of numbers")
    points = math.prod(value.size for value in parameters.values())
    if points > _MOST:
        raise ValueError(f"{', '.join(f'{value.size} {name}' for name, value in parameters.items() if value.ndim)}: {points} points of the grid must be at most {_MOST}")
    dims = [name for name, value in parameters.items() if value.ndim]
    places = {name: [1] * len(dims) for name in dims}
    for k, name in enumerate(dims):
        places[name][k] = -1
    arrays = {name: value.reshape(places[name]) if value.ndim else float(value) for name, value in parameters.items()}
    return tuple(dims), {name: parameters[name] for name in dims}, arrays


class Spectrum:
    """Arrays on a grid whose dimensions have names.

    dims      names of the dimensions, in the order of the arrays' axes
    coords    {name: values along that dimension}
    values    {name: array over dims}; spectrum["name"] is one of them, or of coords
    units     {name: unit} of all these, '' for a ratio
    fixed     {name: number or text}: what was the same for the whole grid
    """

    def __init__(self, dims, coords, values, units, fixed):
        self.dims, self.coords, self.units, self.fixed = tuple(dims), coords, units, fixed
        shape = tuple(len(coords[name]) for name in dims)
        self.values = {name: np.broadcast_to(value, shape) for name, value in values.items()}

    @property
    def shape(self):
        return tuple(len(self.coords[name]) for name in self.dims)

    def __getitem__(self, name):
        try:
            return self.values[name] if name in self.values else self.coords[name]
        except KeyError:
            raise KeyError(f"{name!r}: must be one of {', '.join((*self.values, *self.dims))}") from None

    def rows(self):
        """A structured array: one row for each point of the grid, with the coordinates first."""
        columns = {name: np.broadcast_to(np.reshape(self.coords[name], [-1 if k == i else 1 for k in range(len(self.dims))]), self.shape)
                   for i, name in enumerate(self.dims)}
        columns.update(self.values)
        table = np.zeros(int(np.prod(self.shape)), dtype=[(name, np.asarray(column).dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = np.ravel(column)
        return table

    def to_csv(self, path):
        """Writes rows(); the first line has the names, with their units in brackets."""
        table = self.rows()
        with written(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([f"{name} ({self.units[name]})" if self.units.get(name) else name for name in table.dtype.names])
            writer.writerows(table.tolist())

    def to_xarray(self):
        """An xarray.Dataset with the same dimensions, coordinates and units. Needs the package python3-xarray."""
        with needs("python3-xarray", "to_xarray()"):
            import xarray
        unit = {name: {"units": self.units.get(name, "") or "1"} for name in (*self.dims, *self.values)}
        return xarray.Dataset({name: (self.dims, value, unit[name]) for name, value in self.values.items()},
                              {name: (name, value, unit[name]) for name, value in self.coords.items()}, self.fixed)

    def plot(self, path, value=None, x=None, y=None):
        """A picture of one of the values (None: the first one): curves over x, one for each point of the other dimensions (at most twelve of them); with
        y, maps over the dimensions x and y, one for each point of the others (at most six). x: a dimension, or a value that is followed along the
        longest dimension; None: the longest dimension. path: the file, whose ending says its kind."""
        from ._draw import draw

        draw(self, path, value, x, y)

    def __repr__(self):
        size = " x ".join(f"{len(self.coords[name])} {name}" for name in self.dims) or "one point"
        return f"Spectrum({', '.join(self.values)}: {size}; {', '.join(f'{name}={value}' for name, value in self.fixed.items())})"
