"""Records of ground motions, from files."""

from . import _records
from ._records.units import STANDARD_GRAVITY
from .motions import Record, record_of_series


def read_record(path, component=None, quantity=None, *, unit=None, dt=None, columns=None, gravity=STANDARD_GRAVITY, scale=1.0, baseline="none",
                corner=None, order=2):
    """The masonry.Record of a file, whose format is recognised by its text. print(record) says what was read and where the base ends.

    Formats: PEER (.AT2, .VT2, .DT2), COSMOS and CSMIP (.V1, .V2, .V1c, .V2c), ESM, ITACA and AFAD (.asc, .txt), K-NET and KiK-net, SMC, text files of columns
    (.csv, .txt), and what ObsPy reads, where it is installed (miniSEED, SAC). Compressed files must be unpacked.

    component    of a file with several: its name or direction ('N-S', '360 Deg', '360', 'Up') or the number of its channel. None: the file must have one.
                 Of a text file: the name of its column
    quantity     'acceleration', 'velocity' or 'displacement'; None: acceleration where the file has it, else what it has. Velocities and displacements
                 become a smooth motion, as Record says
    unit, dt     only for text files and what ObsPy reads, whose unit is not guessed: unit='g', 'm/s^2', 'cm/s^2', 'mm/s^2', of a velocity 'm/s', 'cm/s',
                 'mm/s', of a displacement 'm', 'cm', 'mm'; None: the unit in brackets behind the name of the column. dt: s, for a file without times
    columns      of a text file with more than two: (time, value) or value, by number (from 0) or name; 'all': values run on from line to line.
                 Columns are parted by commas or by blanks, numbers have decimal points and may have Fortran's exponents (1.2D-3). Lines that start with
                 # or % and one first line of words are skipped. Times may be rounded to their last digit
    gravity      m/s^2 of the unit g: the standard one, whatever the blocks weigh (9.81 elsewhere)

    scale, baseline, corner, order: those of Record. The units of the other formats are those that their files state; another one, counts that only
    the network can convert, missing values, numbers of values that differ from the stated one, and values below a line that is not understood are refused with
    the line.
    """
    series, name = _records.read(path, component, quantity, unit, dt, columns)
    return record_of_series(Record, path, series, name, gravity, scale=scale, baseline=baseline, corner=corner, order=order)
