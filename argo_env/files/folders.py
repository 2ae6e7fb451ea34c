"""Folders that results are written to."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from argo_compiler.base.errors import Conflict, Unavailable


def check_folder(path: Path) -> None:
    """Raises ArgoError if it is no folder and can't be made one. To be called before long work."""
    above = path.absolute()
    while not os.path.lexists(above):
        above = above.parent
    if not os.path.isdir(above):
        file = "is" if above == path.absolute() else f"can't be made a folder: {above} is"
        raise Conflict(f"{path}: {file} a file, and a folder is asked for; choose another")
    if not (os.path.isdir(path) or os.access(above, os.W_OK | os.X_OK)):
        raise Unavailable(f"{path}: can't be made a folder: {os.strerror(errno.EACCES)}")


def make_folder(path: Path) -> None:
    """Makes the folder, so that no work is lost for want of a place for its results. Raises
    ArgoError if that is impossible."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Unavailable(f"{path}: can't be made a folder: {error.strerror}") from error


@contextmanager
def writing(place: Path, what: str = "", way_out: str = "") -> Iterator[None]:
    """Raises Unavailable for what goes wrong while `what`, such as `the film`, is written there."""
    try:
        yield
    except OSError as error:
        what = f"{what} " if what else ""
        raise Unavailable(f"{place}: {what}can't be written: {error.strerror}{way_out}") from error


ANOTHER_PLACE = "; choose another place"
"""a way out"""
