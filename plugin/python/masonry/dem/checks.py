"""Checks of what a scene holds: materials, recorders, blocks that overlap or float."""

import math

import numpy as np
from masonry._given import number_given, shown
from masonry.dem.bodies import block_body, blocks, contacts_of, geometry
from masonry.results.own_bases import TOUCH, own_bases
from yade import O, wrapper

# Faults that a message names one by one; more are counted.
_NAMED = 10
# kg/m^3. Wide enough for other units (t/mm^3), far from overflow.
_DENSITIES = 1e-12, 1e12
# Gap above a block with mortar from which it is an opening, relative to the smallest size of the two.
_OPENING = 0.5


def listed(items):
    return ", ".join(str(item) for item in items[:_NAMED]) + (f" and {len(items) - _NAMED} more" if len(items) > _NAMED else "")


def check_material(material):
    if not isinstance(material, wrapper.BlockMat):
        raise ValueError(f"material = {shown(material)}: must be a BlockMat")
    if not _DENSITIES[0] <= material.density <= _DENSITIES[1]:
        raise ValueError(f"density = {material.density}: must be positive, from {_DENSITIES[0]:g} to {_DENSITIES[1]:g}, in kg/m^3")
    if not 0 <= material.frictionAngle < math.pi / 2:
        raise ValueError(f"frictionAngle = {material.frictionAngle}: must be from 0 to below pi/2, in rad (noSlip=True where nothing may slip)")


def check_joint_material(mortar):
    if not isinstance(mortar, wrapper.JointMat):
        raise ValueError(f"material = {shown(mortar)}: must be a JointMat")
    if math.isnan(mortar.directStrength):
        raise ValueError("material = JointMat without strengths: must have tensileStrength (or flexuralStrength), fractureEnergy, cohesion and shearFractureEnergy")


def check_mortar(blocks):
    """The JointMats of blocks, without repeats; ValueError where two blocks that touch have different ones."""
    materials = {b.mat.id: b.mat for b in blocks if b.mat.mortar is not None}
    if not materials:
        return []
    known = {id: (_values(mat.mortar), _values(_head_mortar(mat))) for id, mat in materials.items()}
    if len(set(known.values())) > 1:
        pairs, _, _, supports = contacts_of(blocks, TOUCH)
        beds = {tuple(pair) for pair in np.sort(supports, axis=1).tolist()}
        for i, j in pairs.tolist():
            own = [known.get(blocks[k].mat.id, (None, None))[(min(i, j), max(i, j)) not in beds] for k in (i, j)]
            if None not in own and own[0] != own[1]:
                raise ValueError(f"bodies {blocks[i].id} and {blocks[j].id} touch and have different mortar: a joint has one JointMat; give both bodies the same, or bond "
                                 "the joint by dem.bond()")
    return list({_values(one): one for mat in materials.values() for one in (mat.mortar, _head_mortar(mat)) if one is not None}.values())


def _head_mortar(material):
    return None if material.unfilledHeads else material.headMortar or material.mortar


def _values(mortar):
    return None if mortar is None else repr(sorted(mortar.dict().items()))


def check_use_of_mortar(blocks, model, rigid):
    """ValueError where blocks with mortar have gaps, or the scene is to have what knows no mortar: a model, other arguments {name: value} of rigid blocks."""
    walls = rigid["method"] == "wall" and model != "compliant"
    if model in ("planar", "spatial") and not walls:
        raise ValueError(f"model = {shown(model)} with method = {shown(rigid['method'] or 'auto')}: must have method='wall', or be 'compliant', where a BlockMat has mortar")
    for name in (name for name, value in rigid.items() if value and not walls):
        raise ValueError(f"{name} = {shown(rigid[name])}: is for rigid blocks, and must be left out where a BlockMat has mortar, which needs compliant joints "
                         "(model='compliant') or method='wall'")
    if O.iter == 0:
        _check_gaps(blocks)


def _check_gaps(blocks):
    """ValueError where blocks with mortar lie above each other and do not touch. Gaps above half of the smallest size of the two are openings."""
    pairs, gaps, margins, supports = contacts_of(blocks, _OPENING)
    wide = {}
    for pair, gap, margin in sorted(zip(map(tuple, pairs.tolist()), gaps.tolist(), margins.tolist()), key=lambda row: -row[1]):
        wide[pair] = gap if gap > TOUCH / _OPENING * margin else 0.0  # last that of the nearest convex parts
    for pair in map(tuple, np.sort(supports, axis=1).tolist()):
        one, other = (blocks[k] for k in pair)
        if wide.get(pair) and one.mat.mortar and other.mat.mortar and (one.dynamic or other.dynamic):
            raise ValueError(f"bodies {one.id} and {other.id} have mortar and a gap of {wide[pair]:.3g} m: blocks with mortar must touch; the mortar's thickness belongs to their "
                             "sizes, half a joint to either")


