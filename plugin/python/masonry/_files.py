"""Files that are whole or not there: they are written beside, under a name of their own, and renamed."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np


@contextmanager
def written(path):
    """Path to write to in a `with` block, of the same ending and in the same folder; it gets the name `path` when the block has ended, in one step
    of the file system, and vanishes when the block raises. Writers at the same time do not meet: the last one stays."""
    path = Path(path)
    if path.is_dir():
        raise IsADirectoryError(f"path = {path}: is a folder: must be the name of a file")
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=f".part{path.suffix}", dir=path.parent)
    except OSError as error:
        raise type(error)(f"path = {path}: no file can be written in the folder {path.parent}: {error.strerror}") from None
    os.close(handle)
    try:
        yield beside
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(beside, 0o666 & ~mask)  # mkstemp makes files for their owner alone
        os.replace(beside, path)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


def check_csv(path):
    """ValueError unless the path ends in .csv."""
    if not str(path).endswith(".csv"):
        raise ValueError(f"path = {path}: must end in .csv")


def save_picture(figure, path, **options):
    """Writes a figure of Matplotlib; ValueError where no picture has the ending of the path. options: those of Figure.savefig."""
    path = Path(path)
    if not path.is_dir() and path.suffix[1:].lower() not in figure.canvas.get_supported_filetypes():
        raise ValueError(f"path = {path}: must end in .png, .pdf, .svg or another ending of pictures that Matplotlib writes")
    figure.draw_without_rendering()  # the constrained layout finds the height of axes of equal aspect in its first pass, and room for titles in its second
    with written(path) as beside:
        figure.savefig(beside, **options)


def read_npz(path, what):
    """{name: array} of an .npz file. FileNotFoundError and the like where it cannot be opened; ValueError where it is damaged. what: what a message calls
    the file."""
    with open(path, "rb") as file:
        try:
            with np.load(file) as arrays:
                return {name: arrays[name] for name in arrays.files}
        except Exception as error:  # whatever zipfile, zlib and NumPy say of another file, or of one that was cut off
            raise ValueError(f"path = {path}: is no {what}, or a damaged one: must be a file that masonry has written ({str(error)[:100]})") from None
