"""Prisms roll and rock about their edges without slip (a3 to a9).

Spins before and after a landing follow from the energies between landings: about its pivot, a block of moment of inertia I turns with
I spin^2/2 = kinetic + potential energy less the potential energy where it lands. Thus a method that lands at the end of a step is measured without its delay.
"""

import math
import os
from functools import partial

import numpy as np
from masonry import dem
from rows import BULLET, COMPLIANT, IN_SPACE, MODES, collapse, rows, start
from scipy.integrate import quad
from scipy.optimize import brentq
from yade import O, Quaternion, Vector3

G = 9.81
LANDED = 0.02  # share of the kinetic energy whose loss in one step is a landing
SLOW = 1e-3  # rad/s; a block that turns slower does not roll
TRAPEZOID = [(0, 0), (0.8, 0), (0.4, 2), (0, 2)]
TRIANGLE = [(0, 0), (0.8, 0), (0.4, 2)]
HEXAGON = [(0, 0), (0.5, 0), (0.75, 0.25 * math.sqrt(3)), (0.5, 0.5 * math.sqrt(3)), (0, 0.5 * math.sqrt(3)), (-0.25, 0.25 * math.sqrt(3))]  # on a side


# --- closed forms ---


class Section:
    """A polygon (n, 2) whose first side lies on the ground: its centre, its radius of gyration about it, and its two pivots, left and right."""

    def __init__(self, polygon):
        p, q = np.array(polygon, dtype=float), np.roll(polygon, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        area = cross.sum() / 2
        self.center = ((p + q) * cross[:, None]).sum(axis=0) / (6 * area)
        polar = (cross * (p * p + p * q + q * q).sum(axis=1)).sum() / (12 * area)  # mean of the squared distance from the origin
        self.gyration2 = polar - self.center @ self.center
        self.arms = [self.center - p[0], self.center - p[1]]  # from the pivots to the centre

    def natural(self, old, new):
        """Restitution of an impact in which the new pivot alone gets an impulse: its moment of momentum is kept."""
        a, b = self.arms[old], self.arms[new]
        return (self.gyration2 + a @ b) / (self.gyration2 + b @ b)

    def critical(self, pivot):
        """Tangent of the angle at which the centre is above the pivot."""
        return abs(self.arms[pivot][0]) / self.arms[pivot][1]

    def inertia(self, pivot):
        return self.gyration2 + self.arms[pivot] @ self.arms[pivot]  # m^2, per mass

    def height(self, pivot, angle):
        """Height of the centre when the block has turned by an angle about a pivot, m."""
        return math.hypot(*self.arms[pivot]) * math.cos(math.atan(self.critical(pivot)) - angle)

    def peak(self, pivot, spin):
        """Angle at which the block turns back after it has left the ground with a spin."""
        top = self.center[1] + self.inertia(pivot) * spin**2 / (2 * G)
        return brentq(lambda angle: self.height(pivot, angle) - top, 0, math.atan(self.critical(pivot)))

    def spin(self, pivot, peak):
        return math.sqrt(2 * G * (self.height(pivot, peak) - self.center[1]) / self.inertia(pivot))

    def fall(self, pivot, peak):
        """Time from rest at an angle to the landing, s; angle = peak (1 - s^2) takes the root out of the integral."""

        def share(s):
            drop = self.height(pivot, peak) - self.height(pivot, peak * (1 - s * s))
            return 2 * peak * s / math.sqrt(2 * G * drop / self.inertia(pivot))

        return quad(share, 0, 1, epsabs=1e-12, epsrel=1e-12)[0]


def regular(n):
    """Square of the radius of gyration of a regular n-gon over that of its corners."""
    return (2 + math.cos(2 * math.pi / n)) / 6


def landing_of_ngon(n):
    """Natural restitution where a regular n-gon lands on its next side; negative: it stops."""
    return (regular(n) + math.cos(2 * math.pi / n)) / (regular(n) + 1)


def steady_hexagon(side, slope):
    """Spins before and after each landing of a hexagon that rolls down: between two, its centre falls by side sin(slope)."""
    c, inertia = landing_of_ngon(6), side**2 * (1 + regular(6))
    before = math.sqrt(2 * G * side * math.sin(slope) / inertia / (1 - c * c))
    return before, c * before


def least_slope(side=0.2):
    """On which the steady spin after a landing lifts the centre above the next pivot."""

    def surplus(slope):
        _, after = steady_hexagon(side, slope)
        return side**2 * (1 + regular(6)) * after**2 / 2 - G * side * (1 - math.cos(math.pi / 6 - slope))

    return brentq(surplus, math.radians(1), math.radians(20))


# --- scenes ---


def stone(restitution=math.nan):
    return dem.BlockMat(density=2000, noSlip=True, restitution=restitution)


def leaning(polygon, angle, restitution=math.nan):
    """A prism on a base, turned by an angle about its right pivot, or its left one where the angle is negative."""
    O.reset()
    material = stone(restitution)
    base = dem.base((8, 3, 0.2), material)
    body = O.bodies[dem.prism(polygon, 1.0, material, axis="y", on=base)]
    if angle:
        dem.tilt(body.id, angle)
    return body


def start_rolling(mode):
    """A landing of `wall` is late by up to a step, so that its deviations halve with the step: it takes a quarter here."""
    return start(mode, step=0.25 if mode[0] == "wall" else 1.0)


def energy(body, engine):
    """Per mass, m^2/s^2. Velocities of 'wall' and of compliant joints, whose engine has no method, belong to the middle of the step."""
    s, since = body.state, O.dt / 2 if getattr(engine, "method", "wall") == "wall" else 0
    return s.vel.squaredNorm() / 2 + s.inertia[1] / s.mass * s.angVel[1] ** 2 / 2 - engine.gravity.dot(s.pos - since * s.vel)


def settle():
    """A method that lands at the end of a step has landed with all corners by then."""
    for _ in range(3):
        O.step()


def first_landing(mode, polygon, angle):
    """Restitution of the first landing of a prism that is let go at an angle, natural."""
    section, body = Section(polygon), leaning(polygon, angle)
    old, new = (1, 0) if angle > 0 else (0, 1)
    engine = start_rolling(mode)
    O.step()
    before, flat = energy(body, engine), G * section.center[1]
    while energy(body, engine) > before - LANDED * (before - flat):
        O.step()
    settle()
    after = energy(body, engine)
    return math.sqrt(max(after - flat, 0) / section.inertia(new) / ((before - flat) / section.inertia(old)))


class Rolling:
    """A regular n-gon of circumradius R that rolls towards x, with gravity turned by a slope."""

    def __init__(self, mode, n, radius, slope, past, spin=0.0):
        O.reset()
        base = dem.base((60 * radius, 6 * radius, radius), stone())
        O.bodies[base].state.pos += Vector3(20 * radius, 0, 0)
        angles = 2 * math.pi * np.arange(n) / n - math.pi / 2  # one corner below
        polygon = radius * np.column_stack([np.cos(angles), np.sin(angles)])
        self.body = O.bodies[dem.prism(polygon.tolist(), 2 * radius, stone(), axis="y", center=(0, 0, radius))]
        forward = Quaternion(Vector3.UnitY, past)  # about the corner below, which is at the origin
        self.body.state.pos, self.body.state.ori = forward * self.body.state.pos, forward * self.body.state.ori
        self.n, self.radius, self.rolls, self.vertices = n, radius, False, list(self.body.shape.vertices)
        self.inertia, self.apothem = radius**2 * (regular(n) + 1), radius * math.cos(math.pi / n)
        arm = self.body.state.pos
        self.body.state.angVel, self.body.state.vel = Vector3(0, spin, 0), Vector3(0, spin, 0).cross(arm)
        self.engine = start_rolling(mode)
        self.engine.gravity = G * Vector3(math.sin(slope), 0, -math.cos(slope))

    def _pivot(self):
        """The corner about which it turns: the foremost of those that lie on the ground, or deeper in it where springs or a solver give way."""
        corners = np.array([self.body.state.pos + self.body.state.ori * v for v in self.vertices])
        low = corners[:, 2] < corners[:, 2].min() + 0.01 * self.radius * math.sin(math.pi / self.n)
        return self.vertices[np.where(low, corners[:, 0], -math.inf).argmax()]

    def _flat(self, pivot, side):
        """Potential energy per mass where the block lies on the side ahead (1) of a corner on which it stands, or behind it (-1)."""
        corner = self.body.state.pos + self.body.state.ori * pivot
        return -self.engine.gravity.dot(Vector3(corner[0] + side * self.radius * math.sin(math.pi / self.n), 0, self.apothem))

    def landing(self):
        """(spin before, spin after) of the next landing; (0, 0) where it comes to rest, or turns back, before."""
        O.step()
        known, now, lead, pivot = energy(self.body, self.engine), math.inf, 0.0, self._pivot()
        while now > known - LANDED * (known - lead):
            self.rolls |= self.body.state.angVel[1] > SLOW
            if self.rolls and self.body.state.angVel[1] < SLOW:
                return 0.0, 0.0
            lead = self._flat(pivot, 1)
            O.step()
            now = energy(self.body, self.engine)
        settle()
        left = energy(self.body, self.engine) - self._flat(self._pivot(), -1) if self.body.state.angVel[1] > SLOW else 0.0
        return math.sqrt(2 * (known - lead) / self.inertia), math.sqrt(2 * max(left, 0) / self.inertia)


# --- cases ---


def a3_ngons():
    """A regular prism falls from one corner on its next side."""

    def restitution(mode, n):
        before, after = Rolling(mode, n, 0.5, 0.0, past=0.02).landing()
        return [after / before]

    made = []
    for n in (3, 4, 5, 6, 24):
        made += rows("a3", partial(restitution, n=n), [(f"{n}-gon: restitution of a landing", max(landing_of_ngon(n), 0), (1e-5, 3e-3, 5e-4))], MODES + BULLET)
    return made


def decay(mode, landings):
    """Spins of a hexagon before each landing while it rocks on one side from 0.3 rad on, over that before the first: (landings + 1,), by the energies in the
    instants in which it turns back. Fewer where it comes to rest before."""
    section, body = Section(HEXAGON), leaning(HEXAGON, 0.3)
    engine = start_rolling(mode)
    O.step()
    energies, turns = [energy(body, engine)], body.state.angVel[1]
    while len(energies) <= landings and O.time < 10:
        O.step()
        if turns * body.state.angVel[1] < 0:
            energies.append(energy(body, engine))
        turns = body.state.angVel[1]
    heights = np.array(energies) - G * section.center[1]
    return np.sqrt(np.maximum(heights, 0) / heights[0])


def a3_hexagon_rocks():
    """Natural restitution C = 11/17 at each landing, and nothing else that takes energy: C^n after n of them."""
    many = 3

    def measure(mode):
        spins = decay(mode, many)
        return [spins[n] if n < len(spins) else 0.0 for n in (1, many)]

    c = Section(HEXAGON).natural(0, 1)
    return rows("a3", measure, [("hexagon rocks: spin after 1 landing, over the first", c, (1e-5, 3e-3, 5e-4)),
                                (f"after {many} landings", c**many, (1e-5, 9e-3, 2e-3))], MODES + BULLET)


def draw(folder):
    """Decay of the rocking hexagon: the closed form, the methods and, where it is there, Bullet."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    many, marks = 6, iter("s^vDxo")
    right = Section(HEXAGON).natural(0, 1) ** np.arange(many + 1)
    figure, (left, over) = pyplot.subplots(1, 2, figsize=(8.4, 3.6), layout="constrained")
    left.semilogy(right, "k-", label="closed form, (11/17)^n")
    over.axhline(1, color="k")
    for mode in [*IN_SPACE, *COMPLIANT, *BULLET]:
        spins, mark = decay(mode, many), next(marks)
        left.semilogy(spins, mark, fillstyle="none", label="Bullet's hulls" if mode in BULLET else mode[0])
        over.plot(spins / right[:len(spins)], mark + ":", fillstyle="none")
    left.set(xlabel="landings", ylabel="spin before the next landing, over the first")
    over.set(xlabel="landings", ylabel="the same over the closed form")
    left.legend(frameon=False)
    figure.savefig(os.path.join(folder, "decay.png"), dpi=110)


def a4_hexagon_rolls():
    """Spins when 20 landings have made the motion steady."""
    slope = math.radians(10)

    def spins(mode):
        roll = Rolling(mode, 6, 0.2, slope, past=0.1)
        for _ in range(20):
            spins = roll.landing()
        return spins

    before, after = steady_hexagon(0.2, slope)
    return rows("a4", spins, [("hexagon on 10 deg: spin before a landing, rad/s", before, (1e-5, 3e-3, 5e-4)), ("spin after it", after, (1e-5, 3e-3, 5e-4))], MODES + BULLET)


def a5_least_slope():
    """Bisection; a hexagon that has made 12 more landings rolls."""

    def rolls(mode, slope):
        spin = steady_hexagon(0.2, math.radians(8))[1]
        roll = Rolling(mode, 6, 0.2, slope, past=-math.pi / 6 + 1e-9, spin=spin)
        return all(roll.landing()[1] > 0 for _ in range(12))

    def least(mode):
        low, high = math.radians(6.3), math.radians(6.9)
        while high - low > math.radians(0.005):
            middle = (low + high) / 2
            low, high = (low, middle) if rolls(mode, middle) else (middle, high)
        return [math.degrees((low + high) / 2)]

    return rows("a5", least, [("hexagon: least slope on which it rolls on, deg", math.degrees(least_slope()), (1e-3, 5e-3, 5e-3))], MODES + BULLET)


def a7_trapezoid():
    """A right trapezoid, its upright side at A (left). Its two directions have different restitutions and critical angles."""
    section = Section(TRAPEZOID)
    assert np.allclose(section.center, (0.311111, 0.888889), atol=1e-6) and abs(section.gyration2 - 0.3575309) < 1e-7  # a6

    def measure(mode):
        found = [first_landing(mode, TRAPEZOID, angle) for angle in (-0.1, 0.1)]
        for direction in ("-x", "x"):
            leaning(TRAPEZOID, 0)
            found.append(math.atan(collapse(mode, direction)))
        return found

    angles = [math.atan(section.critical(pivot)) for pivot in (0, 1)]
    return rows("a7", measure, [
        ("trapezoid: natural restitution from A to B", section.natural(0, 1), (1e-5, 3e-3, 5e-4)), ("from B to A", section.natural(1, 0), (1e-5, 3e-3, 5e-4)),
        ("critical angle about A, rad", angles[0], (1e-3, 1e-3, 3e-3)), ("about B", angles[1], (1e-3, 1e-3, 3e-3))])


def a8_trapezoid_rocks():
    """Free rocking from 0.2 rad about B with restitution 0.7: four landings and the peaks between them."""
    section, restitution = Section(TRAPEZOID), 0.7
    times, spins, peaks, pivot, angle, now = [], [], [], 1, 0.2, 0.0
    for _ in range(4):
        now += section.fall(pivot, angle)
        times.append(now)
        spins.append(section.spin(pivot, angle))
        pivot = 1 - pivot
        angle = section.peak(pivot, restitution * spins[-1])
        now += section.fall(pivot, angle)
        peaks.append(angle)

    def measure(mode):
        body = leaning(TRAPEZOID, 0.2, restitution)
        start_rolling(mode)
        angles, landings = [], []
        while len(landings) < 5:
            O.step()
            angles.append((O.time, dem.angle(body.id)))
            landings = dem.impacts()
        table = np.array(angles)
        found = [np.abs(table[(table[:, 0] > a) & (table[:, 0] < b), 1]).max() for a, b in zip(landings["time"], landings["time"][1:4])]
        return [*landings["time"][:4], *landings["velocity"][:4], *found]

    wanted = [(f"trapezoid rocks: landing {k + 1}, s", t, (1e-5, 3e-3, 5e-4)) for k, t in enumerate(times)]
    wanted += [(f"spin before landing {k + 1}, rad/s", w, (1e-5, 3e-3, 5e-4)) for k, w in enumerate(spins)]
    wanted += [(f"peak after landing {k + 1}, rad", p, (1e-4, 5e-3, 2e-3)) for k, p in enumerate(peaks[:3])]
    return rows("a8", measure, wanted)


def a9_triangle():
    section = Section(TRIANGLE)

    def measure(mode):
        restitution = first_landing(mode, TRIANGLE, 0.1)
        leaning(TRIANGLE, 0)
        return restitution, math.atan(collapse(mode))

    return rows("a9", measure, [("triangle: natural restitution", section.natural(0, 1), (1e-5, 3e-3, 5e-4)),
                                ("critical angle, rad", math.atan(section.critical(1)), (1e-3, 1e-3, 3e-3))])


CASES = [a3_ngons, a3_hexagon_rocks, a4_hexagon_rolls, a5_least_slope, a7_trapezoid, a8_trapezoid_rocks, a9_triangle]
