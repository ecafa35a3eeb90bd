"""Loads the plugin into YADE, once YADE itself is up."""

import importlib

_HOW = "run the script with `yade -n -x script.py` (Debian 12: `apt install yade`)"


def _import_yade():
    # Inside `yade` the package is on the path. In a plain Python it is not, and is not searched for: YADE's start-up
    # (threads, command line, exit) would be missing there, and O.run() would not behave as users know it.
    try:
        return importlib.import_module("yade")
    except ImportError as error:
        raise ImportError(f"masonry.dem works inside YADE only: {_HOW}. ({error})") from None


def load_classes():
    """Registers the plugin's classes (again: harmless) and returns them by name.

    Raises ImportError outside YADE or when the plugin is not built, RuntimeError when this YADE is not the one that
    the plugin was built for.
    """
    yade = _import_yade()
    try:
        # Only now: opened before yade, the libraries of YADE lack symbols that yade itself brings in.
        plugin = importlib.import_module("masonry._yade")
    except ImportError as error:
        raise ImportError(
            "masonry.dem needs the compiled plugin masonry/_yade.so: build it with `cmake -B build && cmake --build "
            f"build`, put build/python on PYTHONPATH, and {_HOW}. ({error})"
        ) from None
    from yade import wrapper

    classes = {name: getattr(wrapper, name) for name in plugin.setup()}
    for name, cls in classes.items():
        setattr(yade, name, cls)
        if hasattr(yade, "__all__") and name not in yade.__all__:
            yade.__all__.append(name)
    return classes
