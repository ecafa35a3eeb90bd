"""Structures with arches, and vaults: thrust, least thickness and multipliers against statics (a23 to a27)."""

import math

import numpy as np
import domes
import statics
from masonry import dem
from masonry.artificial import artificial_record
from rows import collapse, rows, start
from yade import O

G = 9.81
DEPTH = 0.5  # m, along y
IN_WALL = [("wall", "spatial")]  # hundreds of stones in space take `localised` minutes a second
STILL = 1e-5  # m per m of the size: movement of a structure that stands
GIVE = 3e-5   # the same with compliant joints, whose springs give way by 1e-5 of a block's width, by default


def rectangle(left, right, bottom, top):
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def stone(friction):
    return dem.BlockMat(density=2000, frictionAngle=math.atan(friction))


def build(blocks, ground, friction):
    """Ids of the blocks and of the fixed ones, which are polygons in the plane."""
    O.reset()
    material = stone(friction)

    def add(polygon):
        return dem.convex([(x, y, z) for x, z in polygon for y in (-DEPTH / 2, DEPTH / 2)], material)

    free, fixed = [add(polygon) for polygon in blocks], [add(polygon) for polygon in ground]
    for id in fixed:
        O.bodies[id].dynamic = False
    return free, fixed


def run(seconds):
    O.run(max(1, round(seconds / O.dt)), True)


def places(ids):
    return np.array([O.bodies[id].state.pos for id in ids])


def reaction(ids):
    """Force of fixed bodies on the blocks, N."""
    return sum(dem.reactions(id)["force"].sum(axis=0) for id in ids)


def weight(ids):
    return G * sum(O.bodies[id].state.mass for id in ids)


# --- layouts in the plane: polygons of the blocks, and of what is fixed ---


def arch_at(center, springing, voussoirs, thickness, radius, embrace=math.pi):
    return [block * radius + (center, springing) for block in statics.arch(voussoirs, thickness, embrace).blocks]


def wall_above_arch(courses=4):
    """A segmental arch of 9 voussoirs over 90 degrees and 4 m between the middles of its springings, upright stones on it up to a level, and a wall of
    bricks of 0.8 x 0.3 m over the arch and its abutments."""
    radius, thickness, edge, foot = 2 * math.sqrt(2), 0.15, 4.0, 1.0
    voussoirs = arch_at(0, 0, 9, thickness, radius, math.pi / 2)
    joints = [(block[0], block[3]) for block in voussoirs] + [(voussoirs[-1][1], voussoirs[-1][2])]  # points on the intrados and the extrados
    outer = [joint[1] for joint in joints]
    level = max(z for _, z in outer) + 0.2
    spandrels = [np.array([a, b, (b[0], level), (a[0], level)]) for a, b in zip(outer, outer[1:])]
    bricks = []
    for course in range(courses):
        ends = np.linspace(-edge, edge, 11) if course % 2 == 0 else np.array([-edge, *np.linspace(0.4 - edge, edge - 0.4, 10), edge])
        bricks += [rectangle(a, b, level + 0.3 * course, level + 0.3 * (course + 1)) for a, b in zip(ends, ends[1:])]
    (inside, outside), foot = joints[-1], joints[-1][0][1] - 1.0
    right = [np.array([(inside[0], foot), (edge, foot), (edge, outside[1]), outside, inside]), rectangle(outside[0], edge, outside[1], level)]
    return [*voussoirs, *spandrels, *bricks], [*right, *(mirrored(block) for block in right)]


def mirrored(polygon):
    return polygon[::-1] * (-1, 1)


def pier(center, width, height, stones=3):
    levels = np.linspace(-height, 0, stones + 1)
    return [rectangle(center - width / 2, center + width / 2, a, b) for a, b in zip(levels, levels[1:])]


def arch_on_piers():
    """A half circle of 15 voussoirs, of 2 m to the middle, on two piers of three stones, 0.9 x 1.5 m, which it loads near their inner edges."""
    return [*pier(-2.15, 0.9, 1.5), *pier(2.15, 0.9, 1.5), *arch_at(0, 0, 15, 0.15, 2.0)], [rectangle(-4, 4, -2, -1.5)]


