"""masonry ensemble: runs a study whole, one slice of it, or gathers what its slices have computed."""


def add(subcommands):
    parser = subcommands.add_parser(
        "ensemble", help="run a study of many cases, or one slice of it on a cluster",
        description="Runs a Python script that calls masonry.ensemble.run once. In a Slurm array job, each task runs its slice, unless --slice or "
                    "--gather says otherwise. The program ends when its slice is done: what follows in the script is for the whole table.")
    parser.add_argument("study", help="the script, as python3 would run it")
    parser.add_argument("arguments", nargs="*", help="of the script")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--slice", metavar="K/N", help="compute only the cases K, K + N, K + 2N, ... (K from 1 to N)")
    which.add_argument("--gather", action="store_true", help="compute nothing: make the tables of what is there, and go on with the script")
    parser.set_defaults(run=run)


def run(given):
    import os
    import runpy
    import sys
    import traceback

    from ..ensemble.slices import asked, slice_given
    from ..ensemble.study import CasesFailed

    asked.slice = None if given.gather else slice_given(given.slice or "slurm")
    asked.gather = given.gather
    if not os.path.isfile(given.study):
        raise FileNotFoundError(f"there is no script {given.study}")
    sys.argv = [given.study, *given.arguments]
    sys.path.insert(0, os.path.dirname(os.path.abspath(given.study)))
    try:
        runpy.run_path(given.study, run_name="__main__")
    except CasesFailed as error:
        sys.exit(f"masonry: {error}")
    except Exception:  # of the script: its author needs the place
        traceback.print_exc()
        sys.exit(1)
