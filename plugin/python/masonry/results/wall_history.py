"""The recorded motion of a structure: what the other files of this folder draw, count and export."""

import json
from functools import cached_property

import numpy as np
from masonry import _pose
from masonry._files import check_csv, read_npz, written
from masonry._given import number_given, shown
from masonry._polyhedra import contacts
from masonry._shapes import Shapes, box_corners
from masonry.results.about import about_given, about_of
from masonry.results.bonds import check_bonds
from masonry.results.drift import drift_of
from masonry.results.history_tables import check_tables
from masonry.results.own_bases import TOUCH, own_bases

ENERGIES = ("kinetic", "potential", "elastPotential", "frictDissip", "dampDissip", "impactDissip", "baseWork")
_SAVED = ("time", "ids", "sizes", "free", "position", "orientation", "energies")
# Files have these where they are known.
_OPTIONAL = ("motion", "end", "about", "impacts", "forces", "ties", "bonds", "damage")
# Files hold these fields of shapes if there are convex blocks.
_SHAPES = ("vertices", "vertex_start", "faces", "face_start")
# Share of the motion that may be missing from a run to its end, whose last step or sample may come a little earlier.
_FINISHED = 1e-3


class WallHistory:
    """Positions and orientations of n blocks at s instants, and the energies. Arrays; SI units, rad.

    time           (s,) s, increasing
    ids            (n,) of the bodies in YADE
    sizes          (n, 3) full sizes along the axes of each block, m
    free           (n,) False: prescribed, as the base is
    position       (s, n, 3) of the centres, m
    orientation    (s, n, 4) quaternions w, x, y, z
    energies       (s, 7) kinetic, potential, elastPotential, frictDissip, dampDissip, impactDissip, baseWork, J; None: not recorded
    motion         (2,) s: when the motion of the base begins and ends (infinite: its end is not known); NaN: it has none; None: not known, as in files
                   that do not say it
    end            s: how far the run has come; None: to the last sample
    about          dict that JSON can hold: script, versions, model, materials, masses, motions, loads, ties, solver, notes, and what a script adds (about["seed"] = 7); empty:
                   not known
    impacts        structured array of dem.impacts(); None: not known
    forces         structured array, one row for each joint that carries load in a sample: sample (its number), id1, id2, force on block 2 (N), point
                   where it acts (m); None: not recorded (WallRecorder.recordForces)
    ties           (s, m) structured array, for each sample and each of m ties (dem.tie): body1, body2, point1, point2 (where it is fixed to them, from their centres
                   in their own axes, m), strength (N), force (N, tension positive, mean of the step before), extension (m), energy (J), broken; None: there are none
    bonds          (m,) structured array of the joints with mortar in the last sample, with the columns of dem.damage(): all of the scene, sorted by their bodies;
                   None: there are none
    damage         (s, m) structured array, for each sample and each of these joints: damage, worst, by_tension (share of the damage that tension has made), opening,
                   slip (m), energy_tension, energy_shear (J), all 0 before it is bonded; None: there are none
    shapes         masonry.results.Shapes, the corners and faces of all blocks, where some are convex blocks: their sizes are those of the box around them in
                   their own axes; None: all are boxes

    Displacements and rotations are relative to the base of the block (`bases`: the prescribed body on which its structure stands), and to the first
    sample. Without a prescribed body they are those in the world; a base that is erased counts as staying where it was. dem.wall_history(recorder) makes one;
    save and load keep it in a file, to_csv writes a table.
    Raises ValueError when shapes do not fit, times do not increase or a block that is there at first is nowhere.
    """

    def __init__(self, time, ids, sizes, free, position, orientation, energies=None, motion=None, end=None, about=None, impacts=None, forces=None, shapes=None, ties=None,
                 bonds=None, damage=None):
        self.shapes = shapes
        self.time, self.ids, self.sizes = np.asarray(time, dtype=float), np.asarray(ids, dtype=int), np.asarray(sizes, dtype=float)
        self.free, self.position, self.orientation = np.asarray(free, dtype=bool), np.asarray(position, dtype=float), np.asarray(orientation, dtype=float)
        samples, blocks = self.time.size, self.ids.size
        self._energies = np.full((samples, len(ENERGIES)), np.nan) if energies is None else np.asarray(energies, dtype=float)
        self.motion = None if motion is None else np.asarray(motion, dtype=float)
        self.about, self.impacts, self.forces, self.ties = about_given(about), impacts, forces, ties
        shapes = {"time": (samples,), "ids": (blocks,), "sizes": (blocks, 3), "free": (blocks,), "position": (samples, blocks, 3), "orientation": (samples, blocks, 4),
                  "_energies": (samples, len(ENERGIES))}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name.strip('_')} has the shape {getattr(self, name).shape}: must be {shape} for {samples} times and {blocks} ids")
        if self.motion is not None and self.motion.shape != (2,):
            raise ValueError(f"motion = {shown(motion)}: must be two times, of its begin and its end, or None")
        if not ((self.sizes > 0) & np.isfinite(self.sizes)).all():
            raise ValueError("sizes: must be positive and finite, in m")
        if samples == 0 or not self.free.any():
            raise ValueError(f"{samples} samples of {int(self.free.sum())} free blocks: there must be at least one of each")
        if not (np.diff(self.time) > 0).all():
            raise ValueError(f"time: must increase, and does not after {self.time[:-1][~(np.diff(self.time) > 0)][0]:g} s: record each run with a recorder of its own")
        if not (np.isfinite(self.position[0]).all() and np.isfinite(self.orientation[0]).all()):
            raise ValueError("position, orientation: must be finite in the first sample")
        if self.shapes is not None and (not isinstance(self.shapes, Shapes) or len(self.shapes) != blocks):
            raise ValueError(f"shapes = {shown(self.shapes)}: must be the Shapes of {blocks} blocks, or None")
        check_tables(self)
        check_bonds(bonds, damage, samples)
        self.bonds, self.damage = bonds, damage
        self.end = float(self.time[-1] if end is None else end)
        if not self.end >= self.time[-1]:
            raise ValueError(f"end = {end}: must not come before the last sample, at {self.time[-1]:g} s")

    def __repr__(self):
        return f"WallHistory({len(self.ids)} blocks, {self.time[0]:g} to {self.time[-1]:g} s, {len(self.time)} samples)"

    def save(self, path):
        """Writes a compressed .npz file, which WallHistory.load reads back bit by bit."""
        if not str(path).endswith(".npz"):
            raise ValueError(f"path = {path}: must end in .npz")
        values = {name: getattr(self, "_energies" if name == "energies" else name) for name in (*_SAVED, *_OPTIONAL)}
        if self.shapes is not None:
            values.update({name: getattr(self.shapes, name) for name in _SHAPES})
        values["about"] = np.array(json.dumps(self.about))
        with written(path) as beside:
            np.savez_compressed(beside, **{name: value for name, value in values.items() if value is not None})

    @classmethod
    def load(cls, path):
        """The WallHistory of a file that save() has written."""
        file = read_npz(path, "WallHistory")
        found = {name: file[name] for name in (*_SAVED, *_OPTIONAL) if name in file}
        if set(_SAVED) - found.keys():
            raise ValueError(f"path = {path}: is no WallHistory: {', '.join(sorted(set(_SAVED) - found.keys()))} is missing")
        try:
            if "about" in found:
                found["about"] = json.loads(str(found["about"]))
            if "vertices" in file:
                found["shapes"] = Shapes(*(file[name] for name in _SHAPES))
            return cls(**found)
        except (ValueError, TypeError, RecursionError, KeyError) as error:  # of NumPy and of json
            raise ValueError(f"path = {path}: is no WallHistory, or a damaged one: {error}") from None

    def to_csv(self, path, ids=()):
        """Writes a .csv file, a line a sample, with a header: time (s), drift (of the height), the columns of energy (J) where they were
        recorded, of each tie its force (N), extension (m) and energy (J), and of each block of `ids` (history.ids: all) displacement x, y, z (m) of its centre and rotation (rad), relative to the base and
        since the first sample, and its lean (rad) from the vertical."""
        check_csv(path)
        columns = {"time (s)": self.time, "drift": self.drift()}
        if not np.isnan(self._energies).all():
            columns.update({f"{name} (J)": self.energy[name] for name in self.energy.dtype.names[1:]})
        for k in range(0 if self.ties is None else self.ties.shape[1]):
            columns.update({f"{name} of tie {k} ({unit})": self.ties[name][:, k] for name, unit in (("force", "N"), ("extension", "m"), ("energy", "J"))})
        for id in np.atleast_1d(ids).tolist():
            if id not in self.ids.tolist():
                raise ValueError(f"ids: {id} is no block of the history: must be among {shown(self.ids.tolist())}")
            row = int(np.flatnonzero(self.ids == id)[0])
            columns.update({f"displacement {axis} of {id} (m)": self.displacement[:, row, k] for k, axis in enumerate("xyz")})
            columns.update({f"{name} of {id} (rad)": values[:, row] for name, values in (("rotation", self.rotation), ("lean", self.lean))})
        with written(path) as beside:
            np.savetxt(beside, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")

    def sample(self, time=None, name="time"):
        """Number of the sample nearest to `time` (s, up to the end of the run); None: the last. name: what an error calls it."""
        if time is None:
            return len(self.time) - 1
        # A run ends between two samples; a recorder that has stopped long before knows nothing of the rest.
        latest = min(self.end, self.time[-1] + np.diff(self.time).max(initial=0.0))
        if not self.time[0] <= number_given(name, time) <= latest:
            raise ValueError(f"{name} = {time}: must be from {self.time[0]:g} to {latest:g} s")
        return int(np.abs(self.time - time).argmin())

    @property
    def motion_run(self):
        """Share of the motion of the base that has been run, 0 to 1; 1 where there is none, 0 where it has no end, NaN where it is not known."""
        if self.motion is None:
            return np.nan
        start, end = self.motion.tolist()
        if np.isnan(end):
            return 1.0
        lasts, run = end - start, min(self.end, end) - start
        return 1.0 if run >= (1 - _FINISHED) * lasts else max(0.0, run / lasts)

    def run_in_words(self):
        """How much of the motion of the base has been run, as a report says it."""
        if self.motion is None:
            return f"run until {self.end:.4g} s; whether the motion was over by then is not known"
        start, end = self.motion.tolist()
        if np.isnan(end):
            return f"run until {self.end:.4g} s, without a motion"
        run = max(0.0, min(self.end, end) - start)
        if np.isinf(end):
            return f"{run:.4g} s of a motion without a known end have been run"
        return f"all {end - start:.4g} s of the motion have been run" if self.motion_run == 1 else f"{run:.4g} of {end - start:.4g} s of the motion have been run"

    @cached_property
    def bases(self):
        """(n,) row of the body that the motion of each block is relative to: the first prescribed body on which its structure (blocks that carry each
        other) stands in the first sample; -1 where the history has no prescribed body."""
        axes = _pose.axes_of(self.orientation[0])
        if self.shapes is None:
            return own_bases(self.position[0], self.sizes, axes, self.free)
        middles = (self.own_corners.min(axis=1) + self.own_corners.max(axis=1)) / 2
        centers = self.position[0] + np.einsum("nab,na->nb", axes, middles)  # of the boxes around the blocks
        return own_bases(centers, self.sizes, axes, self.free, contacts(self.shapes, self.convex, self.position[0], self.sizes, self.orientation[0], TOUCH))

    @property
    def base(self):
        """Row of the base of the first free block, or None where the history has no prescribed body."""
        row = int(self.bases[np.argmax(self.free)])
        return None if row < 0 else row

    def on_base(self, id):
        """The WallHistory of what stands on the prescribed body of that id, and of that body: drift, collapse, forces, pictures and reports of one structure among
        several. Impacts, forces, ties, joints with mortar, and motions and materials of `about` are those of its blocks; energies, which the recorder has of all blocks together, are not known."""
        row = np.flatnonzero((self.ids == id) & ~self.free)
        if len(row) != 1 or not (self.free & (self.bases == row[0])).any():
            carrying = np.unique(self.bases[self.free & (self.bases >= 0)])
            raise ValueError(f"id = {shown(id)}: must be a prescribed body on which blocks stand, among {shown(self.ids[carrying].tolist())}")
        rows = np.flatnonzero((self.bases == row[0]) & (self.free | (self.ids == id)))
        ids = self.ids[rows]
        forces, impacts = self.forces, self.impacts
        if forces is not None:
            forces = forces[np.isin(forces["id1"], ids) & np.isin(forces["id2"], ids)]
        if impacts is not None:
            impacts = impacts[np.isin(impacts["body"], ids)]
        shapes, bonds, damage = None if self.shapes is None else self.shapes.of_rows(rows.tolist()), self.bonds, self.damage
        if bonds is not None:
            own = np.isin(bonds["body1"], ids) & np.isin(bonds["body2"], ids)
            bonds, damage = bonds[own], damage[:, own]
        ties = self.ties
        if ties is not None:
            own = np.isin(ties["body1"][0], ids) & np.isin(ties["body2"][0], ids)
            ties = ties[:, own] if own.any() else None
        return WallHistory(self.time, ids, self.sizes[rows], self.free[rows], self.position[:, rows], self.orientation[:, rows], None, self.motion, self.end,
                           about_of(self.about, ids.tolist()), impacts, forces, shapes, ties, bonds, damage)

    def base_path(self, base):
        """Places (s, 3) and orientations (s, 4) of a base, by its row; from where it is erased, the last ones."""
        here = np.isfinite(self.position[:, base]).all(axis=1)
        last = np.maximum.accumulate(np.where(here, np.arange(len(here)), 0))
        return self.position[last, base], self.orientation[last, base]

    @cached_property
    def _from_base(self):
        """Positions and orientations as one sees them from the base of each block, put back where it was at first."""
        position, orientation = self.position.copy(), self.orientation.copy()
        for base in np.unique(self.bases[self.bases >= 0]).tolist():
            rows, (place, turned) = np.flatnonzero(self.bases == base), self.base_path(base)
            if (turned == turned[0]).all():
                position[:, rows] -= (place - place[0])[:, None]
                continue
            back = _pose.product(turned[0], _pose.inverse(turned))
            position[:, rows] = place[0] + np.einsum("sab,snb->sna", _pose.matrices(back), position[:, rows] - place[:, None])
            orientation[:, rows] = _pose.product(back[:, None], orientation[:, rows])
        return position, orientation

    @property
    def relative_position(self):
        """(s, n, 3) m, each block seen from its base, which stays where it was in the first sample."""
        return self._from_base[0]

    @property
    def relative_orientation(self):
        """(s, n, 4) quaternions, each block seen from its base."""
        return self._from_base[1]

    @cached_property
    def displacement(self):
        """(s, n, 3) of the centres relative to the base, since the first sample, m."""
        return self.relative_position - self.relative_position[0]

    @cached_property
    def rotation(self):
        """(s, n) angle of each block relative to the base, since the first sample, 0 to pi rad."""
        turn = _pose.product(self.relative_orientation, _pose.inverse(self.relative_orientation[0]))
        return 2 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0]))

    @cached_property
    def convex(self):
        """(n,) bool: which blocks are no boxes."""
        if self.shapes is None:
            return np.zeros(len(self.ids), dtype=bool)
        boxes = box_corners(self.sizes)
        return np.array([len(own) != 8 or not np.array_equal(own, box) for own, box in zip(np.split(self.shapes.vertices, self.shapes.vertex_start[1:-1]), boxes)])

    @cached_property
    def upright(self):
        """(n,) which axis of each block, 0 to 2, was nearest to the vertical in the first sample."""
        return np.abs(_pose.matrices(self.orientation[0])[:, 2]).argmax(axis=1)

    @cached_property
    def upwards(self):
        """(n, 3) the direction in the axes of each block that counts as upwards: that axis of a box, as it points at first; the vertical of the first sample for
        a convex block."""
        rows, first = np.arange(len(self.ids)), self.vertical[0]
        axes = np.zeros(first.shape)
        axes[rows, self.upright] = np.sign(first[rows, self.upright])
        return np.where(self.convex[:, None], first, axes)

    @cached_property
    def vertical(self):
        """(s, n, 3) the vertical in the axes of each block."""
        return _pose.matrices(self.orientation)[..., 2, :]

    @cached_property
    def lean(self):
        """(s, n) angle between the upright axis of each block, which points up at first, and the vertical, 0 to pi rad. Of a convex block: from the direction
        that was vertical in the first sample."""
        along = np.einsum("sna,na->sn", self.vertical, self.upwards)
        across = np.sqrt(np.maximum(0, (self.vertical**2).sum(axis=2) - along**2))
        return np.arctan2(across, along)

    @cached_property
    def energy(self):
        """(s,) structured array, J: kinetic, potential and elastPotential now; frictDissip, dampDissip, impactDissip, crackDissip (with mortar alone) and baseWork since the
        start of the run, over all lists of engines that the recorder has been in; error: by how much the sum of all others less baseWork has
        grown since the first sample (with method='wall' round-off: impactDissip is there what is left over, numerical losses included), and what
        has no column of its own: the work of other engines' forces, a change of gravity or of velocities by a script, an erased block. NaN where it was
        not recorded."""
        cracks = () if self.damage is None else ("crackDissip",)
        table = np.zeros(len(self.time), dtype=[("time", float)] + [(name, float) for name in (*ENERGIES[:-1], *cracks, ENERGIES[-1], "error")])
        table["time"] = self.time
        for name, column in zip(ENERGIES, self._energies.T):
            table[name] = column
        total = self._energies[:, :-1].sum(axis=1) - self._energies[:, -1]
        if cracks:
            table["crackDissip"] = (self.damage["energy_tension"] + self.damage["energy_shear"]).sum(axis=1)
            total = total + table["crackDissip"]
        table["error"] = total - total[0]
        return table

    def drift(self):
        """(s,) horizontal displacement of the top relative to the base over the height of the structure, 0 or positive, dimensionless. The
        top: the middle of the upper face (of the face that is the upper one at first), of the block where it is farthest away among those whose
        upper end is at first within half their height of the highest one. The height: from the lowest point of the free blocks to the highest,
        at first. A block and a pier of the same shape that turn alike have the same drift. Where structures stand on several bases, the drift is the
        largest of those of each base. Walls that bulge between foot and top move more below it: results.structure_history() has the largest displacement at any height."""
        return np.fmax.reduce([drift_of(self, self.free & (self.bases == base)) for base in np.unique(self.bases[self.free])])

    @cached_property
    def extent(self):
        """Lowest and highest point of each block in the first sample, m."""
        z = self.corners(0)[..., 2]
        return z.min(axis=1), z.max(axis=1)

    @cached_property
    def volumes(self):
        """(n,) m^3; of boxes and of convex blocks and unions: tetrahedra from the origin of the block to the triangles of its faces."""
        if self.shapes is None:
            return self.sizes.prod(axis=1)
        result = np.zeros(len(self.ids))
        for face, block in enumerate(self.shapes.blocks_of_faces):
            corners = self.shapes.vertices[self.shapes.faces[self.shapes.face_start[face]:self.shapes.face_start[face + 1]]]
            result[block] += np.einsum("ka,ka->", np.cross(corners[1:-1], corners[2:]), np.broadcast_to(corners[0], (len(corners) - 2, 3))) / 6
        return result

    @cached_property
    def own_corners(self):
        """(n, most corners of a block, 3) in the axes of each block, m; blocks with fewer corners repeat their last one."""
        return box_corners(self.sizes) if self.shapes is None else self.shapes.filled_vertices

    def corners_at(self, position, orientation):
        """The same (n, corners, 3) in the world, for those poses of all blocks, m."""
        if self.shapes is None:
            return _pose.corners(position, orientation, self.sizes)
        return position[:, None] + np.einsum("nab,ncb->nca", _pose.matrices(orientation), self.own_corners)

    def corners(self, sample, enlarge=1.0):
        """(n, corners, 3) corners of the blocks, each seen from its base, their movement since the first sample taken `enlarge` times, m. A box has eight;
        blocks with fewer corners than others repeat their last one."""
        start = self.corners_at(self.relative_position[0], self.relative_orientation[0])
        return start + enlarge * (self.corners_at(self.relative_position[sample], self.relative_orientation[sample]) - start)


def history_given(history):
    """The value; ValueError unless it is a WallHistory."""
    if not isinstance(history, WallHistory):
        raise ValueError(f"history = {shown(history)}: must be a WallHistory: dem.wall_history(recorder) in YADE, or results.WallHistory.load()")
    return history
