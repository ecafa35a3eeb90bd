"""The engines of a scene, chosen and explained."""

import math
import numbers

import numpy as np
from masonry._given import finite_numbers, is_whole, number_given, shown
from masonry.motions import Motion, PulseTrain, Record
from yade import O, wrapper

from masonry import _yade
from masonry.dem import bodies, notes
from masonry.dem.bodies import poses
from masonry.dem.checks import check_blocks, check_material, check_mortar, check_recorder, check_use_of_mortar
from masonry.dem.joint_engine import joint_engine
from masonry.dem.loads import lasting_loads
from masonry.dem.pushing import HELD_RIGID, Push
from masonry.dem.stiffness import LEAST_PENETRATION, check_stiffness, choose_stiffness, has_stiffness, is_given, landing_step
from masonry.dem.structures import structures
from masonry.dem.ties import tied, ties
from masonry.dem.units import units

_MODELS = ("auto", "planar", "spatial", "compliant")
METHODS = ("auto", "localised", "wall")
_ORDERS = (None, "simultaneous", "sequential")
# By model: up to so many free blocks that are stepped together, impacts are found one by one.
_FEW_BLOCKS = _yade.few_blocks()
# Time step of rigid blocks, share of the largest that is allowed (0.15 sqrt(R/g) of the smallest block): 2.5e-3 sqrt(R/g), 1e-3 s for a
# block 3 m high. Rocking angles of one block are then right to 1e-6.
_RIGID_STEP = 1 / 60
# The same for method='wall': 4e-3 sqrt(R/g), 1e-3 s for blocks of 1.0 x 0.5 m.
_WALL_STEP = 2 / 75
_PENETRATION = 1e-5
# m/s^2: whatever the units of length and time, and far from overflow.
_GRAVITIES = 1e-6, 1e6
# Overlap of rigid blocks relative to their smallest size: what MoreauJeanIntegrator accepts, relative to half of it.
_MOST_OVERLAP = 5e-5
# Share of the critical time step: peaks of a rocking block at the default penetration change by 1 % of their error below it.
_STEP_FRACTION = 0.2


def record_motion(record, ids, direction=(1, 0, 0), start=0.0):
    """The RecordMotionEngine of a masonry.Record: its samples (with the record's scale in them), interval and baseline.

    ids          of the bodies that move, a list
    direction    unit vector along which they do
    start        when, s
    """
    if not isinstance(record, Record):
        raise ValueError(f"record = {shown(record)}: must be a masonry.Record")
    if not np.iterable(ids) or not all(is_whole(id, 0) for id in ids):
        raise ValueError(f"ids = {shown(ids)}: must be a list of ids of bodies, whole numbers from 0 on")
    if record.shape:
        raise ValueError(f"record.scale = {record.scale}: must be one number, a scene has one motion (record.scaled() makes another)")
    what = "a unit vector of three numbers"
    unit = finite_numbers("direction", direction, 3, what)
    if not abs(math.hypot(*unit) - 1) < 1e-9:
        raise ValueError(f"direction = {shown(direction)}: must be {what}")
    engine = wrapper.RecordMotionEngine(ids=[int(id) for id in ids], samples=record.samples.tolist(), interval=record.dt, baseline=record.subtracted,
                                        direction=unit, start=start)
    notes.has_record(engine, record)
    if record.quantity != "acceleration" and record.doubt():
        print(f"masonry.dem: {record.doubt()}")
    return engine


def _in_yade(motion):
    """How a script gives a motion of the theory to YADE."""
    if isinstance(motion, Record):
        return "dem.record_motion(record, ids=[base])"
    if isinstance(motion, PulseTrain):
        return f"dem.PulseTrainEngine(ids=[base], impulse={motion.impulse}, {'resonantBlock=block' if motion.times is None else 'times=...'})"
    return "dem.record_motion(masonry.Record(dt, motion.acceleration(times)), ids=[base])"


def _counted(number, word):
    return f"{number} {word}{'s' if number != 1 else ''}"


def _several(value):
    """What a script gave as one, a list or None, as a list."""
    return [] if value is None else list(value) if isinstance(value, (list, tuple)) else [value]


