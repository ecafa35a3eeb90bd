"""What dem.engines() says of a scene in which a number or a body may not be what the script means: a line each, and the run goes on."""

import math
import weakref

import masonry
import numpy as np
from masonry.dem.bodies import half_sizes, poses
from masonry.dem.checks import floating_and_supports, listed
from masonry.motions import LONGEST_STEP
from yade import O, wrapper

# These are no slips of units: the longest free block (mm for m), m; densities, kg/m^3, of which light timber has 300, and stone 2.7 in g/cm^3 and 27 in kN/m^3; peaks of
# records (g, cm/s^2), m/s^2.
_LONGEST = 50
_DENSITIES = 100, 20000
_PEAKS = 0.1, 50
# Peaks that would be usual in g, of a record whose unit the script has not named.
_PEAKS_IN_G = 0.1, 1.5
# Pa and J/m^2, of mortar.
_STRENGTHS = 1e3, 5e6
_FRACTURE_ENERGIES = 0.1, 1000
_STANDARD_GRAVITY = 9.80665  # m/s^2, as records are given in g
# A base goes on when its record ends if it has more than this share of its largest speed.
_STILL = 1e-3

said = []  # the lines that the last dem.engines() has printed on what may not be meant

_made = []  # weak references to the motion engines that a script has made and not yet given to dem.engines(), each with that of scene_mark()
_pushes = []  # weak references to the motion engines of dem.push()
_given = []  # (weak reference to a motion engine, the masonry.Record that it was made of)


def say(text):
    said.append(text)
    print(f"masonry.dem: {text}")


def say_of_mortar(mortars, blocks):
    """What strengths and energies look like a slip of units, what a flexural strength stands for, and what waits for cracks."""
    for mortar in mortars:
        for name in ("tensileStrength", "flexuralStrength", "cohesion"):
            if getattr(mortar, name) > 0 and not _STRENGTHS[0] <= getattr(mortar, name) <= _STRENGTHS[1]:
                say(f"{name} = {getattr(mortar, name):g} Pa: mortar has 1e3 to 5e6 Pa (0.25 MPa = 0.25 N/mm^2 = 2.5e5 Pa)")
        for name in ("fractureEnergy", "shearFractureEnergy"):
            if not _FRACTURE_ENERGIES[0] <= getattr(mortar, name) <= _FRACTURE_ENERGIES[1]:
                say(f"{name} = {getattr(mortar, name):g} J/m^2: mortar has 0.1 to 1000 J/m^2 (0.018 N/mm = 18 N/m = 18 J/m^2)")
        if not math.isnan(mortar.flexuralStrength):
            say(f"flexuralStrength = {mortar.flexuralStrength:g} Pa stands for the tensile strength {mortar.directStrength:.4g} Pa: joints of this stiffness bear "
                f"{mortar.flexuralStrength / mortar.directStrength:.3g} times the moment at which their edge reaches its strength")
    if mortars and not all(math.isnan(b.mat.restitution) for b in blocks):
        print("masonry.dem: mortar: a restitution acts in joints without sound mortar")


def scene_mark():
    """Of the present scene: a weak reference to its first body, for O.reset() makes other bodies. Without bodies: None."""
    return weakref.ref(O.bodies[0]) if len(O.bodies) and O.bodies[0] else None


def _watch(cls):
    make = cls.__init__

    def __init__(self, *arguments, **attributes):
        make(self, *arguments, **attributes)
        _made.append((weakref.ref(self), scene_mark()))

    cls.__init__ = __init__


for _cls in (wrapper.RecordMotionEngine, wrapper.PulseTrainEngine):
    _watch(_cls)


def has_record(engine, record):
    """The script has made the engine of this masonry.Record."""
    _given[:] = [(known, one) for known, one in _given if known() is not None]
    _given.append((weakref.ref(engine), record))


def is_of_a_push(engine):
    """The engine moves the platens of dem.push(): its accelerations are small and those of no record."""
    _pushes.append(weakref.ref(engine))


def moves_platens(engine):
    """Whether it is that of a push."""
    return any(known() is engine for known in _pushes)


def _record_of(engine):
    return next((record for known, record in _given if known() is engine), None)


def name_of(engine):
    """What the record of a motion engine is called; empty where it is not known."""
    return getattr(_record_of(engine), "name", None) or ""


def _has_unit(engine):
    """Whether the record's unit is known: the script has named it, or the accelerations come from displacements or velocities."""
    record = _record_of(engine)
    return record is not None and (record.unit_given or record.quantity != "acceleration")


def peak_of(record):
    """m/s^2, before the baseline."""
    return max(map(abs, record.samples)) * abs(record.scale)


