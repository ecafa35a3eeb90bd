"""masonry fragility: fragility curves of a block under records, or of the rows of a table."""

import argparse
from pathlib import Path

from . import _given

_EXAMPLES = """examples:
  masonry fragility records/*.AT2 --width 0.4 --height 2 --scales 0.2:4:20
  masonry fragility records/*.AT2 --width 0.4 --height 2 --measure "PGA/g" --levels 0.1:1:10
  masonry fragility --table results/study/ensemble.csv --measure peak --record seed

Measures of a block: PGA (m/s^2), PGA/g, PGV (m/s), "PGA/(g tan alpha)", "p PGV/(g tan alpha)", "Sa(0.5)" (period in s). """


def add(subcommands):
    parser = subcommands.add_parser("fragility", help="fragility curve of a block under records, or of a table of collapses",
                                    description="Fits a lognormal fragility curve by maximum likelihood and writes it as a table and a picture.",
                                    formatter_class=argparse.RawDescriptionHelpFormatter, epilog=_EXAMPLES + f"\nLists of {_given.NUMBERS}.")
    _given.add_records(parser, "*")
    parser.add_argument("--width", type=_given.numbers, help="whole width 2b, m; several sizes are taken together")
    parser.add_argument("--height", type=_given.numbers, help="whole height 2a, m")
    parser.add_argument("--restitution", type=_given.numbers, help="C (default: the natural one)")
    parser.add_argument("--scales", type=_given.numbers, help="factors of every record")
    parser.add_argument("--levels", type=_given.numbers, help="values of the measure to which every record is scaled")
    parser.add_argument("--measure", help="intensity measure (default: PGA); column of the table")
    parser.add_argument("--table", type=Path, help="CSV file with one row for each case, as ensemble.run() writes it, in place of records and a block")
    parser.add_argument("--event", default="collapsed", help="column of the table that says whether a case collapsed (default: collapsed)")
    parser.add_argument("--record", help="column of the table that names the record, where each comes at several levels")
    parser.add_argument("--confidence", type=float, default=0.95, help="of the intervals (default: 0.95)")
    _given.add_output(parser, "fragility")
    parser.set_defaults(run=run)


def run(given):
    curve = _of_table(given) if given.table else _of_block(given)
    print(f"masonry: {curve}")
    _given.write(curve, given)


def _of_block(given):
    import masonry

    if not given.records or given.width is None or given.height is None:
        raise ValueError("give records, --width and --height, or --table")
    block = masonry.RockingBlock.from_size(given.width, given.height)
    scales, levels = (None if value is None else [value] if isinstance(value, float) else value for value in (given.scales, given.levels))
    return masonry.fragility(block, _given.read_records(given), scales, levels, given.measure or "PGA", given.restitution, confidence=given.confidence,
                             progress=_given.progress(given))


def _of_table(given):
    import masonry
    import numpy as np

    if given.records:
        raise ValueError(f"{given.records[0]}, --table: give one of the two")
    if given.measure is None:
        raise ValueError("--table needs --measure, the column of the intensity measure")
    with open(given.table, encoding="utf-8") as file:
        try:
            lines = file.read().splitlines()
            table = np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8", deletechars="", replace_space=" ") if any(lines[1:]) else np.zeros(0)
        except Exception as error:  # whatever NumPy says of another file
            raise ValueError(f"{given.table}: must be a table in CSV, as ensemble.run() writes it ({' '.join(str(error).split())[:200]})") from None
    table = np.atleast_1d(table)
    if not table.size or not table.dtype.names:
        raise ValueError(f"{given.table}: has no rows")
    return masonry.fragility_of_table(table, given.measure, given.event, given.record, confidence=given.confidence)