def _check_arguments(model, method, impact_order, penetration, tolerance, dt, gravity):
    if model not in _MODELS:
        raise ValueError(f"model = {shown(model)}: must be one of {', '.join(_MODELS)}")
    if method not in METHODS:
        raise ValueError(f"method = {shown(method)}: must be one of {', '.join(METHODS)}")
    if impact_order not in _ORDERS:
        raise ValueError(f"impact_order = {shown(impact_order)}: must be 'simultaneous', 'sequential' or None")
    if penetration is not None and not LEAST_PENETRATION <= number_given("penetration", penetration) <= 1e-2:
        raise ValueError(f"penetration = {penetration}: must be from {LEAST_PENETRATION:g} to 0.01")
    if tolerance is not None and not 0 < number_given("tolerance", tolerance) <= 1e-2:
        raise ValueError(f"tolerance = {tolerance}: must be above 0 and at most 0.001, with method='wall' 0.01")
    if dt is not None and not number_given("dt", dt) > 0:
        raise ValueError(f"dt = {dt}: must be positive, in s")
    if not isinstance(gravity, numbers.Real) or isinstance(gravity, bool):
        raise ValueError(f"gravity = {shown(gravity)}: must be one number in m/s^2, which acts along -z; for another direction set "
                         "O.engines[-1].gravity = (x, y, z) of the rigid model, or use dem.TiltTable")
    if not (gravity == 0 or _GRAVITIES[0] <= gravity <= _GRAVITIES[1]):
        raise ValueError(f"gravity = {gravity}: must be 0, or from {_GRAVITIES[0]:g} to {_GRAVITIES[1]:g}, in m/s^2")


def _check_engines(motions, recorders, others, blocks):
    for item in motions:
        if isinstance(item, Motion):
            raise ValueError(f"motion = {shown(item)}: is of the theory, without a body that it moves: must be {_in_yade(item)}")
        if not isinstance(item, wrapper.BaseMotionEngine):
            raise ValueError(f"motion = {shown(item)}: must be a PulseTrainEngine, a RecordMotionEngine, a test of dem.push(), or a list of them")
        if not item.dead:  # as if it were not there
            item.check()
    for item in recorders:
        if not isinstance(item, (wrapper.BlockRecorder, wrapper.WallRecorder)):
            raise ValueError(f"recorder = {shown(item)}: must be a BlockRecorder, a WallRecorder or a list of them")
        check_recorder(item)
        left_out = len({body.id for body in blocks} - set(item.ids))
        if getattr(item, "recordForces", False) and item.ids and left_out:
            notes.say(f"WallRecorder.ids leaves out {_counted(left_out, 'block')}: forces of their joints are not recorded, and the recorded reactions of the base lack them")
    if not isinstance(others, (list, tuple)) or not all(isinstance(one, wrapper.Engine) for one in others):
        raise ValueError(f"others = {shown(others)}: must be a list of engines")


