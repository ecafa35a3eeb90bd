"""WallHistory.about in words."""

import functools
import math

from masonry import _core

_GRAVITY = 9.80665  # m/s^2, as records are given in g
_SMALL = 0.1  # share of a drift
_LEAST = 1e-3  # smaller drifts are none


def decimal(value, digits=3):
    """The value rounded to so many significant digits; large ones are written without a power of ten."""
    value = float(f"{value:.{digits}g}")
    return f"{value:.0f}" if 1 <= abs(value) / 10 ** (digits - 1) < 1e9 else f"{value:.{digits}g}"


def quantity(value, unit=""):
    return "not known" if value is None else f"{value:.4g}{' ' if unit else ''}{unit}"


def material(given):
    """One sentence on a BlockMat of WallHistory.about."""
    friction = "no slip" if given["noSlip"] else f"friction coefficient {math.tan(given['frictionAngle']):.3g}"
    restitution = "natural restitution" if given["restitution"] is None else f"restitution {given['restitution']:.3g}"
    stiffness = [f"{word} stiffness {given[name]:.3g} Pa/m" for name, word in (("normalStiffness", "normal"), ("shearStiffness", "shear"))
                 if given[name] is not None]
    bonded = [mortar(given["mortar"])] if given.get("mortar") else []
    if given.get("headMortar"):
        bonded.append("in its head joints " + mortar(given["headMortar"]))
    if given.get("unfilledHeads"):
        bonded.append("head joints unfilled")
    return ", ".join([f"{len(given['ids'])} blocks: density {given['density']:g} kg/m^3", friction, restitution, *stiffness, *bonded])


def mortar(given):
    """A clause on the JointMat of a BlockMat; what it does not give is that of the block."""
    words = {"tensileStrength": "tensile strength {:.3g} Pa", "flexuralStrength": "flexural strength {:.3g} Pa", "fractureEnergy": "fracture energy {:.3g} J/m^2",
             "cohesion": "cohesion {:.3g} Pa", "shearFractureEnergy": "fracture energy in shear {:.3g} J/m^2", "frictionAngle": "friction angle {:.3g} rad",
             "normalStiffness": "normal stiffness {:.3g} Pa/m", "shearStiffness": "shear stiffness {:.3g} Pa/m", "scatter": "coefficient of variation {:.3g}"}
    return "mortar of " + ", ".join(text.format(given[name]) for name, text in words.items() if given.get(name))


def motion(given):
    """One sentence on a motion engine of WallHistory.about."""
    direction = ", ".join(f"{x:g}" for x in given["direction"])
    start = f", from {given['start']:g} s" if given["start"] else ""
    if given["kind"] == "push":
        return f"platens {', '.join(map(str, given['ids']))} push along ({direction}){start}"
    if given["kind"] == "RecordMotionEngine":
        name = f" “{given['record']}”" if given["record"] else ""
        return (f"record{name}: {given['samples']} samples every {given['interval']:g} s, peak {given['peak']:.3g} m/s^2 ({given['peak'] / _GRAVITY:.3g} g), "
                f"baseline {given['baseline']}, along ({direction}){start}")
    return f"{given['pulses']} pulses ({given['shape']}) of impulse {quantity(given['impulse'], 'm/s')}, along ({direction}){start}"


def load(given):
    """One sentence on a load of WallHistory.about."""
    on = f"on {len(given['ids'])} block{'s' if len(given['ids']) != 1 else ''}"
    if given["kind"] == "mass":
        return f"{decimal(given['size'], 4)} kg {on}, which move with them"
    return f"{decimal(1e-3 * given['size'], 4)} kN {on}, a constant force"


def tie(given):
    """One sentence on equal ties of WallHistory.about."""
    number = len(given["ids"])
    breaks = "does not break" if given["strength"] is None else f"breaks at {decimal(1e-3 * given['strength'], 4)} kN"
    said = [f"{number} tie{'s' if number != 1 else ''}: stiffness {given['stiffness']:.4g} N/m", breaks if number == 1 else breaks.replace("does", "do").replace("breaks", "break")]
    return ", ".join(said + [f"pretension {decimal(1e-3 * given['pretension'], 4)} kN"] * (given["pretension"] != 0) + ["presses too" if number == 1 else "press too"] * (not given["tension_only"]))


def mass(kilograms, gravity):
    """The mass of blocks, and their weight where gravity is known."""
    said = f"{decimal(kilograms, 4)} kg"
    return said if gravity is None else f"{said}, weight {decimal(1e-3 * kilograms * math.hypot(*gravity), 4)} kN"


def _written_by_masonry(sentences):
    """The function of `about`; where that, which may come from a file, lacks what masonry writes into it, ValueError."""
    @functools.wraps(sentences)
    def checked(about, *more):
        try:
            return sentences(about, *more)
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            raise ValueError(f"about of the history: must be what masonry has written ({type(error).__name__}: {error})") from None

    return checked


