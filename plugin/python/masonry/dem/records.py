"""RecordMotionEngine from velocities and displacements."""

import masonry
from masonry._given import shown
from yade import wrapper

from masonry.dem import notes


def _from_motions(cls):
    """The constructor also takes displacement=[...] or velocity=[...] instead of samples, and the unit of either; masonry.Record turns them into samples."""
    default, make = cls().interval, cls.__init__

    def __init__(self, *arguments, displacement=None, velocity=None, unit=None, resolution=None, **attributes):
        moved = displacement is not None or velocity is not None
        if unit is not None and not moved and "samples" not in attributes:
            make(self, *arguments, **attributes)  # refuses a misspelled name
            raise ValueError(f"unit = {shown(unit)}: must come with samples, velocity or displacement")
        if moved or unit is not None:
            baseline = attributes.get("baseline", "none") if moved else "none"
            record = masonry.Record(attributes.get("interval", default), attributes.get("samples"), baseline=baseline, unit=unit, velocity=velocity,
                                    displacement=displacement, resolution=resolution)
            attributes["samples"] = record.samples.tolist()
        make(self, *arguments, **attributes)
        if moved or unit is not None:
            notes.has_record(self, record)
        if moved and record.doubt():
            print(f"masonry.dem: {record.doubt()}")

    cls.__init__ = __init__


_from_motions(wrapper.RecordMotionEngine)