def engines(motion=None, model="auto", dt=None, tolerance=None, penetration=None, impact_order=None, gravity=9.81, recorder=None, others=(), method="auto"):
    """The list for O.engines; sets O.dt and prints the choice and its reason, length and peak of records, and a line each on what may not be
    meant: blocks that stand on nothing, bodies that no block touches, pivots that slip, a base that goes on when its record ends, a motion that was
    made and not given, attributes that the model does not read, numbers that look like a slip of units.

    motion        a motion engine (PulseTrainEngine, RecordMotionEngine), a test (dem.push, dem.pull_and_release), a list of them, or None. Motions of the
                  same bodies, in perpendicular directions (two or three components of a record), add up
    model         'planar' or 'spatial': rigid blocks in a plane or in space (MoreauJeanIntegrator). 'compliant': joints with
                  stiffness, YADE's usual loop with NewtonIntegrator. 'auto': compliant where a BlockMat has mortar (without method='wall') or a stiffness or
                  `penetration` is given; else planar where the scene lies in one upright plane; else spatial.
    dt            time step, s; None: rigid 2.5e-3 sqrt(R/g) of the smallest block (1 ms for a block 3 m high), with method='wall'
                  4e-3 sqrt(R/g); compliant 0.2 of the critical step, at most 0.75 of the largest, to which the run lowers O.dt, with a
                  warning, where blocks come to touch in stiffer joints (a board that falls flat). Too large a step is refused, also in the run.
    tolerance     rigid: residual of the contact laws relative to the speed that gravity gives in a step (above 0, at most 1e-3;
                  None: 1e-9). With method='wall' from 1e-6 to 1e-2, None: 1e-3 (MoreauJeanIntegrator.tolerance)
    penetration   compliant, where BlockMat gives no stiffness: half of the depth by which the weight presses in the edge about which a block
                  rocks, and twice that of a whole face, relative to the smallest width (1e-10 to 1e-2; None: 1e-5). The error of rocking angles is about ten times this, and more where
                  the base's acceleration jumps (docs/limits.md);
                  the cost grows as its inverse square root.
    impact_order  'simultaneous' or 'sequential': how an impact acts on a structure (impactOrder of the engine). None: 'simultaneous', the
                  only one of method='wall'
    gravity       m/s^2, along -z
    recorder      a BlockRecorder, a WallRecorder or a list of them, put where positions, forces and O.time belong together; None
    others        rigid: engines of bodies that are no blocks (collider, InteractionLoop, NewtonIntegrator with a mask that leaves
                  the blocks out), put between ForceResetter and the blocks' own
    method        rigid: 'localised' (each impact found inside the step: second order) or 'wall' (all contacts of the walls solved at
                  once, impacts at the end of the step: first order, hundreds of times faster when many blocks move). 'auto': 'wall'
                  where a structure (dem.structures) has more than 20 free blocks, in space 6, or with a PulseTrainEngine the scene,
                  unless an impact_order 'sequential' or a tolerance below 1e-6 is asked for. With 'wall', structures of fewer
                  blocks have localised impacts (MoreauJeanIntegrator.localisedBlocks)

    A joint of two BlockMats has the smaller friction angle, the mean restitution (the given one where only one is), and noSlip if either has it and the other one
    has no friction angle of 0.
    Engines that are made in a run with mortar go on with its bonds, their damage and crackDissip; all other results begin anew.
    A BlockMat is read when two blocks come near each other. Changed during a run, it acts on pairs that come later; for those that are there
    already set phys.tangensOfFrictionAngle and phys.restitution of the interactions in O.interactions.
    """
    notes.said.clear()
    _check_arguments(model, method, impact_order, penetration, tolerance, dt, gravity)
    gravity, recorders, blocks = float(gravity), _several(recorder), bodies.blocks()
    pushes = [one for one in _several(motion) if isinstance(one, Push)]
    motions = [one.motion if isinstance(one, Push) else one for one in _several(motion)]
    _check_engines(motions, recorders, others, blocks)
    recorders += [one.recorder for one in pushes]
    loads = [*lasting_loads(), *(one.load for one in pushes if one.load)]
    if not any(b.dynamic for b in blocks):
        raise ValueError("there is no free block in O.bodies: add one with dem.block() before dem.engines()")
    for body in blocks:
        check_material(body.mat)
    notes.say_what_looks_odd(blocks, motions, gravity, others, {id for pair in tied() for id in pair})
    reason = "asked for"
    mortars, split = check_mortar(blocks), units()
    mortars += [material for name, (material, _) in split.items() if name not in {repr(sorted(one.dict().items())) for one in mortars}]
    if mortars:
        check_use_of_mortar(blocks, model, {"method": method != "auto" and method, "tolerance": tolerance, "others": others})
    notes.say_of_mortar(mortars, blocks)
    if model == "auto":
        if mortars and method != "wall":
            model, reason = "compliant", "units may split" if len(split) == len(mortars) else "a BlockMat has mortar"
        elif penetration is not None:
            model, reason = "compliant", "penetration is given"
        elif any(has_stiffness(b.mat) for b in blocks):
            model, reason = "compliant", "a BlockMat has a joint stiffness"
    stiff = [name for name in ("normalStiffness", "shearStiffness") if any(is_given(b.mat, name) for b in blocks)]
    notes.say_what_is_unused(blocks, model, stiff)
    if penetration is not None and all(is_given(b.mat, "normalStiffness") for b in blocks):
        notes.say(f"penetration = {penetration:g} is not used: every BlockMat has its normalStiffness")
    if model == "compliant":
        if tolerance is not None or others or method != "auto":
            raise ValueError("tolerance, others and method are for rigid blocks: they must be left out with model='compliant'")
        return _compliant(blocks, motions, reason, dt, penetration or _PENETRATION, impact_order or "simultaneous", gravity, recorders, loads)
    if any(one.held for one in pushes):
        raise ValueError(HELD_RIGID)
    if penetration is not None:
        raise ValueError(f"penetration = {penetration}: must be left out with model={shown(model)}, it is for compliant joints")
    check_blocks(_MOST_OVERLAP, floating=False)
    return _rigid(motions, model, method, bool(mortars), dt, tolerance, impact_order, gravity, recorders, [*loads, *others])


def _go_on_with_mortar(new):
    """The bonds of the engine that steps the scene now, and those of units that may split, for a new engine of the same model."""
    before = joint_engine()
    if O.iter > 0 and getattr(before, "bondedIds", None) and not isinstance(before, type(new)):
        raise ValueError("O.engines have bonded joints in this run, whose damage engines of another model do not know: give dem.engines() the model that the run began with")
    if O.iter == 0:
        for material, pairs in units().values():
            new.bond([id for pair in pairs for id in pair], material, "pairs")
    return before if isinstance(before, type(new)) else None


