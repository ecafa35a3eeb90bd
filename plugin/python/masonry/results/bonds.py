"""Columns of the joints with mortar: of dem.damage(), of WallHistory.bonds and of WallHistory.damage."""

import numpy as np

# Joint by joint, as dem.damage() explains them.
BONDS = [("body1", int), ("body2", int), ("center", float, (3,)), ("area", float), ("damage", float), ("worst", float), ("mode", "U7"),
         ("opening", float), ("slip", float), ("energy_tension", float), ("energy_shear", float), ("cracked", float), ("broken", float)]
# Sample by sample and joint by joint: the same, and the share of the damage that tension has made.
DAMAGE = [("damage", float), ("worst", float), ("by_tension", float), ("opening", float), ("slip", float), ("energy_tension", float), ("energy_shear", float)]
COLUMNS = 13  # of RockingJointEngine.bondedState: centre, area, those of DAMAGE, times of the first crack and of the end


def bond_table(ids, state):
    """(the table of BONDS, sorted by its bodies; the order in which it has the rows of `state`). ids: two for each joint, in a row; state: rows of COLUMNS numbers."""
    ids, state = np.array(ids, dtype=int).reshape(-1, 2), np.array(state, dtype=float).reshape(-1, COLUMNS)
    table = np.zeros(len(ids), dtype=BONDS)
    table["body1"], table["body2"], table["center"] = ids.min(axis=1, initial=2**31 - 1), ids.max(axis=1, initial=0), state[:, :3]
    for name, column in zip(("area", *(name for name, _ in DAMAGE), "cracked", "broken"), state.T[3:]):
        if name in table.dtype.names:
            table[name] = column
    table["mode"] = modes(table["worst"], state[:, 6])
    order = np.lexsort((table["body2"], table["body1"]))
    return table[order], order


def modes(worst, by_tension):
    """What has made more of the damage of each joint: 'tension' or 'shear', '' for a sound joint."""
    return np.where(worst == 0, "", np.where(by_tension >= 0.5, "tension", "shear"))


def check_bonds(bonds, damage, samples):
    """ValueError unless both are None, or tables of the same joints with these columns."""
    if bonds is None and damage is None:
        return
    shape = (samples, np.size(bonds))
    if not (np.ndim(bonds) == 1 and np.asarray(bonds).dtype == np.dtype(BONDS) and np.shape(damage) == shape and np.asarray(damage).dtype == np.dtype(DAMAGE)):
        raise ValueError(f"bonds, damage: must both be None, or structured arrays of m joints and of {samples} samples by m joints, with the columns "
                         f"{', '.join(name for name, *_ in BONDS)} and {', '.join(name for name, *_ in DAMAGE)}")
