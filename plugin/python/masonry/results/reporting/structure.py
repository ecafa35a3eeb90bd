"""Content of the report of a WallHistory."""

import math

import numpy as np
from masonry import _pose
from masonry.results.collapse import collapse
from masonry.results.cracks import Cracks
from masonry.results.forces import has_forces
from masonry.results.joints import joints
from masonry.results.time_histories import joint_history, masses, structure_history
from masonry.results.ties import ties
from masonry.results.view import largest, movement, still

from . import curves, energies, view3d, words
from .sections import counted, section, shaded

# Rows of tables: of joints, and of joints that have cracked.
_JOINTS, _CRACKS = 12, 100
_BASES = 6  # that are named
# Vertical part of the normal of a joint below which it is a head joint: more upright than level.
_HEAD = 0.7
# Error of the energy balance that is named among the warnings, relative to the largest energy in it.
_UNBALANCED = 0.05
# Drifts, and base shears over the weight, along an axis that are not named.
_FAINT = 1e-6


def content(history, exact):
    """What report.html is filled with."""
    verdict, table = collapse(history), joints(history)
    single = history.free.sum() == 1
    shown_first = verdict.peak_drift_time
    told = words.facts(history.about)  # first: it refuses what masonry has not written
    facts = [("Structure", _structure(history)), *_bases(history), *_mass(history), *told]
    sections = [one for one in (
        section("drift", "Drift", curves.drift(history, verdict),
                 "Horizontal displacement of the top relative to the base, over the height." + shaded(verdict)),
        *(_of_one_block(history, exact) if single else [
            section("excursions", "Excursions", curves.excursions(history, verdict),
                     "Largest horizontal displacement in a course, relative to the base; the curve of a block ends when it falls." + shaded(verdict))]),
        section("shape", "Shape at the largest drift", curves.shape(history, shown_first),
                 "The sample of the largest drift" + (" before the collapse" if verdict.collapsed else "") + "; dashed: the first sample."),
        _joints_section(history, verdict, table), _joint_section(history, verdict, table), _cracks_section(history, verdict), *_force_sections(history, verdict), _ties_section(history, verdict),
        energies.section_of(history), energies.joints_of(history), energies.impacts_of(history)) if one]
    return {"title": history.about.get("script") or "Rocking masonry", "kind": verdict.verdict, "headline": _headline(verdict), "sentences": _sentences(history, verdict),
            "warnings": _warnings(history, verdict), "scene": view3d.scene(history, shown_first), "numbers": _numbers(history, verdict, table), "sections": sections,
            "facts": facts, "solver": words.solver(history.about, *_extent(history, verdict)), "known": bool(history.about)}


def _headline(verdict):
    return {"collapsed": f"Collapsed at {verdict.time:.4g} s", "stands": "Stands", "unknown": "Stands in the last sample",
            "unfinished": "Not finished: no collapse so far"}[verdict.verdict]


def _sentences(history, verdict):
    run = verdict.run
    fell = f"{len(verdict.fallen)} of {counted(verdict.free, 'block')} {'has' if len(verdict.fallen) == 1 else 'have'} fallen."
    return [f"{run[0].upper()}{run[1:]}.", fell]


def _warnings(history, verdict):
    said = []
    if verdict.verdict == "unfinished":
        said.append("The motion of the base is not over: whether the structure stands is not known yet.")
    if verdict.verdict == "unknown":
        said.append("The history does not say how long the motion lasts: whether it was over by the last sample is not known.")
    if not verdict.from_base:
        said.append("The base was not recorded: its own motion is in every drift, excursion and fall.")
    said += words.failures(history.about)
    said += [f"{note[0].upper()}{note[1:]}." for note in history.about.get("notes", [])]
    energy = history.energy
    if not np.isnan(energy["kinetic"]).all() and not np.isnan(energy["error"]).all():
        turned = max(largest(np.abs(energy[name])) for name in ("kinetic", "frictDissip", "dampDissip", "impactDissip", "crackDissip", "baseWork")
                     if name in energy.dtype.names)
        error = largest(np.abs(energy["error"]))
        if turned > 0 and error > _UNBALANCED * turned:
            said.append(f"The energies miss their balance by {error:.3g} J, {100 * error / turned:.2g} % of the largest of them: other engines' forces, erased "
                        "blocks, velocities set by a script, or an error of the computation.")
    if movement(history, range(len(history.time))) <= still(history):
        said.append("Nothing moved.")
    if not np.isfinite(history.position).all():
        said.append("Blocks were erased during the run; they count as fallen.")
    return said


