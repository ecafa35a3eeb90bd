"""Push-over tests under displacement control: rigid platens push blocks, and the forces in their contacts are the force of the test."""

import math

import numpy as np
from masonry._files import check_csv, save_picture, written
from masonry._given import finite_numbers, is_whole, number_given, positive_given, shown
from masonry._pose import matrices
from masonry.dem import notes
from masonry.dem.bodies import block_body, blocks, contacts_of, world_shape
from masonry.dem.collapsing import collapsed
from masonry.dem.loads import load_of_a_push
from masonry.dem.platens import contact, last_of_course, neighbour, platen, prescribed
from masonry.results.own_bases import TOUCH
from yade import O, Vector3, wrapper

CURVE = [("displacement", float), ("force", float), ("time", float), ("moved", float), ("step_force", float)]
# m/s^2, by which platens change their speed at most: a force of inertia of a thousandth of the weight.
_ACCELERATION = 0.02
# Most numbers of the record that moves the platens.
_MOST_PARTS = 1_000_000
# Time over which forces are averaged, s: a structure of the mass m that a platen of the usual speed v = 0.01 sqrt(g h) hits takes the impulse m v, a spike in the forces of
# a few steps. Over this time that is the share v/(g 0.2 s) of its weight: 1 % for h = 0.4 m, 2 % for 1.6 m. Longer: the platens go too far meanwhile.
_AVERAGED = 0.2
# Steps between two looks at a drop of the force and at fallen blocks, at least.
_LOOK = 100
# A failure of the integrator that names a jam has these words (rigid_failures.cpp).
_JAM = "bodies with prescribed motion"
# Share of the work that the platens do and take back which the solver may make of nothing without a word.
_MADE = 1e-3
# Share of a step by which O.time may miss the end: it is a sum of steps.
_ROUND_OFF = 1e-3
# Extra width of the gap of the platens in front, relative to what a turn of the block takes.
_ROOM = 1.5
HELD_RIGID = ("vertical = 'held': must come with compliant joints (model='compliant'): the vertical force of rigid blocks between a base and a held top has no finite "
              "value")
_VERTICAL = "free", "load", "held"
# Blocks that are held have no impacts of platens, and forces far above the weight: their acceleration, m/s^2, the time over which forces are averaged, s, and the samples of a test.
_ACCELERATION_HELD, _AVERAGED_HELD, _SAMPLES_HELD = 0.4, 0.004, 2000


