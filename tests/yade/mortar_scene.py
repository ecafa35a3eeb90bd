"""What the tests of mortar share: a brick on a base, pulled, pushed or turned by a spring, with the joints of the walls J4D and J5D of Eindhoven."""

from masonry import dem
from rocking_scene import joint_engine, quiet_engines, steps
from yade import O, PyRunner, Vector3

EINDHOVEN = dict(tensileStrength=0.25e6, fractureEnergy=18, cohesion=0.35e6, shearFractureEnergy=125, frictionAngle=0.6435011087932844,
                 normalStiffness=82e9, shearStiffness=36e9)  # Pa, J/m^2, rad (tangent 0.75), Pa/m
SIZE = (0.1, 0.2, 0.05)
BRICK_WALL = (0.2, 0.1, 0.05)  # m, a brick of a wall
AREA = SIZE[0] * SIZE[1]


def eindhoven(**changes):
    return dem.JointMat(**{**EINDHOVEN, **changes})


def brick_material(mortar=None, **attributes):
    return dem.BlockMat(density=1900, frictionAngle=EINDHOVEN["frictionAngle"], mortar=mortar or eindhoven(), **attributes)


def brick(mortar=None, gravity=0.0, **attributes):
    """Ids of base and brick of a fresh scene, with its engines."""
    O.reset()
    material = brick_material(mortar, **attributes)
    base = dem.base((0.5, 0.5, 0.1), material)
    one = dem.block(SIZE, material, on=base)
    O.engines = quiet_engines(model="auto", gravity=gravity)
    return base, one


class Loading:
    """A brick that a spring moves at a constant velocity (m/s) along x or z, or turns about y (rad/s), under a constant force (N)."""

    instance = None

    def __init__(self, body, along="z", speed=0.02, stiffness=1e9, force=(0, 0, 0)):
        self.body, self.along, self.speed, self.stiffness, self.force = body, along, speed, stiffness, Vector3(*force)
        self.start, self.begin, self.most, self.last, self.work = Vector3(O.bodies[body].state.pos), O.time, 0.0, 0.0, 0.0
        self.place, self.drive = 0.0, 0.0
        Loading.instance = self
        O.engines = O.engines[:1] + [PyRunner(command="import mortar_scene; mortar_scene.Loading.instance.act()", iterPeriod=1)] + O.engines[1:]

    def _moved(self):
        state = O.bodies[self.body].state
        return 2 * state.ori[1] if self.along == "turn" else (state.pos - self.start)["xyz".index(self.along)]

    def act(self):
        reactions = joint_engine().reactions
        moments = joint_engine().reactionMoments
        if reactions:
            self.last = abs(moments[0][1] if self.along == "turn" else reactions[0]["xyz".index(self.along)])
            self.most = max(self.most, self.last)
        moved = self._moved()
        drive = self.stiffness * (self.speed * (O.time - self.begin) - moved)
        self.work += 0.5 * (drive + self.drive) * (moved - self.place)
        self.place, self.drive = moved, drive
        O.forces.addF(self.body, self.force)
        if self.along == "turn":
            O.forces.addT(self.body, (0, drive, 0))
        else:
            O.forces.addF(self.body, Vector3.Unit("xyz".index(self.along)) * drive)

    def run(self, until=0.9999, most=0.5):
        """Until the mean damage of the joint, at most so long (s)."""
        while (not len(dem.damage()) or dem.damage()["damage"][0] < until) and O.time - self.begin < most:
            steps(50)
        return dem.damage()[0]