def _numbers(history, verdict, table):
    """Rows (name, value, when)."""
    before = " before the collapse" if verdict.collapsed else ""
    bases = history.ids[np.unique(history.bases[history.free])].tolist() if history.base is not None else [None]
    rows = [("Largest drift" + before, f"{words.decimal(100 * verdict.peak_drift)} % of the height", f"{verdict.peak_drift_time:.4g} s"),
            ("Drift in the last sample", f"{words.decimal(100 * verdict.residual_drift)} % of the height", f"{history.time[-1]:.4g} s"),
            (f"First drift of {100 * verdict.excursion:g} %", "never" if math.isnan(verdict.first_excursion) else "reached",
             "" if math.isnan(verdict.first_excursion) else f"{verdict.first_excursion:.4g} s")]
    rows += [row for base in bases for row in _of_structure(history, base, len(bases) > 1)]
    for id, time in list(zip(verdict.fallen, verdict.fall_times))[:1]:
        rows.append(("First block to fall", f"block {id}", f"{time:.4g} s"))
    for name, verb in (("opening", "opened"), ("slip", "slid")):
        values = np.nan_to_num(table[name])
        if largest(values) > still(history):
            k = int(values.argmax())
            rows.append((f"Joint that {verb} most", f"{words.decimal(1e3 * values[k], 4)} mm, blocks {table['id1'][k]} and {table['id2'][k]}", f"{table[name + '_time'][k]:.4g} s"))
    return rows + energies.numbers(history)


def _of_structure(history, base, several):
    """Rows of _numbers(): what remains of the drift, and the largest base shear, of what stands on one base."""
    found = structure_history(history, base=base if several else None)
    of, rows = f" on base {base}" if several else "", []
    for axis in "xy":
        drift = found[f"drift_{axis}"]
        if largest(np.abs(drift)) > _FAINT:
            most = int(np.nanargmax(np.abs(drift)))
            rows.append((f"Drift along {axis}{of}: largest, and in the last sample", f"{words.decimal(100 * drift[most])} %, {words.decimal(100 * drift[-1])} %",
                         f"{history.time[most]:.4g} s"))
        moved = np.abs(found[f"displacement_{axis}"])
        if largest(moved) > still(history):
            most = int(np.nanargmax(moved))
            rows.append((f"Largest displacement along {axis}{of}, at any height", f"{words.decimal(1e3 * found[f'displacement_{axis}'][most])} mm, block {found[f'block_{axis}'][most]}, "
                         f"{words.decimal(found[f'height_{axis}'][most])} m above the foot", f"{history.time[most]:.4g} s"))
        share = found.numbers.get(f"the same over the weight (V/W along {axis})")
        if share is not None and abs(share) > _FAINT:
            most = int(np.nanargmax(np.abs(found[f"shear_{axis}"])))
            rows.append((f"Largest base shear along {axis}{of}", f"{words.decimal(abs(share))} of the weight", f"{history.time[most]:.4g} s"))
    return rows


def _extent(history, verdict):
    """(duration of the history, s; height, m; largest displacement of the top, m)."""
    height = float(np.ptp(history.corners(0)[history.free][..., 2]))
    return history.end - float(history.time[0]), height, verdict.peak_drift * height


def _structure(history):
    free, sizes = history.free, history.sizes[history.free]
    low, high = history.extent
    box = np.ptp(history.corners(0)[free].reshape(-1, 3), axis=0)
    same = history.shapes is None and np.ptp(sizes, axis=0).max() < 1e-9 * sizes.max()
    kinds = len(np.unique(sizes.round(9), axis=0)) if history.shapes is None else len(set(np.array(history.shapes.distinct[1])[free].tolist()))
    of = f" of {' × '.join(f'{x:.3g}' for x in sizes[0])} m" if same else f" of {kinds} {'sizes' if history.shapes is None else 'shape' if kinds == 1 else 'shapes'}"
    return (f"{counted(int(free.sum()), 'free block')}{of}, {counted(int((~free).sum()), 'prescribed body') if free.all() or (~free).sum() == 1 else f'{(~free).sum()} prescribed bodies'}; "
            f"{box[0]:.3g} × {box[1]:.3g} × {box[2]:.3g} m in all; {len(history.time)} samples from {history.time[0]:.4g} to {history.time[-1]:.4g} s")


