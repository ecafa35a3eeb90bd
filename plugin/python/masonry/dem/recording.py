"""What a recorder has kept, as arrays and files."""

import numpy as np
from masonry._files import written
from masonry._given import shown
from masonry._pose import BOX_FACES
from masonry._shapes import Shapes, box_corners
from masonry.dem import notes
from masonry.dem.describing import about
from masonry.dem.joint_engine import impacts, joint_engine
from masonry.dem.loads import dead_loads
from masonry.dem.placing import union_polyhedron
from masonry.results import WallHistory
from masonry.results.bonds import DAMAGE, bond_table
from masonry.results.history_tables import JOINT_FORCES, TIES
from yade import O, wrapper


def wall_history(recorder):
    """The masonry.results.WallHistory of a WallRecorder that has run: motion and energies of its blocks, apart from YADE, to be
    saved, drawn, counted (masonry.results), with the impacts so far and what it was run with (WallHistory.about: the models, materials and steps that are
    in the scene now). Raises ValueError where it has recorded nothing, or no free block."""
    if not isinstance(recorder, wrapper.WallRecorder):
        raise ValueError(f"recorder = {shown(recorder)}: must be a WallRecorder")
    if not recorder.times:
        raise ValueError("recorder: has recorded nothing yet: give it to dem.engines(recorder=...) and run")
    blocks = np.array(recorder.blocks).reshape(-1, 4)
    poses = np.frombuffer(recorder.posesAsBytes()).reshape(len(recorder.times), -1, 7)
    motions = [motion for motion in recorder.motions if not motion.dead]
    of_bases = [motion for motion in motions if not notes.moves_platens(motion)]
    motion = (min(m.start for m in of_bases), max(m.end for m in of_bases)) if of_bases else (np.nan, np.nan)
    # The last sample is up to a period older than the run, whose time is O.time while the recorder takes part in it.
    present = recorder in O.engines
    end = max(O.time, recorder.times[-1]) if present else None
    sizes, shapes = _shapes(recorder, 2 * blocks[:, :3])
    energies = np.array(recorder.energies).reshape(len(recorder.times), -1)
    if present:
        _add_loads(energies, recorder.ids, poses[..., :3])
    return WallHistory(recorder.times, recorder.ids, sizes, blocks[:, 3] > 0, poses[..., :3], poses[..., 3:], energies, motion, end,
                       about(recorder.ids, motions) if present else None, impacts() if present and joint_engine() else None, _forces(recorder), shapes, _ties(recorder), *_bonds(recorder))


def _add_loads(energies, ids, places):
    """Adds the potential energy of the dead loads of now on these blocks; where one is erased its load is gone."""
    row = {id: k for k, id in enumerate(ids)}
    for id, force in dead_loads().items():
        if id in row:
            energies[:, 1] -= np.nan_to_num(places[:, row[id]] @ force)


def _shapes(recorder, sizes):
    """(full sizes of boxes, and of what is around convex blocks; the Shapes of all blocks, or None where all are boxes)."""
    counts = recorder.vertexCounts
    if not any(counts):
        return sizes, None
    own = np.split(np.array([tuple(v) for v in recorder.vertices]), np.cumsum(counts)[:-1])
    parts, made = iter(recorder.partCounts), {}
    blocks = []
    for k, points in enumerate(own):
        if len(points):
            ends = [next(parts)]
            while ends[-1] < len(points):
                ends.append(ends[-1] + next(parts))
            key = points.tobytes(), tuple(ends)
            if key not in made:
                made[key] = union_polyhedron(np.split(points, ends[:-1]), in_own_axes=True)
            faces, start = (made[key][name] for name in ("faces", "face_start"))
            sizes[k] = np.ptp(points, axis=0)
            blocks.append((points, [faces[a:b] for a, b in zip(start, start[1:])]))
        else:
            blocks.append((box_corners(sizes[k]), BOX_FACES))
    return sizes, Shapes.of(blocks)


