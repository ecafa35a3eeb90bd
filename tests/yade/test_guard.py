"""The guard accepts the YADE that the plugin was built for and refuses any other with one sentence, before the plugin is opened."""

import sys

import guard_probe
import guard_probe_shifted
import pytest
import yade
from masonry import _build, _fit

REBUILD = "scripts/quickstart"
VERSION = _build.YADE


def refused(act, *parts, kind=RuntimeError):
    with pytest.raises(kind) as error:
        act()
    sentence = str(error.value)
    assert all(part in sentence for part in parts), sentence
    assert "\n" not in sentence and sentence.count(". ") == 0 and sentence.endswith("."), sentence
    assert "masonry._yade" not in sys.modules and not hasattr(yade.wrapper, "BlockMat"), "YADE is no longer as it was"


def load():
    from masonry import dem  # noqa: F401


# Only the last test of this file loads the plugin: what has been loaded stays in YADE.


def test_sizes_as_the_guard_alone_accepts_them():
    guard_probe.require()


# State has 320 bytes in every YADE without DEFORM.
@pytest.mark.parametrize("change, found", (
    (("State", 336), "its State takes 320 bytes instead of 336"), (("LawFunctor", 96), "its LawFunctor takes 88 bytes instead of 96"),
))
def test_sizes_as_the_guard_alone_refuses_them(change, found):
    with pytest.raises(RuntimeError) as error:
        guard_probe.require([change])
    assert str(error.value) == found


def test_another_version(monkeypatch):
    monkeypatch.setattr(_build, "YADE", "2024.01")
    refused(load, f"masonry does not fit this YADE: it is YADE {VERSION}, but the plugin was built for YADE 2024.01", REBUILD)


def test_another_python(monkeypatch):
    python = _build.PYTHON
    monkeypatch.setattr(_build, "PYTHON", "3.1")
    refused(_fit.require_python, f"masonry was built for Python 3.1, but this is Python {python}", REBUILD, kind=ImportError)


@pytest.mark.parametrize("build_id, built_on", ((_build.YADE_BUILD_ID, "this very"), ("0123", "another")))
def test_a_wrong_definition(build_id, built_on, monkeypatch):
    """YADE_DEFORM gives State a member more. The build id tells whether it is the same build of YADE."""
    monkeypatch.setitem(sys.modules, "masonry._guard", guard_probe_shifted)
    monkeypatch.setattr(_build, "YADE_BUILD_ID", build_id)
    refused(load, "its State takes 320 bytes instead of 328", f"on {built_on} build of YADE {VERSION}", REBUILD)


def test_a_rebuild_of_the_same_version(monkeypatch):
    """It passes where all sizes and tables agree."""
    build_id = _build.YADE_BUILD_ID
    monkeypatch.setattr(_build, "YADE_BUILD_ID", "0123")
    from masonry import dem

    assert dem.BlockMat(density=2000).density == 2000
    assert guard_probe.build_id("libyade.so") == build_id and len(build_id) == 40, build_id