def _records(motions):
    return [motion for motion in motions if isinstance(motion, wrapper.RecordMotionEngine) and not moves_platens(motion)]


def of_records(motions):
    """Length and peak of each record, so that slips of units (g for m/s^2, samples a second for the interval) are seen."""
    text = ""
    for record in _records(motions):
        peak = peak_of(record)
        text += f"; record of {(len(record.samples) - 1) * record.interval:g} s, at most {peak:.3g} m/s^2 ({peak / _STANDARD_GRAVITY:.3g} g)"
    return text


def say_what_looks_odd(blocks, motions, gravity, others, tied=()):
    """Prints a line for each; overlapping blocks are a ValueError. tied: ids of blocks that hang on ties."""
    floating, supports = floating_and_supports(floating=False)
    floating = [id for id in floating if id not in tied]
    if floating and gravity > 0:
        say(f"no chain of supports joins these blocks to a prescribed body, they will fall: {listed(floating)}")
    motions = [motion for motion in motions if not motion.dead]
    carried = supports
    supports = [(below, body) for below, body in supports if isinstance(body.shape, wrapper.Box)]  # the others have no width and height
    for text in (_untouched(others), _motion_left_out(motions), *_left_behind(motions, carried), _pivots_that_slip(supports), _pulses_that_slip(supports, motions), *map(_end_of, _records(motions))):
        if text:
            say(text)
    for density in sorted({b.mat.density for b in blocks}):
        if not _DENSITIES[0] <= density <= _DENSITIES[1]:
            say(f"a density is {density:g}: densities are in kg/m^3")
    for record in _records(motions):
        peak = peak_of(record)
        if 0 < peak and not _PEAKS[0] <= peak <= _PEAKS[1]:
            say(f"a record reaches {peak:.3g}: in g or cm/s^2? Accelerations are in m/s^2")
        elif _PEAKS_IN_G[0] <= peak <= _PEAKS_IN_G[1] and not _has_unit(record):
            say(f"a record given without a unit reaches {peak:.3g} m/s^2: is it in g? Then multiply it by {_STANDARD_GRAVITY:g}; else name its unit")
        if record.interval > LONGEST_STEP:
            say(f"a record has steps of {record.interval:g} s: are they in ms? Times are in s")
    longest = poses([b for b in blocks if b.dynamic])[1].max()
    if longest > _LONGEST:
        say(f"the longest block measures {longest:g} m: sizes are in m")


def say_what_is_unused(blocks, model, stiff):
    """Prints a line on attributes of the materials that the model does not read. stiff: names of the stiffnesses that the script has given."""
    default = wrapper.BlockMat()
    unused = [name for name in ("young", "poisson") if any(getattr(b.mat, name) != getattr(default, name) for b in blocks)]
    if unused:
        say(f"{' and '.join(unused)} of a BlockMat have no effect: blocks are rigid, and joints as stiff as normalStiffness and shearStiffness "
            "(Pa/m, model='compliant') say")
    if stiff and model != "compliant":
        say(f"{' and '.join(stiff)} of a BlockMat have no effect with model={model!r}: model='compliant' takes them")


def _untouched(others):
    """Blocks touch boxes and convex blocks with a BlockMat; what else there is needs `others`, engines of its own."""
    untouched, unmoved = [], False
    interact, move = (any(one.__class__.__name__ == name for one in others) for name in ("InteractionLoop", "NewtonIntegrator"))
    for body in O.bodies:
        shaped = isinstance(body.shape, (wrapper.Box, wrapper.ConvexBlock))
        if shaped and isinstance(body.mat, wrapper.BlockMat) or body.isClump:
            continue
        loose = body.dynamic and not move
        if shaped or not interact or loose:
            untouched.append(f"{body.id} ({type(body.shape).__name__ if body.shape else 'no shape'})")
            unmoved |= loose
    if not untouched:
        return None
    return (f"no block touches these bodies, which are no boxes or convex blocks with a BlockMat: {listed(untouched)}"
            + ("; no engine of `others` moves those that are free" if unmoved else ""))


def is_left_out(motion):
    """Whether the script has made this motion engine and given it to no dem.engines()."""
    return any(known() is motion for known, _ in _made)


def _motion_left_out(motions):
    """Sentence on a motion engine that the script has made in this scene and given to no dem.engines()."""
    _made[:] = [(known, mark) for known, mark in _made if known() is not None and not any(known() is given for given in motions)]
    here = scene_mark()
    present = [known() for known, mark in _made if mark in (here, None)]
    present = [motion for motion in present if not motion.dead and motion.ids and all(id < len(O.bodies) for id in motion.ids)]
    if motions or not present:
        return None
    return f"no motion: the {type(present[-1]).__name__} of body {listed(present[-1].ids)} does nothing unless it is given, dem.engines(motion=...)"


