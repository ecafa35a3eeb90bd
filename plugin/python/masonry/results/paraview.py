"""The motion of a structure as files that ParaView opens: one of blocks (.vtu) a sample, and a list of them with their times (.pvd)."""

import base64
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from masonry._files import written
from masonry._given import whole_given
from masonry.results.cracks import Cracks
from masonry.results.joints import moved_patches, patches, patches_of
from masonry.results.ties import tie_ends, unbroken
from masonry.results.wall_history import history_given

# VTK's order of the corners of a hexahedron, from ours (x fastest, then y).
_HEXAHEDRON = [0, 1, 3, 2, 4, 5, 7, 6]
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


def _array(name, values):
    values = np.ascontiguousarray(values)
    data = values.astype(values.dtype.newbyteorder("<")).tobytes()
    parts = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    text = base64.b64encode(len(data).to_bytes(8, "little") + data).decode()
    return f'<DataArray type="{_TYPES[values.dtype.str[1:]]}" Name="{name}"{parts} format="binary">{text}</DataArray>\n'


def _boxes(count):
    """Cells of so many boxes: hexahedra."""
    connectivity = (8 * np.arange(count)[:, None] + _HEXAHEDRON).ravel()
    return _array("connectivity", connectivity) + _array("offsets", 8 * np.arange(1, count + 1)) + _array("types", np.full(count, 12, np.uint8))


def _polyhedra(shapes, rows):
    """Cells of blocks with any faces: for each the number of its faces and, face by face, the number of its points and these."""
    counts = np.diff(shapes.vertex_start)[rows]
    ends, faces, face_ends = np.cumsum(counts), [], []
    for row, start in zip(rows.tolist(), (ends - counts).tolist()):
        loops = shapes.loops[row]
        faces.append(len(loops))
        for loop in loops:
            faces += [len(loop), *(start + k for k in loop)]
        face_ends.append(len(faces))
    return (_array("connectivity", np.arange(ends[-1] if len(rows) else 0)) + _array("offsets", ends) + _array("types", np.full(len(rows), 42, np.uint8))
            + _array("faces", np.array(faces, dtype=int)) + _array("faceoffsets", np.array(face_ends, dtype=int)))


def _ties(history, sample, relative):
    """File of the ties: a line each, with force and extension."""
    ends, own = tie_ends(history, sample, relative=relative), unbroken(history, sample)
    count = len(own)
    lines = (_array("connectivity", np.arange(2 * count)) + _array("offsets", 2 * np.arange(1, count + 1)) + _array("types", np.full(count, 3, np.uint8)))
    return _vtu(ends.reshape(-1, 3), lines, count, {name: own[name] for name in ("body1", "body2", "force", "extension")}, {})


def _bonds(history, sample, position, orientation):
    """File of the joints with mortar: a polygon each, fixed to block 1, with its damage."""
    own = Cracks(history, sample).table
    which, rows = patches_of(history, own["body1"], own["body2"])
    corners = moved_patches(history, rows, position, orientation)
    there = np.isfinite(corners).all(axis=(1, 2))
    own, corners = own[which[there]], corners[there]
    real = np.ones(corners.shape[:2], dtype=bool)  # not the last corner repeated
    real[:, 1:] = (np.diff(patches(history)[rows[there]], axis=1) != 0).any(axis=2)
    cells = (_array("connectivity", np.arange(real.sum())) + _array("offsets", np.cumsum(real.sum(axis=1))) + _array("types", np.full(len(own), 7, np.uint8)))
    values = {name: own[name] for name in ("body1", "body2", "damage", "worst", "opening", "slip", "energy_tension", "energy_shear")}
    values["mode"] = np.where(own["mode"] == "", 0, np.where(own["mode"] == "tension", 1, 2))
    return _vtu(corners[real], cells, len(own), values, {})


def _vtu(points, cells, count, cell_data, point_data):
    sections = {"Points": _array("Points", points), "Cells": cells,
                "CellData": "".join(_array(*item) for item in cell_data.items()), "PointData": "".join(_array(*item) for item in point_data.items())}
    body = "".join(f"<{name}>\n{text}</{name}>\n" for name, text in sections.items())
    return ('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n{body}</Piece>\n</UnstructuredGrid>\n</VTKFile>\n')


def write_paraview(history, path, every=1, relative=False):
    """Writes the history for ParaView (open the .pvd file) and returns the path of that file.

    path        of the .pvd file; the .vtu files go to the folder of the same name beside it, which is made
    every       every n-th sample is written; n, at least 1
    relative    True: as seen from the base, which then stands still

    Each block is a cell with id, free (1 or 0), displacement of its centre (m), rotation and lean (rad); the corners have their displacement too, for
    the filter "Warp By Vector" on the first file. Cells are hexahedra, or polyhedra where there are convex blocks. Displacements and rotations are relative to the base and the first sample. Erased blocks are
    left out. Ties that are not broken are lines with force (N) and extension (m), part 1 of the list. Joints with mortar are polygons fixed to their first block,
    part 2, with damage and worst (mean and largest D), mode (0 sound, 1 tension, 2 shear), opening and slip of their cracks (m) and their energies (J).
    """
    history, path = history_given(history), Path(path)
    if path.suffix != ".pvd":
        raise ValueError(f"path = {path}: must end in .pvd")
    every = whole_given("every", every, 1)
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    position, orientation = (history.relative_position, history.relative_orientation) if relative else (history.position, history.orientation)
    start, sets = history.corners(0), []
    counts = np.full(len(history.ids), 8) if history.shapes is None else np.diff(history.shapes.vertex_start)
    real = np.arange(start.shape[1]) < counts[:, None]  # not the last corner repeated
    for sample in range(0, len(history.time), every):
        there = np.isfinite(position[sample]).all(axis=1)
        points = history.corners_at(position[sample], orientation[sample])
        cells = {"id": history.ids, "free": history.free.astype(np.uint8), "displacement": history.displacement[sample],
                 "rotation": history.rotation[sample], "lean": history.lean[sample]}
        moved = history.corners(sample) - start
        file = folder / f"{path.stem}_{sample:06d}.vtu"
        own = there[:, None] & real
        shape = _boxes(there.sum()) if history.shapes is None else _polyhedra(history.shapes, np.flatnonzero(there))
        text = _vtu(points[own], shape, there.sum(), {name: values[there] for name, values in cells.items()}, {"displacement": moved[own]})
        with written(file) as beside:
            Path(beside).write_text(text, encoding="utf-8")
        sets.append(f'<DataSet timestep="{float(history.time[sample])!r}" file={quoteattr(f"{folder.name}/{file.name}")}/>\n')
        others = [] if history.ties is None else [("ties", 1, _ties(history, sample, relative))]
        others += [] if history.bonds is None else [("joints", 2, _bonds(history, sample, position[sample], orientation[sample]))]
        for name, part, text in others:
            file = folder / f"{path.stem}_{name}_{sample:06d}.vtu"
            with written(file) as beside:
                Path(beside).write_text(text, encoding="utf-8")
            sets.append(f'<DataSet timestep="{float(history.time[sample])!r}" part="{part}" file={quoteattr(f"{folder.name}/{file.name}")}/>\n')
    with written(path) as beside:
        Path(beside).write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n<Collection>\n'
                                f'{"".join(sets)}</Collection>\n</VTKFile>\n', encoding="utf-8")
    return path
