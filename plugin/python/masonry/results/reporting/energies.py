"""Energies in a report: their balance, the joints that have dissipated most, the impacts."""

import math

import numpy as np
from masonry.results.forces import has_forces
from masonry.results.joint_energies import joint_energies

from . import curves, words
from .sections import counted, section

# Rows of tables: of joints, and of impacts (those that lost most).
_JOINTS, _IMPACTS = 12, 200


def numbers(history):
    """Rows (name, value, when): the balance of energies in the last sample, since the first one."""
    energy, rows = history.energy, []
    for name, word in (("baseWork", "Work of the base"), ("kinetic", "Kinetic energy"), ("potential", "Potential energy"), ("elastPotential", "Elastic energy"), ("frictDissip", "Dissipated by friction"),
                       ("impactDissip", "Dissipated by impacts"), ("dampDissip", "Dissipated by dashpots and ties"), ("crackDissip", "Spent by cracks of mortar"), ("error", "Error of the balance of these")):
        if name not in energy.dtype.names:
            continue
        since = name in ("kinetic", "potential", "elastPotential")  # in the last sample; the others have been summed up
        value = energy[name][-1] - (energy[name][0] if since else 0)
        if np.isfinite(value) and (value != 0 or name == "baseWork"):
            rows.append((f"{word}, gained" if since else word, f"{words.decimal(value, 4)} J", "since the first sample" if since else "in all"))
    return rows


def joints_of(history):
    """The joints that have dissipated most; None where their forces are not known, and no mortar has cracked."""
    if not has_forces(history) and history.bonds is None:
        return None
    found = joint_energies(history)
    rows = [(f"{r['id1']} – {r['id2']}", *("" if math.isnan(r[name]) else f"{r[name]:.3g}" for name in ("friction", "impact", "crack", "total"))) for r in found.table[:_JOINTS] if r["total"] > 0]
    if not rows:
        return None
    sums = [f"{word} {words.decimal(np.nansum(found[part]), 4)} J{'' if math.isnan(found.engine[part]) else f' ({words.decimal(found.engine[part], 4)} J in the balance of the whole scene)'}"
            for part, word in (("friction", "friction"), ("impact", "impacts"), ("crack", "cracks")) if np.isfinite(found[part]).any()]
    return section("joint-energies", "Energy by joint", caption=f"Sums over the joints: {', '.join(sums)}. Friction by joint is force times way from sample to sample, which is wrong where samples are rare; the impacts are "
                   "those of the list below. results.joint_energies() has all joints.",
                   columns=["Blocks", "Friction (J)", "Impacts (J)", "Cracks (J)", "Sum (J)"], rows=rows, more=f"The {len(rows)} joints of {len(found)} that dissipated most.",
                   fold="Table of joints")


def section_of(history):
    if np.isnan(history.energy["kinetic"]).all():
        return None
    return section("energies", "Energies", curves.energies(history),
                    "Kinetic and potential energy, what was dissipated, and the work of the base. With method='wall' what impacts dissipated is what is left over of "
                    "the balance, numerical losses included; with other methods the error of the balance is drawn below.")


def impacts_of(history):
    table = history.impacts
    if table is None:
        return None
    if not len(table):
        why = (" With method='wall' only impacts with a given restitution are listed." if history.about.get("model", {}).get("method") == "wall" else "")
        return section("impacts", "Impacts", caption="No impact is in the list." + why)
    kept = np.sort(np.argsort(-table["energy_lost"], kind="stable")[:_IMPACTS])
    rows = [(f"{r['time']:.4f}", str(r["body"]), str(r["support"]), "natural" if math.isnan(r["restitution_asked"]) else f"{r['restitution_asked']:.3f}",
             f"{r['restitution']:.3f}", f"{r['velocity']:.3g}", f"{r['energy_lost']:.3g}", f"{r['friction_demand']:.2f}", "capped" if r["capped"] else "")
            for r in table[kept]]
    return section("impacts", "Impacts", curves.impacts(table, history.time),
                    f"{counted(len(table), 'impact')}, which lost {table['energy_lost'].sum():.4g} J.",
                    columns=["Time (s)", "Block", "on", "C asked", "C", "Velocity before (rad/s)", "Energy lost (J)", "Friction needed", ""], rows=rows,
                    more="All of them." if len(rows) == len(table) else f"The {len(rows)} that lost most.", fold="List of impacts")
