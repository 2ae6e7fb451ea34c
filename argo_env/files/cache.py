"""Cache on disk of results that take long to compute.

It has a folder for each site with its robot, and a small one for each description of a robot.
"""

import hashlib
import logging
import os
import re
import shutil
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from argo_compiler.base.errors import reason_text
from argo_env.files.parts import NO_CACHE, Parts

VARIABLE = "ARGO_CACHE_DIR"
"""environment variable that names the folder to use instead of the default one"""
MAX_SIZE = 2 * 1024**3
"""bytes that the cache may take; the least recently used entries are removed first"""
_MAX_FILES = 50_000
SITES, ROBOTS = "sites", "robots"
"""the kinds of entries; each kind has a folder of that name"""
_NAME = re.compile("[0-9a-f]{32}")  # of an entry; other files in the folder are not Argo's
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Contents:
    """Number and size of the entries in the cache."""

    sites: int
    """entries of sites; those of robots only count in `files` and `size`"""
    files: int
    size: int
    """bytes"""


def cache_folder() -> Path:
    """Return the folder that ARGO_CACHE_DIR names, or else Argo's folder in the user's cache."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    # Imported here because it is slow to import and often not needed.
    from platformdirs import user_cache_path

    return user_cache_path("argo", appauthor=False)


def entry_for(content: Iterable[str], kind: str = SITES) -> Parts:
    """Return the cache's entry for these texts, which may still be empty.

    Its key is a hash of `content`, which are all texts that its parts depend on. The entry is
    marked as used now. If there is no usable cache folder, the entry stores nothing.
    """
    sink = hashlib.blake2b(digest_size=16)
    for piece in content:
        sink.update(f"{len(piece)} ".encode() + piece.encode())
    key = sink.hexdigest()
    try:
        folder = cache_folder() / kind / key
        with suppress(FileNotFoundError):
            os.utime(folder)  # for `evict`
    except (
        OSError,
        RuntimeError,
        ValueError,
    ) as error:  # no home, forbidden, invalid name
        _log.debug("the cache can't be used: %s", error)
        return NO_CACHE
    return Parts(folder, key)


def evict(max_size: int = MAX_SIZE, max_files: int = _MAX_FILES) -> None:
    """Remove the least recently used entries until the cache is within its limits.

    The remaining entries take at most `max_size` bytes in at most `max_files` files.
    """
    size, count = 0, 0
    for _, folder in sorted(((_last_used(f), f) for f in _entries()), reverse=True):
        sizes = _sizes(folder)
        size, count = size + sum(sizes), count + len(sizes)
        if size > max_size or count > max_files:
            shutil.rmtree(folder, ignore_errors=True)


def contents() -> Contents:
    """Return the number and size of the entries that are in the cache now."""
    entries = _entries()
    sizes = [_sizes(folder) for folder in entries]
    sites = sum(folder.parent.name == SITES for folder in entries)
    return Contents(sites, sum(map(len, sizes)), sum(map(sum, sizes)))


def unwritable_reason() -> str | None:
    """Return the reason why the cache's folder can't be written to, or None if it can.

    To find out, it makes the folder if there is none, and writes a temporary file.
    """
    from tempfile import TemporaryFile

    try:
        folder = cache_folder() / SITES
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder) as file:
            file.write(b"?")
    except (OSError, RuntimeError, ValueError) as error:
        return reason_text(error)
    return None


def clear() -> None:
    """Remove all entries; a process that needs one again computes it anew."""
    for folder in _entries():
        shutil.rmtree(folder, ignore_errors=True)


def _entries() -> list[Path]:
    try:
        paths = [path for kind in (SITES, ROBOTS) for path in (cache_folder() / kind).glob("*")]
        return [path for path in paths if _NAME.fullmatch(path.name)]
    except (OSError, RuntimeError, ValueError):
        return []


def _last_used(folder: Path) -> float:
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
