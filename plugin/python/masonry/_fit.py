"""Whether this copy fits the Python and the YADE that run it: one sentence that says what does not fit, and what to do."""

import sys

from . import _build

_REBUILD = ("remove the folder build and run scripts/quickstart, which builds for the YADE that is installed, or install the package python3-masonry "
            "of your distribution")


def require_python():
    running = "{}.{}".format(*sys.version_info)
    if running != _build.PYTHON:
        raise ImportError(f"masonry was built for Python {_build.PYTHON}, but this is Python {running}: {_REBUILD}.")


def require_yade():
    """Raises RuntimeError unless the running YADE is what the plugin was compiled for: version, sizes, members and virtual functions. Opens
    the compiled guard, not the plugin."""
    from yade import config

    if config.version != _build.YADE:
        raise RuntimeError(f"masonry does not fit this YADE: it is YADE {config.version}, but the plugin was built for YADE {_build.YADE}: {_REBUILD}.")
    from . import _guard

    try:
        _guard.require()
    except RuntimeError as error:
        same = _guard.build_id("libyade.so") == _build.YADE_BUILD_ID
        build = "this very build of" if same else "another build of"
        raise RuntimeError(f"masonry does not fit this YADE: {error} (the plugin was compiled on {build} YADE {_build.YADE}, with {_build.HEADERS} "
                           f"headers); {_REBUILD}.") from None