def _rigid(motions, model, method, mortared, dt, tolerance, impact_order, gravity, recorders, others):
    attributes = {"method": "wall", "tolerance": 1e-3} if mortared else {}  # with which mortar is allowed
    integrator = wrapper.MoreauJeanIntegrator(motions=motions, ties=ties(), model=model, gravity=(0, 0, -gravity), **attributes)
    choice = integrator.choice()
    if method == "auto":
        few = _FEW_BLOCKS[choice.split(":")[0]]
        pulses = any(isinstance(m, wrapper.PulseTrainEngine) for m in motions)  # they keep all structures in one step
        joined = [len(ids) for ids in structures()]
        blocks = sum(joined) if pulses else max(joined)
        fine = impact_order == "sequential" or (tolerance is not None and tolerance < 1e-6)
        method = "wall" if blocks > few and not fine else "localised"
        beside = [n for n in joined if n <= few]
        if method == "wall":
            whole = f"{blocks} blocks" if pulses or len(joined) == 1 else f"largest structure {blocks} of {sum(joined)} blocks"
            choice += f"; {whole}: method 'wall'"
            if beside and not pulses:
                choice += f", localised impacts for {_counted(len(beside), 'structure')} of {_counted(sum(beside), 'block')} beside"
        elif len(joined) > 1 and not pulses:
            choice += f"; {len(joined)} structures apart, each stepped by itself"
    wall = method == "wall"
    integrator.updateAttrs(dict(method=method, tolerance=tolerance or (1e-3 if wall else 1e-9), impactOrder=impact_order or "simultaneous"))
    if dt is None and gravity == 0:
        raise ValueError("dt = None: must be given where gravity is 0")
    step = dt if dt is not None else (_WALL_STEP if wall else _RIGID_STEP) * integrator.largestTimeStep
    if not step <= integrator.largestTimeStep:
        raise ValueError(f"dt = {dt}: must be at most {integrator.largestTimeStep:.3g} s, 0.15 sqrt(R/g) of the smallest block")
    O.dt = float(step)
    before = _go_on_with_mortar(integrator)
    if before and (before.bondsAsked or O.iter > 0 and before.bondedIds):
        if not wall:
            raise ValueError(f"method = {shown(method)}: must be 'wall', where blocks have been bonded with mortar")
        integrator.goOnWith(before)
    print(f"masonry.dem: rigid blocks, {choice}; dt = {O.dt:.3g} s{notes.of_records(motions)}")
    return [wrapper.ForceResetter(), *others, *recorders, integrator]


def _compliant(blocks, motions, reason, dt, penetration, impact_order, gravity, recorders, loads):
    reasons = [f"compliant joints, YADE's usual loop: {reason}"]
    check_stiffness(blocks, gravity)
    chosen = choose_stiffness(blocks, penetration, gravity)
    if chosen:
        reasons.append(chosen)

    joints = wrapper.RockingJointEngine(impactOrder=impact_order, ties=ties())
    before = _go_on_with_mortar(joints)
    bonded = getattr(before, "bondedIds", None) or []
    if getattr(before, "bondsAsked", None) or O.iter > 0 and any(O.interactions.has(*pair) for pair in zip(bonded[::2], bonded[1::2])):
        joints.goOnFrom(before)
    critical, largest = joints.criticalTimeStep(), joints.largestTimeStep
    if not np.isfinite(critical):  # nothing touches yet
        free = [b for b in blocks if b.dynamic]
        critical = largest = min(landing_step(b, alone=len(free) == 1) for b in free)
    if dt is not None and not dt <= largest:
        raise ValueError(f"dt = {dt}: must be below {largest:.3g} s, the largest stable step of joints this stiff, dashpots included")
    joints.stepFraction = _STEP_FRACTION if dt is None else 0
    O.dt = float(dt if dt is not None else min(_STEP_FRACTION * critical, joints.chosenTimeStep))
    reasons.append(f"dt = {O.dt:.3g} s ({O.dt / critical:.2g} of the critical step)")
    print("masonry.dem:", "; ".join(reasons) + notes.of_records(motions))

    smallest = poses(blocks)[1].min() / 2
    return [
        wrapper.ForceResetter(),
        *loads,
        wrapper.InsertionSortCollider([wrapper.Bo1_Box_Aabb(), wrapper.Bo1_ConvexBlock_Aabb()], verletDist=0.05 * smallest),
        wrapper.InteractionLoop([wrapper.Ig2_Box_Box_BlockGeom(), wrapper.Ig2_Box_ConvexBlock_BlockGeom(), wrapper.Ig2_ConvexBlock_ConvexBlock_BlockGeom()],
                                [wrapper.Ip2_BlockMat_BlockMat_BlockPhys()], [wrapper.Law2_BlockGeom_BlockPhys_Rocking()]),
        joints,
        *motions,
        *recorders,
        wrapper.NewtonIntegrator(gravity=(0, 0, -gravity), damping=0),
    ]
