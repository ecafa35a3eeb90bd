"""What the 3D view of a report needs: the motion of the blocks in a few hundred frames, and the library that draws them."""

import base64
import json
from pathlib import Path

import numpy as np
from masonry import _pose
from masonry._shapes import Shapes
from masonry.results.collapse import lies
from masonry.results.joints import own_patches, patches_of
from masonry.results.pictures import scale_end, shades
from masonry.results.view import STILL, enlargement, plane_normal, still

# Debian's package libjs-three installs it here. Its MIT licence asks for the notice in copies; report.html has it.
_LIBRARY = Path("/usr/share/javascript/three/three.min.js")
# Frames, and numbers in all of them: 4 MB of the file.
_FRAMES, _NUMBERS = 300, 1_000_000
_POSE = 7
# Movement of the farthest moved block, relative to the smallest block, that is shown enlarged where all of it is smaller.
_DRAWN = 0.5
_STOPS = 16
# Half height of the band around a cracked joint, and how far it stands out, relative to the root of the joint's area.
_BAND, _OUT = 0.04, 0.01


def library():
    """{"library": text of three.js, or None}."""
    try:
        return {"library": _LIBRARY.read_text(encoding="utf-8").replace("</script", "<\\/script")}
    except OSError:
        return {"library": None}


def frames(history):
    """Samples that are shown: spread evenly, with the first, the last and that of the largest drift."""
    count = min(len(history.time), max(2, min(_FRAMES, _NUMBERS // (_POSE * len(history.ids)))))
    even = np.linspace(0, len(history.time) - 1, count).round().astype(int)
    return np.unique([*even, int(np.nanargmax(history.drift()))])


def _packed(values):
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def _base_motions(history, samples, origin):
    """((bases, frames, 7) where each base has gone since the first sample: a turn about the origin and then a shift; (n,) which of them moves a block)."""
    bases, own = np.unique(history.bases, return_inverse=True)
    motions = np.tile([0.0, 0, 0, 1, 0, 0, 0], (len(bases), len(samples), 1))
    for motion, base in zip(motions, bases.tolist()):
        if base >= 0:
            place, turned = (path[samples] for path in history.base_path(base))
            turn = _pose.product(turned, _pose.inverse(history.orientation[0, base]))
            motion[:, :3] = place - origin - np.einsum("sab,b->sa", _pose.matrices(turn), history.position[0, base] - origin)
            motion[:, 3:] = turn
    return motions, own


def _bands(history, samples):
    """What shows cracks: {joints: a band around each joint with mortar, its block and corners (lower and upper, one after the other) in the axes of that block, damage: mean D
    by frame and joint}. Empty where no joint has mortar."""
    if history.bonds is None or not len(history.bonds):
        return {}
    which, rows = patches_of(history, history.bonds["body1"], history.bonds["body2"])
    blocks, corners, normals = own_patches(history, rows)
    bands = []
    for block, polygon, normal, area in zip(blocks.tolist(), corners, normals, history.bonds["area"][which]):
        polygon = polygon[np.r_[True, (np.diff(polygon, axis=0) != 0).any(axis=1)]]  # the last corner is repeated
        away = polygon - polygon.mean(axis=0)
        size = np.sqrt(area)
        out = polygon + _OUT * size * away / np.linalg.norm(away, axis=1, keepdims=True)
        edges = np.stack([out - _BAND * size * normal, out + _BAND * size * normal], axis=1)
        bands.append({"block": block, "vertices": edges.round(6).ravel().tolist()})
    return {"joints": bands, "damage": _packed(history.damage["damage"][samples][:, which])}


def scene(history, start):
    """The JSON text that viewer.js reads. start: the instant that it shows first, s."""
    from matplotlib.colors import to_hex

    samples = frames(history)
    # Single precision has seven digits: places are counted from the base, in whole metres of the scene.
    origin = np.round(history.position[0, history.base or 0])
    poses = np.concatenate([history.relative_position[samples] - origin, history.relative_orientation[samples]], axis=2)
    motions, own = _base_motions(history, samples, origin)
    stands = ~lies(history)[samples][:, history.free]
    quantities = []
    for name, unit, factor, values, least in (("displacement", "mm", 1e3, np.linalg.norm(history.displacement[samples], axis=2), still(history)),
                                              ("rotation", "mrad", 1e3, history.rotation[samples], STILL)):
        most, beyond = scale_end(values[:, history.free], stands, least)
        quantities.append({"name": name, "unit": unit, "factor": factor, "most": most, "beyond": beyond})
    normal = plane_normal(history)
    shapes = Shapes.boxes(history.sizes) if history.shapes is None else history.shapes
    rows, shape = shapes.distinct
    vertices = [shapes.vertices[shapes.vertex_start[row]:shapes.vertex_start[row + 1]] for row in rows]
    return json.dumps({
        "time": [round(float(t), 6) for t in history.time[samples]], "ids": history.ids.tolist(), "free": history.free.tolist(),
        "sizes": history.sizes.round(9).tolist(), "shape": shape,
        "shapes": [{"vertices": own.round(9).ravel().tolist(), "faces": shapes.loops[row]} for row, own in zip(rows, vertices)], "poses": _packed(poses), "base": _packed(motions), "bases": own.ravel().tolist(), "quantities": quantities,
        "palette": [to_hex(shades("YlOrRd", 1).to_rgba(k / (_STOPS - 1))) for k in range(_STOPS)],
        "enlarge": float(f"{enlargement(history, samples, _DRAWN):.2g}"), "front": (normal if normal is not None else np.array([0.0, -1, 0])).tolist(),
        "start": float(start), **_bands(history, samples)}).replace("</", "<\\/")
