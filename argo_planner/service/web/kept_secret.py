"""The token of a folder of missions."""

import os
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import Unavailable
from argo_planner.service.web.access import checked_secret, new_secret

_SECRET = ".token"


def kept_secret(folder: Path) -> str:
    """The token of the folder, made where there is none: a service that begins again has the same,
    so that open pages go on. Raises Unavailable where it can't be kept, Invalid where it was
    spoilt."""
    path = folder / _SECRET
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            file = os.open(path, flags, 0o600)
            with open(file, "w", encoding="ascii") as new:
                new.write(new_secret())
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
        with open(file, encoding="ascii") as kept:
            return checked_secret(kept.read().strip(), str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise Unavailable(f"{path}: can't be kept: {error}; choose another folder") from None