def two_arches():
    """Two half circles of 11 voussoirs, of 1.5 m to the middle, on a pier of 0.9 x 1.8 m between them and on fixed abutments at the far ends."""
    blocks = [*pier(0, 0.9, 1.8), *arch_at(-1.7, 0, 11, 0.15, 1.5), *arch_at(1.7, 0, 11, 0.15, 1.5)]
    return blocks, [rectangle(-4, -2.8, -2.3, 0), rectangle(2.8, 4, -2.3, 0), rectangle(-1, 1, -2.3, -1.8)]


# --- cases ---


def rests(mode, ids, fixed, size, seconds=2.0, **options):
    """(largest movement over the size, error of the vertical reaction over the weight) after some seconds; the engines run."""
    begin = places(ids)
    start(mode, **options)
    run(seconds)
    return np.linalg.norm(places(ids) - begin, axis=1).max() / size, reaction(fixed)[2] / weight(ids) - 1


def at_rest(*give):
    """give: allowed movement with compliant joints, where they run the case."""
    return [("moves, of the size", 0.0, (STILL, STILL, *give)), ("vertical reaction over the weight, less 1", 0.0, (1e-3, 1e-3, *(1e-3 for _ in give)))]


def between(least, most, ways=2):
    """The middle of two bounds, and what may be allowed around it."""
    middle, half = (least + most) / 2, (most - least) / 2
    return middle, (half / middle,) * ways


def opened(vertices, share):
    """The corners (n, 3) of a stone of a dome whose beds are `share` shorter along the ring, in their planes: its neighbours in the ring are as much away."""
    middle = math.atan2(*vertices.mean(axis=0)[1::-1])
    radial, ring = np.array([math.cos(middle), math.sin(middle), 0]), np.array([-math.sin(middle), math.cos(middle), 0])
    return np.outer(vertices @ radial, radial) + np.outer(vertices @ ring * (1 - share), ring) + vertices * (0, 0, 1)


def a23_dome():
    """Half a sphere of 6 rings of 12 stones and a closing stone, radius 2 m: least thickness, and at rest with t/R 0.1. Stones that meet along an edge, across
    a ring and a meridian, pull each other along the ring by friction. With forces there statics allow any thickness from a friction coefficient of 0.147
    on, so that the least thickness without slip is measured with meridian joints that are open by 1e-4 of their stones, where no such edges touch."""
    courses, stones, radius = 6, 12, 2.0

    def scene(thickness, friction, share=0.0):
        O.reset()
        base, material = dem.base((6, 6, 0.5), stone(friction)), stone(friction)
        ids = dem.dome(radius, thickness * radius, courses, stones, material, on=base)
        if share:
            shapes = [opened(dem.geometry(id).vertices, share) for id in ids[:courses * stones]] + [dem.geometry(ids[-1]).vertices]
            O.reset()
            material = stone(friction)
            base, ids = dem.base((6, 6, 0.5), material), [dem.convex(vertices, material) for vertices in shapes]
        return base, ids

    right = domes.least_thickness(courses, stones, 0.5)
    assert not domes.Dome(0.99 * right, courses, stones).stands(5.0) and domes.Dome(0.1 * right, courses, stones).stands(0.15, edges=True)

    def stands(mode, thickness, *given):
        _, ids = scene(thickness, *given)
        begin = places(ids)
        start(mode)
        for _ in range(8):
            run(0.5)
            if np.linalg.norm(places(ids) - begin, axis=1).max() > 1e-2 * radius:
                return False
        return True

    def least(mode, *given):
        low, high = 0.97 * right, 1.03 * right
        while high - low > 2e-3 * right:
            middle = (low + high) / 2
            low, high = (low, middle) if stands(mode, middle, *given) else (middle, high)
        return ((low + high) / 2,)

    yield from rows("a23", lambda mode: least(mode, 0.5), [("dome of 6 x 12 stones, mu 0.5: least t/R", right, (0.01, 0.01))], IN_WALL)
    yield from rows("a23", lambda mode: least(mode, 5.0, 1e-4), [("no slip, meridian joints open by 1e-4: least t/R", right, (0.01, 0.01))], IN_WALL)

    def rest(mode):
        base, ids = scene(0.1, 0.7)
        found = rests(mode, ids, [base], radius)
        table = dem.reactions(base)
        radial = places(table["id"].tolist())[:, :2]
        inwards = (table["force"][:, :2] * radial).sum(axis=1) / np.linalg.norm(radial, axis=1)
        return *found, -inwards.sum() / weight(ids)

    middle, allowed = between(*domes.Dome(0.1, courses, stones).thrust(0.7), 3)
    wanted = [*at_rest(GIVE), ("sum of the outward thrusts over the weight lies between the bounds", middle, allowed)]
    yield from rows("a23", rest, [(f"dome at rest, t/R 0.1: {what}", *given) for what, *given in wanted], IN_WALL)


