"""Stiffness of compliant joints: what a script gives, or what is chosen from the weight."""

import numpy as np
from masonry.dem import notes
from masonry.dem.bodies import face_areas, geometry, half_sizes, reach
from masonry.dem.loads import dead_loads
from yade import O, wrapper

# Smaller ones drown in the round-off of positions.
LEAST_PENETRATION = 1e-10
# Share of the smallest width by which the weight presses in joints of a given stiffness: above the first, blocks sink into each other;
# above the second, a slip of units is likelier than rubber.
_MOST_PENETRATION, _ODD_PENETRATION = 0.1, 2e-3

# (material, stiffness) that choose_stiffness has given: materials may outlive their scenes.
_chosen = []


def is_given(material, name):
    """By a script, or for a run that goes on; what was chosen for another scene, or before the first step, is chosen anew."""
    stiffness = getattr(material, name)
    return not np.isnan(stiffness) and not (O.iter == 0 and any(material is one and stiffness == value for one, value in _chosen))


def has_stiffness(material):
    """Whether a script has given the BlockMat a joint stiffness, in either direction."""
    return is_given(material, "normalStiffness") or is_given(material, "shearStiffness")


def _largest_pressure(free, gravity):
    """Of the weight of a block and of what stands above it, over its lower face, Pa. Overlaps are measured along the axes of that face."""
    loads = dead_loads()
    (centers, sizes, axes), mass = geometry(free), np.array([b.state.mass + np.linalg.norm(loads.get(b.id, 0)) / gravity for b in free])
    pressures = []
    for k, (center, own) in enumerate(zip(centers, axes)):
        face = np.delete(own, np.abs(own[:, 2]).argmax(), axis=0)
        half = (np.abs(axes @ face.T) * sizes[:, :, None] / 2).sum(axis=1)  # of all blocks along the two axes, m
        # Half of the overlap of the two intervals over half the other's length, along both axes.
        shares = np.clip((half[k] + half - np.abs((centers - center) @ face.T)) / (2 * half), 0, 1).prod(axis=1)
        load = mass[k] + (mass * shares)[centers[:, 2] > center[2]].sum()
        convex = isinstance(free[k].shape, wrapper.ConvexBlock)
        pressures.append(load * gravity / (-face_areas(free[k])[:, 2].min() if convex else 4 * half[k].prod()))
    return max(pressures)


def check_stiffness(blocks, gravity):
    """Refuses given stiffnesses that the weight presses in by impossible depths, and names those that look like a slip of units."""
    if gravity == 0:
        return
    free = [b for b in blocks if b.dynamic]
    width = 2 * half_sizes(free)[:, :2].min()
    pressure = _largest_pressure(free, gravity)
    for name in ("normalStiffness", "shearStiffness"):
        for material in {b.mat.id: b.mat for b in blocks}.values():
            stiffness = getattr(material, name)
            if not is_given(material, name):
                continue
            depth = pressure / (stiffness * width)
            if not LEAST_PENETRATION / 2 <= depth <= _MOST_PENETRATION:
                raise ValueError(f"{name} = {stiffness:g} Pa/m: must be from {pressure / (width * _MOST_PENETRATION):.2g} to "
                                 f"{2 * pressure / (width * LEAST_PENETRATION):.2g} Pa/m here, where the weight presses joints in by {depth:.2g} of the smallest "
                                 f"width. It is a stiffness per area: 10 GPa/m = 10 N/mm^3 = 1e10 Pa/m")
            if depth > _ODD_PENETRATION:
                notes.say(f"{name} = {stiffness:g} Pa/m: the weight presses joints in by {1e3 * depth * width:.2g} mm, {depth:.2g} of the smallest width. Joints of "
                          "masonry have 1e9 to 1e12 Pa/m (10 GPa/m = 10 N/mm^3 = 1e10 Pa/m)")


def _not_of_mortar(materials, name):
    """Gives materials the stiffness of their mortar; returns those whose mortar has none."""
    for material in materials:
        if material.mortar is not None and not np.isnan(getattr(material.mortar, name)):
            setattr(material, name, getattr(material.mortar, name))
            _chosen.append((material, getattr(material, name)))
    return [m for m in materials if m.mortar is None or np.isnan(getattr(m.mortar, name))]


def choose_stiffness(blocks, penetration, gravity):
    """Fills in the stiffness per area of every BlockMat that has none: the weight presses the edge of the most loaded joint in by twice the
    `penetration`, times the smallest width, and the whole face by a quarter of that (joint_contact.hpp). The step follows from the shear stiffness
    of slender blocks; half of the normal one leaves it as long as the edge needs. Returns a sentence, or None when nothing was chosen."""
    materials = {b.mat.id: b.mat for b in blocks}.values()
    normal, shear = (_not_of_mortar([m for m in materials if not is_given(m, name)], name) for name in ("normalStiffness", "shearStiffness"))
    if normal:
        if gravity == 0:
            raise ValueError("gravity = 0: every BlockMat must have a normalStiffness, there is no weight to choose one by")
        free = [b for b in blocks if b.dynamic]
        stiffness = 2 * _largest_pressure(free, gravity) / (penetration * 2 * half_sizes(free)[:, :2].min())
        for material in normal:
            material.normalStiffness = stiffness
            _chosen.append((material, stiffness))
    for material in shear:
        material.shearStiffness = material.normalStiffness
        if any(material is one for one in normal):
            material.shearStiffness /= 2
            _chosen.append((material, material.shearStiffness))
    if normal:
        return f"stiffness {stiffness:.3g} Pa/m (the weight presses faces in by {penetration / 2:g} of the width, edges by {2 * penetration:g})"
    return None


def landing_step(body, alone):
    """Critical time step of a block on its largest face, s. Above the frequency of any of its joints: all springs at the corner, and twice as stiff
    where it may land on another free block, which swings against it."""
    shape, state = body.shape, body.state
    if isinstance(shape, wrapper.Box):
        x, y, z = shape.extents
        area, reach_squared = 4 * x * y * z / min(x, y, z), shape.extents.squaredNorm()
    else:
        area, reach_squared = np.linalg.norm(face_areas(body), axis=1).max(), reach(body) ** 2
    stiffness = max(getattr(one, name) for one in (body.mat.mortar, body.mat) if one for name in ("normalStiffness", "shearStiffness") if getattr(one, name) > 0)
    return 2 / np.sqrt((1 if alone else 2) * stiffness * area * (1 / state.mass + reach_squared / min(state.inertia)))
