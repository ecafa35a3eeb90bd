"""Loads the plugin into YADE, once YADE itself is up."""

import importlib
import inspect
import math
import re
import sys

from masonry._calls import near_words
from masonry._given import shown

from masonry import _fit

_HOW = "run the script with `yade -n -x script.py` (`apt install yade`)"


def _import_yade():
    # Inside `yade` the package is on the path. In a plain Python it is not, and is not searched for: YADE's start-up
    # (threads, command line, exit) would be missing there, and O.run() would not behave as users know it.
    try:
        return importlib.import_module("yade")
    except ImportError as error:
        raise ImportError(f"masonry.dem works inside YADE only: {_HOW}. ({error})") from None


def _no_such_attribute(cls, name):
    own = (word for word, one in inspect.signature(cls.__init__).parameters.items() if one.kind is one.KEYWORD_ONLY)  # of the constructor alone
    near = near_words(name, [*(known for known in dir(cls) if not known.startswith("_")), *own])
    return AttributeError(f"dem.{cls.__name__} has no `{name}`; {near or f'see help(dem.{cls.__name__})'}")


def _wrong_kind(thing, name, known, value):
    """The error of an attribute that was given a value of another kind than the known one."""
    if isinstance(known, bool):
        kind = "True or False"
    elif isinstance(known, (int, float)):
        kind = "a number"
    elif isinstance(known, str):
        kind = "a text"
    elif name in ("mortar", "headMortar"):
        kind = "a JointMat or None"
    elif type(known).__name__ == "Vector3":
        kind = "three numbers (x, y, z)"
    elif isinstance(known, list):
        kind = f"a list, see help(dem.{type(thing).__name__})"
    else:
        kind = "of the kind " + type(known).__name__
    return TypeError(f"{type(thing).__name__}.{name} = {shown(value)}: must be {kind}")


def _assign(assign, thing, name, value):
    """Sets the attribute. A value of the wrong type is refused by the attribute's name, and one that the object refuses does not stay."""
    old = getattr(thing, name, None)
    if name == "restitution" and value is None and isinstance(old, float):
        value = math.nan
    if type(old).__module__.endswith("minieigenHP"):
        old = type(old)(old)  # it was part of the object
    try:
        assign(thing, name, value)
    except TypeError:
        raise _wrong_kind(thing, name, old, value) from None
    except ValueError:
        assign(thing, name, old)
        raise


def _guard_attributes(cls):
    """A misspelled attribute of an object of the class is an error with the names that are near, in the constructor and where it is set: a
    Boost.Python class would take it as a new one. A value of another kind is an error that names the attribute and its kind. The restitution
    None is NaN, the natural one, as in the theory."""
    make, assign = cls.__init__, cls.__setattr__

    def __init__(self, *arguments, **attributes):
        if cls.__name__ == "BlockMat" and attributes.get("restitution", 0) is None:
            attributes["restitution"] = math.nan
        try:
            make(self, *arguments, **attributes)
        except AttributeError:
            for name in attributes:
                if not hasattr(cls, name):
                    raise _no_such_attribute(cls, name) from None
            raise
        except TypeError:
            blank = cls.__new__(cls)
            make(blank)
            for name, value in attributes.items():
                _assign(assign, blank, name, value)
            raise

    def __setattr__(self, name, value):
        if type(self) is cls and not hasattr(cls, name):  # classes that a script derives may have their own
            raise _no_such_attribute(cls, name)
        _assign(assign, self, name, value)

    cls.__init__, cls.__setattr__ = __init__, __setattr__


class _Documentation(str):
    """Text of an attribute, with the marks (type, default, flags) that YADE's object editor searches for in it. help(), IPython and Sphinx expand its tabs
    first, and get the text without the marks."""

    def expandtabs(self, tabsize=8):
        return re.sub(r"\s*:y\w+:`[^`]*`", "", self).expandtabs(tabsize)


def _hide_marks(cls):
    for name, attribute in list(vars(cls).items()):
        if isinstance(attribute, property):
            setattr(cls, name, property(attribute.fget, attribute.fset, attribute.fdel, _Documentation(attribute.__doc__)))


def load_classes():
    """Registers the plugin's classes (again: harmless) and returns them by name.

    Raises ImportError outside YADE or when the plugin is not built, RuntimeError when this YADE is not the one that
    the plugin was built for; YADE is then as it was.
    """
    yade = _import_yade()
    try:
        # Only now: opened before yade, the libraries of YADE lack symbols that yade itself brings in.
        _fit.require_yade()
        plugin = importlib.import_module("masonry._yade")
    except ImportError as error:
        raise ImportError(
            "masonry.dem needs the compiled plugin masonry/_yade.so: build it with `cmake -B build && cmake --build "
            f"build`, put build/python on PYTHONPATH, and {_HOW}. ({error})"
        ) from None
    from yade import wrapper

    classes = {name: getattr(wrapper, name) for name in plugin.setup()}
    for name, cls in classes.items():
        if "__setattr__" not in vars(cls):
            _guard_attributes(cls)
            _hide_marks(cls)
        setattr(yade, name, cls)
        if hasattr(yade, "__all__") and name not in yade.__all__:
            yade.__all__.append(name)
    viewer = sys.modules.get("yade.qt")
    if viewer is not None and hasattr(plugin, "draw_our_classes"):
        plugin.draw_our_classes(viewer.Renderer())
    return classes
