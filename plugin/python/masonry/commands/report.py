"""masonry report wall.npz: the report of a saved history."""

from pathlib import Path


def add(subcommands):
    parser = subcommands.add_parser("report", help="write the report of a saved wall history, one HTML file",
                                    description="Writes one HTML file that opens in a browser without a network: what was run, the verdict, a 3D view that "
                                                "turns and plays, and the curves.")
    parser.add_argument("history", type=Path, help="the .npz file that WallHistory.save() has written")
    parser.add_argument("-o", "--output", type=Path, help="the .html file; without it, the name of the history with .html")
    parser.add_argument("--title", default="", help="heading of the report")
    parser.set_defaults(run=run)


def run(given):
    from masonry import results

    path = given.output or given.history.with_suffix(".html")
    results.report(results.WallHistory.load(given.history), path, title=given.title)
    print(f"masonry: wrote {path}")
