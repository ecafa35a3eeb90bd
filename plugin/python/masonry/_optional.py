"""Packages that only some functions need."""

from contextlib import contextmanager


@contextmanager
def needs(package, what):
    """Imports in the `with` block; where one fails, the error names the package to install. what: what it is needed for."""
    try:
        yield
    except ImportError as error:
        raise ImportError(f"{what} needs {package}: apt install {package}. ({error})") from None
