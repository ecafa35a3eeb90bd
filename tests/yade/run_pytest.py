"""Runs the tests of one file inside YADE: yade -n -x run_pytest.py test_X.py [options of pytest]. The exit status is that of pytest."""

import os
import sys
from pathlib import Path

import pytest

os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # other packages' plugins take half a second to load
sys.stdout.reconfigure(write_through=True)  # a run that is stopped has shown how far it came
script, name, *options = sys.argv
sys.exit(pytest.main([str(Path(script).with_name(name)), "-q", "-ra", "-p", "no:cacheprovider", *options]))
