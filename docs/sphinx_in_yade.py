"""Sphinx inside YADE, for docs/build: `yade -n -x docs/sphinx_in_yade.py OUTPUT`, in the root of the project."""
import os
import sys

from sphinx.cmd.build import main

output = sys.argv[-1]
status = main(["-W", "--keep-going", "-q", "-E", "-b", "html", "-c", "docs", ".", output])
if status == 0:
    with open(os.path.join(output, "index.html"), "w", encoding="utf-8") as page:
        page.write('<!DOCTYPE html><meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">yade-masonry</a>\n')
sys.stdout.flush()
os._exit(status)
