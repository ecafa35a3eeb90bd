"""The table and the arrays of an ensemble as NetCDF 3 (classic), which SciPy writes, and which xarray, netCDF4, Panoply, R and MATLAB read.

The format has no integers of 64 bits, no bool and no text but characters. Here they follow the conventions that xarray decodes: whole numbers are int32, or
double where that is exact, or text; bools are bytes with the attribute dtype = bool; text is UTF-8 characters along a dimension of its own. Names that the
format or SciPy cannot write are spelled with _, and have a number behind them where another has that spelling; the attribute long_name is the name itself.
"""

import re

import numpy as np

from ..results.collapse import UNITS


def _whole(values):
    for kind in (np.int32, float):
        with np.errstate(invalid="ignore", over="ignore"):
            stored = values.astype(kind)
        if all(int(a) == int(b) for a, b in zip(stored.ravel().tolist(), values.ravel().tolist())):
            return stored
    return values.astype(str)


def _bytes(text):
    return text.encode() or b" "  # an attribute without a character is none


def _spellings(names):
    """{name: how the file spells it}, each once."""
    found, taken = {}, set(names)
    for name in names:
        spelled = base = re.sub(r"[^ -~]|/", "_", name)
        number = 2
        while spelled != name and spelled in taken:
            spelled, number = f"{base}_{number}", number + 1
        found[name] = spelled
        taken.add(spelled)
    return found


def _put(file, name, spelled, values, dimensions, attributes):
    attributes = dict(attributes)
    if spelled != name:
        attributes["long_name"] = name
    if values.dtype.kind in "iu":
        values = _whole(values)
    if values.dtype.kind == "b":
        values, attributes["dtype"] = values.astype(np.int8), "bool"
    if values.dtype.kind == "U":
        values = np.char.encode(values, "utf-8")
        length = max(values.dtype.itemsize, 1)
        dimensions, attributes["_Encoding"] = (*dimensions, f"string{length}"), "utf-8"
        if dimensions[-1] not in file.dimensions:
            file.createDimension(dimensions[-1], length)
        values = np.ascontiguousarray(values).view("S1").reshape(*values.shape, length)
    if values.dtype.kind == "f" and values.dtype.itemsize not in (4, 8):
        values = values.astype(float)
    variable = file.createVariable(spelled, values.dtype, dimensions)
    variable[:] = values
    for key, text in attributes.items():
        setattr(variable, key, _bytes(text))


def _filled(arrays, shape):
    """The arrays of all cases in one, with NaN or empty text behind those that are shorter."""
    arrays = [np.asarray(array) for array in arrays]
    if all(array.shape == shape for array in arrays):
        return np.stack(arrays)
    text = any(array.dtype.kind == "U" for array in arrays)
    whole = np.full((len(arrays), *shape), "" if text else np.nan, dtype=np.result_type(*arrays) if text else float)
    for place, array in zip(whole, arrays):
        place[tuple(map(slice, array.shape))] = array
    return whole


def _even(arrays):
    """Those of the arrays that have as many dimensions in every case; a line tells of the others."""
    counts = {name: sorted({np.ndim(array) for array in values}) for name, values in arrays.items()}
    for name, found in counts.items():
        if len(found) > 1:
            print(f"masonry.ensemble: {name} is not in ensemble.nc: it has {' or '.join(map(str, found))} dimensions, and must have the same number in every case")
    return {name: values for name, values in arrays.items() if len(counts[name]) == 1}


def _axes(name, arrays, dimensions):
    """The names of an array's dimensions beside `case`."""
    count = np.ndim(arrays[0])
    default = [f"{name}_{k}" for k in range(count)] if count > 1 else [f"{name}_sample"]
    names = dimensions.get(name, default)
    names = [names] if isinstance(names, str) else list(names)
    if len(names) != count or "case" in names:
        raise ValueError(f"dimensions = {{{name!r}: {names}}}: must be {count} names, none of them 'case'")
    return names


def write(path, table, given, arrays, units, dimensions, attributes):
    """table: of make_table, its first `given` columns those of the cases; arrays: {name: [the array of each case]}; attributes: texts."""
    from scipy.io import netcdf_file

    unknown = sorted(set(dimensions) - set(arrays))
    if unknown:
        raise ValueError(f"dimensions: {', '.join(unknown)} is no array that the function returns")
    units, arrays = {**UNITS, **units}, _even(arrays)
    axes = {name: _axes(name, values, dimensions) for name, values in arrays.items()}
    own = set().union(*axes.values())
    both = sorted(own & set(table.dtype.names))
    if both:
        raise ValueError(f"dimensions: {', '.join(both)} must not be a column of the table")
    # An array that is named as a dimension is the dimension's coordinate.
    coordinates = {}
    for name in sorted(own & set(arrays)):
        longest = max(arrays[name], key=len)
        if np.ndim(longest) != 1 or not all(np.array_equal(array, longest[:len(array)]) for array in arrays[name]):
            raise ValueError(f"{name}: must be one array that all cases share, or its beginning, to be the coordinate of a dimension")
        coordinates[name], axes[name] = np.asarray(longest), [name]
    shapes = {}
    for name, names in axes.items():
        for array in arrays[name]:
            for axis, length in zip(names, np.shape(array)):
                shapes[axis] = max(shapes.get(axis, 1), length)
    spelled = _spellings(dict.fromkeys((*table.dtype.names, *arrays, *shapes)))
    with netcdf_file(path, "w", version=2) as file:
        for key, text in attributes.items():
            setattr(file, key, _bytes(text))
        file.createDimension("case", len(table))
        for axis, length in shapes.items():
            file.createDimension(spelled[axis], length)
        told = " ".join(spelled[name] for name in table.dtype.names[:given])
        for column, name in enumerate(table.dtype.names):
            more = {} if column < given else {"coordinates": told}
            _put(file, name, spelled[name], table[name], ("case",), {**more, **_unit(units, name)})
        for name, values in coordinates.items():
            _put(file, name, spelled[name], values, (spelled[name],), _unit(units, name))
        for name in (name for name in arrays if name not in coordinates):
            shape = tuple(shapes[axis] for axis in axes[name])
            _put(file, name, spelled[name], _filled(arrays[name], shape), ("case", *(spelled[axis] for axis in axes[name])), {"coordinates": told, **_unit(units, name)})


def _unit(units, name):
    return {"units": units[name]} if name in units else {}
