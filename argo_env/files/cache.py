"""A cache on disk of what takes long to find: a folder for each site with its robot, and small ones
for the descriptions of robots."""

import hashlib
import logging
import os
import re
import shutil
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from argo_env.files.parts import NOWHERE, Parts

VARIABLE = "ARGO_CACHE_DIR"
"""The environment variable that names another folder."""
MOST = 2 * 1024**3
"""bytes that the cache may take; what was not used for longest makes room"""
_MOST_FILES = 50_000
SITES, ROBOTS = "sites", "robots"
"""what is kept, each in a folder of that name"""
_NAME = re.compile("[0-9a-f]{32}")  # of an entry: what else lies there is not Argo's
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Contents:
    """What is in the cache."""

    sites: int
    files: int
    size: int
    """bytes"""


def cache_folder() -> Path:
    """Where the cache is: the folder that ARGO_CACHE_DIR names, or the user's own for caches."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    # Slow to import, and rarely needed twice.
    from platformdirs import user_cache_path

    return user_cache_path("argo", appauthor=False)


def entry(content: Iterable[str], kind: str = SITES) -> Parts:
    """Return the parts that belong to what `content` says, all that they depend on."""
    sink = hashlib.blake2b(digest_size=16)
    for piece in content:
        sink.update(f"{len(piece)} ".encode() + piece.encode())
    key = sink.hexdigest()
    try:
        folder = cache_folder() / kind / key
        with suppress(FileNotFoundError):
            os.utime(folder)  # used now
    except (OSError, RuntimeError, ValueError) as error:  # no home, not mine, no name of a file
        _log.debug("the cache can't be used: %s", error)
        return NOWHERE
    return Parts(folder, key)


def make_room(most: int = MOST, files: int = _MOST_FILES) -> None:
    """Take away the entries that were not used for longest, until the others take at most `most`
    bytes in `files` files."""
    kept, count = 0, 0
    for _, folder in sorted(((_used(f), f) for f in _entries()), reverse=True):
        sizes = _sizes(folder)
        kept, count = kept + sum(sizes), count + len(sizes)
        if kept > most or count > files:
            shutil.rmtree(folder, ignore_errors=True)


def contents() -> Contents:
    """Return what is in the cache now."""
    entries = _entries()
    sizes = [_sizes(folder) for folder in entries]
    sites = sum(folder.parent.name == SITES for folder in entries)
    return Contents(sites, sum(map(len, sizes)), sum(map(sum, sizes)))


def flaw() -> str | None:
    """Why nothing can be kept in the cache; None if it can."""
    from tempfile import TemporaryFile

    try:
        folder = cache_folder() / SITES
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder) as file:
            file.write(b"?")
    except (OSError, RuntimeError, ValueError) as error:
        return getattr(error, "strerror", None) or str(error)
    return None


def empty() -> None:
    """Takes all entries away; whoever uses them just then makes them anew."""
    for folder in _entries():
        shutil.rmtree(folder, ignore_errors=True)


def _entries() -> list[Path]:
    try:
        found = [path for kind in (SITES, ROBOTS) for path in (cache_folder() / kind).glob("*")]
        return [path for path in found if _NAME.fullmatch(path.name)]
    except (OSError, RuntimeError, ValueError):
        return []


def _used(folder: Path) -> float:
    try:
        return folder.stat().st_mtime
    except OSError:
        return 0.0


def _sizes(folder: Path) -> list[int]:
    sizes = []
    try:
        for file in os.scandir(folder):
            with suppress(OSError):
                sizes.append(file.stat().st_size)
    except OSError:
        pass
    return sizes
