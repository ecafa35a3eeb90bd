"""help() of the plugin's classes has sentences alone; the marks that YADE's object editor searches for stay where it looks."""
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest


def test_help_shows_no_marks_and_the_editor_finds_them(tmp_path):
    if not shutil.which("yade"):
        pytest.skip("there is no YADE")
    subprocess.run(["yade", "-j1", "-n", "-x", Path(__file__).with_name("help_in_yade.py"), tmp_path / "found.json"], check=True, capture_output=True,
                   stdin=subprocess.DEVNULL)
    found = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert len(found["help"]) > 50 and found["help"].keys() == found["editor"].keys()
    for name, doc in found["editor"].items():
        # The two searches of yade/qt/SerializableEditor.py
        assert re.search(r":yattrtype:`([^`]*)`", doc) and re.search(r":yattrflags:`\s*([0-9]+)\s*`", doc), name
        sentences = re.sub(r"\s*:y\w+:`[^`]*`", "", doc)
        assert sentences and ":y" not in found["help"][name], name
        assert " ".join(sentences.split()) in " ".join(found["help"][name].split()), name
