"""Quasi-static tilting of rigid blocks: the multiplier of their weight at which they collapse, and how."""

import contextlib
import io
import math

import numpy as np
from masonry._boxes import bounds, face_gaps
from masonry._given import finite_numbers, number_given, positive_given, shown
from masonry._polyhedra import gaps
from masonry._pose import axes_of
from masonry._progress import wanted
from masonry.dem.bodies import blocks, geometry, poses, reach, shapes_of, world_shape
from masonry.dem.collapse import Collapse, Trial
from masonry.dem.describing import about
from masonry.dem.engines import METHODS, engines
from masonry.dem.joint_engine import joint_engine
from masonry.dem.loads import load_engines
from masonry.dem.mechanism import Mechanism
from masonry.dem.mortar import damage
from masonry.dem.stiffness import has_stiffness
from masonry.dem.tilting_ties import TiltedTies
from tqdm import tqdm
from yade import O, Vector3

_DIRECTIONS = {"x": (1, 0, 0), "-x": (-1, 0, 0), "y": (0, 1, 0), "-y": (0, -1, 0)}
# Time step of a trial relative to sqrt(R/g) of the smallest block. Blocks that stand still or begin to move ask for no small one.
_STEP = 0.02
# Residual of the contact laws of a step: with 'wall' the least that it takes, so that rests are told from slow movements.
_TOLERANCES = {"localised": 1e-9, "wall": 1e-6}
# Impacts found inside a step; later ones close at its end, plastically. They do not matter where collapse begins, and cost most.
_EVENTS = 1
# Steps between two looks at the blocks.
_LOOK = 5
# Speed of blocks at rest relative to what gravity gives since the load was put on: a multiplier above the critical one by this is taken for it.
_REST = 1e-6
# Blocks that have been at rest for two looks stay so: their state has not changed, nor have the loads. Blocks that have moved, for this
# share of the hold: they may be turning back.
_QUIET = 0.1
# Looks in a row at which blocks gain speed in proportion to the time, but for this share, that tell of collapse.
_STEADY, _SLACK = 3, 0.1
# Blocks that move off under a constant load move with the square of the time: steps may be this share of it.
_SHARE_OF_TIME = 0.05
# A trial is held longer, at most this many times, while blocks move and slow down.
_LONGEST = 5
# Largest stair of the multiplier, relative to it. Far above collapse all blocks move at once, which costs up to a hundred times more than a
# rest does.
_GROWTH = 0.1
# A stair whose contact laws the solver misses is taken by halves; the next ones grow again by this factor.
_RECOVERY = 1.25
# Larger multipliers are not tried; the time step would be too large for them.
_MOST = 30
# Movement of a block, relative to what is collapse, from which on blocks that come to rest have not stood. They rest only if they lean on one
# that they did not touch in the scene as built: their gap was more than a share of the smallest size.
_SETTLED, _GAP = 0.01, 1e-7
# Largest damage from which a joint counts as cracked, as in dem.damage().
_CRACKED = 0.02
# Blocks on ties may rest beyond `share`: movement, relative to it, from which on they are taken not to.
_BEYOND = 2


def _direction_given(direction):
    """The unit vector of a direction in plan."""
    if isinstance(direction, str):
        if direction not in _DIRECTIONS:
            raise ValueError(f"direction = {shown(direction)}: must be one of {', '.join(map(repr, _DIRECTIONS))}, or (dx, dy)")
        return Vector3(_DIRECTIONS[direction])
    x, y = finite_numbers("direction", direction, 2, "two finite numbers (dx, dy) in plan, not both 0, or 'x', '-x', 'y' or '-y'")
    if not math.hypot(x, y) > 0:
        raise ValueError(f"direction = {shown(direction)}: must be (dx, dy) in plan, not both 0")
    return Vector3(x, y, 0) / math.hypot(x, y)


def _check_multiplier(multiplier):
    if multiplier > _MOST:
        raise ValueError(f"the blocks stand at any multiplier up to {_MOST:g}: they are held on all sides")


def _cracked():
    """How many joints with mortar have cracked."""
    return np.count_nonzero(damage()["worst"] >= _CRACKED)


