"""Quantities over time, as tables that are saved and drawn: of a joint, and of a structure as a whole."""

import numpy as np
from masonry._files import check_csv, save_picture, written
from masonry._given import number_given, positive_given, shown
from masonry.results._table import Table
from masonry.results.collapse import lies
from masonry.results.drift import farthest_of, signed_drift_of
from masonry.results.forces import base_reactions, has_forces
from masonry.results.joint_forces import ForcesOfJoints
from masonry.results.joints import joint_movement, joints
from masonry.results.view import still
from masonry.results.wall_history import history_given

_JOINT = [("time", float), ("opening", float), ("slip", float), ("closed", bool), ("normal", float), ("shear", float), ("point", float, 3), ("friction_work", float)]
_FORCES = "shear_x", "shear_y", "vertical", "moment_x", "moment_y"
_STRUCTURE = [("time", float), ("drift_x", float), ("drift_y", float), ("displacement_x", float), ("displacement_y", float), ("block_x", int), ("block_y", int), ("height_x", float),
              ("height_y", float), *((name, float) for name in _FORCES)]
_UNITS = {"time": "s", "opening": "m", "slip": "m", "closed": "1", "normal": "N", "shear": "N", "point": "m", "friction_work": "J", "drift_x": "1", "drift_y": "1",
          "displacement_x": "m", "displacement_y": "m", "block_x": "1", "block_y": "1", "height_x": "m", "height_y": "m",
          "shear_x": "N", "shear_y": "N", "vertical": "N", "moment_x": "N m", "moment_y": "N m"}
_STANDARD_GRAVITY = 9.81  # m/s^2


