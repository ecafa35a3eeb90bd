"""Mortar: bonds between blocks, the damage of their joints, strengths that scatter."""

import numpy as np
from masonry._given import is_whole, number_given, shown, whole_given
from masonry.dem.bodies import block_body
from masonry.dem.checks import check_joint_material
from masonry.dem.joint_engine import joint_engine_given
from masonry.results.bonds import bond_table
from yade import wrapper

_JOINTS = "all", "bed", "head"


def damage():
    """The joints that have been bonded with mortar: a structured array, one row a joint, sorted by its bodies.

    body1, body2      ids
    center, area      of the joint when it was bonded, m and m^2
    damage, worst     mean and largest damage D over the area, 0 (sound) to 1 (dry). D is the fracture energy spent over that of the mortar
    mode              what has spent more of it, 'tension' or 'shear'; '' for a sound joint
    opening, slip     largest opening of its cracks and longest path of their slip, m: of the mortar alone, they end where it is broken
    energy_tension, energy_shear    spent by cracks so far, J; their sum over all joints is crackDissip of dem.energy()
    cracked, broken   time at which `worst` reached 0.02, and at which the last mortar broke, s; NaN: not yet
    """
    engine = joint_engine_given()
    return bond_table(engine.bondedIds, engine.bondedState)[0]


def bond(ids=None, material=None, joints="all"):
    """Bonds the joints of blocks that touch now, as they are, without stress: what the blocks weigh stays on the joints. Returns the number of joints.

    ids         of blocks and bases, a list: joints of which both bodies are named; None: all
    material    a JointMat. Friction angle, and stiffness with model='compliant', that it does not give are those of the joint
    joints      'all', 'bed' or 'head': head joints have upright faces

    Raises ValueError where no two of the bodies touch. The scene must have its engines, of model='compliant' or of method='wall'; the bonds act from the next step on. A joint that has been bonded before gets new mortar."""
    check_joint_material(material)
    if ids is not None and not (np.iterable(ids) and all(is_whole(id, 0) for id in ids)):
        raise ValueError(f"ids = {shown(ids)}: must be a list of ids of bodies, whole numbers from 0 on, or None for all")
    for id in ids or []:
        block_body(int(id))
    if joints not in _JOINTS:
        raise ValueError(f"joints = {shown(joints)}: must be 'all', 'bed' or 'head'")
    engine = joint_engine_given()
    if isinstance(engine, wrapper.MoreauJeanIntegrator) and engine.method != "wall":
        raise ValueError(f"method = {shown(engine.method)}: rigid blocks are bonded by dem.engines(method='wall') only; or take model='compliant'")
    if ids is not None and not len(ids):
        return 0
    if ids is not None and len(set(map(int, ids))) < 2:
        raise ValueError(f"ids = {shown(ids)}: must name two different bodies at least: a joint is between two")
    count = engine.bond([int(id) for id in ids or []], material, joints)
    if count == 0:
        raise ValueError(f"ids = {shown(ids)}, joints = {shown(joints)}: no two of these bodies touch face on face in such a joint: there is nothing to bond")
    return count


def scatter(mortar, cov=0.3, seed=1):
    """A JointMat like this one whose joints differ: each has one lognormal factor, of the mean 1, for both strengths and both fracture energies.

    cov     standard deviation over mean, 0 to 1; measured ones of masonry are 0.2 to 0.5
    seed    a whole number from 0 on. A joint's factor follows from the seed and the ids of its bodies"""
    check_joint_material(mortar)
    if not 0 <= number_given("cov", cov) <= 1:
        raise ValueError(f"cov = {cov}: must be from 0 to 1")
    return wrapper.JointMat(**{**mortar.dict(), "scatter": float(cov), "seed": whole_given("seed", seed, 0, 2**31 - 1)})