def check_recorder(recorder):
    name = type(recorder).__name__
    periods = recorder.iterPeriod, recorder.virtPeriod, recorder.realPeriod
    later = isinstance(recorder, wrapper.BlockRecorder) and not any(periods)  # by O.dt, which dem.engines() is to choose
    if later:
        print(f"masonry.dem: {name} records nothing until its iterPeriod or virtPeriod is set")
    elif not any(0 < period < math.inf for period in periods):
        raise ValueError(f"{name}.iterPeriod = {recorder.iterPeriod}, virtPeriod = {recorder.virtPeriod}: one of them must be positive and finite")
    if isinstance(recorder, wrapper.BlockRecorder) and not recorder.ids:
        raise ValueError(f"{name}.ids is empty: it must name at least one block")
    wall = isinstance(recorder, wrapper.WallRecorder)
    if recorder.times and recorder.times[-1] > O.time:
        raise ValueError(f"{name}.times ends at {recorder.times[-1]:g} s, after O.time = {O.time:g} s: it holds an earlier run: make a new {name} (after loading, O.engines has the one of the run)")
    if recorder.times:  # it goes on, also without blocks that have been erased since
        return
    bodies = [block_body(id) for id in recorder.ids]
    left_out = _bases_left_out({b.id for b in bodies}) if wall and bodies else []
    if left_out:
        lacks = "no prescribed body" if all(b.dynamic for b in bodies) else "not the base of all its blocks"
        print(f"masonry.dem: {name}.ids has {lacks}: drifts and falls will not be relative to the base: add {listed(left_out)} where it moves")


def _bases_left_out(ids):
    """Ids of the prescribed bodies on which some of the blocks stand, and which are not among them."""
    bodies = blocks()
    bases = own_bases(*geometry(bodies), np.array([b.dynamic for b in bodies]), contacts_of(bodies, TOUCH))
    return sorted({bodies[base].id for body, base in zip(bodies, bases) if base >= 0 and body.id in ids} - ids)


def check_blocks(tolerance=1e-3, floating=True):
    """Raises a ValueError that names the ids of overlapping blocks, prescribed bodies included, and, with `floating`, of those that no chain of supports joins to
    a prescribed body (head joints of boxes do not carry, all joints of convex blocks do). tolerance: depth of an overlap, or gap in a joint, that is still accepted, relative to
    the smallest size of the two blocks; 0 < tolerance <= 0.1. Returns the ids of the floating blocks."""
    return floating_and_supports(tolerance, floating)[0]


def floating_and_supports(tolerance=1e-3, floating=True):
    """What check_blocks() does and returns, and the pairs (body below, body on it) of blocks that touch."""
    if not 0 < number_given("tolerance", tolerance) <= 0.1:
        raise ValueError(f"tolerance = {tolerance}: must be above 0 and at most 0.1")
    bodies = blocks()
    if not bodies:
        return [], []
    prescribed = np.array([not b.dynamic for b in bodies])
    pairs, gaps, margins, supports = contacts_of(bodies, tolerance)
    deep = -gaps > margins
    ids, found = [b.id for b in bodies], []
    loose = [ids[i] for i in np.flatnonzero(~_carried(supports, prescribed))]
    each = [(prescribed[i] and prescribed[j], f"{ids[i]} and {ids[j]} (by {-gap:.3g} m)") for (i, j), gap in zip(pairs[deep].tolist(), gaps[deep].tolist())]
    for both, name in ((False, "overlapping blocks: "), (True, "overlapping prescribed bodies, which would share the load on them: ")):
        named = [text for one, text in each if one == both]
        if named:
            found.append(name + listed(named))
    if floating and loose:
        found.append("floating blocks, which no chain of supports joins to a prescribed body: " + listed(loose))
    if found:
        raise ValueError(f"{'; '.join(found)}; overlaps and gaps must be at most {tolerance:g} of the smallest size (tolerance)")
    return loose, [(bodies[lower], bodies[upper]) for lower, upper in supports.tolist()]


def _carried(supports, prescribed):
    """Which blocks a chain of supports (rows: lower, upper) joins to a prescribed one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order

    ground, (lower, upper), carry = len(prescribed), supports.T, np.flatnonzero(prescribed)
    ends = np.concatenate([lower, np.full(len(carry), ground)]), np.concatenate([upper, carry])
    chains = coo_array((np.ones(len(ends[0])), ends), shape=(ground + 1, ground + 1)).tocsr()
    return np.isin(np.arange(ground), breadth_first_order(chains, ground, return_predecessors=False))