def _left_behind(motions, supports):
    """Sentences on what a motion does not move, though it seems to be meant to: prescribed bodies on those that move, and all blocks. supports: (body below, body on it)."""
    moved = {id for motion in motions if not moves_platens(motion) for id in motion.ids}
    touching = {(one.id, other) for pair in supports for one, other in (pair, pair[::-1]) if one.id in moved and other.id not in moved}
    fixed = sorted((other.id, id) for id, other in touching if not other.dynamic)
    if fixed:
        body, below = fixed[0]
        yield (f"a motion moves body {below} and not body {body}, which touches it and is prescribed: it stays where it is. Add to the ids of the motion what moves along: "
               f"{listed(sorted({id for id, _ in fixed}))}")
    if moved and not any(other.dynamic for _, other in touching):
        yield f"no free block stands on what a motion moves (body {listed(sorted(moved))})"


def _end_of(record):
    """Sentence on a base that goes on when its record ends."""
    theory = masonry.Record(record.interval, list(record.samples), record.scale, record.baseline)
    times = record.interval * np.arange(len(record.samples))
    speeds = theory.velocity(times)
    if abs(speeds[-1]) <= _STILL * np.abs(speeds).max():
        return None
    return (f"when the record ends, at {record.end:g} s, the base is {theory.displacement(times[-1]):.3g} m from where it was and goes on at {speeds[-1]:.3g} m/s "
            f"(baseline={record.baseline!r}; 'constant' brings it to rest)")


# --- friction that pivots ask for ---


def _law(below, body):
    """(restitution or None, friction coefficient or infinity) of a joint, as Ip2_BlockMat_BlockMat_BlockPhys makes it of two materials."""
    materials = below.mat, body.mat
    given = [m.restitution for m in materials if not math.isnan(m.restitution)]
    smooth = any(m.frictionAngle == 0 and not m.noSlip for m in materials)
    friction = math.inf if any(m.noSlip for m in materials) and not smooth else math.tan(min(m.frictionAngle for m in materials))
    return sum(given) / len(given) if given else None, friction


def _pivots_that_slip(supports):
    """Sentence on the block whose landings slip most: without slip, one that obeys C asks for a friction of slenderness (1 - C)/(1 + C).
    supports: (body below, body on it)."""
    slip = []
    for (below, body), half in zip(supports, half_sizes([body for _, body in supports])):
        restitution, friction = _law(below, body)
        if body.dynamic and restitution is not None:
            asked = half[2] / min(half[0], half[1]) * (1 - restitution) / (1 + restitution)
            if asked > friction:
                slip.append((asked - friction, body.id, below.id, asked, restitution, friction))
    if not slip:
        return None
    _, id, on, asked, restitution, friction = max(slip)
    return (f"where block {id} rocks on body {on} about its narrow side it asks for a friction coefficient of {asked:.2g} to land "
            f"with restitution {restitution:g} and has {friction:.2g}: pivots slip, and what slips rocks on farther (noSlip=True: it does not slip)")


def _pulses_that_slip(supports, motions):
    """Sentence on the block at rest that a Dirac pulse of its base would need most friction to tip without slip.

    The base jumps by I: about the edge, (4/3) m R^2 w = m I a (a, b: half height and half width). The edge gives the impulses m (I - w a) sideways and
    m w b upwards, whose ratio is (s^2 + 4)/(3 s) with the slenderness s = a/b: 4/3 at least. A block that carries others asks for something
    else: only those that carry none are looked at."""
    slip, carrying = [], {below.id for below, _ in supports}
    for motion in motions:
        if not isinstance(motion, wrapper.PulseTrainEngine) or motion.shape != "dirac" or motion.direction[2] != 0:
            continue
        along = 0 if abs(motion.direction[0]) >= abs(motion.direction[1]) else 1
        for (below, body), half in zip(supports, half_sizes([body for _, body in supports])):
            friction, slenderness = _law(below, body)[1], half[2] / half[along]
            asked = (slenderness**2 + 4) / (3 * slenderness)
            if body.dynamic and body.id not in carrying and below.id in motion.ids and asked > friction:
                slip.append((asked - friction, body.id, below.id, asked, friction))
    if not slip:
        return None
    _, id, on, asked, friction = max(slip)
    return (f"a Dirac pulse of body {on} asks for a friction coefficient of {asked:.3g} to tip block {id} without slip, which has {friction:.3g}: it slips, "
            "and rocks less (noSlip=True: it does not slip)")
