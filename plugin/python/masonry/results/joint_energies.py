"""Where energy was dissipated: joint by joint."""

import numpy as np
from masonry._files import check_csv, written
from masonry.results._table import Table
from masonry.results.forces import has_forces
from masonry.results.joint_forces import ForcesOfJoints
from masonry.results.joints import joints
from masonry.results.wall_history import history_given

_PARTS = "friction", "impact", "crack"
_FIELDS = [("id1", int), ("id2", int), *((name, float) for name in (*_PARTS, "total"))]
_NAMED = 5  # joints that print() lists


class JointEnergies(Table):
    """Energy that each joint has dissipated: energies["total"], energies["id1"]; a row for each pair of blocks, the most dissipating first (`table`). J:

    id1, id2    the two blocks, id1 the lower id
    friction    of sliding, as in results.joint_history(); NaN unless WallRecorder(recordForces=True) has kept the forces. Pairs that did not touch face on face in the
                first sample have none
    impact      lost in impacts of block and support, as dem.impacts() lists them: where joints land at the same instant the first has all of it, and with method='wall' only
                impacts with a given restitution are listed; NaN where impacts are not known
    crack       spent by the cracks of mortar; NaN where there is none
    total       of what is known

    `engine`: what the engine of the joints has counted in the whole scene, {"friction": J, "impact": J, "crack": J}; NaN: not known. What the joints lack to it is that of pairs that came to
    touch later, and of what happened between samples.
    """

    def __init__(self, table, engine):
        self.table, self.engine = table, engine

    def __str__(self):
        lines = [f"{int((self.table['total'] > 0).sum())} of {len(self)} joints have dissipated energy"]
        for name in _PARTS:
            if np.isfinite(self.table[name]).any():
                known = "" if np.isnan(self.engine[name]) else f" ({self.engine[name]:.4g} J in the balance of the whole scene)"
                lines.append(f"  {name}: {np.nansum(self.table[name]):.4g} J in the joints{known}")
            elif self.engine[name] > 0:
                lines.append(f"  {name}: {self.engine[name]:.4g} J in the balance of the whole scene, and not known of the joints")
        for row in self.table[:_NAMED]:
            parts = ", ".join(f"{name} {row[name]:.3g}" for name in _PARTS if row[name] > 0)
            lines += [f"  blocks {row['id1']} and {row['id2']}: {row['total']:.4g} J ({parts})"] if row["total"] > 0 else []
        return "\n".join(lines)

    def save(self, path):
        """Writes a .csv file, a line a joint, with a header line of names and units."""
        check_csv(path)
        header = ",".join([*("id1", "id2"), *(f"{name} (J)" for name in (*_PARTS, "total"))])
        with written(path) as beside:
            np.savetxt(beside, np.column_stack([self.table[name] for name in self.table.dtype.names]), delimiter=",", header=header, comments="", fmt=["%d", "%d"] + ["%.9g"] * 4)


def joint_energies(history):
    """Energy that each joint has dissipated by sliding, impacts and cracks, the most dissipating joints first: a JointEnergies. Raises ValueError where the history knows
    none of the three."""
    parts = {"friction": _friction(history_given(history)), "impact": _impacts(history), "crack": _cracks(history)}
    if all(part is None for part in parts.values()):
        raise ValueError("history: it knows no forces of joints, no impacts and no mortar: record with dem.WallRecorder(recordForces=True)")
    pairs = sorted(set().union(*(part for part in parts.values() if part is not None)))
    table = np.zeros(len(pairs), dtype=_FIELDS)
    if pairs:
        table["id1"], table["id2"] = np.array(pairs).T
    for name, part in parts.items():
        table[name] = np.nan if part is None else [part.get(pair, 0.0) for pair in pairs]
    table["total"] = np.nansum([table[name] for name in _PARTS], axis=0)
    energy = history.energy
    engine = {part: float(energy[name][-1]) if name in energy.dtype.names else np.nan for part, name in zip(_PARTS, ("frictDissip", "impactDissip", "crackDissip"))}
    return JointEnergies(table[np.argsort(-table["total"], kind="stable")], engine)


def _pairs(table, one, two):
    """[(lower id, higher id)] of the rows."""
    return [tuple(pair) for pair in np.sort(np.column_stack([table[one], table[two]]), axis=1).tolist()]


def _sums(pairs, values):
    """{pair: sum of its values}."""
    sums = {}
    for pair, value in zip(pairs, values.tolist()):
        sums[pair] = sums.get(pair, 0.0) + value
    return sums


def _friction(history):
    """{pair: J} of the joints that touch in the first sample, or None."""
    if not has_forces(history):
        return None
    forces, table, found = ForcesOfJoints(history), joints(history), {}
    for pair, joint in zip(_pairs(table, "id1", "id2"), table):
        if pair not in found:  # of several joints between two bodies the forces are together
            found[pair] = float(forces.of(int(joint["id1"]), int(joint["id2"]), joint["normal"]).friction_work[-1])
    return found


def _impacts(history):
    """{pair: J}, or None."""
    return None if history.impacts is None else _sums(_pairs(history.impacts, "body", "support"), history.impacts["energy_lost"])


def _cracks(history):
    """{pair: J}, or None."""
    if history.bonds is None:
        return None
    last = history.damage[-1]
    return _sums(_pairs(history.bonds, "body1", "body2"), last["energy_tension"] + last["energy_shear"])
