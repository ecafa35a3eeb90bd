"""Running bond in runs of any length: where the head joints of a course lie. Geometry alone, no YADE; lengths in m."""

from bisect import bisect_left
from dataclasses import dataclass
from functools import lru_cache

# Share of a block by which lengths may miss a bound: round-off.
ROUND_OFF = 1e-9
_FAR = float("inf")
# The search minimises these costs, in pieces of a course: a piece beside its own one, a joint that laps by nothing, a joint that laps by less than a quarter.
_HALF, _CUT, _SHORT, _INSIDE, _LAP, _LITTLE = 0.25, 0.5, 0.5, 0.3, 0.4, 1.0


@dataclass(frozen=True)
class Bond:
    """What the pieces of a course must be.

    longest     length of a whole block
    lap         least distance of a joint from those of the courses above and below
    shortest    length of the shortest piece"""

    longest: float
    lap: float
    shortest: float


def joints_of_run(start, end, bond, below=(), above=()):
    """The joints of a run from `start` to `end`, both included, or None where no joints keep the lap.

    below    joints of the course below; above: joints that the course above must have, at junctions and lintels

    The run with the least cost is found by dynamic programming over candidate places, which are quarters of a block from either end and from the joints below: few
    pieces, whole ones before halves, halves before others, cut ones at the ends, and laps of half a block before shorter ones."""
    scale = ROUND_OFF * bond.longest
    near = [tuple(sorted(round((place - start) / scale) for place in places if start - bond.longest < place < end + bond.longest)) for places in (below, above)]
    found = _joints(round((end - start) / scale), *near, round(bond.longest / scale), round(bond.lap / scale), round(bond.shortest / scale))
    return None if found is None else [start, *(start + place * scale for place in found), end]


@lru_cache(maxsize=4096)
def _joints(length, below, above, longest, lap, shortest):
    """The inner joints of a run from 0, in billionths of a block."""
    if length < shortest - 2:
        return None
    avoided = sorted({*below, *above})
    places = _candidates(length, below, above, longest, lap)
    places = [place for place in places if shortest - 2 <= place <= length - shortest + 2 and _distance(place, avoided) >= lap - 2]
    places = [0, *places, length]
    cost, before, first = [0.0] + [_FAR] * (len(places) - 1), [0] * len(places), 0
    for k in range(1, len(places)):
        while places[k] - places[first] > longest + 2:
            first += 1
        place, last = places[k], k == len(places) - 1
        joint = 0 if last else _LAP * (1 - min(2 * _distance(place, below) / longest, 1)) + (_LITTLE if _distance(place, avoided) < longest / 4 - 2 else 0)
        least = _FAR
        for j in range(first, k):
            if cost[j] + 1 < least and place - places[j] >= shortest - 2:
                total = cost[j] + _cost(place - places[j], longest, inside=0 < j and not last)
                if total < least - 1e-9:
                    least, before[k] = total, j
        cost[k] = least + joint
    if cost[-1] == _FAR:
        return None
    found, k = [], before[-1]
    while k > 0:
        found.append(places[k])
        k = before[k]
    return found[::-1]


def _cost(piece, longest, inside):
    if abs(piece - longest) <= 2:
        return 1
    cut = 1 + (_INSIDE if inside else 0)
    if abs(piece - longest / 2) <= 2:
        return cut + _HALF
    return cut + _CUT + (_SHORT if piece < longest / 2 else 0)


def _candidates(length, below, above, longest, lap):
    quarter = longest / 4
    count = int(length / quarter) + 1
    places = {round(k * quarter) for k in range(1, count)} | {round(length - k * quarter) for k in range(1, count)}
    for joint in below:
        places |= {joint + round(k * quarter) for k in (-2, -1, 1, 2)} | {joint - lap, joint + lap}
    for joint in above:
        places |= {joint - lap, joint + lap} | {joint + round(k * quarter) for k in (-2, -1, 1, 2)}
    kept = []
    for place in sorted(place for place in places if 0 < place < length):
        if not kept or place - kept[-1] > 2:
            kept.append(place)
    return kept


def _distance(place, joints):
    """From the nearest of the joints, which increase."""
    k = bisect_left(joints, place)
    return min(joints[k] - place if k < len(joints) else _FAR, place - joints[k - 1] if k else _FAR)
