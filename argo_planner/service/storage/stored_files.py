"""Reading of the files that a service stores: regular files only, each under the id that it has."""

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import NO_LINK_FLAGS
from argo_env.files.checked_files import damaged, read_checked

ModelT = TypeVar("ModelT", bound=Model)
MAX_BYTES = 100_000_000
"""size of the largest file that is read as a whole"""
_FLAGS = os.O_RDONLY | NO_LINK_FLAGS | getattr(os, "O_NONBLOCK", 0)
"""flags with which a pipe is opened without a wait for its writer"""


def open_stored_file(path: Path) -> int:
    """Open a file for reading; raise OSError, with the reason in words, if it is no regular one.

    A link is not followed.
    """
    if os.path.islink(path):
        raise OSError(errno.ELOOP, "it is a link, and links are not followed")
    file = os.open(path, _FLAGS)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "it is not a regular file")
    return file


def read_stored_bytes(path: Path) -> bytes:
    """Return the content of a regular file; raises OSError as `open_stored_file`."""
    with open(open_stored_file(path), "rb") as file:
        if os.fstat(file.fileno()).st_size > MAX_BYTES:
            raise OSError(errno.EFBIG, f"it is larger than {MAX_BYTES // 1_000_000} MB")
        return file.read()


def read_stored(model: type[ModelT], path: Path, remedy: str) -> ModelT:
    """Return the model in a file of JSON with or without a checksum.

    Raises NotFound if there is no file, Unavailable, which ends with the `remedy`, if it is
    damaged, can't be read, or is no regular file.
    """
    try:
        content = read_stored_bytes(path)
    except (FileNotFoundError, NotADirectoryError):
        raise NotFound(Message("{path} does not exist", path=path)) from None
    except OSError as error:
        raise Unavailable(
            Message(
                "{path} can't be read: {reason}; {remedy}",
                path=path,
                reason=reason_text(error),
                remedy=remedy,
            )
        ) from None
    try:
        return read_checked(model, content, path, remedy)
    except ValidationError as error:
        field = ".".join(map(str, error.errors(include_url=False)[0]["loc"]))
        why = Message("its `{field}` is not of this version of Argo", field=field)
        raise damaged(path, why, remedy) from None


def require_regular_files(folder: Path) -> None:
    """Raise Unavailable if a folder is a link, or has links or pipes inside."""
    if os.path.islink(folder):
        raise Unavailable(
            Message("{folder} is a link, and links are not followed: move it away", folder=folder)
        )
    for above, folders, files in os.walk(folder):
        for path in (Path(above, name) for name in (*folders, *files)):
            with suppress(FileNotFoundError):  # a draft that has meanwhile replaced its file
                mode = path.lstat().st_mode
                if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
                    raise Unavailable(
                        Message("{path} is a link, or not a regular file: move it away", path=path)
                    )


def require_own_id(path: Path, stored: str, id: str, remedy: str) -> None:
    """Raise Unavailable, which ends with the `remedy`, unless the file of `id` has this id inside.

    `stored` is the id that it has. A copy or a renamed file would be taken for another thing.
    """
    if stored != id:
        raise Unavailable(
            Message(
                "{path} was copied or renamed, as the id in it is {stored}: rename it so, "
                "or {remedy}",
                path=path,
                stored=stored[:40],
                remedy=remedy,
            )
        )


def remove_if_empty(folder: Path) -> None:
    """Remove a folder if it is empty, as nothing could be written into it."""
    with suppress(OSError):
        folder.rmdir()
