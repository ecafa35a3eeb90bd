"""Runs the tests of one file inside YADE: yade -n -x run_pytest.py test_X.py [options of pytest]. The exit status is that of pytest."""

import os
import sys
from pathlib import Path

import pytest

os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # other packages' plugins take half a second to load
script, name, *options = sys.argv
# -v: a line a test, so that CTest shows how far a file came that takes too long
sys.exit(pytest.main([str(Path(script).with_name(name)), "-v", "-ra", "-p", "no:cacheprovider", *options]))
