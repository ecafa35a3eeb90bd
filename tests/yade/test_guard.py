"""The guard accepts the YADE that the plugin was built for and refuses any other with one sentence, before the plugin is opened."""

import sys

import guard_probe
import guard_probe_shifted
import yade
from masonry import _build, _fit

REBUILD = "scripts/quickstart"


def refused(act, *parts, kind=RuntimeError):
    try:
        act()
    except kind as error:
        sentence = str(error)
        assert all(part in sentence for part in parts), sentence
        assert "\n" not in sentence and sentence.count(". ") == 0 and sentence.endswith("."), sentence
    else:
        raise AssertionError(f"accepted, without {parts}")
    assert "masonry._yade" not in sys.modules and not hasattr(yade.wrapper, "BlockMat"), "YADE is no longer as it was"


def load():
    from masonry import dem  # noqa: F401


# Sizes, as the guard alone says it. State has 320 bytes in every YADE without DEFORM.
guard_probe.require()
for change, found in ((("State", 336), "its State takes 320 bytes instead of 336"), (("LawFunctor", 96), "its LawFunctor takes 88 bytes instead of 96")):
    try:
        guard_probe.require([change])
    except RuntimeError as error:
        assert str(error) == found, error
    else:
        raise AssertionError(f"accepted {change}")

# Another version, and another Python.
here, _build.YADE = _build.YADE, "2024.01"
refused(load, f"masonry does not fit this YADE: it is YADE {here}, but the plugin was built for YADE 2024.01", REBUILD)
_build.YADE = here
python, _build.PYTHON = _build.PYTHON, "3.1"
refused(_fit.require_python, f"masonry was built for Python 3.1, but this is Python {python}", REBUILD, kind=ImportError)
_build.PYTHON = python

# A wrong definition: YADE_DEFORM gives State a member more. The build id tells whether it is the same build of YADE.
sys.modules["masonry._guard"] = guard_probe_shifted
refused(load, "its State takes 320 bytes instead of 328", f"on this very build of YADE {here}", REBUILD)
build_id, _build.YADE_BUILD_ID = _build.YADE_BUILD_ID, "0123"
refused(load, "its State takes 320 bytes instead of 328", f"on another build of YADE {here}", REBUILD)

# A rebuild of the same version passes where all sizes and tables agree.
del sys.modules["masonry._guard"]
from masonry import dem  # noqa: E402

assert dem.BlockMat(density=2000).density == 2000
assert guard_probe.build_id("libyade.so") == build_id and len(build_id) == 40, build_id
