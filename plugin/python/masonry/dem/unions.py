"""Rigid unions of convex parts: L, T and U blocks, dovetails, lintels with a notch."""

import numpy as np
from masonry._given import array_given, is_whole, shown
from masonry._polyhedra import placed_pairs
from masonry.dem.bodies import block_body, part_corners
from masonry.dem.checks import check_material
from masonry.dem.layouts import check_extent
from masonry.dem.placing import block_material, convex_body, one_body, polyhedron, union_polyhedron
from yade import O

# Depth of an overlap, and width of a gap, relative to the extent of the union, up to which two parts touch; least area of what they share, relative to the smaller face.
_TOUCH, _LEAST_AREA = 1e-6, 1e-6


def union(parts, material=None, on=None, center=None, orientation=None, keep=False):
    """A free block that is the rigid union of convex parts: one body, with the mass, the centre and the inertia of the whole. Returns its id.

    parts       ids of free blocks, or corners (k, 3) of each part, m: the hull of these. The parts are joined as they stand. They touch each other on
                faces and do not overlap, to 1e-6 of the extent of the whole.
    material    of the union; without it that of the blocks, which must then have one
    keep        False: the blocks of these ids are taken out of the scene; True: they stay
    on, center, orientation    as in dem.convex()

    The faces of several parts in one plane are one face, and what touches it is one joint. Parts of no thickness, parts that overlap (by how much) and
    parts that touch no other are refused. Compliant joints do not take unions of more than one part."""
    ids, corners, material = _given(parts, material)
    check_extent(np.concatenate(corners), "parts")
    _check_parts(corners)
    found = union_polyhedron(corners)
    id = one_body(lambda: convex_body(found, block_material(material)), on, center, orientation)
    if not keep:
        for one in ids:
            O.bodies.erase(one)
    return id


def _given(parts, material):
    """(ids of the blocks, corners of each part in the world, material)."""
    if isinstance(parts, (str, bytes)) or not np.iterable(parts) or not len(parts):
        raise ValueError(f"parts = {shown(parts)}: must be ids of blocks, or corners of each part, one at least")
    ids, corners, materials = [], [], {}
    for k, part in enumerate(parts):
        if is_whole(part, 0):
            body = block_body(part, f"parts[{k}]")
            if part in ids:
                raise ValueError(f"parts[{k}] = {part}: stands there twice")
            if not body.dynamic:
                raise ValueError(f"parts[{k}] = {part}: that body is prescribed (a base): must be a free block")
            ids.append(int(part))
            corners += part_corners(body)
            materials[body.mat.id] = body.mat
            continue
        points = array_given(f"parts[{k}]", part)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"parts[{k}] = {shown(part)}: must be the id of a block, or points of three numbers, in m")
        polyhedron(points, f"parts[{k}]")  # refuses what is no convex block
        corners.append(points)
    if material is None:
        if len(materials) != 1:
            raise ValueError(f"material = None: must be a BlockMat, because the parts have {len(materials) or 'no'} materials")
        (material,) = materials.values()
    check_material(material)
    return ids, corners, material


def _check_parts(corners):
    """ValueError where parts overlap, and where some are joined to the others by no face."""
    extent = np.linalg.norm(np.ptp(np.concatenate(corners), axis=0))
    i, j = np.triu_indices(len(corners), 1)
    if not len(i):
        return
    found = placed_pairs(corners, np.stack([i, j], axis=1), _TOUCH * extent)
    for one, other, gap in zip(i.tolist(), j.tolist(), found.gaps.tolist()):
        if gap < -_TOUCH * extent:
            raise ValueError(f"parts: {one} and {other} overlap by {-gap:.3g} m: must touch, or be apart, within {_TOUCH * extent:.3g} m")
    touch = (np.abs(found.gaps) <= _TOUCH * extent) & (found.areas > _LEAST_AREA * found.faces)
    reached, last = {0}, None
    while reached != last:
        last = set(reached)
        reached |= {k for pair in np.stack([i, j], axis=1)[touch].tolist() if reached & set(pair) for k in pair}
    apart = sorted(set(range(len(corners))) - reached)
    if apart:
        raise ValueError(f"parts: {', '.join(map(str, apart))} touch{'es' if len(apart) == 1 else ''} none of those that are joined to part 0 on a face: "
                         f"must touch within {_TOUCH * extent:.3g} m")
