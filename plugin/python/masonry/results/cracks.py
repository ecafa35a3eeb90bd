"""Cracks of the joints with mortar of a WallHistory: which joints, in tension or in shear, when, and what they have spent."""

import numpy as np
from masonry._files import check_csv, save_picture, written
from masonry.results._table import Table
from masonry.results.bonds import BONDS, modes
from masonry.results.wall_history import history_given

# Largest damage from which a joint counts as cracked, as in the columns cracked of dem.damage().
CRACKED = 0.02
_UNITS = {"center": "m", "area": "m^2", "opening": "m", "slip": "m", "energy_tension": "J", "energy_shear": "J", "cracked": "s", "broken": "s", "damage": "1", "worst": "1"}
_TIMELINE = [("time", float), ("tension", int), ("shear", int), ("broken", int), ("damage", float), ("energy_tension", float), ("energy_shear", float)]


class Cracks(Table):
    """The joints with mortar in one sample: cracks["damage"], one row a joint, sorted by its bodies.

    table       structured array with the columns of dem.damage(): body1, body2, center (m), area (m^2), damage (mean D over the joint), worst (largest D), mode
                ('tension' or 'shear', '' for a sound joint), opening and slip of its cracks (m), energy_tension and energy_shear (J), cracked (time at which `worst`
                reached 0.02, s) and broken (s); NaN: not by that sample
    time        of the sample, s
    """

    def __init__(self, history, sample):
        self._history, self._sample = history, sample
        self.time = float(history.time[sample])
        self.table = np.zeros(0, dtype=BONDS) if history.bonds is None else history.bonds.copy()
        if not len(self.table):
            return
        now = history.damage[sample]
        for name in set(self.table.dtype.names) & set(now.dtype.names):
            self.table[name] = now[name]
        self.table["mode"] = modes(now["worst"], now["by_tension"])
        self.table["cracked"][now["worst"] < CRACKED] = np.nan
        self.table["broken"][now["damage"] < 1] = np.nan

    def __str__(self):
        if not len(self):
            return "no joint has mortar"
        own = self.cracked
        said = f"{len(own)} of {len(self)} joints cracked by {self.time:.4g} s"
        if not len(own):
            return said
        kinds = ", ".join(f"{(own['mode'] == mode).sum()} in {mode}" for mode in ("tension", "shear") if (own["mode"] == mode).any())
        first = own[0]
        return (f"{said}: {kinds}, {np.isfinite(own['broken']).sum()} broken; the first at {first['cracked']:.4g} s, of bodies {first['body1']} and {first['body2']}; "
                f"{self.energy:.4g} J spent by cracks")

    @property
    def cracked(self):
        """Rows of the joints that have cracked (largest D of 0.02 or more), in the order of their first cracks."""
        own = self.table[self.table["worst"] >= CRACKED]
        return own[np.argsort(own["cracked"], kind="stable")]

    @property
    def energy(self):
        """Energy that all cracks have spent, J: crackDissip of dem.energy()."""
        return float((self.table["energy_tension"] + self.table["energy_shear"]).sum())

    @property
    def mean_damage(self):
        """Mean D over the area of all joints with mortar, 0 to 1; NaN where there are none."""
        return float(np.average(self.table["damage"], weights=self.table["area"])) if len(self) else np.nan

    @property
    def timeline(self):
        """Structured array, one row a sample up to this one: time (s), how many joints have cracked in `tension` and in `shear` (by what has made more of their
        damage) and are `broken` (no mortar is left), mean `damage` over the area of all, energy_tension and energy_shear that all have spent (J)."""
        table = np.zeros(self._sample + 1, dtype=_TIMELINE)
        table["time"] = self._history.time[:self._sample + 1]
        if len(self):
            own = self._history.damage[:self._sample + 1]
            mode = np.where(own["worst"] >= CRACKED, modes(own["worst"], own["by_tension"]), "")
            for name in ("tension", "shear"):
                table[name] = (mode == name).sum(axis=1)
                table[f"energy_{name}"] = own[f"energy_{name}"].sum(axis=1)
            table["broken"] = (own["damage"] == 1).sum(axis=1)
            table["damage"] = np.average(own["damage"], axis=1, weights=self.table["area"])
        return table

    def save(self, path):
        """Writes a .csv file, a line a joint, with a header line of names and units."""
        check_csv(path)
        header, columns = [], []
        for name in self.table.dtype.names:
            unit = f" ({_UNITS[name]})" if name in _UNITS else ""
            if name == "center":
                header += [f"center {axis}{unit}" for axis in "xyz"]
                columns += list(self.table["center"].T)
            else:
                header.append(name + unit)
                columns.append(self.table[name])
        lines = [",".join(str(value) for value in row) for row in zip(*(column.tolist() for column in columns))]
        with written(path) as beside, open(beside, "w", encoding="utf-8") as file:
            file.write("\n".join([",".join(header), *lines, ""]))

    def picture(self, path, view=None, title=""):
        """Writes the crack map (.png, .pdf, .svg): the joints on the structure as it was at first, coloured by their mean damage D from 0 to 1; sound ones are thin
        and grey. view: direction from the scene to the viewer; None: onto the face of a wall along x or y, else as in results.draw(). Raises ValueError where no joint has mortar."""
        save_picture(self.figure(view, title), path, dpi=150)

    def figure(self, view=None, title=""):
        """The matplotlib figure of picture()."""
        from masonry.results.pictures import cracks_figure

        if not len(self):
            raise ValueError("history: no joint of it has mortar: give BlockMat(mortar=) or dem.bond(), and record with a WallRecorder")
        return cracks_figure(self._history, self, view, title)


def cracks(history, time=None):
    """The Cracks of a WallHistory: for each joint with mortar its damage D, tension or shear, opening, slip, energy, and the time of its first crack. Prints as a
    sentence; .table, .cracked, .timeline, .save("cracks.csv"), .picture("cracks.png"). It is empty where no joint has mortar.

    time    the sample nearest to it is taken, s; None: the last. Damage only rises
    """
    return Cracks(history_given(history), history.sample(time))
