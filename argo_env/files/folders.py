"""Checks and errors for the folders and files that results are written to."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from argo_compiler.base.errors import Conflict, Unavailable, reason_text
from argo_compiler.base.message import Message, as_message


def require_folder_or_creatable(path: Path) -> None:
    """Raise ArgoError if the path is no folder and none can be made there.

    To be called before long work.

    Raises:
        Conflict: the path, or the nearest existing path above it, is a file.
        Unavailable: the folder does not exist, and the one above it can't be written to. Whether an
            existing folder can be written to is not checked.
    """
    above = path.absolute()
    while not os.path.lexists(above):
        above = above.parent
    if not os.path.isdir(above):
        problem = (
            Message("is")
            if above == path.absolute()
            else Message("can't be made a folder: {above} is", above=above)
        )
        raise Conflict(
            Message(
                "{path} {problem} a file, but a folder is needed; choose another path",
                path=path,
                problem=problem,
            )
        )
    if not (os.path.isdir(path) or os.access(above, os.W_OK | os.X_OK)):
        raise Unavailable(
            Message(
                "{path} can't be made a folder: {reason}",
                path=path,
                reason=as_message(os.strerror(errno.EACCES)),
            )
        )


def leaves_folder(name: str) -> bool:
    """Return True if a relative path may lead out of the folder that it is relative to.

    That is so for an absolute path, one with a drive of Windows, and one with `..`.
    """
    parts = name.replace("\\", "/").split("/")
    return ".." in parts or (len(parts) > 1 and not parts[0]) or parts[0][1:2] == ":"


def links_leave_folder(folder: Path, name: str) -> bool:
    """Return True if links lead from a path relative to the folder to a place outside of it.

    If the path is itself a folder, links in that one count too.
    """
    if "\0" in name:
        return False  # there is no such file
    path, root = folder / name, os.path.realpath(folder)
    inside: list[str] = []
    with suppress(OSError):
        inside = os.listdir(path)
    return not all(
        Path(os.path.realpath(one)).is_relative_to(root)
        for one in (path, *(path / entry for entry in inside))
    )


def make_folder(path: Path) -> None:
    """Make the folder and its parents if they do not exist.

    To be called before long work, so that its results can be written. Raises Unavailable if the
    folder can't be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be made a folder: {reason}", path=path, reason=reason_text(error))
        ) from error


def make_private_folder(path: Path) -> None:
    """Make a folder that only its owner can open, or make an existing one so; raises OSError.

    Folders above it are made as usual.
    """
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.chmod(0o700)


@contextmanager
def reporting_write_errors(path: Path, content: str = "", remedy: str = "") -> Iterator[None]:
    """Raise Unavailable for an OSError in the body, which writes to `path`.

    The message names `content`, such as `the film`, and ends with the `remedy`, which begins with
    its punctuation, as in `; choose another place`.
    """
    try:
        yield
    except OSError as error:
        subject = f": {content}" if content else ""
        raise Unavailable(
            Message(
                "{path}{subject} can't be written: {reason}{remedy}",
                path=path,
                subject=subject,
                reason=reason_text(error),
                remedy=remedy,
            )
        ) from error


CHOOSE_ANOTHER_PLACE = Message("; choose another place")
"""a remedy for `reporting_write_errors`"""
