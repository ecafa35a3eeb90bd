"""What dem.TiltTable finds: the trials of multipliers, and the collapse that they enclose."""

from dataclasses import dataclass, field

import numpy as np
from masonry._files import save_picture
from masonry.dem import tilting_report


@dataclass
class Trial:
    """What a multiplier did: 'rest', 'collapse', 'jammed' where blocks moved and stopped in joints that were closed all along, 'stretched' where they
    rest on ties beyond `share`, 'unclear' where they still moved at the end and slowed down, or 'missed' where the contact laws were, so that a smaller stair is taken."""

    multiplier: float
    verdict: str
    moved: float  # m, of the farthest moved block
    time: float  # s, simulated
    failures: int  # of the integrator


@dataclass
class Collapse:
    """Multiplier at which a scene collapses: the mean of `bracket`, the largest that it stands and the least that it does not."""

    multiplier: float
    bracket: tuple
    trials: list
    joints: np.ndarray  # id1, id2, opening (m), slip (m, of body 2 on body 1), opens, slides; from the last rest to the end of the trial that is drawn
    blocks: list  # ids that have moved since the last rest
    doubts: list  # why the result cannot be trusted; empty: none
    remarks: list  # what blocks did below collapse, or where it was not reached, in words
    _mechanism: object = field(repr=False)
    about: dict = field(default_factory=dict, repr=False)  # what was run: direction, load, materials, model

    def __str__(self):
        opens, slides = self.joints["opens"], self.joints["slides"]
        both = f" ({(opens & slides).sum()} of them slide too)" if (opens & slides).any() else ""
        lines = [f"collapse multiplier {self.multiplier:.5g} (stands {self.bracket[0]:.5g}, collapses {self.bracket[1]:.5g})",
                 f"{len(self.blocks)} blocks move; {opens.sum()} joints open{both}, {(slides & ~opens).sum()} slide closed"]
        return "\n".join(lines + self.remarks + [f"NOT TO BE TRUSTED: {doubt}" for doubt in self.doubts])

    def draw(self, path, title=None):
        """Writes a picture (.png, .pdf, ...): the blocks, their movement magnified; open joints red, sliding ones blue, those seen face on as outlines."""
        save_picture(self.figure(title or str(self)), path, dpi=150, bbox_inches="tight")

    def figure(self, title):
        """The matplotlib figure of draw()."""
        return self._mechanism.figure(self, title)

    def report(self, path, title=""):
        """Writes a page, one .html file: the multiplier, doubts and remarks in words, the mechanism, its joints, the trials and what was run."""
        tilting_report.write(self, path, title)