class Push:
    """A push-over test: dem.push() and dem.pull_and_release() make it, dem.engines(push) takes it, dem.run(until=push) runs it.

    platens    ids of the prescribed bodies that push
    ids        of the blocks that are pushed
    ended      why dem.run(until=push) has ended: 'displacement' (all displacements have been reached), 'drop', 'collapse', 'jam'; '' before that
    """

    def __init__(self, points, platens, direction, targets, motion, recorder, load, drop, collapse):
        """points: {id of a block: where a platen touches it, m}. load: the engine of the dead load, or None. Blocks that are held are their own platens."""
        self.held = list(points) == platens
        self.ids, self.platens, self.direction, self.targets = list(points), platens, direction, targets
        self.motion, self.recorder, self.load = motion, recorder, load
        self.drop, self.collapse, self.releases, self.ended = drop, collapse, False, ""
        states = {id: O.bodies[id].state for id in points}
        self._arms = {id: np.array(states[id].ori.conjugate() * (Vector3(point) - states[id].pos)) for id, point in points.items()}  # in the axes of the block
        self._made_before = None  # J, what the solver had made of nothing when the run of the push began
        self._look = 0  # O.iter of the next look at force and blocks: each reads the whole curve and all blocks

    @property
    def curve(self):
        """Structured array, one row a step of the run: displacement of the platens along the direction (m), force on the blocks along it (N), time (s), and
        moved (m): how far the points of the blocks have gone at which they were first touched, the mean over `ids`. The force is positive while
        the platens press along the direction, negative while they press back, and without the dead load. It is the mean over 0.1 s before and 0.1 s after the sample:
        the impulse of the platens over that time, divided by it (2 ms before and after with vertical='held', and 2000 rows). step_force (N) is that of the single step,
        which has spikes where a platen lands on a block or a stuck block snaps."""
        return self.averaged(_AVERAGED_HELD if self.held else _AVERAGED)

    def _of_steps(self):
        """The curve with the force of each step in both columns of forces."""
        recorder = self.recorder
        samples, bodies = len(recorder.times), len(recorder.ids)
        table = np.zeros(samples, dtype=CURVE)
        if not samples:
            return table
        table["time"] = recorder.times
        poses = np.frombuffer(recorder.posesAsBytes()).reshape(samples, bodies, 7)
        row = {id: k for k, id in enumerate(recorder.ids)}
        table["displacement"] = (poses[:, row[self.platens[0]], :3] - poses[0, row[self.platens[0]], :3]) @ self.direction
        paths = [(own[:, :3] + matrices(own[:, 3:]) @ arm) @ self.direction for own, arm in ((poses[:, row[id]], arm) for id, arm in self._arms.items())]
        table["moved"] = np.mean([path - path[0] for path in paths], axis=0) if paths else np.nan
        forces = np.frombuffer(recorder.jointForcesAsBytes()).reshape(-1, 8)
        one, two = (np.isin(forces[:, k], self.platens) for k in (0, 1))
        on_blocks = np.where(one & ~two, 1.0, np.where(two & ~one, -1.0, 0.0)) * (forces[:, 2:5] @ self.direction)
        np.add.at(table["step_force"], np.repeat(np.arange(samples), recorder.jointCounts), on_blocks)
        table["force"] = table["step_force"]
        return table

    def averaged(self, time=_AVERAGED):
        """The curve with its force averaged over that time, s, half of it before and half after each sample."""
        table = self._of_steps()
        if len(table) > 2:
            half = int(round(positive_given("time", time) / 2 / max(np.median(np.diff(table["time"])), 1e-300)))
            sums, rows = np.concatenate([[0.0], np.cumsum(table["force"])]), np.arange(len(table))
            low, high = np.maximum(rows - half, 0), np.minimum(rows + half + 1, len(table))
            table["force"] = (sums[high] - sums[low]) / (high - low)
        return table

    @property
    def largest_force(self):
        """(force, displacement) of the curve where its force, the mean over 0.2 s, is largest in size, N and m."""
        table = self.curve
        if not len(table):
            raise ValueError("push: nothing has been recorded yet: O.engines = dem.engines(push), then dem.run(until=push)")
        k = int(np.abs(table["force"]).argmax())
        return float(table["force"][k]), float(table["displacement"][k])

    def save(self, path):
        """Writes the curve as .csv: displacement (m), force (N), time (s), moved (m), force of the step (N), a line a step."""
        check_csv(path)
        table = self.curve
        with written(path) as beside:
            np.savetxt(beside, np.column_stack([table[name] for name, _ in CURVE]), delimiter=",", comments="",
                       header="displacement (m),force (N),time (s),moved (m),force of the step (N)")

    def picture(self, path, title=""):
        """Writes a picture (.png, .pdf, .svg) of force over displacement: averaged over 0.2 s in blue, as it was in each step in grey."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        table = self.curve
        if not len(table):
            raise ValueError("push: nothing has been recorded yet: O.engines = dem.engines(push), then dem.run(until=push)")
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        axes.axhline(0, color="0.7", linewidth=0.8)
        axes.plot(1e3 * table["displacement"], 1e-3 * table["step_force"], color="0.8", linewidth=0.6)
        axes.plot(1e3 * table["displacement"], 1e-3 * table["force"], color="tab:blue", linewidth=1.5)
        least, most = 1e-3 * table["force"].min(), 1e-3 * table["force"].max()
        room = 0.1 * max(most - least, 1e-12)
        axes.set(xlabel="displacement (mm)", ylabel="force (kN)", title=title, ylim=(min(least, 0) - room, max(most, 0) + room))
        save_picture(figure, path, dpi=150)

    def release(self):
        """Takes the platens away at once, or lets go of blocks that are held: the blocks are free from the next step on."""
        self.motion.dead = True
        for engine in O.engines:
            if isinstance(engine, wrapper.MoreauJeanIntegrator):
                engine.motions = [motion for motion in engine.motions if motion is not self.motion]
        O.engines = [engine for engine in O.engines if engine is not self.motion]
        for id in self.platens:
            if O.bodies[id] is not None and self.held:
                O.bodies[id].state.blockedDOFs = ""
            elif O.bodies[id] is not None:
                O.bodies.erase(id)

    # --- what dem.run asks ---

    def is_given(self):
        """Whether the motion of the platens moves the present scene."""
        return any(motion is self.motion for engine in O.engines if not isinstance(engine, wrapper.WallRecorder)
                   for motion in [engine, *getattr(engine, "motions", ())])

    def is_over(self):
        """Whether the test has ended by now; `ended` then says why."""
        if self._made_before is None:
            self._made_before = _made_energy()
        if not self.ended:
            self.ended = self._why()
            if self.ended == "jam":
                notes.say(f"the push jams at {O.time:.4g} s: the platens {', '.join(map(str, self.platens))} press blocks that cannot give way, and the curve "
                          "is worthless from there on: another height, more clearance or a smaller displacement may help")
            if self.ended:
                self._say_what_is_made()
            if self.ended and self.releases:
                self.release()
        return bool(self.ended)

    def _say_what_is_made(self):
        """A slow test turns over little kinetic energy: what the solver makes of nothing is judged by the work of the platens."""
        table = self.curve
        work, made = np.abs(table["step_force"][1:] * np.diff(table["displacement"])).sum(), _made_energy() - self._made_before
        if made > _MADE * work > 0:
            notes.say(f"in this push the solver has made {made:.3g} J of nothing, {100 * made / work:.2g} % of the work that the platens do and take back: "
                      "blocks that it has thrown may have changed the curve. Compare with a smaller dt of dem.engines()")

    def _why(self):
        if any(_JAM in getattr(engine, "firstFailure", "") for engine in O.engines):
            return "jam"
        over = O.time >= self.motion.end - _ROUND_OFF * O.dt
        if O.iter >= self._look or over:
            self._look = O.iter + max(_LOOK, O.iter // 200)
            if self.drop and self._has_dropped():
                return "drop"
            if self.collapse and collapsed(self.collapse):
                return "collapse"
        return "displacement" if over else ""

    def _has_dropped(self):
        """Whether the force on the envelope, where the displacement is the farthest so far, has dropped."""
        table = self.curve
        for side in (1, -1):
            place, force = side * table["displacement"], side * table["force"]
            envelope = force[(place > 0) & (place >= np.maximum.accumulate(place))]
            if len(envelope) and place[-1] > 0 and place[-1] >= place.max() and envelope[-1] < (1 - self.drop) * envelope.max():
                return True
        return False


def _made_energy():
    """J, of the engine that moves the blocks."""
    return sum(getattr(engine, "madeEnergy", 0) for engine in O.engines)


def _direction_given(direction):
    what = "a unit vector of three numbers that is level, as (1, 0, 0)"
    unit = np.array(finite_numbers("direction", direction, 3, what))
    if not (abs(np.linalg.norm(unit) - 1) < 1e-9 and abs(unit[2]) < 1e-12):
        raise ValueError(f"direction = {shown(direction)}: must be {what}")
    return unit


def _targets_given(displacement, cycles):
    if (displacement is None) == (cycles is None):
        raise ValueError(f"displacement = {displacement}, cycles = {shown(cycles)}: give one of the two")
    if cycles is None:
        return [positive_given("displacement", displacement, ", in m, along `direction`")]
    if not np.iterable(cycles) or isinstance(cycles, str) or not len(cycles):
        raise ValueError(f"cycles = {shown(cycles)}: must be a list of displacements in m, as [1e-3, -1e-3, 2e-3, -2e-3]")
    targets = [float(number_given("cycles", one)) for one in cycles]
    if not all(math.isfinite(one) for one in targets) or any(a == b for a, b in zip([0.0, *targets], targets)):
        raise ValueError(f"cycles = {shown(cycles)}: must be finite displacements in m, each another than the one before (the first one not 0)")
    return targets


def _record(targets, speed, largest):
    """(accelerations, interval) that bring the platens to each target in turn and stop them there, at that speed and acceleration at most: m/s^2, s."""
    legs = np.diff([0.0, *targets])
    interval = min(speed / largest, math.sqrt(np.abs(legs).min() / (2 * largest)))
    # A leg of `count` intervals has the speed leg/(count interval), reached within two intervals, and the acceleration leg/(count interval^2).
    parts = [max(2, math.ceil(abs(leg) / interval * max(1 / speed, 1 / (largest * interval)) * (1 - 1e-12))) for leg in legs]
    if sum(parts) > _MOST_PARTS:
        raise ValueError(f"speed = {speed:g}: the displacements of {np.abs(legs).sum():g} m in all need more than {_MOST_PARTS} numbers: must be larger, in m/s")
    samples = np.zeros(sum(parts) + 2 * len(parts) + 1)
    at = 0
    for leg, count in zip(legs, parts):
        acceleration = leg / count / interval**2
        samples[at + 1] += acceleration
        samples[at + count + 1] -= acceleration
        at += count + 2
    return samples, interval


def _ids_given(ids):
    ids = [ids] if is_whole(ids, 0) else ids
    if not np.iterable(ids) or isinstance(ids, str) or not len(list(ids)):
        raise ValueError(f"ids = {shown(ids)}: must be a list of ids of free blocks")
    for id in ids:
        if not block_body(id, "ids").dynamic:
            raise ValueError(f"ids = {shown(ids)}: body {id} is prescribed (a base): must be free blocks; platens=[...] moves prescribed bodies of your own")
    if len(set(ids)) < len(ids):
        raise ValueError(f"ids = {shown(ids)}: must name each block once")
    return [int(id) for id in ids]


def push(ids=None, displacement=None, speed=None, direction=(1, 0, 0), vertical="free", force=None, cycles=None, height=None, drop=None, collapse=1,
         platens=None, clearance=None):
    """A push-over test under displacement control: rigid platens without friction move along `direction` and press against the blocks `ids`. Give the result to
    dem.engines(push), then dem.run(until=push); push.curve has the force over the displacement.

    ids             of the free blocks that are pushed, each by a platen of its own that touches it along one horizontal edge; all platens move alike
    displacement    of the platens, m, positive; or
    cycles          displacements of the platens, m, to reach one after the other, [1e-3, -1e-3, 2e-3, -2e-3]. There is then a platen behind each block and
                    one in front of it, or of the last block of its course, and they press in turns
    speed           of the platens, at most, m/s; None: 1 % of sqrt(g height), of the height of the pushed blocks over the lowest free block
    direction       level unit vector
    vertical        'free': the blocks carry no load; 'load': they carry the dead load `force` together, each the same share, at its centre; platens hold no block down.
                    'held' (model='compliant'): the blocks move as platens themselves. From this call on they are held at their height and do not turn, and a dead load on
                    them no longer acts: call it when the structure is at rest under its loads
    force           with vertical='load': the dead load, N, downwards; it is there as long as dem.engines(push) is in O.engines, and energies, reactions and reports
                    have it as a load of dem.dead_load()
    height          z of the edges of the platens, m, in the world; None: that of the centre of each block
    drop            ends the test when the force, averaged over 0.2 s, has fallen below (1 - drop) times the largest one in that direction, while the displacement
                    is the farthest so far: 0 < drop <= 1; None: never
    collapse        ends it when so many blocks have fallen (dem.collapsed); None: never
    platens         instead of ids: prescribed bodies of your own that move and push what they touch; all free blocks are then recorded
    clearance       with cycles: gap between a block and the platens in front of it, m; None: room for a turn of the block about the foot of the structure

    The force is the sum of the forces in the contacts of the platens, averaged over 0.2 s (push.curve). The platens begin at rest at O.time, and change their speed with 0.02 m/s^2 at most (0.4 with vertical='held'). A
    test ends at the last displacement, at a drop, a collapse or a jam (push.ended), which is said in a line. Another line says at its end that the solver has made more than 1e-3 of
    the work that the platens do and take back. Raises ValueError for input out of its range.
    """
    unit, targets = _direction_given(direction), _targets_given(displacement, cycles)
    if (ids is None) == (platens is None):
        raise ValueError(f"ids = {shown(ids)}, platens = {shown(platens)}: give one of the two")
    if drop is not None and not 0 < number_given("drop", drop) <= 1:
        raise ValueError(f"drop = {drop}: must be above 0 and at most 1, or None")
    if collapse is not None and not is_whole(collapse, 1):
        raise ValueError(f"collapse = {shown(collapse)}: must be a whole number of blocks from 1 on, or None")
    _check_load(vertical, force, ids)
    held = vertical == "held"
    if held:
        _check_held(ids, height, clearance)
    pushed = [] if ids is None else _ids_given(ids)
    free = [body for body in blocks() if body.dynamic]
    if not free:
        raise ValueError("there is no free block in O.bodies: add one with dem.block() before dem.push()")
    low = min(world_shape(body)[0][:, 2].min() for body in free)
    speed = positive_given("speed", speed, ", in m/s") if speed is not None else 0.01 * math.sqrt(9.81 * max(
        (O.bodies[id].state.pos[2] - low for id in pushed), default=max(body.state.pos[2] for body in free) - low))
    samples, interval = _record(targets, speed, _ACCELERATION_HELD if held else _ACCELERATION)
    if held:
        points, back, made = {id: O.bodies[id].state.pos for id in pushed}, set(), pushed
        for id in pushed:
            _hold(O.bodies[id].state)
    else:
        points, back, made = ({}, set(), prescribed(platens, "platens")) if ids is None else _made(pushed, unit, height, targets, clearance, low)
    motion = wrapper.RecordMotionEngine(ids=made, samples=samples.tolist(), interval=interval, direction=unit, start=O.time)
    notes.is_of_a_push(motion)
    if held:
        recorder = wrapper.WallRecorder(ids=made + _beside(made), recordForces=True, virtPeriod=len(samples) * interval / _SAMPLES_HELD)
    else:
        recorder = wrapper.WallRecorder(ids=made + sorted(back) + (pushed or [body.id for body in free]), recordForces=True, iterPeriod=1)
    return Push(points, made, unit, targets, motion, recorder, load_of_a_push(pushed, force) if vertical == "load" else None, drop, collapse)


def pull_and_release(ids, displacement, speed=None, direction=(1, 0, 0), vertical="free", force=None, height=None):
    """Free vibration from a displaced position: platens move the blocks `ids` by `displacement` as dem.push() does, and are taken away at once when they are
    there. dem.run(until=pull) does both; dem.run(5) then runs 5 s of free vibration. The arguments are those of dem.push(). The dead load stays."""
    made = push(ids, displacement, speed, direction, vertical, force, height=height)
    made.releases = True
    return made


def _check_load(vertical, force, ids):
    if vertical not in _VERTICAL:
        raise ValueError(f"vertical = {shown(vertical)}: must be 'free', 'load' or 'held'")
    if vertical == "load":
        if ids is None:
            raise ValueError("vertical = 'load': must come with ids, the blocks that carry the load; with platens of your own use dem.dead_load(ids, N)")
        positive_given("force", force, ", in N, the dead load that the pushed blocks carry together")
    elif force is not None:
        raise ValueError(f"force = {force}: must come with vertical='load', or be left out")


def _check_held(ids, height, clearance):
    if ids is None:
        raise ValueError("vertical = 'held': must come with ids, the blocks that are held; platens of your own keep their height anyway")
    for name, value in (("height", height), ("clearance", clearance)):
        if value is not None:
            raise ValueError(f"{name} = {value}: must be left out with vertical='held', where no platens touch the blocks")
    if any(isinstance(engine, wrapper.MoreauJeanIntegrator) and not engine.dead for engine in O.engines):
        raise ValueError(HELD_RIGID)


def _beside(ids):
    """Ids of the other blocks that touch these."""
    there = blocks()
    pairs = np.array([body.id for body in there])[contacts_of(there, TOUCH)[0]]
    return sorted(set(pairs[np.isin(pairs, ids).any(axis=1)].ravel().tolist()) - set(ids))


def _hold(state):
    state.blockedDOFs = "xyzXYZ"
    state.vel = state.angVel = Vector3.Zero


def _made(ids, unit, height, targets, clearance, low):
    """({id of a block: where it is touched}, ids of the blocks that are pushed back, ids of the new platens): behind the blocks where displacements go along
    `direction`, in front of them, or of the course that they belong to, where they go back."""
    legs = np.diff([0.0, *targets])
    first = -1 if legs[0] > 0 else 1
    sides = [first, -first] if (legs * legs[0] < 0).any() else [first]
    if clearance is not None and not 0 <= number_given("clearance", clearance) < math.inf:
        raise ValueError(f"clearance = {clearance}: must be 0 or positive and finite, in m")
    heights = {id: O.bodies[id].state.pos[2] if height is None else float(number_given("height", height)) for id in ids}
    points = {id: contact(id, unit, z, first).point for id, z in heights.items()}
    places, most = [], max(abs(one) for one in targets)
    for id, z in heights.items():
        beside = neighbour(id, unit, z, first)
        if beside is not None:
            raise ValueError(f"ids: block {beside} is in the way of a platen at block {id}, at the height of {z:.4g} m: must be blocks that are free on the side of the push")
        turn = min(most / max(z - low, most), 1.0)
        end = last_of_course(id, unit, z, -first)
        width = contact(end, unit, z, -first).width + abs((contact(end, unit, z, -first).point - points[id]) @ unit)
        room = _ROOM * width * (1 / math.cos(turn) - 1) if clearance is None else clearance
        places += [(id if side == first else end, z, side, 0.0 if side == first else room) for side in sides]
    return points, {id for id, *_ in places} - set(ids), [platen(id, unit, z, side, room) for id, z, side, room in places]
