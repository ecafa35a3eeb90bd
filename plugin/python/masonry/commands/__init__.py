"""Subcommands of the command masonry, a module each. Its add(subcommands) declares the arguments and sets `run`, a function of the parsed arguments;
it imports what it computes with inside `run`, so that `masonry --help` starts at once."""

from . import ensemble, fragility, report, rock, spectrum

ALL = (report, rock, spectrum, fragility, ensemble)
