"""A gable shaken out of its plane, free and tied to the roof behind it: writes gable.png."""
import tempfile
from pathlib import Path

from PIL import Image

from masonry import artificial_record, dem, results
from yade import O

COURSES, SIZE = 6, (0.6, 0.3, 0.3)
BEHIND = 3.0  # m, from the gable to the far end of the ties, which moves with the ground as the other walls do


def gable(material, base):
    """A stepped gable in running bond: one block less in each course. Returns the ids, course by course, bottom up."""
    x, _, z = SIZE
    return [[dem.block(SIZE, material, center=((k - (COURSES - 1 - course) / 2) * x, 0, (course + 0.5) * z)) for k in range(COURSES - course)]
            for course in range(COURSES)]


def run(tied):
    O.reset()
    stone = dem.BlockMat(density=2000, frictionAngle=0.6)
    base = dem.base((8, 9, 0.2), stone)
    courses = gable(stone, base)
    if tied:
        for course in courses[3:]:
            for block in course:
                x, y, z = O.bodies[block].state.pos
                # A steel bar of 12 mm and 3 m, which the roof beam keeps from buckling.
                dem.tie(block, (x, y, z), base, (x, y + BEHIND, z), stiffness=7.5e6, tension_only=False)
    motion = dem.record_motion(artificial_record(seed=3, peak=7, duration=4, frequency=0.7), ids=[base], direction=(0, 1, 0))
    recorder = dem.WallRecorder(virtPeriod=0.01)
    O.engines = dem.engines(motion, recorder=recorder)
    dem.run(until=motion)
    history = dem.wall_history(recorder)
    print(results.collapse(history))
    with tempfile.TemporaryDirectory() as folder:
        results.draw(history, Path(folder) / "one.png", time=2.2, enlarge=1, view=(0.8, -1, 0.5), title="tied" if tied else "free")
        return Image.open(Path(folder) / "one.png").convert("RGB")


drawn = [run(tied) for tied in (False, True)]
sheet = Image.new("RGB", (sum(one.width for one in drawn), max(one.height for one in drawn)), "white")
for k, one in enumerate(drawn):
    sheet.paste(one, (k * drawn[0].width, (sheet.height - one.height) // 2))
sheet.quantize(64).save("gable.png", optimize=True)