def a24_wall_above_arch():
    blocks, ground = wall_above_arch()
    structure = statics.assembly(blocks, ground)
    left = [k for k, (first, _, a, _) in enumerate(structure.joints) if first is None and a[0] < 0]
    least, _ = statics.thrust(structure, 0.7, left)  # without an upper bound: the spandrels are between abutments

    def measure(mode):
        ids, fixed = build(blocks, ground, 0.7)
        found = rests(mode, ids, fixed, 8.0)
        return *found, least * weight(ids) / reaction([id for id in fixed if O.bodies[id].state.pos[0] < 0])[0]

    wanted = [*at_rest(GIVE), (f"least H/W of statics, {least:.4f}, over the one found: 0 to 1", 0.5, (1.0,) * 3)]
    yield from rows("a24", measure, [(f"wall above an arch: {what}", *given) for what, *given in wanted])


def _multiplier(case, name, layout):
    blocks, ground = layout()
    right = statics.multiplier(statics.assembly(blocks, ground), 0.7)

    def rest(mode):
        return rests(mode, *build(blocks, ground, 0.7), 4.0)

    def multiplier(mode):
        build(blocks, ground, 0.7)
        return (collapse(mode),)

    yield from rows(case, rest, [(f"{name}: {what}", *given) for what, *given in at_rest(GIVE)])
    yield from rows(case, multiplier, [(f"{name}: multiplier, mu 0.7", right, (0.01, 0.01))])


def a25_arch_on_piers():
    yield from _multiplier("a25", "arch on two piers", arch_on_piers)


def a26_two_arches():
    yield from _multiplier("a26", "two arches on a pier", two_arches)


def a27_vault():
    """A barrel vault in running bond, half a circle of 32 courses, t/R 0.15, of 2,000 stones: 10 s at rest, and a second of a record whose peak is 0.8 of the
    multiplier of its section, so that it stands still on its base."""
    radius, thickness, voussoirs, along = 2.0, 0.15, 32, 62
    structure = statics.arch(voussoirs, thickness)
    multiplier = statics.multiplier(structure, 0.7)
    middle, allowed = between(*statics.thrust(structure, 0.7))

    def measure(mode):
        O.reset()
        base = dem.base((6, 26, 0.5), stone(0.7))
        ids = dem.barrel_vault(2 * radius, radius, thickness * radius, voussoirs, 24.8, along, stone(0.7), on=base, measured="middle")
        record = artificial_record(1, 0.8 * multiplier * G, duration=1.0)
        motion = dem.RecordMotionEngine(ids=[base], samples=[0.0] * round(10 / record.dt) + list(record.samples), interval=record.dt, direction=(1, 0, 0))
        begin, at = places(ids), np.array(O.bodies[base].state.pos)
        start(mode, motion=motion, dt=1e-3)
        run(10)
        rest, force = np.linalg.norm(places(ids) - begin, axis=1).max(), reaction([base])[2] / weight(ids) - 1
        sides = dem.reactions(base)
        thrust = -sum(force[0] for id, force in zip(sides["id"].tolist(), sides["force"]) if O.bodies[id].state.pos[0] < 0) / weight(ids)
        run(1)
        shaken = np.linalg.norm(places(ids) - begin - (np.array(O.bodies[base].state.pos) - at), axis=1).max()
        return rest / (2 * radius), force, abs(thrust), shaken / (2 * radius)

    wanted = [*at_rest(), ("H/W lies between the bounds", middle, allowed), ("after a record of 0.8 of its multiplier: moves, of the size", 0.0, (STILL, STILL))]
    yield from rows("a27", measure, [(f"vault of 2,000: {what}", *given) for what, *given in wanted], IN_WALL)


IN_SECONDS = [a23_dome, a24_wall_above_arch, a25_arch_on_piers, a26_two_arches]  # which the tests have, too
CASES = [*IN_SECONDS, a27_vault]
