"""Writes files so that nobody ever sees half of one."""

import os
import secrets
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, text: str) -> None:
    """Writes `text` as UTF-8 with Unix line ends; afterwards the file is either old or new.

    It is written beside its place and then moved there. A link stays a link, and what is no file,
    such as a terminal, is written to as it is. Raises OSError.
    """
    path = path.resolve()
    content = text.encode("utf-8")
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    beside = path.with_name(f".argo-{secrets.token_hex(6)}.tmp")
    try:
        with beside.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            beside.chmod(path.stat().st_mode & 0o7777)
        beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise
