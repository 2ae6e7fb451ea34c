"""The file beside a script in which its draft is kept, with what was decided on."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.files.atomic_write import check_writable, is_stream, write_atomically
from argo_compiler.files.loading import FileError, decode_text, read_bytes
from argo_compiler.script.documents.reading import MAX_BYTES

if TYPE_CHECKING:
    from argo_compiler.script import Draft, StoredDraft

_MAX_DRAFT_BYTES = 2 * MAX_BYTES


def draft_path(script: Path) -> Path | None:
    """Return where the draft of a script is kept: beside it; None for standard input and pipes."""
    if str(script) == "-" or is_stream(script):
        return None
    return script.with_name(f"{script.name}.draft")


def read_draft_beside(script: Path) -> "StoredDraft | None":
    """Return what is kept in the draft beside a script; None if there is none.

    Raises:
        ArgoError: The file is no draft, or can't be read.
    """
    path = draft_path(script)
    if path is None or not os.path.lexists(path):
        return None
    if os.path.isdir(path):
        raise Invalid(f"{path} is a directory, not the draft of {script}; rename it")
    from argo_compiler.script import read_draft

    try:
        text = decode_text(read_bytes(path, "draft", _MAX_DRAFT_BYTES), str(path), "draft")
    except FileError as error:  # names a file other than the script, which messages are about
        raise Invalid(str(error)) from None
    return read_draft(text, str(path))


def keep_draft(script: Path, draft: "Draft") -> None:
    """Write the draft of a script beside it, if there is something to keep or to decide.

    If that is impossible, a message on standard error says so, and the command continues.
    """
    path = draft_path(script)
    if path is None or not (draft.left or draft.decisions or os.path.exists(path)):
        return
    try:
        write_draft(script, draft)
    except Unavailable as error:
        loss = "; what was decided counts for this command only" if draft.decisions else ""
        print(f"argo: {error}{loss}", file=sys.stderr)


def write_draft(script: Path, draft: "Draft") -> None:
    """Write the draft of a script beside it.

    Raises:
        Unavailable: The file can't be written.
    """
    from argo_compiler.script import draft_text

    path = draft_path(script)
    assert path is not None, "only the draft of a file is kept"
    try:
        write_atomically(path, draft_text(draft))
    except OSError as error:
        raise Unavailable(f"{path} can't be written: {error.strerror}") from error


def require_draft_writable(script: Path) -> None:
    """Raise ArgoError if no draft can be kept beside a script."""
    path = draft_path(script)
    if path is None:
        raise Invalid(f"{script} is no file, so decisions can't be kept beside it")
    check_writable(path)
