"""The command masonry, and what a copy says that was built for another Python."""

import subprocess
import sys

import pytest
from masonry import _build, _fit


def test_version_prints_what_a_report_needs():
    said = subprocess.run([sys.executable, "-m", "masonry", "--version"], capture_output=True, check=True, text=True).stdout
    for part in (f"masonry {_build.VERSION}", f"Python {_build.PYTHON}", _build.DISTRIBUTION, _build.PROCESSOR, _build.COMPILER, _build.LIBRARIES):
        assert part and part in said


def test_another_python_is_refused(monkeypatch):
    monkeypatch.setattr(_build, "PYTHON", "3.1")
    with pytest.raises(ImportError, match=r"^masonry was built for Python 3\.1, but this is Python 3\.\d+: .*scripts/quickstart.*\.$"):
        _fit.require_python()
