"""Public calls: keywords that they do not have are refused in one sentence, and warnings point to the line of the user's script."""

import difflib
import functools
import inspect
import sys
import warnings

# Likeness (difflib) of two words that are near, and of those where other words are allowed too.
_NEAR, _ALMOST = 0.6, 0.8


def near_words(word, known, likeness=_NEAR):
    """The known words that are near, as a question; "" where none is."""
    lower = {name.lower(): name for name in known}  # friction_angle is near frictionAngle, and Density is density
    near = [f"`{lower[name]}`" for name in difflib.get_close_matches(word.lower(), lower, cutoff=likeness)]
    return f"did you mean {' or '.join(near)}?" if near else ""


def warn(text):
    """Warns at the line outside the package from which it was called."""
    level, frame = 1, inspect.currentframe()
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, stacklevel=level)


def _checked(function, call):
    """The function; a keyword that it does not have raises TypeError with such a sentence. Its name, signature and docstring stay. call: what the sentence calls it."""
    parameters = inspect.signature(function).parameters
    takes_others = any(one.kind is one.VAR_KEYWORD for one in parameters.values())  # which go on to another call: only almost the right word is a wrong one
    known = [name for name, one in parameters.items() if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY) and name not in ("self", "cls")]

    @functools.wraps(function)
    def checked(*arguments, **keywords):
        for word in keywords:
            if word in known:
                continue
            words = near_words(word, [name for name in known if name not in keywords], _ALMOST if takes_others else _NEAR)
            if words or not takes_others:
                raise TypeError(f"{call} has no `{word}`; {words or _takes(known)}")
        return function(*arguments, **keywords)

    return checked


def _takes(known):
    return f"it takes {', '.join(f'`{name}`' for name in known)}" if known else "it takes no keywords"


def _check_methods(cls, of):
    """Checks the constructor and the public methods of a class, in place."""
    for name, method in list(vars(cls).items()):
        kind = type(method) if isinstance(method, (classmethod, staticmethod)) else None
        function = method.__func__ if kind else method
        if inspect.isfunction(function) and not hasattr(function, "__wrapped__") and (name == "__init__" or not name.startswith("_")):
            checked = _checked(function, f"{of}()" if name == "__init__" else f"{of}.{name}()")
            setattr(cls, name, kind(checked) if kind else checked)


def check_keywords(module):
    """Checks the keywords of all public functions and classes of the package's module of that name, and of the classes whose objects they return: those beside
    them in their files. pickle looks for a function where it was defined: it is replaced there too."""
    space, short = vars(sys.modules[module]), module.rpartition(".")[2]
    public = {name: thing for name, thing in space.items() if not name.startswith("_") and getattr(thing, "__module__", "").startswith("masonry")}
    for name, thing in public.items():
        source = vars(sys.modules[thing.__module__])
        if inspect.isfunction(thing) and not hasattr(thing, "__wrapped__"):
            space[name] = source[thing.__name__] = _checked(thing, f"{short}.{name}()")
        for beside, cls in source.items():
            if inspect.isclass(cls) and cls.__module__ == thing.__module__ and not beside.startswith("_") and not issubclass(cls, (tuple, Exception)):
                _check_methods(cls, f"{short}.{beside}" if beside in public else beside)
