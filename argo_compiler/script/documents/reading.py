"""Reads a script's file into text."""

from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_compiler.files.loading import decode_text, read_bytes, require_size

MAX_BYTES = 32_000_000
"""of a script's file; a mission of a hundred thousand steps fits"""


def read_script(path: str | Path) -> str:
    """The text of the script at `path`, UTF-8 or UTF-16.

    Raises ArgoError if there is no such file, or if it can't be a script: a directory, empty,
    binary, in another encoding, or larger than `MAX_BYTES`.
    """
    return decode_script(read_bytes(Path(path), "script", MAX_BYTES), str(path))


def decode_script(data: bytes, source_name: str) -> str:
    """The text in `data`; raises ArgoError as `read_script` does."""
    require_size(data, source_name, "script", MAX_BYTES)
    if not data.strip():
        raise Invalid(f"{source_name} is empty; a script is a mission sheet or a protocol")
    return decode_text(data, source_name, "script")
