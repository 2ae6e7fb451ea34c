"""Reads files: what is no readable file is refused with a message, and never by the library."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import BinaryIO

from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.files.encodings import encoding_of

_PART = 1 << 20
_DOCUMENTS = {b"%PDF-": "PDF", rb"{\rtf": "RTF"}
"""how documents begin that may look like text"""


class FileProblem(StrEnum):
    """Why a file is of no use."""

    MISSING = "missing"
    DIRECTORY = "directory"
    UNREADABLE = "unreadable"
    TOO_LARGE = "too-large"
    NOT_TEXT = "not-text"


class FileError(ArgoError):
    """A file can't be read: `problem` says why, `message` in words, and `hint` what to do."""

    def __init__(self, name: object, problem: FileProblem, message: str, hint: str) -> None:
        super().__init__(f"{name}: {message}; {hint}")
        self.problem = problem
        self.message = message
        self.hint = hint

    def __reduce__(self) -> tuple[object, ...]:
        name = str(self).removesuffix(f": {self.message}; {self.hint}")
        return type(self), (name, self.problem, self.message, self.hint), vars(self)


class NoFile(FileError, NotFound):
    """There is no file of that name."""


class UnreadableFile(FileError, Invalid):
    """There is something of that name, but it can't be read, or is no such thing."""


def read_bytes(path: Path, thing: str, max_bytes: int, magic: bytes = b"") -> bytes:
    """What the file holds that is meant as a `thing`, such as `script`; no more than its beginning
    if that is not the `magic` one of all such things.

    Raises FileError if there is no such file, it can't be read, or it is too large.
    """
    with opened(path, thing) as file:
        content = file.read(len(magic))
        if content == magic:
            size = os.fstat(file.fileno()).st_size
            # What is asked for is allocated at once, and pipes have no size.
            whole = 0 < size <= max_bytes
            content += file.read() if whole else _read_at_most(file, max_bytes + 1)
    require_size(content, path, thing, max_bytes)
    return content


@contextmanager
def opened(path: Path, thing: str) -> Iterator[BinaryIO]:
    """The file that is meant as a `thing`, open for reading. Raises FileError where it can't be
    opened, or read further."""
    try:
        if os.path.isdir(path):
            message = "can't be read: is a directory"
            raise UnreadableFile(path, FileProblem.DIRECTORY, message, f"name the {thing} in it")
        with path.open("rb") as file:
            yield file
    except FileNotFoundError:
        raise NoFile(
            path,
            FileProblem.MISSING,
            "can't be read: it does not exist (no such file)",
            f"check the name of the {thing}",
        ) from None
    except OSError as error:
        message = f"can't be read: {error.strerror}"
        raise UnreadableFile(path, FileProblem.UNREADABLE, message, "check the file") from error
    except ValueError as error:  # a NUL in the path
        message = f"can't be read: {error}"
        raise UnreadableFile(path, FileProblem.UNREADABLE, message, "check its name") from error


def _read_at_most(file: BinaryIO, count: int) -> bytes:
    parts = []
    while count > 0 and (part := file.read(min(count, _PART))):
        parts.append(part)
        count -= len(part)
    return b"".join(parts)


def read_text(path: Path, thing: str, max_bytes: int) -> str:
    """The text of the file that is meant as a `thing`; raises FileError if there is none."""
    return decode_text(read_bytes(path, thing, max_bytes), path, thing)


def require_size(content: bytes, name: object, thing: str, max_bytes: int) -> None:
    """Raises UnreadableFile if there is more of it than of any `thing`."""
    if len(content) > max_bytes:
        raise UnreadableFile(
            name,
            FileProblem.TOO_LARGE,
            f"is larger than {max_bytes} bytes",
            f"a {thing} is far smaller: is it the right file?",
        )


def decode_text(content: bytes, name: object, thing: str) -> str:
    """The text of a file that is meant as a `thing`: UTF-8 with or without a byte order mark, or
    UTF-16, which Windows calls Unicode.

    Raises UnreadableFile if it is binary or in another encoding.
    """
    for beginning, kind in _DOCUMENTS.items():
        if content.startswith(beginning):
            message = f"is no plain text but a document ({kind})"
            raise UnreadableFile(name, FileProblem.NOT_TEXT, message, "save it as plain text")
    encoding = encoding_of(content)
    try:
        text = "\0" if encoding is None else content.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = content[: error.start].decode(error.encoding, "replace").count("\n") + 1
        place = f"(byte {error.start + 1}, line {line})"
        wrong = "is not UTF-8" if encoding == "utf-8" else f"is damaged {error.encoding.upper()}"
        raise UnreadableFile(
            name, FileProblem.NOT_TEXT, f"{wrong} {place}", "save it as UTF-8"
        ) from error
    if "\0" in text:
        raise UnreadableFile(
            name, FileProblem.NOT_TEXT, "is no text but a binary file", f"a {thing} is plain text"
        )
    return text