def _ties(recorder):
    """WallHistory.ties, or None where there are none."""
    if not recorder.ties:
        return None
    states = np.frombuffer(recorder.tieStatesAsBytes()).reshape(len(recorder.times), len(recorder.ties), 4)
    table = np.zeros(states.shape[:2], dtype=TIES)
    for name in ("body1", "body2", "point1", "point2", "strength"):
        table[name] = [np.array(getattr(one, name)) for one in recorder.ties]
    for k, name in enumerate(("force", "extension", "energy", "broken")):
        table[name] = states[..., k]
    return table


def _bonds(recorder):
    """(WallHistory.bonds, WallHistory.damage), or two None where no joint has mortar."""
    if not recorder.bondIds:
        return None, None
    table, order = bond_table(recorder.bondIds, recorder.bondStates)
    bonded = np.arange(len(order)) < np.array(recorder.bondCounts)[:, None]
    values = np.frombuffer(recorder.damagesAsBytes()).reshape(-1, len(DAMAGE))
    damage = np.zeros(bonded.shape, dtype=DAMAGE)
    for (name, _), column in zip(DAMAGE, values.T):
        damage[name][bonded] = column
    return table, damage[:, order]


def _forces(recorder):
    """WallHistory.forces, or None where they were not recorded."""
    if not recorder.recordForces:
        return None
    rows = np.frombuffer(recorder.jointForcesAsBytes()).reshape(-1, 8)
    table = np.zeros(len(rows), dtype=[("sample", int)] + JOINT_FORCES)
    table["sample"] = np.repeat(np.arange(len(recorder.times)), recorder.jointCounts)
    table["id1"], table["id2"], table["force"], table["point"] = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 5:]
    return table


def history(recorder):
    """What a BlockRecorder has kept, a structured array with one row per time: time (s) and, for each block in the order of its ids,
    rotation (rad, vector in the block's own axes; the y component is dem.angle), position (m), uplift (m, largest gap of the joint
    below, NaN in flight) and force (N, of what is below)."""
    if not isinstance(recorder, wrapper.BlockRecorder):
        raise ValueError(f"recorder = {shown(recorder)}: must be a BlockRecorder (a WallRecorder: dem.wall_history)")
    rows, blocks = len(recorder.times), len(recorder.ids)
    fields = [("time", float), ("rotation", float, (blocks, 3)), ("position", float, (blocks, 3)), ("uplift", float, (blocks,)), ("force", float, (blocks, 3))]
    table = np.zeros(rows, dtype=fields)
    table["time"] = recorder.times
    for name, values in (("rotation", recorder.rotations), ("position", recorder.positions), ("uplift", recorder.uplifts), ("force", recorder.forces)):
        table[name] = np.array(values, dtype=float).reshape(table[name].shape)
    return table


def save_history(recorder, path):
    """Writes dem.history() to a file: .npz (NumPy), or .csv with one column per number and a header line (pandas, ParaView). Of a WallRecorder:
    dem.wall_history(recorder).save("wall.npz"), or .to_csv("wall.csv") (time, drift, energies; ids=... adds the motion of blocks)."""
    table = history(recorder)
    if str(path).endswith(".npz"):
        with written(path) as beside:
            np.savez(beside, ids=recorder.ids, **{name: table[name] for name in table.dtype.names})
    elif str(path).endswith(".csv"):
        header, columns = ["time (s)"], [table["time"]]
        for k, id in enumerate(recorder.ids):
            for name, unit in (("rotation", "rad"), ("position", "m"), ("force", "N")):
                for axis, letter in enumerate("xyz"):
                    header.append(f"{name} {letter} of {id} ({unit})")
                    columns.append(table[name][:, k, axis])
            header.append(f"uplift of {id} (m)")
            columns.append(table["uplift"][:, k])
        with written(path) as beside:
            np.savetxt(beside, np.column_stack(columns), delimiter=",", header=",".join(header), comments="")
    else:
        raise ValueError(f"path = {path}: must end in .npz or .csv")
