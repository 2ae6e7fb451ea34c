"""Loading of files: each file that can't be read raises an error with a message and a hint."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import BinaryIO

from argo_compiler.base.errors import ArgoError, Invalid, NotFound, reason_text
from argo_compiler.base.message import Message, as_message
from argo_compiler.base.quantity_text import with_article
from argo_compiler.files.atomic_write import OPEN_FILES
from argo_compiler.files.encodings import detect_encoding

_CHUNK = 1 << 20
_DOCUMENTS = {b"%PDF-": "PDF", rb"{\rtf": "RTF"}
"""First bytes of documents that may look like text, with the name of their format."""


class FileProblem(StrEnum):
    """Reason why a file can't be used."""

    MISSING = "missing"
    DIRECTORY = "directory"
    UNREADABLE = "unreadable"
    TOO_LARGE = "too-large"
    NOT_TEXT = "not-text"


class FileError(ArgoError):
    """Raised when a file can't be read.

    Attributes:
        problem: The reason.
        message: The reason in words, with a verb but without the file as its subject.
        hint: What the user can do.
    """

    def __init__(self, name: object, problem: FileProblem, message: str, hint: str) -> None:
        self.message = as_message(message)
        self.hint = as_message(hint)
        super().__init__(
            Message("{name} {message}; {hint}", name=name, message=self.message, hint=self.hint)
        )
        self.problem = problem

    def __reduce__(self) -> tuple[object, ...]:
        name = str(self).removesuffix(f" {self.message}; {self.hint}")
        return type(self), (name, self.problem, self.message, self.hint), vars(self)


class MissingFile(FileError, NotFound):
    """Raised when there is no file with that name."""


class UnreadableFile(FileError, Invalid):
    """Raised when a file exists, but can't be read or is not of the expected kind."""


def read_bytes(path: Path, kind: str, max_bytes: int, whole_if_magic: bytes = b"") -> bytes:
    """Return the content of a file.

    Args:
        path: The file.
        kind: What the file should be, such as `script`; for messages.
        max_bytes: Size of the largest file that is accepted.
        whole_if_magic: First bytes of all files of this kind. If the file has others, only as many
            of its first bytes as `whole_if_magic` has are returned.

    Raises:
        FileError: The file does not exist, can't be read, or is too large.
    """
    with open_file(path, kind) as file:
        content = file.read(len(whole_if_magic))
        if content == whole_if_magic:
            size = os.fstat(file.fileno()).st_size
            # `read(n)` allocates n bytes at once, and pipes report no size.
            fits = 0 < size <= max_bytes
            content += file.read() if fits else _read_at_most(file, max_bytes + 1)
    require_size(content, path, kind, max_bytes)
    return content


@contextmanager
def open_file(path: Path, kind: str) -> Iterator[BinaryIO]:
    """Yield a file that is open for reading.

    `kind` is what the file should be, such as `script`; for messages. Raises FileError if the file
    can't be opened, or if reading fails inside the block.
    """
    try:
        if os.path.isdir(path):
            message = Message("can't be read: it is a directory")
            raise UnreadableFile(
                path,
                FileProblem.DIRECTORY,
                message,
                Message("name the {kind} in it", kind=as_message(kind)),
            )
        with path.open("rb") as file:
            yield file
    except FileNotFoundError:
        raise MissingFile(
            path,
            FileProblem.MISSING,
            "can't be read: it does not exist (no such file)",
            Message("check the name of the {kind}", kind=as_message(kind)),
        ) from None
    except OSError as error:
        message = Message("can't be read: {reason}", reason=reason_text(error))
        raise UnreadableFile(path, FileProblem.UNREADABLE, message, "check the file") from error
    except ValueError as error:  # a NUL in the path
        message = Message("can't be read: {error}", error=error)
        raise UnreadableFile(path, FileProblem.UNREADABLE, message, "check its name") from error


def _read_at_most(file: BinaryIO, count: int) -> bytes:
    parts = []
    while count > 0 and (part := file.read(min(count, _CHUNK))):
        parts.append(part)
        count -= len(part)
    return b"".join(parts)


def read_text(path: Path, kind: str, max_bytes: int) -> str:
    """Return the text of a file.

    `kind` is what the file should be, such as `script`; for messages. Raises FileError if the file
    can't be read, is too large, or is not text.
    """
    return decode_text(read_bytes(path, kind, max_bytes), path, kind)


def is_pipe(path: Path) -> bool:
    """Return True if the path is a pipe, which can be read only once; False if that is unknown."""
    try:
        return stat.S_ISFIFO(os.stat(path).st_mode)
    except (OSError, ValueError):
        return False


def is_own_open_file(path: Path) -> bool:
    """Return True if the path names a file that this process has open, as `/dev/stdin` does.

    For another process, it is another file.
    """
    absolute = path.absolute()
    return absolute == Path("/dev/stdin") or absolute.parent in OPEN_FILES


def size_on_disk(path: Path) -> int:
    """Return the size of a file, or of all files of a folder, in bytes; 0 if it can't be found."""
    try:
        files = [path / name for name in os.listdir(path)] if os.path.isdir(path) else [path]
        return sum(map(os.path.getsize, files))
    except (OSError, ValueError):
        return 0


def require_size(content: bytes, name: object, kind: str, max_bytes: int) -> None:
    """Raise UnreadableFile if the content is too large; `name` and `kind` are for the message."""
    if len(content) > max_bytes:
        raise UnreadableFile(
            name,
            FileProblem.TOO_LARGE,
            Message("is larger than {max_bytes} bytes", max_bytes=max_bytes),
            Message(
                "{with_article} is far smaller: is it the right file?",
                with_article=with_article(kind),
            ),
        )


def decode_text(content: bytes, name: object, kind: str) -> str:
    """Return the text of a file's content.

    `name` is the file, and `kind` what it should be, such as `script`; both are for messages. The
    content may be UTF-8 with or without a byte order mark, UTF-32 with such a mark, or UTF-16,
    which Windows calls Unicode. Raises UnreadableFile if it is binary or in another encoding.
    """
    for first_bytes, document in _DOCUMENTS.items():
        if content.startswith(first_bytes):
            message = Message("is a document ({document}), not plain text", document=document)
            raise UnreadableFile(name, FileProblem.NOT_TEXT, message, "save it as plain text")
    encoding = detect_encoding(content)
    try:
        text = "\0" if encoding is None else content.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = content[: error.start].decode(error.encoding, "replace").count("\n") + 1
        position = Message("(byte {start}, line {line})", start=error.start + 1, line=line)
        problem = (
            Message("is not UTF-8")
            if encoding == "utf-8"
            else Message("is damaged {upper}", upper=error.encoding.upper())
        )
        raise UnreadableFile(
            name,
            FileProblem.NOT_TEXT,
            Message("{problem} {position}", problem=problem, position=position),
            "save it as UTF-8",
        ) from error
    if "\0" in text:
        raise UnreadableFile(
            name,
            FileProblem.NOT_TEXT,
            "is a binary file, not text",
            Message("{with_article} is plain text", with_article=with_article(kind)),
        )
    return text