def _bases(history):
    """Row on the sizes of the prescribed bodies on which blocks stand."""
    rows = np.unique(history.bases[history.free & (history.bases >= 0)])
    said = [f"body {history.ids[row]}: {' × '.join(f'{x:.3g}' for x in history.sizes[row])} m" for row in rows[:_BASES].tolist()]
    more = [f"and {len(rows) - _BASES} more"] if len(rows) > _BASES else []
    return [("Base" if len(rows) == 1 else "Bases", "; ".join(said + more))] if said else []


def _mass(history):
    total = masses(history)[history.free].sum()
    return [("Mass of the free blocks", words.mass(total, history.about.get("model", {}).get("gravity")))] if np.isfinite(total) else []


def _joints_section(history, verdict, table):
    if not len(table):
        return None
    rank = np.argsort(-np.nan_to_num(table["opening"]), kind="stable")
    fell = set(verdict.fallen.tolist())
    rows = [(f"{r['id1']} – {r['id2']}", _mm(r["opening"]), f"{r['opening_time']:.3f}", _mm(r["slip"]), "" if math.isnan(r["slip"]) else f"{r['slip_time']:.3f}",
             ", ".join(["head joint"] * bool(abs(r["normal"][2]) < _HEAD) + ["fallen"] * bool(fell & {r["id1"], r["id2"]}))) for r in table[rank[:_JOINTS]]]
    return section("joints", "Opening and slip of the joints", curves.joints(history, verdict, table),
                    "The joints that opened, and slid, most. An opening or a slip counts until the first of the two blocks has fallen, a slip only while the joint "
                    "is closed." + shaded(verdict),
                    second=curves.joint_map(history), second_caption="Largest values of each joint, on the structure as it was at first.",
                    columns=["Blocks", "Opening (mm)", "at (s)", "Slip while closed (mm)", "at (s)", ""], rows=rows,
                    more=f"The {len(rows)} joints of {len(table)} that opened most; fallen: one of the blocks has in the end. Head joint: upright; "
                         "it counts as closed while its sides are within 1 % of the smallest size of the two blocks, also where they do not press.", fold="Table of joints")


def _joint_section(history, verdict, table):
    """The joint that opened most, where its forces are known."""
    if not has_forces(history) or not len(table) or not largest(table["opening"]) > still(history):
        return None
    found = joint_history(history)
    return section("joint", f"The joint that opened most: blocks {found.title.split('blocks ')[1]}", curves.of_joint(found, verdict),
                    "Opening and slip, the force across the joint (pressure) and along it, and the energy that sliding has dissipated in it, summed over the samples; results.joint_history() "
                    "has that of every joint." + shaded(verdict))


def _ties_section(history, verdict):
    table = ties(history)
    if not len(table):
        return None
    rank = np.argsort(-np.maximum(table["force"], table["compression"]), kind="stable")
    rows = [(f"{r['body1']} – {r['body2']}", *(text for name in ("force", "compression") for text in ((f"{r[name] / 1e3:.4g}", f"{r[name + '_time']:.3f}") if r[name] else ("", ""))),
             _mm(r["extension"]), f"{r['extension_time']:.3f}",
             f"{r['broken_time']:.3f}" if r["broken"] else "") for r in table[rank[:_JOINTS]]]
    broke = f" {int(table['broken'].sum())} of them broke." if table["broken"].any() else " None of them broke."
    return section("ties", "Ties", curves.tie_forces(history, verdict), f"Forces of {counted(len(table), 'tie')} at the instants of the samples, tension positive: means of the step before. One "
                    "that broke has carried its strength."
                    + broke + shaded(verdict), columns=["Bodies", "Tension (kN)", "at (s)", "Compression (kN)", "at (s)", "Extension (mm)", "at (s)", "Broken at (s)"], rows=rows,
                    more=f"The {len(rows)} ties of {len(table)} that carried most.", fold="Table of ties")


