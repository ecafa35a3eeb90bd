"""The command masonry (python3 -m masonry)."""

import argparse
import platform
import sys
import warnings

from . import _build, commands


def versions():
    """What a report of a fault needs."""
    yade = f"{_build.YADE} ({_build.HEADERS} headers; libyade.so {_build.YADE_BUILD_ID})" if _build.YADE else "none: the theory alone"
    return "\n".join((
        f"masonry {_build.VERSION}",
        f"YADE          {yade}",
        f"features      {' '.join(_build.YADE_FEATURES)}",
        f"built on      {_build.DISTRIBUTION}, {_build.PROCESSOR}, Python {_build.PYTHON}",
        f"built with    {_build.COMPILER}; {_build.LIBRARIES}",
        f"running on    {platform.freedesktop_os_release().get('PRETTY_NAME', '?')}, {platform.machine()}, Python {platform.python_version()}",
    ))


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}; {self.prog} --help says more\n")


def main():
    parser = _Parser(prog="masonry", description="Rocking masonry blocks in YADE: `from masonry import dem` in a script that yade runs.",
                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action="version", version=versions(), help="print all that a report of a fault needs")
    parser.set_defaults(run=lambda given: parser.print_help())
    subcommands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for command in commands.ALL:
        command.add(subcommands)
    given = parser.parse_args()
    with warnings.catch_warnings():
        if given.run is not commands.ensemble.run:  # which runs a script, whose author needs the place
            warnings.showwarning = lambda message, *_: print(f"masonry: {message}", file=sys.stderr)
        try:
            given.run(given)
        except (OSError, ValueError, ImportError, RuntimeError) as error:  # input that is wrong, or a package that is missing: their message says which
            missing = f"{error.filename}: there is no such file or folder" if isinstance(error, FileNotFoundError) and error.filename else ""
            parser.exit(2, f"masonry: {missing or ' '.join(str(error).split())}\n")
        except MemoryError as error:
            parser.exit(2, f"masonry: the memory is too small for that: {error}\n")
        except KeyboardInterrupt:
            parser.exit(130, "masonry: interrupted\n")


if __name__ == "__main__":
    main()
