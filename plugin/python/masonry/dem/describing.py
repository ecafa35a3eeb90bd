"""What a scene was run with, in words and plain numbers: WallHistory.about."""

import math
import os
import platform
import sys

from masonry import _build
from masonry.dem import notes
from masonry.dem.joint_engine import joint_engine
from masonry.dem.loads import added_mass, dead_loads
from masonry.dem.ties import ties
from yade import O, config, wrapper

_MATERIAL = ("density", "frictionAngle", "restitution", "noSlip", "normalStiffness", "shearStiffness")
_INTEGRATOR = {"chosenModel": "model", "reason": "reason", "method": "method", "impactOrder": "impact order", "tolerance": "tolerance",
               "gravity": "gravity"}
_SOLVER = ("worstResidual", "failures", "firstFailure", "madeEnergy", "lostEnergy", "toldMade", "toldLost", "turnedOver", "movingSteps", "substeps", "events")


def about(ids, motions):
    """A dict that JSON can hold: script, versions, model, materials (with the ids that they have among `ids`), masses of free blocks, ties where there are any, motions, loads where there are any, solver and notes."""
    engine, loads = joint_engine(), _loads()
    found = {"script": os.path.basename(sys.argv[0]) if sys.argv else "", "versions": _versions(), "model": _model(engine),
             "materials": _materials(ids), "masses": _masses(ids), "motions": [_motion(one) for one in motions],
             "solver": {name: getattr(engine, name) for name in _SOLVER if hasattr(engine, name)}, "notes": list(notes.said)}
    more = {name: rows for name, rows in (("loads", loads), ("ties", _ties(ids))) if rows}
    return _plain({**found, **more})


def _loads():
    """Rows {kind, size, ids}: kg that move with blocks, and N of dead loads, with the unit of each as its kind says."""
    mass, dead = added_mass(), dead_loads()
    rows = [{"kind": "mass", "size": sum(mass.values()), "ids": sorted(mass)}] if mass else []
    return rows + ([{"kind": "dead load", "size": sum(math.hypot(*force) for force in dead.values()), "ids": sorted(dead)}] if dead else [])


def _plain(value):
    """For JSON, which has no number that is not finite: None."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _versions():
    return {"masonry": _build.VERSION, "YADE": config.version, "Python": platform.python_version(),
            "system": platform.freedesktop_os_release().get("PRETTY_NAME", "") + f", {platform.machine()}"}


def _model(engine):
    given = {"dt": O.dt, "steps": O.iter}
    if isinstance(engine, wrapper.RockingJointEngine):
        newton = next((one for one in O.engines if isinstance(one, wrapper.NewtonIntegrator)), None)
        return {"model": "compliant", "impact order": engine.impactOrder, **given, **({"gravity": list(newton.gravity)} if newton else {})}
    for name, word in _INTEGRATOR.items():
        if hasattr(engine, name):
            value = getattr(engine, name)
            given[word] = list(value) if word == "gravity" else value
    return given


def _materials(ids):
    found = {}
    for id in ids:
        body = O.bodies[id] if id < len(O.bodies) else None
        if body is not None and isinstance(body.mat, wrapper.BlockMat):
            values = {name: getattr(body.mat, name) for name in _MATERIAL}
            for name in ("mortar", "headMortar"):
                if getattr(body.mat, name) is not None:
                    values[name] = getattr(body.mat, name).dict()
            if body.mat.unfilledHeads:
                values["unfilledHeads"] = True
            found.setdefault(repr(values), {**values, "ids": []})["ids"].append(id)
    return list(found.values())


def _masses(ids):
    """Rows {mass, ids}: kg of each of these free blocks, with what dem.add_mass has added."""
    found = {}
    for id in ids:
        body = O.bodies[id] if id < len(O.bodies) else None
        if body is not None and body.dynamic:
            found.setdefault(body.state.mass, []).append(id)
    return [{"mass": mass, "ids": own} for mass, own in found.items()]


def _ties(ids):
    """Rows {stiffness, pretension, strength (None: it does not break), tension_only, ids}: N/m, N, N, pairs of bodies."""
    found = {}
    for one in ties():
        if not one.dead and {one.body1, one.body2} <= set(ids):
            values = {"stiffness": one.stiffness, "pretension": one.pretension, "strength": one.strength, "tension_only": one.tensionOnly}
            found.setdefault(repr(values), {**values, "ids": []})["ids"].append([one.body1, one.body2])
    return list(found.values())


def _motion(engine):
    if notes.moves_platens(engine):
        return {"kind": "push", "ids": list(engine.ids), "direction": list(engine.direction), "start": engine.start, "end": engine.end}
    said = {"kind": type(engine).__name__, "ids": list(engine.ids), "direction": list(engine.direction), "start": engine.start, "end": engine.end}
    if isinstance(engine, wrapper.RecordMotionEngine):
        said.update(record=notes.name_of(engine), interval=engine.interval, samples=len(engine.samples), peak=notes.peak_of(engine), scale=engine.scale,
                    baseline=engine.baseline)
    else:
        said.update(impulse=engine.impulse, shape=engine.shape, duration=engine.duration, pulses=len(engine.pulseTimes))
    return said