def _cracks_section(history, verdict):
    found = Cracks(history, len(history.time) - 1)
    if not len(found):
        return None
    text = f"{found}."
    own = found.cracked
    if not len(own):
        return section("cracks", "Cracks of the mortar", caption=f"{text[0].upper()}{text[1:]}")
    rows = [(f"{r['body1']} – {r['body2']}", f"{r['cracked']:.4f}", str(r["mode"]), f"{r['damage']:.3f}", _mm(r["opening"]), _mm(r["slip"]),
             f"{r['energy_tension'] + r['energy_shear']:.3g}", "" if math.isnan(r["broken"]) else f"{r['broken']:.4f}") for r in own[:_CRACKS]]
    return section("cracks", "Cracks of the mortar", curves.cracks(found, verdict), text + " A joint counts as cracked when the largest damage D in it is 0.02 or more; "
                    "broken: no mortar is left." + shaded(verdict), second=curves.crack_map(history, found),
                    second_caption="Joints coloured by their mean damage D in the last sample, on the structure as it was at first.",
                    columns=["Bodies", "First crack (s)", "in", "D", "Opening (mm)", "Slip (mm)", "Energy (J)", "Broken at (s)"], rows=rows,
                    more=f"The first {len(rows)} of {len(own)} joints to crack, in their order.", fold="Table of cracks")


def _mm(value):
    return "" if math.isnan(value) else f"{1e3 * value:.3f}"


def _force_sections(history, verdict):
    """Forces of each base, and with the first one the lines of thrust."""
    if not has_forces(history):
        return []
    thrust = curves.thrust_map(history, verdict.peak_drift_time)
    caption = ("Lines of thrust at the largest drift" + (" before the collapse" if verdict.collapsed else "") + ": the resultant of each joint, as long as it is "
               "large, and a dot where it crosses the joint; on the structure as it was at first.")
    if history.base is None:
        return [section("forces", "Thrust", thrust, caption)]
    bases = history.ids[np.unique(history.bases[history.free])].tolist()
    said = ("Forces of the base on the structure, and their moment about the middle of its foot, at the instants of the samples; peaks of impacts may leave "
            "the picture." + shaded(verdict))
    if len(bases) == 1:
        return [section("forces", "Base shear, overturning moment and thrust", curves.base_forces(history, verdict), said, second=thrust, second_caption=caption)]
    return [section(f"forces-{base}", f"Base shear and overturning moment of base {base}", curves.base_forces(history, verdict, base), said)
            for base in bases] + [section("thrust", "Thrust", thrust, caption)]


def _of_one_block(history, exact):
    """Signed rotation of the block, beside the exact one, and its phase plane."""
    row = int(np.flatnonzero(history.free)[0])
    angles = _signed(_from_upright(history, row))
    known = np.isfinite(angles)
    time, angles = history.time[known], np.unwrap(angles[known])
    other = exact.sample(time) if exact is not None else None
    caption = "Rotation relative to the base." + ("" if exact is None else f" Dashed: the exact solution; largest difference {largest(np.abs(angles - other[0])):.3g} rad.")
    speed = np.gradient(angles, time) if len(time) > 1 else np.zeros(len(time))
    return [section("rotation", "Rotation", curves.rotation(time, angles, None if other is None else other[0]), caption),
            section("phase-plane", "Phase plane", curves.phase_plane(angles, speed, None, other),
                     "Angular velocity over rotation, from differences of the samples." + ("" if exact is None else " Dashed: the exact solution."))]


def _from_upright(history, row):
    """(s, 4) how a block is turned from where its upright axis is vertical, seen from the base."""
    start, up = history.relative_orientation[0, row], history.upright[row]
    axis = _pose.matrices(start)[:, up]
    axis = axis * (1 if axis[2] >= 0 else -1)
    lean = np.array([1 + axis[2], -axis[1], axis[0], 0])  # the shortest way from the vertical to the axis
    stood = _pose.product(_pose.inverse(lean / np.linalg.norm(lean)), start)
    turn = _pose.product(history.relative_orientation[:, row], _pose.inverse(stood))
    return turn * np.where(turn[:, :1] < 0, -1, 1)


def _signed(turn):
    """Angle about the axis of the scene that the block turns about most."""
    sine = np.linalg.norm(turn[:, 1:], axis=1)
    vector = (2 * np.arctan2(sine, turn[:, 0]) / np.maximum(sine, 1e-300))[:, None] * turn[:, 1:]
    return vector[:, np.nan_to_num(np.abs(vector)).max(axis=0).argmax()]
