"""Reads a script's file into text."""

from pathlib import Path

from argo_compiler.errors import ArgoError

MAX_BYTES = 32_000_000
"""of a script's file; a mission of a hundred thousand steps fits"""


def read_script(path: str | Path) -> str:
    """The text of the script at `path`, which must be UTF-8, with or without a byte order mark.

    Raises ArgoError if there is no such file, or if it can't be a script: a directory, empty,
    binary, in another encoding, or larger than `MAX_BYTES`.
    """
    path = Path(path)
    if path.is_dir():
        raise ArgoError(f"{path} is a directory; name the script's file")
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ArgoError(f"{path} does not exist; check the script's name") from None
    except (OSError, ValueError) as error:
        raise ArgoError(f"{path} can't be read: {error}") from error
    if len(data) > MAX_BYTES:
        raise ArgoError(f"{path} is larger than {MAX_BYTES} bytes, too large for a script")
    return decode_script(data, str(path))


def decode_script(data: bytes, source_name: str) -> str:
    """The text in `data`; raises ArgoError as `read_script` does."""
    if not data.strip():
        raise ArgoError(f"{source_name} is empty; a script is a mission sheet or a protocol")
    if b"\0" in data:
        raise ArgoError(f"{source_name} is a binary file; a script is plain text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ArgoError(
            f"{source_name} is not UTF-8 (byte {error.start + 1}, line {line}); save it as UTF-8"
        ) from error
