"""Prints, as JSON, what help() says of the plugin's classes, and what YADE's object editor finds in the documentation of their attributes."""
import json
import os
import pydoc
import sys

import masonry._yade
from masonry import dem

classes = {name: getattr(dem, name) for name in masonry._yade.setup()}
attributes = {f"{name}.{attribute}": value for name, cls in classes.items() for attribute, value in vars(cls).items() if attribute in cls().dict()}
with open(sys.argv[-1], "w", encoding="utf-8") as file:
    json.dump({"help": {name: pydoc.render_doc(attribute, renderer=pydoc.plaintext) for name, attribute in attributes.items()},
               "editor": {name: str(attribute.__doc__) for name, attribute in attributes.items()}}, file)
sys.stdout.flush()
os._exit(0)
