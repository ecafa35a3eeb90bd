"""masonry rock RECORD --width 0.6 --height 2: the history of one block under a record, as a table and a picture."""

import argparse
import warnings
from pathlib import Path

from . import _given

# The longest block that is no slip of units (mm for m), m.
_LONGEST = 50


def add(subcommands):
    parser = subcommands.add_parser("rock", help="rock one block by a record: its history as a table and a picture", formatter_class=argparse.RawDescriptionHelpFormatter,
                                    description="Computes the exact history of one block under a record and writes NAME.csv (time, angle, angular velocity, base) and "
                                                "NAME.png.", epilog="example:\n  masonry rock quake.AT2 --width 0.6 --height 2 --scale 1.5")
    _given.add_records(parser, 1)
    parser.add_argument("--width", type=float, required=True, help="whole width 2b, m")
    parser.add_argument("--height", type=float, required=True, help="whole height 2h, m")
    parser.add_argument("--restitution", type=float, help="C (default: the natural one)")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the record (default: 1)")
    parser.add_argument("--end", type=float, metavar="SECONDS", help="end of the run, s (default: when the record is over and the block at rest or overturned)")
    parser.add_argument("-o", "--output", type=Path, metavar="NAME", help="NAME.csv and NAME.png are written (default: rotation)", default=Path("rotation"))
    parser.set_defaults(run=run)


def run(given):
    import masonry

    for name in ("width", "height"):
        if not 0 < getattr(given, name) < float("inf"):
            raise ValueError(f"--{name} {getattr(given, name):g}: must be positive and finite, in m")
    if max(given.width, given.height) > _LONGEST:
        warnings.warn(f"The block measures {given.width:g} x {given.height:g} m: sizes are in m.", stacklevel=2)
    record, = _given.read_records(given)
    history = masonry.simulate(masonry.RockingBlock(given.width / 2, given.height / 2), record.scaled(given.scale), given.restitution, t_end=given.end)
    table, picture = (given.output.with_name(given.output.name + ending) for ending in (".csv", ".png"))
    history.to_csv(table)
    history.draw(picture)
    print(f"masonry: {history}\nmasonry: wrote {table} and {picture}")