@_written_by_masonry
def facts(about):
    """Rows (name, value) of the table of what was run."""
    rows = [("Script", about["script"])] if about.get("script") else []
    rows += [("Material" if len(about["materials"]) == 1 else f"Material {k + 1}", material(one)) for k, one in enumerate(about.get("materials", []))]
    rows += [("Push" if one["kind"] == "push" else "Motion of the base", motion(one)) for one in about.get("motions", [])] or ([("Motion of the base", "none")] if "motions" in about else [])
    rows += [("Added mass" if one["kind"] == "mass" else "Dead load", load(one)) for one in about.get("loads", [])]
    rows += [("Ties", tie(one)) for one in about.get("ties", [])]
    model = about.get("model", {})
    if "model" in model:
        rows.append(("Model", f"{model['model']}{': ' + model['reason'] if model.get('reason') else ''}"))
    for name in ("method", "impact order", "tolerance"):
        if name in model:
            rows.append((name.capitalize(), f"{model[name]:g}" if name == "tolerance" else model[name]))
    if "dt" in model:
        rows.append(("Time step", f"{model['dt']:.4g} s in the last of {model['steps']} steps"))
    if "gravity" in model:
        rows.append(("Gravity", f"({', '.join(f'{x:g}' for x in model['gravity'])}) m/s^2"))
    rows += [(name[0].upper() + name[1:], value if isinstance(value, str) else f"{value!r}") for name, value in about.items()
             if name not in ("script", "materials", "masses", "motions", "loads", "ties", "model", "solver", "notes", "versions")]
    if "versions" in about:
        rows.append(("Versions", ", ".join(f"{name} {value}" for name, value in about["versions"].items())))
    return rows


@_written_by_masonry
def solver(about, duration, height, moved):
    """Rows (name, value, meaning) on how well the laws were met. duration: of the run, s; height: of the structure, m; moved: the largest displacement of its top, m."""
    given, model = about.get("solver", {}), about.get("model", {})
    rows = []
    if "worstResidual" in given:
        step = (math.hypot(*model["gravity"]) * model["dt"]) if "gravity" in model else 0
        share = [f"{given['worstResidual'] / step:.2g} of the speed that gravity gives in a step"] if step > 0 else []
        rows.append(("Largest residual of the contact laws", quantity(given["worstResidual"], "m/s"), "; ".join(share + [_of_drift(given["worstResidual"] * duration, height, moved)])))
    if "failures" in given:
        rows.append(("Steps that missed a law or the tolerance", str(given["failures"]), f"of {model['steps']} steps" if "steps" in model else ""))
    for name, word in (("madeEnergy", "Energy made of nothing"), ("lostEnergy", "Energy that vanished")):
        if name in given and model.get("method") != "wall":
            turned = given.get("turnedOver") or 0
            rows.append((word, quantity(given[name], "J"), f"{100 * given[name] / turned:.2g} % of what was turned over" if turned > 0 else ""))
    return rows


def _of_drift(way, height, moved):
    """What a residual means for the drift: way: how far it goes in the whole run, m."""
    said = f"if every step missed by as much in one direction, the top would be off by {decimal(1e3 * way, 2)} mm in the end, {decimal(100 * way / height, 2)} % of the height"
    if way <= _SMALL * max(moved, _LEAST * height):
        return f"{said}: small beside {'the largest drift' if moved > _LEAST * height else f'a drift of {100 * _LEAST:g} %'}"
    return f"{said}: not small beside the largest drift; a run with a smaller tolerance or step tells whether it matters (dem.compare)"


def _distrust(about):
    """Sentences on energy that came from nothing or vanished, where the run has warned of it and it still is that share of what was turned over."""
    given, compliant = about.get("solver", {}), about.get("model", {}).get("model") == "compliant"
    turned, said = given.get("turnedOver") or 0, []
    for of, what, most in (("made", "come from nothing", _core.MADE_BY_JOINTS if compliant else _core.MADE_SHARE), ("lost", "vanished", _core.MADE_SHARE)):
        energy = given.get(f"{of}Energy") or 0
        warned = given.get(f"told{of.capitalize()}", energy) > 0  # files of before do not have it
        if warned and turned > 0 and energy > most * turned:
            said.append(f"Do not trust this run: {quantity(energy, 'J')} of energy have {what}, {100 * energy / turned:.2g} % of what was turned over")
    return said


@_written_by_masonry
def failures(about):
    """Sentences on failures of the solver, and on energy that should not have been."""
    return _distrust(about) + _missed(about)


def _missed(about):
    given = about.get("solver", {})
    if not given.get("failures"):
        return []
    count = f"{given['failures']} step{'s' if given['failures'] != 1 else ''} missed the contact laws or the tolerance"
    return [f"{count}. The first: {given['firstFailure']}"] if given.get("firstFailure") else []
