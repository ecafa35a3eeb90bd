"""Units that may split: two halves, bonded by a joint in the middle."""

from masonry._given import shown
from masonry.dem.checks import check_joint_material
from masonry.dem.notes import scene_mark
from yade import wrapper

_made = []  # (ids of the two halves, JointMat, mark of the scene that a script has made them in)


def add_units(pairs, material):
    """Pairs of ids of halves, whose joint is to have this JointMat from the first step on."""
    here = scene_mark()
    _made.extend((pair, material, here) for pair in pairs)


def units():
    """{repr of the values of a JointMat: (the JointMat, pairs of ids)} of the present scene."""
    here, found = scene_mark(), {}
    _made[:] = [one for one in _made if one[2] == here]
    for pair, material, _ in _made:
        found.setdefault(repr(sorted(material.dict().items())), (material, []))[1].append(pair)
    return found


def check_split(split):
    if not isinstance(split, wrapper.JointMat):
        raise ValueError(f"split = {shown(split)}: must be a JointMat, that of the joint in the middle of each whole block, or None")
    check_joint_material(split)