class TimeHistory(Table):
    """A table over time: history["opening"], history["time"]. `table`: the structured array, one row a sample; `title`: what it is of; `numbers`: a dict of what sums
    it up."""

    def __init__(self, table, title, panels, numbers):
        self.table, self.title, self._panels, self.numbers = table, title, panels, numbers

    def __str__(self):
        return "\n".join([self.title, *(f"  {name}: {value if isinstance(value, int) else f'{value:.4g}'}" for name, value in self.numbers.items())])

    def save(self, path):
        """Writes a .csv file, a line a sample, with a header line of names and units."""
        check_csv(path)
        header, columns = [], []
        for name in self.table.dtype.names:
            values = self.table[name].astype(float)
            axes = [""] if values.ndim == 1 else [f" {axis}" for axis in "xyz"]
            header += [f"{name}{axis} ({_UNITS[name]})" for axis in axes]
            columns.append(values.reshape(len(values), -1))
        with written(path) as beside:
            np.savetxt(beside, np.concatenate(columns, axis=1), delimiter=",", header=",".join(header), comments="")

    def picture(self, path):
        """Writes a picture (.png, .pdf, .svg): the quantities over time, one panel for each unit."""
        save_picture(self.figure(), path, dpi=150)

    def panels(self):
        """[(label, factor on the values, [(name, word)])] of what is known."""
        return [panel for panel in self._panels if any(np.isfinite(self.table[name]).any() for name, _ in panel[2])]

    def figure(self, width=7.4):
        """The matplotlib figure of picture()."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        panels = self.panels()
        figure = Figure(figsize=(width, 1 + 1.7 * len(panels)), layout="constrained")
        FigureCanvasAgg(figure)
        rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (label, factor, names) in zip(rows, panels):
            axes.axhline(0, color="0.8", linewidth=0.8)
            for k, (name, word) in enumerate(names):
                values = factor * self.table[name]
                if name == "slip":
                    values = np.where(self.table["closed"], values, np.nan)
                axes.plot(self.table["time"], values, color=f"C{k}", linewidth=1, label=word)
            axes.set_ylabel(label)
            if len(names) > 1:
                axes.legend(fontsize="small")
        rows[0].set_title(self.title, fontsize="medium")
        rows[-1].set(xlabel="time (s)", xlim=(self.table["time"][0], max(self.table["time"][-1], np.nextafter(self.table["time"][0], np.inf))))
        return figure


def joint_history(history, id1=None, id2=None):
    """What a joint did: a TimeHistory.

    id1, id2    the two blocks, in either order; both None: the joint that opened most or, where none has opened, slid most (the title says so)

    time             s
    opening, slip    m, as in results.joints(): NaN from the fall of one of the blocks on. A slip counts where the joint is closed somewhere; where it is open all
                     over (closed = False), it is how far the nearest points have gone along it
    closed           whether the joint is closed somewhere
    normal, shear    force that the joint carries, N: its part across the joint in the first sample, turned with block 1 (positive: pressure), and the
                     size of the part along it
    point            where the force crosses the joint, m; NaN where it carries none
    friction_work    J, dissipated by sliding so far: the force along the joint times the slip of its point, summed over the samples. It never falls: where the sum does,
                     the way and the mean force between two samples were not those of the steps, and the largest sum so far stays. Samples must be dense. With
                     mortar it has what the shear of the mortar takes up too

    Forces and work are NaN unless WallRecorder(recordForces=True) has kept them. Raises ValueError where the blocks do not touch in the first sample."""
    table = joints(history)
    if not len(table):
        raise ValueError("history: no two blocks touch face on face in the first sample: it has no joints")
    if (id1 is None) != (id2 is None):
        raise ValueError(f"id1 = {shown(id1)}, id2 = {shown(id2)}: give both, or none")
    of = ""
    if id1 is None:
        opened = np.nan_to_num(table["opening"]).max() > still(history)
        row = int(np.nan_to_num(table["opening" if opened else "slip"]).argmax())
        of = "" if opened else f" (no joint opened{', this one slid most' if np.nan_to_num(table['slip']).max() > still(history) else ' or slid'})"
    else:
        found = np.flatnonzero(((table["id1"] == id1) & (table["id2"] == id2)) | ((table["id1"] == id2) & (table["id2"] == id1)))
        if not len(found):
            raise ValueError(f"id1 = {shown(id1)}, id2 = {shown(id2)}: must be two blocks that touch in the first sample; results.joints(history) lists them")
        row = int(found[0])
    one, two = int(table["id1"][row]), int(table["id2"][row])
    result = np.zeros(len(history.time), dtype=_JOINT)
    result["time"] = history.time
    result["opening"], result["slip"], result["closed"] = joint_movement(history, row)
    for name in ("normal", "shear", "point", "friction_work"):
        result[name] = np.nan
    if has_forces(history):
        found = ForcesOfJoints(history).of(one, two, table["normal"][row])
        for name in ("normal", "shear", "point", "friction_work"):
            result[name] = getattr(found, name)
    numbers = {"largest opening (m)": np.nanmax(result["opening"], initial=0), "largest slip while closed (m)": np.nanmax(np.where(result["closed"], result["slip"], np.nan), initial=0)}
    if has_forces(history):
        numbers |= {"largest pressure (N)": np.nanmax(result["normal"], initial=0), "dissipated by sliding (J)": float(result["friction_work"][-1])}
    panels = [("movement (mm)", 1e3, [("opening", "opening"), ("slip", "slip, while closed")]), ("force (kN)", 1e-3, [("normal", "pressure"), ("shear", "along the joint")])]
    if has_forces(history) and result["friction_work"][-1] > still(history) * numbers["largest pressure (N)"]:  # else round-off
        panels.append(("dissipated\nby sliding (J)", 1, [("friction_work", "")]))
    return TimeHistory(result, f"joint of the blocks {one} and {two}{of}", panels, numbers)


def structure_history(history, base=None, weight=None):
    """Drift, base shear and overturning moment of a structure: a TimeHistory.

    base      id of the prescribed body on which it stands; None: that of the first free block, with the forces of all prescribed bodies where it is the only base
    weight    N; None: of the masses of the blocks, with what dem.add_mass has added (about["masses"]), where the history knows them, else not known

    time                 s
    drift_x, drift_y     displacement of the top relative to the base over the height, with its sign, dimensionless: that of the block where it is largest in size
                         (WallHistory.drift() has both together)
    displacement_x, displacement_y    largest displacement of a block's centre relative to the base at any height, with its sign, m, as of a wall that bulges between foot
                         and top. A block counts until it falls; NaN where all have fallen
    block_x, block_y     id of that block; -1: none
    height_x, height_y   height of its centre above the foot in the first sample, m
    shear_x, shear_y     force of the base on the structure, N
    vertical             the same upwards
    moment_x, moment_y   of these forces about the middle of the foot, N m; moment_y: overturning in the plane x, z

    numbers: the largest drifts and what remains of them in the last sample, the largest displacements with time, block and height, the largest base shear, over the
    weight too, and the largest moment. Forces are NaN unless they were recorded (WallRecorder(recordForces=True))."""
    rows = history_given(history).bases
    if base is None:
        row = history.base
    elif base in history.ids[~history.free].tolist():
        row = int(np.flatnonzero(history.ids == base)[0])
    else:
        raise ValueError(f"base = {shown(base)}: must be the id of a prescribed body of the history, among {shown(history.ids[~history.free].tolist())}")
    standing = history.free & (rows == row) if row is not None else history.free
    if not standing.any():
        raise ValueError(f"base = {shown(base)}: no free block stands on it in the first sample")
    if weight is not None:
        positive_given("weight", number_given("weight", weight), ", in N")
    result = np.zeros(len(history.time), dtype=_STRUCTURE)
    result["time"] = history.time
    result["drift_x"], result["drift_y"] = signed_drift_of(history, standing).T
    farthest, blocks, heights = farthest_of(history, standing, ~lies(history))
    for k, axis in enumerate("xy"):
        result[f"displacement_{axis}"], result[f"height_{axis}"] = farthest[:, k], heights[:, k]
        result[f"block_{axis}"] = np.where(blocks[:, k] < 0, -1, history.ids[blocks[:, k]])
    for name in _FORCES:
        result[name] = np.nan
    if has_forces(history) and row is not None:
        several = len(np.unique(rows[history.free])) > 1
        table = base_reactions(history, base=int(history.ids[row]) if several or base is not None else None)
        result["shear_x"], result["shear_y"], result["vertical"] = table["force"].T
        result["moment_x"], result["moment_y"] = table["moment"][:, :2].T
    weight = _weight(history, standing) if weight is None else weight
    numbers = {}
    for axis in "xy":
        drift = result[f"drift_{axis}"]
        numbers |= {f"largest drift along {axis}": drift[np.nanargmax(np.abs(drift))], f"residual drift along {axis}": drift[-1]}
    for axis in "xy":
        moved = np.abs(result[f"displacement_{axis}"])
        if (moved > 0).any():
            most = result[np.nanargmax(moved)]
            numbers |= {f"largest displacement along {axis} at any height (m)": most[f"displacement_{axis}"], f"its time, along {axis} (s)": most["time"],
                        f"its block, along {axis}": most[f"block_{axis}"], f"its height above the foot, along {axis} (m)": most[f"height_{axis}"]}
    for axis in "xy":
        shear = result[f"shear_{axis}"]
        if np.isfinite(shear).any():
            most = shear[np.nanargmax(np.abs(shear))]
            numbers[f"largest base shear along {axis} (N)"] = most
            if weight:
                numbers[f"the same over the weight (V/W along {axis})"] = most / weight
    if np.isfinite(result["moment_y"]).any():
        numbers["largest overturning moment in x, z (N m)"] = result["moment_y"][np.nanargmax(np.abs(result["moment_y"]))]
        numbers["largest overturning moment in y, z (N m)"] = result["moment_x"][np.nanargmax(np.abs(result["moment_x"]))]
    of = "" if row is None else f" on base {history.ids[row]}"
    panels = [("drift (% of height)", 100, [("drift_x", "along x"), ("drift_y", "along y")]),
              ("largest displacement\nat any height (mm)", 1e3, [("displacement_x", "along x"), ("displacement_y", "along y")]),
              ("force (kN)", 1e-3, [("shear_x", "base shear x"), ("shear_y", "base shear y"), ("vertical", "vertical")]),
              ("moment (kN m)", 1e-3, [("moment_x", "about x"), ("moment_y", "about y")])]
    return TimeHistory(result, f"{int(standing.sum())} blocks{of}", panels, {name: value.item() if isinstance(value, np.generic) else value for name, value in numbers.items()})


def _weight(history, blocks):
    """Of those blocks, N; None where neither their masses nor their densities are known."""
    gravity = history.about.get("model", {}).get("gravity")
    weight = masses(history)[blocks].sum() * (_STANDARD_GRAVITY if gravity is None else float(np.linalg.norm(gravity)))
    return float(weight) if np.isfinite(weight) and weight > 0 else None


def masses(history):
    """(n,) kg: the masses that the history was run with; of blocks without one, as of those that were erased, density times volume; NaN: not known."""
    found = np.full(len(history.ids), np.nan)
    for material in history.about.get("materials", []):
        own = np.isin(history.ids, material.get("ids", []))
        found[own] = material.get("density", np.nan) * history.volumes[own]
    for row in history.about.get("masses", []):
        found[np.isin(history.ids, row["ids"])] = row["mass"]
    return found