class TiltTable:
    """Finds the multiplier of the weight, acting sideways, at which the free blocks of the scene collapse.

    direction    where the blocks are pulled: 'x', '-x', 'y' or '-y', or (dx, dy) in plan, of any length
    load         'force': a horizontal body force, multiplier times the weight, is added to gravity. 'turned': gravity keeps its size and is
                 turned by the arc tangent of the multiplier, as on a tilting table. Dead loads (dem.dead_load) are pulled or turned as the weights are
    model        'auto', 'planar' or 'spatial', as in dem.engines()
    hold         how long a multiplier is held while blocks move, in sqrt(height / gravity) of the scene; a tenth of it where they rest
    share        movement of a block, relative to the smallest size of any, that is collapse: more than the gaps
                 that the joints may close, and little, since blocks that fall apart take long. Blocks that move less rest if
                 they come to lean on one that they did not touch as built; Collapse.remarks says how far they have gone
    gravity      m/s^2
    method       'wall' ('auto': the same) or 'localised', as in dem.engines(). 'wall' steps structures of few blocks as walls too, so that its
                 answer does not depend on their order; 'localised' may find multipliers that are up to 10 % larger, with a wall and its
                 mirror image at different ones

    A trial starts from rest and ends when a block has moved by `share`; collapse is also when blocks still gain speed at the end of the
    hold. Rigid blocks that carry a load do not move at all, and have no spring to overshoot, so a stair of the load is put on at once: with
    bisect() upon the largest load that the blocks have stood, with the forces in their joints that it has left, since with friction these
    depend on what came before. Of its trials that collapse only the first and the last move the blocks by `share`; the others end when
    these gain speed steadily. Restitution hardly matters, but 0 is fastest. Afterwards the blocks are put back, at rest, with O.time 0; O.engines and O.dt
    are left as in the last trial.

    With friction the multiplier need not be unique: Coulomb's law may allow a load both to be carried and to move the blocks. In walls with level beds
    'wall' finds the load that moves blocks which have stood a smaller one, as compliant joints do, and 'localised' may carry more. Where blocks wedge between
    inclined faces it is the other way round: 'wall' carries the largest load that friction can balance, in a V groove 5 % more than 'localised'
    (validation/convex, case a12). Neither method is safe by itself: where the two differ, the multiplier is indeterminate; trust the smaller one.

    The bar shows the multiplier of the last trial and its verdict:
        rest        the blocks stand, and the load grows from here
        collapse    a block has moved by `share`, or blocks gain speed steadily
        jammed      blocks moved, and stopped in joints that were closed as built: taken for collapse, since friction alone stops them
        stretched   blocks rest on ties, but farther than `share` from where they were built: taken for collapse, and named in `doubts`
        unclear     blocks still moved, slowing down, when five times `hold` had passed: taken for collapse, and named in `doubts`
        missed      a step missed the contact laws: half the stair is tried, unless it is down to the tolerance
    Ties (dem.tie) stretch. A tie breaks where the blocks rest and it bears more than its strength, the most overloaded one first, and the trial goes on without it.
    Blocks are stopped where they are fastest (kinetic damping), so that no vibration adds to the force of a tie. The stretch counts as movement: `share` must be
    larger than it. Afterwards the ties are as built. ramp() refuses scenes with ties.
    Blocks with mortar (BlockMat(mortar=), dem.wall(split=)) need method='wall'. Their joints are bonded under gravity alone and keep what a load that they stand has
    cracked; Collapse.remarks says so.
    Steps that miss the contact laws are counted in the trials, without a warning; of each step it seeks one impact (mostEvents = 1), since what follows where
    blocks begin to move does not matter. Whether the multiplier can be trusted stands in Collapse.doubts.
    """

    def __init__(self, direction="x", load="force", model="auto", hold=3.0, share=2e-3, gravity=9.81, method="auto"):
        self._towards = _direction_given(direction)
        if load not in ("force", "turned"):
            raise ValueError(f"load = {shown(load)}: must be 'force' or 'turned'")
        if model not in ("auto", "planar", "spatial"):
            raise ValueError(f"model = {shown(model)}: must be 'auto', 'planar' or 'spatial'")
        if method not in METHODS:
            raise ValueError(f"method = {shown(method)}: must be one of {', '.join(METHODS)}")
        for name, value in (("hold", hold), ("share", share), ("gravity", gravity)):
            positive_given(name, value)
        self.direction, self.load, self.model, self.share, self.gravity = direction, load, model, share, gravity
        self._blocks = blocks()
        self._free = [b for b in self._blocks if b.dynamic]
        if not self._free:
            raise ValueError("there is no free block in O.bodies: add one with dem.block() before dem.TiltTable()")
        before = joint_engine()
        if getattr(before, "bondsAsked", None) or O.iter > 0 and getattr(before, "bondedIds", None):
            raise ValueError("O.engines have joints that have been bonded in this run: TiltTable makes engines of its own, and begins with the mortar of "
                             "BlockMat(mortar=) and of dem.wall(split=) before its first step")
        if model == "auto" and any(has_stiffness(b.mat) for b in self._blocks):
            raise ValueError("model = 'auto': must be 'planar' or 'spatial' where a BlockMat has a joint stiffness: TiltTable is for rigid blocks")
        self._ties = TiltedTies()
        self._start = [(b.state.pos, b.state.ori) for b in self._blocks]
        self._loads = [(engine, Vector3(engine.force)) for engine in load_engines()]
        self._as_built, self._row = poses(self._blocks), {b.id: k for k, b in enumerate(self._blocks)}
        self._shapes, _ = shapes_of(self._blocks)
        self._free_start = [start for b, start in zip(self._blocks, self._start) if b.dynamic]
        _, sizes, _ = free = geometry(self._free)
        low, high = bounds(*free)
        self._size, self._reach = sizes.min(), np.linalg.norm(sizes, axis=1) / 2
        if self._shapes is not None:
            low = high = np.concatenate([world_shape(b)[0] for b in self._free])
            self._reach = np.array([reach(b) for b in self._free])
        self._unit = math.sqrt((high[:, 2].max() - low[:, 2].min()) / gravity)
        self._hold = hold * self._unit
        self._dt = _STEP * math.sqrt(self._reach.min() / gravity)
        self._model, self._method = model, "wall" if method == "auto" else method
        if model == "auto":
            self._model = self._begin(1.0).choice().split(":")[0]  # of the pulled blocks, not of those that only stand
        self._joints = self._find_joints()

    # --- the two ways to the multiplier ---

    def bisect(self, tolerance=1e-3, lower=0.1, progress=None):
        """The Collapse within `tolerance` of its multiplier. lower: the first that is tried, which grows by a tenth until the blocks
        collapse; the nearer below, the faster."""
        if not 0 < number_given("tolerance", tolerance) < 1:
            raise ValueError(f"tolerance = {tolerance}: must be above 0 and below 1")
        if not 0 < number_given("lower", lower) < _MOST:
            raise ValueError(f"lower = {lower}: must be above 0 and below {_MOST}")
        trials, rest, mechanism, cracked, broken = [], None, None, [], []

        def hold(multiplier, **ends):
            nonlocal rest, mechanism
            with self._ties.loaded():
                trials.append(self._hold_load(integrator, multiplier, **ends))
            verdict = trials[-1].verdict
            if verdict == "rest":
                rest = self._keep(integrator)
                if count := _cracked():
                    cracked.append((multiplier, count))
                if count := self._ties.broken():
                    broken.append((multiplier, count))
            elif rest:
                mechanism = self._mechanism(rest)
                self._go_back(integrator, rest)
            bar.set_postfix_str(f"{multiplier:.5g} {verdict}")
            bar.update()
            return verdict

        with self._trials("trial", progress) as bar:
            integrator = self._begin(0.0)
            if hold(0.0, settles=True) != "rest":
                raise ValueError("the blocks do not stand without a sideways load: check supports and friction")
            low, high, growth, careful, sure = 0.0, math.inf, _GROWTH, bool(self._ties), False  # blocks that stretch a tie gain speed first
            while not sure:
                while math.isinf(high) or high - low > tolerance * high:
                    height = low or lower / _GROWTH
                    stair = min(growth * height, (high - low) / 2)
                    tried = low + stair
                    _check_multiplier(tried)
                    early = math.isfinite(high) and not careful
                    verdict = hold(tried, early=early, again=stair > tolerance * tried)
                    if verdict == "rest":
                        low, growth = tried, min(_RECOVERY * growth, _GROWTH)
                    elif verdict == "missed":
                        growth = stair / height / 2
                    else:
                        high, sure = tried, not early and not (self._ties and stair > tolerance * tried)
                if not sure and hold(high) == "rest":  # they moved off, and came to rest
                    low, high, careful = high, math.inf, True
                    growth = tolerance if self._ties else growth
                else:
                    sure = True
        return self._collapse((low + high) / 2, (low, high), trials, mechanism, cracked, broken)

    def ramp(self, rate=0.02, start=0.0, progress=None):
        """The Collapse of a multiplier that grows slowly. rate: per sqrt(height / gravity) of the scene. The bracket is from where the
        blocks last rested to where one had moved by `share`; the multiplier is its lower end: what follows is delay."""
        if self._ties:
            raise ValueError("ramp() is not for scenes with ties (dem.tie), which stretch while the load grows, so that blocks never rest: use bisect()")
        positive_given("rate", rate)
        if not 0 <= number_given("start", start) < _MOST:
            raise ValueError(f"start = {start}: must be from 0 to below {_MOST}")
        multiplier, rested, rest = start, None, None
        with self._trials("stair", progress) as bar:
            integrator = self._begin(start)
            while self._moved() <= self.share * self._size:
                multiplier = start + rate * O.time / self._unit
                _check_multiplier(multiplier)
                self._pull(integrator, multiplier)
                for _ in range(_LOOK):
                    O.step()
                if self._speed() <= _REST * self.gravity * self._unit and (rested is None or not self._is_jammed(last)):
                    rested, last, rest = multiplier, self._places(), self._keep(integrator)
                bar.set_postfix_str(f"{multiplier:.5g}")
                bar.update()
            trial, mechanism = Trial(multiplier, "collapse", self._moved(), O.time, integrator.failures), self._mechanism(rest)
        if rested is None:
            raise ValueError(f"start = {start}: the blocks do not stand under it: must be below the multiplier of collapse")
        result = self._collapse(rested, (rested, multiplier), [trial], mechanism)
        if rested < multiplier / 2:
            result.doubts.append("the load has more than doubled since the blocks rested: a smaller rate tells what they stand")
        return result

    def trial(self, multiplier):
        """Holds one multiplier, of 30 at most in size, from rest. The scene is left as it is at the end."""
        if not abs(number_given("multiplier", multiplier)) <= _MOST:
            raise ValueError(f"multiplier = {multiplier}: must be from -{_MOST} to {_MOST}")
        integrator = self._begin(multiplier)
        with self._ties.loaded():
            return self._hold_load(integrator, multiplier)

    # --- a trial ---

    def _hold_load(self, integrator, multiplier, early=False, again=False, settles=False):
        """The Trial of a multiplier from the present state. early: it ends when the blocks gain speed steadily; again: when the solver
        misses the contact laws, to be tried again with a smaller stair; settles: blocks that move and rest in their own joints are no jam."""
        self._pull(integrator, multiplier)
        O.resetTime()
        O.dt = self._dt
        before, verdict, fastest, pace, moving, steady, quiet = integrator.failures, "", 0.0, 0.0, 0.0, 0, 0
        start = self._places()
        while not verdict:
            for _ in range(_LOOK):
                if self._ties:
                    self._ties.brake(self._free, self._speed())
                O.step()  # in this thread: O.run(n, True) looks every 40 ms only whether it has ended
                if again and integrator.failures > before:
                    return Trial(multiplier, "missed", self._moved(), O.time, integrator.failures - before)
            speed = self._speed()
            last, pace = pace, speed / O.time
            if pace > _REST * self.gravity:
                moving, quiet = O.time, 0
                steady = steady + 1 if pace >= (1 - _SLACK) * last else 0
                O.dt = min(max(self._dt, _SHARE_OF_TIME * O.time), integrator.largestTimeStep)
            else:
                steady, quiet = 0, quiet + 1
            moved = self._moved() / (self.share * self._size)
            if moved > (_BEYOND if self._ties else 1) or (early and steady >= _STEADY):
                verdict = "collapse"
            elif quiet >= 2 and (not moving or O.time >= moving + _QUIET * self._hold):
                if self._ties.break_worst():
                    moving, quiet = O.time, 0
                elif moved > 1:
                    verdict = "stretched"
                else:
                    verdict = "jammed" if not settles and self._is_jammed(start) else "rest"
            elif O.time >= self._hold and not quiet:
                if speed >= fastest:
                    verdict = "collapse"
                elif O.time >= _LONGEST * self._hold:
                    verdict = "unclear"
            fastest = max(fastest, speed)
        return Trial(multiplier, verdict, self._moved(), O.time, integrator.failures - before)

    def _keep(self, integrator):
        """A rest, to go back to and to tell the mechanism from: what the integrator remembers, the blocks' states, and the joints."""
        return integrator.remembered, [(b.state.pos, b.state.ori, Vector3(b.state.vel), Vector3(b.state.angVel)) for b in self._blocks], self._closed()

    def _go_back(self, integrator, rest):
        integrator.remembered, states, _ = rest
        for body, (pos, ori, vel, spin) in zip(self._blocks, states):
            if body.dynamic:
                body.state.pos, body.state.ori, body.state.vel, body.state.angVel = pos, ori, vel, spin

    @contextlib.contextmanager
    def _trials(self, unit, shown):
        """The progress bar; at the end, whatever it was, the scene is put back."""
        try:
            with tqdm(desc="TiltTable", unit=unit, disable=not wanted(shown)) as bar:
                yield bar
        finally:
            self._put_back()

    def _put_back(self):
        O.interactions.clear()
        O.resetTime()
        self._ties.put_back()
        for body, (pos, ori) in zip(self._blocks, self._start):
            body.state.pos, body.state.ori = pos, ori
            body.state.vel = body.state.angVel = body.state.angMom = Vector3.Zero
        for engine, force in self._loads:
            engine.force = force

    def _begin(self, multiplier):
        self._put_back()
        with contextlib.redirect_stdout(io.StringIO()):
            O.engines = engines(model=self._model, method=self._method, tolerance=_TOLERANCES[self._method], dt=self._dt, gravity=self.gravity)
        integrator = O.engines[-1]
        integrator.wallsOnly = True  # structures of few blocks too
        integrator.mostEvents, integrator.onTrouble = _EVENTS, "count"
        integrator.along = self._towards  # the plane, before there is a pull
        self._pull(integrator, multiplier)
        return integrator

    def _pull(self, integrator, multiplier):
        pull = self._towards * multiplier - Vector3.UnitZ
        pull = pull.normalized() if self.load == "turned" else pull
        integrator.gravity = self.gravity * pull
        for engine, force in self._loads:
            engine.force = pull * force.norm()

    def _speed(self):
        return max(b.state.vel.norm() + r * b.state.angVel.norm() for b, r in zip(self._free, self._reach))

    def _moved(self, start=None):
        """How far the farthest moved corner can have gone since `start`, without it since the scene was built, m."""
        return max((b.state.pos - pos).norm() + reach * (b.state.ori * ori.conjugate()).toAxisAngle()[1]
                   for b, (pos, ori), reach in zip(self._free, start or self._free_start, self._reach))

    def _places(self):
        return [(b.state.pos, b.state.ori) for b in self._free]

    def _settled(self):
        return _SETTLED * self.share * self._size

    def _is_jammed(self, start):
        """Whether blocks that rest have moved since `start`, and neither lean on one that they had not touched before nor hang on a tie that has stretched. Friction
        allows such a rest: a smaller load has moved them, or would if they were pushed."""
        if self._moved(start) <= self._settled() or self._ties.hold_more(_GAP * self._size):
            return False
        pressed = [(self._row[i.id1], self._row[i.id2]) for i in O.interactions if any(force.norm() > 0 for force in i.phys.forces)]
        return not pressed or self._gaps_as_built(np.array(pressed)).max() <= _GAP * self._size

    def _gaps_as_built(self, pairs):
        centers, sizes, quaternions = self._as_built
        if self._shapes is not None:
            return gaps(self._shapes, centers, quaternions, pairs)
        return face_gaps(*pairs.T, centers, sizes, axes_of(quaternions))

    # --- what is reported ---

    def _closed(self):
        """(id1, id2, normal from 1 to 2, points) of the joints that are closed now."""
        return [(i.id1, i.id2, np.array(i.geom.normal), np.array([tuple(p) for p in i.geom.points])) for i in O.interactions]

    def _find_joints(self):
        """The joints that are closed at the start."""
        self._begin(0.0)
        O.step()
        found = self._closed()
        self._put_back()
        return found

    def _mechanism(self, rest=None):
        """What moves from a rest, or from the start: blocks that have closed a gap below collapse need not take part in it."""
        start, joints = ([state[:2] for state in rest[1]], rest[2]) if rest else (self._start, self._joints)
        return Mechanism(self._blocks, start, joints, 1 if abs(self._towards[1]) > abs(self._towards[0]) else 0)

    def _collapse(self, multiplier, bracket, trials, mechanism, cracked=(), broken=()):
        failures = sum(t.failures for t in trials if t.multiplier in bracket)
        other = "localised" if self._method == "wall" else "wall"
        doubts = [f"the integrator missed its tolerance or left out impacts in {failures} steps of the trials that decide: compare with "
                  f"TiltTable(method={other!r})"] if failures else []
        unclear = [f"{t.multiplier:.5g}" for t in trials if t.verdict == "unclear"]
        if unclear:
            doubts.append(f"blocks still moved, slowing down, when the trials of {', '.join(unclear)} were ended; taken for collapse: a larger hold decides them")
        if any(t.verdict == "stretched" and t.multiplier in bracket for t in trials):
            doubts.append(f"at {bracket[1]:.5g} blocks rest on ties that have stretched, farther than {1e3 * self.share * self._size:.2g} mm (share) from where they were built; taken for "
                          "collapse: a larger share lets the ties stretch")
        return Collapse(multiplier, bracket, trials, mechanism.joints(), mechanism.moving(), doubts, self._remarks(trials, bracket, cracked, broken), mechanism,
                        self._about())

    def _about(self):
        direction = self.direction if isinstance(self.direction, str) else f"({self._towards[0]:.4g}, {self._towards[1]:.4g})"
        return {**about([b.id for b in self._blocks], []), "pull": f"towards {direction}, {'a body force' if self.load == 'force' else 'by gravity that turns'}"}

    def _remarks(self, trials, bracket, cracked, broken):
        moved = [t for t in trials if t.verdict == "rest" and t.moved > self._settled()]
        jammed = [t for t in trials if t.verdict == "jammed" and t.multiplier in bracket]
        remarks = []
        if moved:
            where = "on ties that stretch, or against others that they did not touch" if self._ties else "against others that they did not touch"
            remarks.append(f"below it, from {moved[0].multiplier:.5g} on, blocks move by up to {1e3 * max(t.moved for t in moved):.2g} mm and come to rest "
                           f"{where}: less than {1e3 * self.share * self._size:.2g} mm (share) is no collapse")
        if jammed:
            remarks.append(f"at {jammed[-1].multiplier:.5g} blocks move by {1e3 * jammed[-1].moved:.2g} mm and jam in joints that were closed before: taken for collapse")
        if cracked:
            remarks.append(f"below it, from {cracked[0][0]:.5g} on, joints have cracked and the blocks stand: {cracked[-1][1]} at {cracked[-1][0]:.5g}")
        if broken:
            remarks.append(f"below it, from {broken[0][0]:.5g} on, ties have broken and the blocks stand: {broken[-1][1]} at {broken[-1][0]:.5g}")
        return remarks
